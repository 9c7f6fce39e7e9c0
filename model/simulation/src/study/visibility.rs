//! Visibility of the effects of a plan: an upper bound on the detection rate of any calibrator.

use pinswitch_calibration::evidence::Evidence;
use pinswitch_inference::{Element, Hypothesis, Member, information};

use crate::plan::Plan;
use crate::series_traits::SessionTraits;
use crate::simulate::simulate;
use crate::twin::readings;

/// Smallest standard deviation of mount effects for the visibility of a disturbance: some rigs
/// without effect have it, and must not raise an alarm.
const MOUNT_SCALE_WITHOUT_ALARM: f64 = 0.04;
/// Posterior odds of a reported effect: a probability of 0.9.
const REPORTED_ODDS: f64 = 9.0;
/// Quantile of the standard normal distribution for the detection probability of a visible effect,
/// 95 %.
const VISIBLE_QUANTILE: f64 = 1.645;

/// Whether a session of this plan could detect each of its effects and disturbances, with a
/// probability of at least 95 %; true for a plan without either.
///
/// The detector knows the noise of the same rig without effects and the true change `x` of the
/// readings by each effect and disturbance. Only their sizes are unknown, with a normal prior whose
/// standard deviation is the true size. With the information `S = x'Px` on a size, the estimate over
/// its standard error is `z ~ N(sqrt(S), 1)`, and the log evidence gains
///
/// ```text
/// 1/2 S/(1 + S) z^2 - 1/2 ln(1 + S)
/// ```
///
/// With the prior odds of the calibrator, posterior odds of 9 need a `|z|` above some bound. The
/// calibrator does not know the true change and considers other explanations, so that it can miss a
/// visible effect. A disturbance must be distinguishable from mount effects.
pub(super) fn is_visible(plan: &Plan, traits: &SessionTraits) -> Option<bool> {
    if plan.effects.is_empty() && plan.disturbances.is_empty() {
        return Some(true);
    }
    let mut quiet = Plan { effects: Vec::new(), disturbances: Vec::new(), ..plan.clone() };
    if !plan.disturbances.is_empty() {
        quiet.noise.mount_scale = quiet.noise.mount_scale.max(MOUNT_SCALE_WITHOUT_ALARM);
    }
    let rows = simulate(&quiet).rows;
    let evidence = Evidence::baseline(&rows, plan.seed).ok()?;
    let (problem, space) = (evidence.problem(), evidence.problem().space());
    let ideal = traits.without_friction_factors();
    let all = readings(plan, &rows, &ideal);
    // Change of each row of the problem in newtons, against the plan without a part of it.
    let change_n = |without: &Plan| -> Vec<f64> {
        let without = readings(without, &rows, &ideal);
        evidence.rows().map(|(row, ..)| all[row] - without[row]).collect()
    };
    let mut changes: Vec<(Vec<f64>, f64)> = Vec::new();
    let prior = |member, form| Hypothesis::from_elements([Element { member, form }]).log_prior_odds(space);
    for effect in &plan.effects {
        let effects = plan.effects.iter().filter(|e| e.id != effect.id).cloned().collect();
        let change = change_n(&Plan { effects, ..plan.clone() });
        let index = space.effects.iter().position(|e| e.name == effect.id);
        let odds = index.map_or(f64::NEG_INFINITY, |index| prior(Member::Effect(index), 0));
        changes.push((change, odds));
    }
    let kernels = space.kernels.iter().enumerate().filter(|(_, kernel)| kernel.noise_probability.is_none());
    let of_structure = kernels
        .flat_map(|(i, kernel)| (0..kernel.variants.len()).map(move |form| (i, form)))
        .map(|(i, form)| prior(Member::Kernel(i), form))
        .fold(f64::NEG_INFINITY, f64::max);
    for at in 0..plan.disturbances.len() {
        let mut without = plan.clone();
        without.disturbances.remove(at);
        changes.push((change_n(&without), of_structure));
    }
    for (at, (change, odds)) in changes.iter().enumerate() {
        let others: Vec<Vec<f64>> = changes
            .iter()
            .enumerate()
            .filter(|(i, _)| *i != at)
            .map(|(_, (other, _))| other.clone())
            .collect();
        let s = information(problem, &evidence.posterior().baseline, change, &others)?;
        let gain = REPORTED_ODDS.ln() - odds + 0.5 * s.ln_1p();
        let least_z = (2.0 * gain.max(0.0) * (1.0 + s) / s).sqrt();
        let is_detected = s.sqrt() >= least_z + VISIBLE_QUANTILE;
        if !is_detected {
            return Some(false);
        }
    }
    Some(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget};
    use crate::plan::EffectPlan;

    fn visible(plan: &Plan) -> bool {
        is_visible(plan, &simulate(plan).traits).unwrap()
    }

    fn with(effects: &[(&str, f64)]) -> Plan {
        let effects = effects.iter().map(|(id, size)| EffectPlan {
            id: (*id).to_owned(),
            values: vec![*size],
            form: 0,
        });
        Plan { seed: 5, effects: effects.collect(), ..Plan::default() }
    }

    #[test]
    fn large_effects_are_visible() {
        assert!(visible(&Plan { seed: 5, ..Plan::default() }), "a plan without effects");
        assert!(visible(&with(&[("load_cell_gain", 0.05)])));
        assert!(!visible(&with(&[("load_cell_gain", 0.0005)])));
        // Each of several effects must be visible.
        assert!(visible(&with(&[("load_cell_gain", 0.05), ("guide_drag", 0.8)])));
        assert!(!visible(&with(&[("load_cell_gain", 0.05), ("guide_drag", 0.003)])));
    }

    #[test]
    fn large_disturbances_are_visible() {
        let step = |target, size| Plan {
            disturbances: vec![Disturbance {
                kind: DisturbanceKind::Step { at: 0.5, over: 0.0 },
                target,
                size,
            }],
            ..with(&[])
        };
        assert!(visible(&step(DisturbanceTarget::Reading, 0.8)));
        assert!(!visible(&step(DisturbanceTarget::Reading, 0.01)));
        assert!(visible(&step(DisturbanceTarget::Friction, 0.6)));
        // Wear of a layout that is not larger than the mount effects cannot be distinguished from
        // them.
        let pins = Plan::default().layouts[1].clone();
        let layout = |size| Plan {
            disturbances: vec![Disturbance {
                kind: DisturbanceKind::Layout { pins: pins.clone() },
                target: DisturbanceTarget::Friction,
                size,
            }],
            ..with(&[])
        };
        assert!(!visible(&layout(0.06)));
    }
}
