//! The error to expect on a new session of the same rig: the whole procedure, from the noise to the names, is run
//! without a fourth of the series, and judged on them.

use crate::forms::with_best_form;
use crate::inference::{Levels, Model, Observations, Selection, Weighed, fit, selected_model};
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

/// The promise for a table; `None` if a part of its series cannot fix the baseline.
///
/// `with_form` says that the model takes a drawn form in place of shapes.
pub(crate) fn promise(
    whole: &Selection,
    data: &Observations,
    levels: Levels,
    with_form: bool,
) -> Option<Promise> {
    let known = &whole.baseline.model;
    let start = Model::baseline(known.frame.clone()).among(&known.vocabulary);
    let parts =
        map_each((0..FOLDS).collect(), |left_out| part(left_out, &start, whole, data, levels, with_form));
    let (mut baseline, mut augmented, mut rows) = (0.0, 0.0, 0.0);
    for (b, a, n) in parts.into_iter().flatten() {
        baseline += b;
        augmented += a;
        rows += n;
    }
    (rows > 0.0)
        .then(|| Promise { baseline_n: (baseline / rows).sqrt(), augmented_n: (augmented / rows).sqrt() })
}

/// Sums of squares on one part and its rows, if the rest could be fitted.
fn part(
    left_out: usize,
    start: &Model,
    whole: &Selection,
    data: &Observations,
    levels: Levels,
    with_form: bool,
) -> Option<(f64, f64, f64)> {
    let fold = |row: usize| (data.series_of[row] * 7 / 3) % FOLDS;
    let mut seen = data.subset(|row| fold(row) != left_out);
    let hidden = data.subset(|row| fold(row) == left_out && !data.is_excluded(row));
    let readings: f64 = hidden.counts.iter().sum();
    if seen.points.len() < start.values().len() + 8 || hidden.points.is_empty() {
        return None;
    }
    let (mut found, noise, structure) = selected_model(start, &mut seen, levels);
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
