//! Test of one hypothesis: the size of an effect with fixed shapes, and its probability by chance.

use crate::effects::{Effect, EffectDefinition};
use crate::inference::{
    Fit, Model, Reliability, Screen, Term, VISIBLE_SHARE, Weighed, coordinate_covariance, family_p_value,
    fit, gain_at, jacobian,
};

/// Norm of a trace, in standard deviations, below which the effect is not identifiable.
const LEAST_STRENGTH: f64 = 1e-6;

/// Estimate of a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// The size, in its unit.
    pub(super) value: f64,
    /// Half width of its 95 % interval.
    pub(super) half: f64,
    /// Probability of such a size by chance: the larger one of score test and interval, which may
    /// differ for a nonlinear effect.
    pub(super) p_value: f64,
}

/// Estimates the size of an effect in addition to a fit without it; `None` if it is not
/// identifiable.
pub(super) fn ask(
    definition: &EffectDefinition,
    effect: &'static dyn Effect,
    without: &Fit,
    weighed: &Weighed<'_>,
) -> Option<Found> {
    let data = weighed.data;
    let claimed: Vec<f64> = claimed(definition);
    let score = Screen::new(without, weighed)
        .effect_at(effect, claimed.clone())
        .filter(|s| s.strength > LEAST_STRENGTH && s.visible_share > VISIBLE_SHARE)?;
    let predicted: Vec<f64> = data.force_n.iter().zip(&without.residual_n).map(|(y, r)| y - r).collect();
    let own = jacobian(&without.model, data, &predicted);
    let degrees =
        Reliability::new(data, weighed.noise, &own).degrees(data, &score.trace_n, score.strength.powi(2));
    let sizes = definition.parameters.iter().filter(|p| p.bounds.is_none()).count();
    let (value, sd) = if sizes == 1 {
        size_as_claimed(&without.model, effect, &claimed, weighed)?
    } else {
        // Several sizes keep their hypothesised ratio: one factor for all, to first order.
        (score.size * score.share, score.size.abs() / score.strength)
    };
    let by_interval = family_p_value((value / sd).powi(2), 1, degrees);
    Some(Found {
        value,
        half: gain_at(0.05, 1, degrees).sqrt() * sd,
        p_value: family_p_value(score.gain, 1, degrees).max(by_interval),
    })
}

/// Returns the hypothesised constants.
pub(super) fn claimed(definition: &EffectDefinition) -> Vec<f64> {
    definition.parameters.iter().map(|p| p.start).collect()
}

/// Fits an effect with its shapes fixed at their hypothesised values. Sizes come before shapes.
pub(super) fn with_claim(
    definition: &EffectDefinition,
    effect: &'static dyn Effect,
    without: &Model,
    weighed: &Weighed<'_>,
) -> Fit {
    let with = without.with_term(Term::Named(effect), &claimed(definition));
    let sizes = definition.parameters.iter().filter(|p| p.bounds.is_none()).count();
    let at = with.term_offset(without.terms.len());
    let held = at + sizes..at + definition.parameters.len();
    let free: Vec<usize> = (0..with.coordinates.len()).filter(|i| !held.contains(i)).collect();
    fit(&with.frozen_except(&free), weighed)
}

/// Fits the size of an effect with fixed shapes, since friction is not linear in its coefficients;
/// returns size and standard error. `None` if the fit diverges or does not determine the size.
fn size_as_claimed(
    without: &Model,
    effect: &'static dyn Effect,
    claimed: &[f64],
    weighed: &Weighed<'_>,
) -> Option<(f64, f64)> {
    let with = without.with_term(Term::Named(effect), claimed);
    let at = with.term_offset(without.terms.len());
    let free: Vec<usize> = (0..=at).collect();
    let fitted = fit(&with.frozen_except(&free), weighed);
    let (value, slope) = fitted.model.value(at);
    let variance = coordinate_covariance(&fitted, weighed)[(at, at)];
    let is_known = fitted.cost.is_finite() && value.is_finite() && variance.is_finite() && variance > 0.0;
    is_known.then(|| (value, slope.abs() * variance.sqrt()))
}
