//! The true form of a disturbance, as user-defined effects with free sizes: the reference for
//! estimated forms.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use pinswitch_calibration::effects::{
    ActsOn, Combine, Covariate, EffectDefinition, OwnEffect, OwnParameter, Side, Vocabulary,
};
use pinswitch_calibration::table::Frame;

use crate::disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget};

/// Returns the vocabulary with the true forms of a disturbance, and their ids. `None` for
/// operators, which no variable of a formula describes.
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
                drawn_from: Vec::new(),
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
        DisturbanceKind::Operators { .. } => return None,
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
        DisturbanceKind::Operators { .. } => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::NoisePlan;
    use crate::simulate::simulate;
    use crate::study::case::Group;
    use crate::study::cases::{plan_of, study_cases};
    use pinswitch_calibration::inference::{Model, Noise, Observations, Term, Weighed, fit};

    /// On a rig with little noise, a fit of the true form leaves no structure.
    #[test]
    fn true_forms_explain_the_twin() {
        for case in study_cases().into_iter().filter(|c| c.group == Group::Outside) {
            let mut plan = plan_of(&case, 3);
            plan.noise = NoisePlan {
                repetition_n: 0.01,
                repetition_per_load: 0.0,
                series_n: 0.001,
                series_per_load: 0.0,
                outlier_share: 0.0,
                ..NoisePlan::default()
            };
            let rows = simulate(&plan).rows;
            let frame = Frame::new(&rows);
            let Some((vocabulary, ids)) = true_forms(&plan.disturbances[0], &frame) else { continue };
            let data = Observations::new(&frame, &rows).unwrap();
            let weighed = Weighed::new(&data, Noise::constant(0.02, 0.01));
            let baseline = Model::baseline(frame).among(&vocabulary);
            let before = fit(&baseline, &weighed);
            let with = ids.iter().fold(before.model.clone(), |model, id| {
                let effect = vocabulary.named(id).unwrap();
                let start = effect.starts(&model.frame).remove(0);
                model.with_term(Term::Named(effect), &start)
            });
            let after = fit(&with, &weighed);
            let rms = |r: &[f64]| (r.iter().map(|v| v * v).sum::<f64>() / r.len() as f64).sqrt();
            let (before, after) = (rms(&before.residual_n), rms(&after.residual_n));
            assert!(
                after < 0.06 || after < 0.2 * before,
                "{} {:?}: {before} {after}",
                case.name,
                case.protocol
            );
        }
    }
}
