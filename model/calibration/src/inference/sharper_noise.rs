//! Revised noise: an effect or a shape that is not in the model yet inflates the estimated noise.

use pinswitch_friction::sort_by_number;

use super::baseline::explainable;
use super::evidence::evidence;
use super::fit::{Fit, fit, jacobian};
use super::model::Term;
use super::noise::Noise;
use super::observations::Observations;
use super::scatter::Scatter;
use super::screening::Screen;
use super::search::possible;
use super::structure_scores::StructureScore;
use super::unnamed::with_structure;
use super::variance_components::{estimate, shared_again};
use super::weighed::Weighed;
use crate::parallel::map_each;

/// Reduction of the deviance below which a shape is not considered.
const MIN_SHAPE_GAIN: f64 = 9.0;
/// The same for an effect, since effects are few.
const MIN_NAME_GAIN: f64 = 4.0;
/// Number of effects considered.
const NAMES: usize = 8;

/// Evidence that a shape must gain in addition to the choice among all shapes to change the noise.
const MIN_EVIDENCE: f64 = 6.0;

/// Reduction of the deviance by a shape that is not explained by chance: the best of many shapes
/// makes the noise of a small table look smaller than it is.
const CERTAIN_GAIN: f64 = 100.0;

/// Returns the noise with the best shape of each covariate, if one of them makes the table more
/// probable than the noise without it, and the scores of all shapes.
pub(super) fn sharper_noise(
    found: &Fit,
    data: &Observations,
    noise: Noise,
) -> (Option<Noise>, Vec<StructureScore>) {
    let weighed = Weighed::new(data, noise);
    let screen = Screen::new(found, &weighed);
    let shapes = screen.structures();
    let choice = 2.0 * libm::log(shapes.len().max(1) as f64) + MIN_EVIDENCE;
    let mut best = (evidence(found, &weighed) - choice, None);
    let mut covariates = Vec::new();
    let mut strongest: Vec<&StructureScore> = Vec::new();
    for score in shapes.iter().filter(|s| s.gain > MIN_SHAPE_GAIN) {
        let covariate = score.group[0].covariate;
        if !covariates.contains(&covariate) {
            covariates.push(covariate);
            strongest.push(score);
        }
    }
    let columns = explainable(found, data);
    let tried = map_each(strongest, |score| {
        let with = with_structure(found, score, &weighed);
        let own = &with.model.terms[found.model.terms.len()..];
        let mut columns = columns.clone();
        let predicted: Vec<f64> = data.force_n.iter().zip(&with.residual_n).map(|(y, r)| y - r).collect();
        let all = jacobian(&with.model, data, &predicted);
        columns.extend(all.into_iter().rev().take(own.len()));
        beside(&with, own, score.gain, &columns, data, noise)
    });
    for (toll, sharper) in tried {
        if toll < best.0 {
            best = (toll, Some(sharper));
        }
    }
    (best.1, shapes)
}

/// Returns the noise with the best single effect, if it makes the table more probable than the
/// noise without it: for tables that are too small to project out the effects before the noise is
/// estimated.
pub(super) fn noise_beside_a_name(found: &Fit, data: &Observations, noise: Noise) -> Option<Noise> {
    let weighed = Weighed::new(data, noise);
    let mut scores = Screen::new(found, &weighed).effects();
    scores.retain(|score| score.gain > MIN_NAME_GAIN);
    sort_by_number(&mut scores, |s| -s.gain);
    scores.truncate(NAMES);
    let choice = 2.0 * libm::log(found.model.vocabulary.count().max(1) as f64) + MIN_EVIDENCE;
    let least = evidence(found, &weighed) - choice;
    let tried = map_each(scores, |score| {
        let with = fit(&found.model.with_term(Term::Named(score.effect), &score.start), &weighed);
        let columns = explainable(&with, data);
        let own = &with.model.terms[found.model.terms.len()..];
        possible(score.effect, &with).then(|| beside(&with, own, score.gain, &columns, data, noise))
    });
    let better = tried.into_iter().flatten().filter(|(toll, _)| *toll < least);
    better.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, sharper)| sharper)
}

/// Returns the evidence of a model, and the noise with its `columns` projected out; its `own` terms
/// have this gain.
fn beside(
    with: &Fit,
    own: &[Term],
    gain: f64,
    columns: &[Vec<f64>],
    data: &Observations,
    noise: Noise,
) -> (f64, Noise) {
    // An effect that varies within series was part of the estimated repetition noise, too.
    let sharper = if gain > CERTAIN_GAIN && own.iter().any(Term::moves_along_a_series) {
        let found = estimate(data, &with.residual_n, columns, noise);
        Scatter::ALL.iter().fold(found, |found, scatter| scatter.taken_from(noise, found))
    } else {
        shared_again(data, &with.residual_n, columns, noise)
    };
    let weighed = Weighed::new(data, sharper);
    (evidence(&fit(&with.model, &weighed), &weighed), sharper)
}
