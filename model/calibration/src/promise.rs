//! Expected error of a new session of the same rig: the whole procedure, from noise to effects, is
//! repeated without a quarter of the series and evaluated on it. The scatter of new mounts is
//! added, since the series of one mount share it.

use crate::forms::with_best_form;
use crate::inference::{
    FoundStructure, Levels, Model, Noise, Observations, Selection, Weighed, fit, new_mounts_n2,
    selected_model,
};
use crate::parallel::map_each;

/// Number of folds.
const FOLDS: usize = 4;
/// Residuals above this number of standard deviations are clipped.
const FURTHEST_SD: f64 = 20.0;

/// Root mean square errors in newtons on series that were not used in any way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Promise {
    /// Error of the refitted baseline.
    pub(crate) baseline_n: f64,
    /// Error of the model that the procedure selected on the other series.
    pub(crate) augmented_n: f64,
}

/// Result of the procedure on a table without one fold.
pub(crate) struct Learned {
    left_out: usize,
    seen: Observations,
    model: Model,
    noise: Noise,
    structure: Option<FoundStructure>,
}

/// Returns the indices of the folds.
pub(crate) fn parts() -> Vec<usize> {
    (0..FOLDS).collect()
}

/// Runs the procedure without one fold; `None` if the other rows do not determine the baseline.
pub(crate) fn learn(left_out: usize, start: &Model, data: &Observations, levels: Levels) -> Option<Learned> {
    let parts = data.parts_of_series(FOLDS);
    let mut seen = data.subset(|row| parts[row] != left_out);
    if seen.points.len() < start.values().len() + 8 {
        return None;
    }
    let (model, noise, structure) = selected_model(start, &mut seen, levels);
    Some(Learned { left_out, seen, model, noise, structure })
}

/// Returns the expected errors of a table from the results of its folds; `None` if no fold could be
/// evaluated.
///
/// `with_form` is true if the model contains a derived formula in place of shapes.
pub(crate) fn promise(
    learned: Vec<Option<Learned>>,
    whole: &Selection,
    data: &Observations,
    with_form: bool,
) -> Option<Promise> {
    let judged = map_each(learned, |learned| judge(learned?, whole, data, with_form));
    let (mut baseline, mut augmented, mut rows) = (0.0, 0.0, 0.0);
    for (b, a, n) in judged.into_iter().flatten() {
        baseline += b;
        augmented += a;
        rows += n;
    }
    let anew = new_mounts_n2(&whole.augmented, data, whole.noise);
    let expected_n = |squares: f64| (squares / rows + anew).sqrt();
    (rows > 0.0).then(|| Promise { baseline_n: expected_n(baseline), augmented_n: expected_n(augmented) })
}

/// Returns the sums of squares on the fold that was left out, and its number of readings; `None` if
/// none of them counts.
fn judge(
    learned: Learned,
    whole: &Selection,
    data: &Observations,
    with_form: bool,
) -> Option<(f64, f64, f64)> {
    let Learned { left_out, seen, model: mut found, noise, structure } = learned;
    let parts = data.parts_of_series(FOLDS);
    let hidden = data.subset(|row| parts[row] == left_out && !data.is_excluded(row));
    if hidden.points.is_empty() {
        return None;
    }
    let readings: f64 = hidden.counts.iter().sum();
    if let Some(structure) = structure.filter(|_| with_form)
        && let Some(with_form) = with_best_form(structure.covariate, &found, noise, &seen)
    {
        found = with_form;
    }
    let baseline = fit(&whole.baseline.model, &Weighed::new(&seen, noise));
    let squares = |model: &Model| -> f64 {
        let predicted = model.predict(&hidden.points);
        predicted
            .iter()
            .zip(&hidden.force_n)
            .enumerate()
            .map(|(i, (p, y))| {
                let furthest = FURTHEST_SD * whole.noise.at(hidden.points[i].load_n, hidden.friction_n[i]);
                hidden.counts[i] * ((p - y).powi(2).min(furthest * furthest) + hidden.within_n2[i])
            })
            .sum()
    };
    Some((squares(&baseline.model), squares(&found), readings))
}
