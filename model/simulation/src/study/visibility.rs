//! Visibility of the effects of a plan: an upper bound on the detection rate of any calibrator.

use pinswitch_calibration::effects::{CATALOGUE, effect_named};
use pinswitch_calibration::inference::{
    Levels, Model, Noise, Observations, Term, VISIBLE, Weighed, degrees_of_freedom, expected_gain,
    probability_found, probability_structure_found, select,
};
use pinswitch_calibration::table::Frame;

use crate::plan::{EffectPlan, Plan};
use crate::series_traits::SessionTraits;
use crate::simulate::simulate;
use crate::twin::readings;

/// Smallest standard deviation of mount effects for the visibility of a disturbance: some rigs
/// without effect have it, and must not raise an alarm.
const MOUNT_SCALE_WITHOUT_ALARM: f64 = 0.04;

/// Whether a session of this plan could detect each of its effects and disturbances; true for a
/// plan without either.
///
/// The detector is generalised least squares with the noise of the same rig without effects, the
/// true shape of each effect, and the other effects in the model, with unknown sizes. It must
/// detect each with a probability of at least [`VISIBLE`] at the calibrator's level of a first
/// effect, or of structure. The calibrator has a stricter level for further effects, so that it can
/// miss a visible one. A disturbance must be distinguishable from mount effects.
pub(super) fn is_visible(plan: &Plan, traits: &SessionTraits, levels: Levels) -> Option<bool> {
    if plan.effects.is_empty() && plan.disturbances.is_empty() {
        return Some(true);
    }
    let quiet = Plan { effects: Vec::new(), disturbances: Vec::new(), ..plan.clone() };
    let rows = simulate(&quiet).rows;
    let frame = Frame::new(&rows);
    let mut data = Observations::new(&frame, &rows)?;
    let alone = select(&Model::baseline(frame), &mut data, levels);
    let degrees = degrees_of_freedom(&data, alone.baseline.model.values().len());
    let ideal = traits.without_friction_factors();
    let all = readings(plan, &rows, &ideal);
    let change_n = |without: &Plan| -> Vec<f64> {
        all.iter().zip(readings(without, &rows, &ideal)).map(|(with, without)| with - without).collect()
    };
    let weighed = Weighed::new(&data, alone.noise);
    let shows_effect = |effect: &EffectPlan| {
        let effects: Vec<_> = plan.effects.iter().filter(|e| e.id != effect.id).cloned().collect();
        let others = with_effects(&alone.baseline.model, &effects);
        let gain = expected_gain(&others, &weighed, &change_n(&Plan { effects, ..plan.clone() }));
        probability_found(gain, levels, CATALOGUE.len(), degrees) >= VISIBLE
    };
    let mount_scale = alone.noise.mount_scale.max(MOUNT_SCALE_WITHOUT_ALARM);
    let scattered = Weighed::new(&data, Noise { mount_scale, ..alone.noise });
    let shows_disturbance = |at: usize| {
        let mut without = plan.clone();
        without.disturbances.remove(at);
        let others = with_effects(&alone.baseline.model, &plan.effects);
        let gain = expected_gain(&others, &scattered, &change_n(&without));
        probability_structure_found(gain, levels, alone.structures_tried, degrees) >= VISIBLE
    };
    Some(plan.effects.iter().all(shows_effect) && (0..plan.disturbances.len()).all(shows_disturbance))
}

/// Returns the model with these effects, in the fitter's forms.
fn with_effects(model: &Model, effects: &[EffectPlan]) -> Model {
    effects.iter().filter_map(|e| effect_named(&e.id)).fold(model.clone(), |model, effect| {
        match effect.starts(&model.frame).first() {
            Some(start) => model.with_term(Term::Named(effect), start),
            None => model,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget};

    fn visible(plan: &Plan) -> bool {
        is_visible(plan, &simulate(plan).traits, Levels::default()).unwrap()
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
