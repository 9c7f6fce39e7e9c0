//! The true form of a disturbance, as user-defined effects with free sizes: the reference for
//! estimated forms.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use pinswitch_calibration::effects::{
    ActsOn, Combine, Covariate, EffectDefinition, OwnEffect, OwnParameter, Side, Vocabulary,
};
use pinswitch_calibration::table::Frame;

use crate::disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget};

/// Returns the vocabulary with the true forms of a disturbance, and their ids. `None` for
/// operators and alternation, which no variable of a formula describes.
pub(super) fn true_forms(disturbance: &Disturbance, frame: &Frame) -> Option<(Vocabulary, Vec<String>)> {
    let shape = shape_formula(disturbance, frame)?;
    let size = disturbance.size;
    let parts = match (&disturbance.kind, disturbance.target) {
        (DisturbanceKind::Swap { silicone, .. }, _) => {
            vec![(ActsOn::MuPins, size), (ActsOn::MuSilicone, *silicone)]
        }
        (DisturbanceKind::Memory { .. }, _) | (_, DisturbanceTarget::Silicone) => {
            vec![(ActsOn::MuSilicone, size)]
        }
        (_, DisturbanceTarget::Friction) => vec![(ActsOn::Mu, size)],
        (_, DisturbanceTarget::Pins) => vec![(ActsOn::MuPins, size)],
        (_, DisturbanceTarget::Reading) => vec![(ActsOn::Reading, size)],
        (_, DisturbanceTarget::Drag) => vec![(ActsOn::Tension, size)],
    };
    let covariate = disturbance.covariates().first().copied().unwrap_or(Covariate::Time);
    let effects: Option<Vec<OwnEffect>> = parts
        .into_iter()
        .enumerate()
        .map(|(i, (acts_on, size))| {
            let is_force = matches!(acts_on, ActsOn::Reading | ActsOn::Tension);
            let direction = if acts_on == ActsOn::Tension { "direction*" } else { "" };
            OwnEffect::new(EffectDefinition {
                id: format!("truth_{i}"),
                side: if is_force { Side::Rig } else { Side::Switch },
                covariate,
                acts_on,
                combine: if is_force { Combine::Sum } else { Combine::Factor },
                formula: format!("a*{direction}{shape}"),
                one_sided: false,
                confused_with: Vec::new(),
                experiment: String::new(),
                drawn_from: Some(Vec::new()),
                parameters: vec![OwnParameter {
                    name: "a".to_owned(),
                    unit: if is_force { "N" } else { "1" }.to_owned(),
                    start: size,
                    bounds: None,
                }],
            })
            .ok()
        })
        .collect();
    let effects = effects?;
    let ids = effects.iter().map(|e| e.definition().id.clone()).collect();
    Some((Vocabulary::built_in().with(effects).ok()?, ids))
}

/// Returns the formula of a disturbance of size one.
fn shape_formula(disturbance: &Disturbance, frame: &Frame) -> Option<String> {
    Some(match &disturbance.kind {
        DisturbanceKind::Step { at, over } if *over > 0.0 => format!("min(1, max(0, (time - {at})/{over}))"),
        DisturbanceKind::Step { at, .. } | DisturbanceKind::Swap { at, .. } => format!("(time >= {at})"),
        DisturbanceKind::Window { from, to } => format!("(time >= {from})*(time < {to})"),
        DisturbanceKind::TimeWave { cycles, phase } => format!("sin({}*time + {phase})", TAU * cycles),
        DisturbanceKind::StrokeWave { cycles, phase, square } => {
            let wave = format!("sin({}*stroke + {phase})", TAU * cycles);
            if *square { format!("{FRAC_PI_4}*(2*({wave} > 0) - 1)") } else { wave }
        }
        DisturbanceKind::Spot { at, width, flat } => {
            let inside = format!("(abs(stroke - {at}) <= {})", 0.5 * width);
            if *flat { inside } else { format!("{inside}*cos({}*(stroke - {at}))", PI / width) }
        }
        DisturbanceKind::Resonance { speed_pct, width_pct } => {
            format!("1/(1 + ((speed_pct - {speed_pct})/{width_pct})^2)")
        }
        DisturbanceKind::Stribeck { speed_pct, width } => {
            format!("(0 - exp(-(ln(speed_pct/{speed_pct})/{width})^2))")
        }
        DisturbanceKind::Layout { pins } => {
            let condition = frame.conditions.iter().find(|c| c.pins == *pins)?;
            format!(
                "(abs(pin_count - {}) < 0.5)*(abs(turn_unevenness - {:.5}) < 0.0005)",
                pins.len(),
                condition.turn_unevenness()
            )
        }
        DisturbanceKind::Memory { repetitions } => format!(
            "(previous_load_n - load_n)/{:.6}*exp(-repetitions_so_far/{repetitions})",
            frame.load_range_n.1
        ),
        DisturbanceKind::Alternation | DisturbanceKind::Operators { .. } => return None,
    })
}

/// Returns the correct names of the shape in a report; empty if no shape is expected.
pub(super) fn true_shapes(disturbance: &Disturbance) -> &'static [&'static str] {
    match disturbance.kind {
        DisturbanceKind::Step { .. } | DisturbanceKind::Swap { .. } => &["step"],
        DisturbanceKind::Window { .. } | DisturbanceKind::Layout { .. } => &["level"],
        DisturbanceKind::TimeWave { .. } | DisturbanceKind::StrokeWave { .. } => &["sine"],
        // A box is another level between its ends.
        DisturbanceKind::Spot { flat, .. } => {
            if flat {
                &["bump", "dip", "level"]
            } else {
                &["bump", "dip"]
            }
        }
        DisturbanceKind::Resonance { .. } | DisturbanceKind::Stribeck { .. } => &["bump", "dip"],
        DisturbanceKind::Memory { .. } => &["memory"],
        DisturbanceKind::Alternation | DisturbanceKind::Operators { .. } => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{EffectPlan, Plan};
    use crate::simulate::simulate;
    use crate::study::case::Group;
    use crate::study::cases::{plan_of, study_cases};
    use crate::twin::readings;

    /// The true form with the true sizes changes the readings like the disturbance, up to what follows
    /// from other friction laws of twin and fitter.
    #[test]
    fn true_forms_explain_the_twin() {
        let mut compared = 0;
        for case in study_cases().into_iter().filter(|c| c.group == Group::Outside) {
            let plan = plan_of(&case, 3);
            let session = simulate(&plan);
            let frame = Frame::new(&session.rows);
            let Some((vocabulary, ids)) = true_forms(&plan.disturbances[0], &frame) else { continue };
            let without = Plan { disturbances: Vec::new(), ..plan.clone() };
            let values = |id: &str| {
                let own = vocabulary.own().find(|own| own.definition().id == id);
                own.map_or(Vec::new(), |own| own.definition().parameters.iter().map(|p| p.start).collect())
            };
            let effects = ids.iter().map(|id| EffectPlan { id: id.clone(), values: values(id), form: 0 });
            let effects = effects.collect();
            let form = Plan { effects, vocabulary, ..without.clone() };
            let traits = session.traits.without_friction_factors();
            let [baseline, disturbed, with_form] =
                [&without, &plan, &form].map(|plan| readings(plan, &session.rows, &traits));
            let rms = |a: &[f64], b: &[f64]| {
                (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
            };
            let (left, change) = (rms(&disturbed, &with_form), rms(&disturbed, &baseline));
            assert!(left < 0.2 * change, "{} {:?}: {left} of {change} N", case.name, case.protocol);
            compared += 1;
        }
        assert_eq!(compared, 24);
    }
}
