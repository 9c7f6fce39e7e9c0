//! Held-out errors: each quarter of the series, then each quarter of the loads, is left out of the
//! fit.

use crate::inference::{Model, Weighed, fit};

/// Root mean square errors in newtons on rows that are left out of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOut {
    /// Error on each quarter of the series, left out in turn.
    pub series_n: f64,
    /// Error on each quarter of the loads, left out in turn.
    pub loads_n: f64,
}

impl HeldOut {
    /// Returns the root mean square of both errors.
    pub fn both_n(self) -> f64 {
        (0.5 * (self.series_n.powi(2) + self.loads_n.powi(2))).sqrt()
    }
}

const FOLDS: usize = 4;
/// Returns the held-out errors of a model, which is refitted from its current constants.
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
    /// Replaces an error that could not be determined, for lack of series or loads, by the other
    /// one.
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
