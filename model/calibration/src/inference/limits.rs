//! What the data exclude: for each effect that was not found the sizes that remain possible, and effects that this
//! design cannot tell apart.

use super::fit::{Fit, jacobian};
use super::projection::{Projection, dot};
use super::reliability::Reliability;
use super::screening::{EffectScore, Screen};
use super::significance::gain_at;
use super::weighed::Weighed;
use crate::effects::{Effect, Stage};

/// Share of the friction, or of the reading, that an effect must change somewhere to be of consequence.
pub const CONSEQUENCE: f64 = 0.05;
/// Cosine between two traces after the refit beyond which a design cannot tell the effects apart.
pub const ALIKE: f64 = 0.95;

/// Sizes of an absent effect that the data do not exclude.
#[derive(Clone, Debug)]
pub struct SizeLimit {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Constants of its shape at which these sizes are told: those of its starts that the data speak for most.
    pub shape: Vec<f64>,
    /// Ends of the 95 % interval of its size, in the unit of its first constant; of an effect without constants, in
    /// shares of the effect. An effect that cannot be negative has none below zero; a limit of the cell ends at the
    /// highest one that was tried.
    pub interval: [f64; 2],
    /// Size at which it changes friction, or the reading, by [`CONSEQUENCE`] somewhere in the table.
    pub typical: f64,
}

impl SizeLimit {
    /// Whether nothing of consequence can hide: every size left is smaller than the typical one.
    pub fn is_excluded(&self) -> bool {
        let [low, high] = self.interval;
        if self.effect.description().scales || self.effect.parameters().is_empty() {
            low > -self.typical && high < self.typical
        } else {
            low > self.typical
        }
    }
}

/// The part of an interval that an effect's physics allows.
fn allowed(effect: &dyn Effect, [low, high]: [f64; 2]) -> [f64; 2] {
    if effect.description().one_sided { [low.max(0.0), high.max(0.0)] } else { [low, high] }
}

/// Limits of the effects that a model does not have, of those that pass `visible`.
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
                // A limit of the cell's range does not grow from zero: what it excludes is no interval about zero.
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

/// Steps between the limits of a cell that are tried, as a factor.
const RANGE_STEP: f64 = 0.98;

/// The lowest limit of the cell that the data do not exclude: a limit below the highest readings cuts them off, which
/// residuals would show. Tried from the highest reading that the model predicts downwards.
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
    // What the model's own constants could take over of a cut is no evidence against it.
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

/// Largest share of the friction (of the reading, for what acts on it or against the motion) that a trace changes.
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

/// Groups of effects whose visible traces have a cosine above [`ALIKE`], each in the order of the scores.
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
