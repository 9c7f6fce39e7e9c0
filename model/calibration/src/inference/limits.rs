//! What the data exclude: for each effect that was not found the sizes that remain possible, and effects that this
//! design cannot tell apart.

use super::fit::Fit;
use super::projection::dot;
use super::screening::{EffectScore, Screen};
use super::significance::gain_at;
use super::variance_components::Reliability;
use super::weighed::Weighed;
use crate::effects::{Effect, Stage};

/// Share of the friction, or of the reading, that an effect must change somewhere to be of consequence.
pub const CONSEQUENCE: f64 = 0.05;
/// Cosine between two traces after the refit beyond which a design cannot tell the effects apart.
pub const ALIKE: f64 = 0.95;

/// Sizes of an absent effect that the data do not exclude.
#[derive(Clone, Copy, Debug)]
pub struct SizeLimit {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Ends of the 95 % interval of its size, in the unit of its first constant; of an effect without constants, in
    /// shares of the effect.
    pub interval: [f64; 2],
    /// Size at which it changes friction, or the reading, by [`CONSEQUENCE`] somewhere in the table.
    pub typical: f64,
}

impl SizeLimit {
    /// Whether nothing of consequence can hide: every size left is smaller than the typical one.
    pub fn is_excluded(&self) -> bool {
        let [low, high] = self.interval;
        let low = if self.effect.description().one_sided { low.max(0.0) } else { low };
        low > -self.typical && high < self.typical
    }
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
                (false, false) => return None,
            };
            let degrees = reliability.degrees(weighed.data, &score.trace_n, score.strength.powi(2));
            let half = gain_at(0.05, 1, degrees).sqrt() * size.abs() / score.strength;
            let middle = size * score.share;
            Some(SizeLimit {
                effect: score.effect,
                interval: [middle - half, middle + half],
                typical: size.abs() * CONSEQUENCE / largest_share(score, &predicted, weighed).max(1e-12),
            })
        })
        .collect()
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
