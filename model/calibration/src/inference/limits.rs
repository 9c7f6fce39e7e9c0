//! Sizes that the data exclude, for effects that are not in the model, and classes of effects that
//! this design cannot separate.

use super::fit::{Fit, jacobian};
use super::projection::{Projection, dot};
use super::reliability::Reliability;
use super::screening::{EffectScore, Screen};
use super::significance::gain_at;
use super::weighed::Weighed;
use crate::effects::{Effect, Stage};

/// Smallest relevant change of friction or reading, as a share.
pub const CONSEQUENCE: f64 = 0.05;
/// Cosine of two traces after the refit above which a design cannot separate the effects.
pub const ALIKE: f64 = 0.95;

/// Sizes of an absent effect that the data do not exclude.
#[derive(Clone, Debug)]
pub struct SizeLimit {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Shape constants for which the sizes apply: those of the start with the largest gain.
    pub shape: Vec<f64>,
    /// Ends of the 95 % interval of its size, in the unit of its first constant; in shares of an
    /// effect without constants. Sizes of a one-sided effect are not negative; the interval of a
    /// load cell's limit ends at the highest one tried.
    pub interval: [f64; 2],
    /// Size that changes friction or reading by [`CONSEQUENCE`] somewhere in the table.
    pub typical: f64,
}

impl SizeLimit {
    /// Returns whether every size in the interval is smaller than the typical one.
    pub fn is_excluded(&self) -> bool {
        let [low, high] = self.interval;
        if self.effect.description().scales || self.effect.parameters().is_empty() {
            low > -self.typical && high < self.typical
        } else {
            low > self.typical
        }
    }
}

/// Returns the part of an interval with possible signs.
fn allowed(effect: &dyn Effect, [low, high]: [f64; 2]) -> [f64; 2] {
    if effect.description().one_sided { [low.max(0.0), high.max(0.0)] } else { [low, high] }
}

/// Returns limits of the effects that are not in a model and pass `visible`.
pub(super) fn limits(
    fitted: &Fit,
    weighed: &Weighed<'_>,
    reliability: &Reliability,
    visible: impl Fn(&'static dyn Effect) -> bool,
) -> Vec<SizeLimit> {
    let predicted: Vec<f64> =
        weighed.data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    Screen::new(fitted, weighed)
        .effects()
        .iter()
        .filter(|score| visible(score.effect) && score.strength > 1e-6)
        .filter_map(|score| {
            let told = score.effect.description();
            let size = match (told.parameters.is_empty(), told.scales) {
                (true, _) => 1.0,
                (false, true) => score.size,
                // The limit of a load cell does not vanish at zero, so the interval is not around
                // zero.
                (false, false) => return range_limit(score.effect, fitted, weighed, &predicted),
            };
            let degrees = reliability.degrees(weighed.data, &score.trace_n, score.strength.powi(2));
            let half = gain_at(0.05, 1, degrees).sqrt() * size.abs() / score.strength;
            let middle = size * score.share;
            Some(SizeLimit {
                effect: score.effect,
                shape: score.start.get(1..).unwrap_or_default().to_vec(),
                interval: allowed(score.effect, [middle - half, middle + half]),
                typical: size.abs() * CONSEQUENCE / largest_share(score, &predicted, weighed).max(1e-12),
            })
        })
        .collect()
}

/// Ratio of consecutive limits of a load cell that are tried.
const RANGE_STEP: f64 = 0.98;

/// Returns the lowest limit of a load cell that the data do not exclude, since a limit below the
/// highest readings would cut them off. Limits are tried downwards from the highest predicted
/// reading.
fn range_limit(
    effect: &'static dyn Effect,
    fitted: &Fit,
    weighed: &Weighed<'_>,
    predicted: &[f64],
) -> Option<SizeLimit> {
    let highest = predicted.iter().copied().fold(0.0, f64::max);
    if highest <= 0.0 {
        return None;
    }
    // The part of a cut-off that the model's constants can absorb is not evidence against it.
    let mut own = Projection::new(predicted.len());
    for mut column in jacobian(&fitted.model, weighed.data, predicted) {
        weighed.whiten(&mut column);
        own.absorb(column);
    }
    let squares = |mut residual: Vec<f64>| {
        weighed.whiten(&mut residual);
        own.remove(&mut residual);
        dot(&residual, &residual)
    };
    let as_it_is = squares(fitted.residual_n.clone());
    let chance = gain_at(0.05, 1, 1e6);
    let beyond_chance = |limit: f64| {
        let cut = predicted.iter().map(|reading| (reading - limit).max(0.0));
        squares(fitted.residual_n.iter().zip(cut).map(|(r, cut)| r + cut).collect()) - as_it_is > chance
    };
    let mut low = highest;
    while low > 0.3 * highest && !beyond_chance(low * RANGE_STEP) {
        low *= RANGE_STEP;
    }
    let typical = highest * (1.0 - CONSEQUENCE);
    Some(SizeLimit { effect, shape: Vec::new(), interval: [low, highest], typical })
}

/// Returns the largest relative change of friction by a trace (of the reading, for effects on the
/// reading or against the motion).
fn largest_share(score: &EffectScore, predicted: &[f64], weighed: &Weighed<'_>) -> f64 {
    let of_reading = !matches!(
        score.effect.description().stage,
        Stage::AddedFriction | Stage::ScaledFriction | Stage::Switch
    );
    score
        .trace_n
        .iter()
        .zip(predicted)
        .zip(&weighed.data.points)
        .map(|((trace, reading), point)| {
            let of = if of_reading { *reading } else { reading - point.load_n };
            trace.abs() / of.abs().max(0.02 * point.load_n).max(1e-9)
        })
        .fold(0.0, f64::max)
}

/// Returns groups of effects whose traces have a cosine above [`ALIKE`], each in the order of the
/// scores.
pub(super) fn classes(
    scores: &[EffectScore],
    visible: impl Fn(&EffectScore) -> bool,
) -> Vec<Vec<&'static str>> {
    let seen: Vec<&EffectScore> = scores.iter().filter(|s| visible(s) && s.strength > 1e-6).collect();
    let mut class: Vec<usize> = (0..seen.len()).collect();
    for i in 0..seen.len() {
        for j in 0..i {
            let cosine = dot(&seen[i].column, &seen[j].column) / (seen[i].strength * seen[j].strength);
            if cosine.abs() > ALIKE && class[i] != class[j] {
                let (from, to) = (class[i].max(class[j]), class[i].min(class[j]));
                class.iter_mut().filter(|c| **c == from).for_each(|c| *c = to);
            }
        }
    }
    (0..seen.len())
        .map(|c| (0..seen.len()).filter(|i| class[*i] == c).map(|i| seen[i].effect.id()).collect::<Vec<_>>())
        .filter(|ids| ids.len() > 1)
        .collect()
}
