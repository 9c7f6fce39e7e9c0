//! Errors on data held out from the fit: whole series, then whole loads.

use crate::inference::{Model, Weighed, fit};

/// Root mean square errors in newtons on rows that the fit did not see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOut {
    /// Each fourth of the series left out in turn.
    pub series_n: f64,
    /// Each fourth of the loads left out in turn.
    pub loads_n: f64,
}

impl HeldOut {
    /// Both together, as one root mean square.
    pub fn both_n(self) -> f64 {
        (0.5 * (self.series_n.powi(2) + self.loads_n.powi(2))).sqrt()
    }
}

const FOLDS: usize = 4;
/// Held-out errors of a model that is refitted from where it stands.
pub fn held_out(model: &Model, weighed: &Weighed<'_>) -> HeldOut {
    let data = weighed.data;
    let mut loads: Vec<f64> = data.points.iter().map(|p| p.load_n).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    let load_fold = |i: usize| loads.partition_point(|l| *l < data.points[i].load_n - 1e-7) % FOLDS;
    let parts = data.parts_of_series(FOLDS);
    let series_fold = |i: usize| parts[i];
    HeldOut {
        series_n: error(model, weighed, &series_fold),
        loads_n: if loads.len() > FOLDS { error(model, weighed, &load_fold) } else { f64::NAN },
    }
    .without_gaps()
}

impl HeldOut {
    /// With too few loads, or series, to leave any out, the others stand for both.
    fn without_gaps(self) -> Self {
        let either = |a: f64, b: f64| if a.is_nan() { b } else { a };
        Self { series_n: either(self.series_n, self.loads_n), loads_n: either(self.loads_n, self.series_n) }
    }
}

fn error(model: &Model, weighed: &Weighed<'_>, fold: &dyn Fn(usize) -> usize) -> f64 {
    let data = weighed.data;
    let mut misses = Vec::new();
    for left_out in 0..FOLDS {
        let seen = data.subset(|i| fold(i) != left_out);
        if seen.points.len() < model.values().len() + 2 || seen.points.len() == data.points.len() {
            continue;
        }
        let fitted = fit(model, &Weighed::new(&seen, weighed.noise));
        let predicted = fitted.model.predict(&data.points);
        let hidden = (0..predicted.len()).filter(|i| fold(*i) == left_out && data.is_sound(*i));
        misses.extend(hidden.map(|i| (i, data.force_n[i] - predicted[i])));
    }
    data.root_mean_square_n(misses.into_iter())
}
