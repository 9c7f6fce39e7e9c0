//! Gains and rivals of the effects of a model, and scores of all others.

use pinswitch_friction::sort_by_number;

use super::fit::{Fit, fit};
use super::levels::Levels;
use super::model::Term;
use super::projection::dot;
use super::screening::{EffectScore, Screen};
use super::search::possible;
use super::selection::{CandidateEffect, FoundEffect, Rival};
use super::weighed::Weighed;
use crate::effects::Effect;

/// Returns gain and rivals of each effect of a model.
pub(super) fn found_effects(augmented: &Fit, weighed: &Weighed<'_>, levels: Levels) -> Vec<FoundEffect> {
    let mut found = Vec::new();
    for (index, term) in augmented.model.terms.iter().enumerate() {
        let Term::Named(effect) = term else { continue };
        let without = fit(&augmented.model.without_term(index), weighed);
        let gain = without.cost - augmented.cost;
        let bends = f64::from(u8::from(effect.description().bends));
        let margin = levels.rival.max(levels.rival_share * gain * bends);
        let mut rivals = rivals(*effect, gain, &without, augmented.cost, weighed);
        rivals.retain(|r| r.worse_by < margin);
        found.push(FoundEffect { effect: *effect, term: index, gain, rivals });
    }
    found
}

/// Fits effects in place of one with a gain of `gain`: added to the model `without` it, and
/// compared with the `cost` with it.
fn rivals(
    effect: &'static dyn Effect,
    gain: f64,
    without: &Fit,
    cost: f64,
    weighed: &Weighed<'_>,
) -> Vec<Rival> {
    let scores = Screen::new(without, weighed).effects();
    let own = scores.iter().find(|s| s.effect.id() == effect.id()).map(|s| s.column.clone());
    let mut others: Vec<_> = scores.into_iter().filter(|s| s.effect.id() != effect.id()).collect();
    sort_by_number(&mut others, |s| -s.gain);
    others.retain(|s| s.gain > 0.3 * gain);
    others.truncate(4);
    others
        .into_iter()
        .filter_map(|score| {
            let other = fit(&without.model.with_term(Term::Named(score.effect), &score.start), weighed);
            possible(score.effect, &other).then(|| {
                let cosine = own.as_ref().map_or(0.0, |own| {
                    (dot(own, &score.column) / (dot(own, own) * dot(&score.column, &score.column)).sqrt())
                        .abs()
                });
                Rival { effect: score.effect, worse_by: other.cost - cost, cosine }
            })
        })
        .collect()
}

/// Returns the strength at the typical size, whichever start scored best, since identifiability
/// must not depend on the noise realisation.
fn at_typical_size(score: &EffectScore, fitted: &Fit) -> f64 {
    let typical = score.effect.starts(&fitted.model.frame).first().and_then(|start| start.first().copied());
    match typical {
        Some(typical) if score.effect.description().scales && score.size != 0.0 => {
            score.strength * (typical / score.size).abs()
        }
        _ => score.strength,
    }
}

/// Returns every effect of the catalogue, by its score over the baseline.
pub(super) fn candidates(
    scores: &[EffectScore],
    augmented: &Fit,
    weighed: &Weighed<'_>,
) -> Vec<CandidateEffect> {
    let left = Screen::new(augmented, weighed).effects();
    let mut candidates: Vec<_> = scores
        .iter()
        .map(|score| CandidateEffect {
            effect: score.effect,
            gain: score.gain,
            gain_left: left.iter().find(|l| l.effect.id() == score.effect.id()).map(|l| l.gain),
            visible_share: score.visible_share,
            strength: at_typical_size(score, augmented),
        })
        .collect();
    sort_by_number(&mut candidates, |c| -c.gain);
    candidates
}
