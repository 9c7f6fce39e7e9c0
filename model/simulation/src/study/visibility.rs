//! What a session of a plan could show at all, whoever looks for it: the bound that a calibrator is held against.

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

/// Scatter of friction from mount to mount beside which something without a name must be seen: rigs without effect have
/// it, and of them nothing may be said.
const MOUNTS_WITHOUT_ALARM: f64 = 0.04;

/// Whether a session of this plan could show each of its effects and disturbances. Generalised least squares are told the
/// noise of the same rig without any of them and the course of what they look for, and of the other effects which there
/// are, but no size. They would have to find each with a probability of at least [`VISIBLE`] at the calibrator's level of
/// a first name, or of a shape. It asks more of a further name, so that it may miss what is called visible here; a
/// disturbance must be found beside mounts that may differ as much as those of rigs of which nothing may be said. True of
/// a plan without either.
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
    let seats = traits.seated_ideally();
    let all = readings(plan, &rows, &seats);
    let change_n = |without: &Plan| -> Vec<f64> {
        all.iter().zip(readings(without, &rows, &seats)).map(|(with, without)| with - without).collect()
    };
    let weighed = Weighed::new(&data, alone.noise);
    let shows_effect = |effect: &EffectPlan| {
        let effects: Vec<_> = plan.effects.iter().filter(|e| e.id != effect.id).cloned().collect();
        let others = beside(&alone.baseline.model, &effects);
        let gain = expected_gain(&others, &weighed, &change_n(&Plan { effects, ..plan.clone() }));
        probability_found(gain, levels, CATALOGUE.len(), degrees) >= VISIBLE
    };
    let mount_scale = alone.noise.mount_scale.max(MOUNTS_WITHOUT_ALARM);
    let scattered = Weighed::new(&data, Noise { mount_scale, ..alone.noise });
    let shows_disturbance = |at: usize| {
        let mut without = plan.clone();
        without.disturbances.remove(at);
        let others = beside(&alone.baseline.model, &plan.effects);
        let gain = expected_gain(&others, &scattered, &change_n(&without));
        probability_structure_found(gain, levels, alone.structures_tried, degrees) >= VISIBLE
    };
    Some(plan.effects.iter().all(shows_effect) && (0..plan.disturbances.len()).all(shows_disturbance))
}

/// A model that knows of these effects, in the fitter's forms.
fn beside(model: &Model, effects: &[EffectPlan]) -> Model {
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

    fn shown(plan: &Plan) -> bool {
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
    fn what_is_large_is_shown_and_what_is_tiny_is_not() {
        assert!(shown(&Plan { seed: 5, ..Plan::default() }), "nothing is missed where nothing is");
        assert!(shown(&with(&[("load_cell_gain", 0.05)])));
        assert!(!shown(&with(&[("load_cell_gain", 0.0005)])));
        // Each of several must be.
        assert!(shown(&with(&[("load_cell_gain", 0.05), ("guide_drag", 0.8)])));
        assert!(!shown(&with(&[("load_cell_gain", 0.05), ("guide_drag", 0.003)])));
    }

    #[test]
    fn a_disturbance_is_shown_beside_mounts_that_differ() {
        let step = |target, size| Plan {
            disturbances: vec![Disturbance {
                kind: DisturbanceKind::Step { at: 0.5, over: 0.0 },
                target,
                size,
            }],
            ..with(&[])
        };
        assert!(shown(&step(DisturbanceTarget::Reading, 0.8)));
        assert!(!shown(&step(DisturbanceTarget::Reading, 0.01)));
        assert!(shown(&step(DisturbanceTarget::Friction, 0.6)));
        // A layout that is worn by no more than mounts differ cannot be told from its mount.
        let pins = Plan::default().layouts[1].clone();
        let layout = |size| Plan {
            disturbances: vec![Disturbance {
                kind: DisturbanceKind::Layout { pins: pins.clone() },
                target: DisturbanceTarget::Friction,
                size,
            }],
            ..with(&[])
        };
        assert!(!shown(&layout(0.06)));
    }
}
