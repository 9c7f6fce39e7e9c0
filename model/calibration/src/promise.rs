//! The error to expect on a new session of the same rig: the whole procedure, from the noise to the names, is run
//! without a fourth of the series, and judged on them; and what mounts that are put on anew add, whose scatter the other
//! series of a mount share.

use crate::forms::with_best_form;
use crate::inference::{
    FoundStructure, Levels, Model, Noise, Observations, Selection, Weighed, fit, new_mounts_n2,
    selected_model,
};
use crate::parallel::map_each;

/// Parts into which the series are dealt.
const FOLDS: usize = 4;
/// Readings further off than this many standard deviations count as if they were this far off.
const FURTHEST_SD: f64 = 20.0;

/// Root mean square errors in newtons on series that had no part in anything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Promise {
    /// Of the refitted baseline.
    pub(crate) baseline_n: f64,
    /// Of what the procedure made of the other series.
    pub(crate) augmented_n: f64,
}

/// What the procedure makes of a table without one part of its series.
pub(crate) struct Learned {
    left_out: usize,
    seen: Observations,
    model: Model,
    noise: Noise,
    structure: Option<FoundStructure>,
}

/// The parts that are left out in turn.
pub(crate) fn parts() -> Vec<usize> {
    (0..FOLDS).collect()
}

/// Runs the procedure without one part; `None` if the rest cannot fix the baseline.
pub(crate) fn learn(left_out: usize, start: &Model, data: &Observations, levels: Levels) -> Option<Learned> {
    let parts = data.parts_of_series(FOLDS);
    let mut seen = data.subset(|row| parts[row] != left_out);
    if seen.points.len() < start.values().len() + 8 {
        return None;
    }
    let (model, noise, structure) = selected_model(start, &mut seen, levels);
    Some(Learned { left_out, seen, model, noise, structure })
}

/// The promise for a table, from what was learned of its parts; `None` if no part could be judged.
///
/// `with_form` says that the model takes a drawn form in place of shapes.
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

/// Sums of squares on the part that was left out, and its readings; `None` if it has none that count.
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
