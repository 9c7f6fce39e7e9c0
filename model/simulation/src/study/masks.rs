//! Rigs with a small or large drag of the guide pulleys, and a second effect that it may mask.

use pinswitch_calibration::effects::{PaperProtocol, effect_named};

use super::case::Truth;
use crate::plan::Protocol;

/// Drags of the guide pulleys in newtons.
const DRAGS_N: [f64; 3] = [0.25, 2.0, 10.0];

/// Second effects, with ranges of size in the paper's protocol and in the randomised one. The lower
/// bound changes friction or reading by 3 % at most (a test checks it).
const MASKED: [(&str, [(f64, f64); 2]); 4] = [
    ("rate_dependence", [(0.36, 0.5), (0.15, 0.5)]),
    ("load_cell_gain", [(0.03, 0.06), (0.03, 0.06)]),
    ("dwell_relaxation", [(0.04, 0.12), (0.04, 0.12)]),
    ("substrate_saturation", [(0.12, 0.33), (0.12, 0.33)]),
];

/// Returns names and truths of the masked rigs of a protocol.
pub(super) fn masked(protocol: Protocol) -> Vec<(String, Truth)> {
    let mut all = Vec::new();
    for drag_n in DRAGS_N {
        for (id, _) in MASKED {
            let Some(effect) = effect_named(id) else { continue };
            let truth = match (protocol, effect.description().study.paper) {
                (Protocol::Paper, PaperProtocol::Hidden) => continue,
                (Protocol::Paper, PaperProtocol::Confounded) => Truth::Confounded(vec!["guide_drag", id]),
                _ => Truth::Effects(vec!["guide_drag", id]),
            };
            all.push((format!("guide_drag of {drag_n} N + {id}"), truth));
        }
    }
    all
}

/// Returns the drag of a masked rig in newtons, from its name.
pub(super) fn drag_n(name: &str) -> Option<f64> {
    name.strip_prefix("guide_drag of ")?.split(' ').next()?.parse().ok()
}

/// Returns the range of size of a masked effect.
pub(super) fn sizes(id: &str, protocol: Protocol) -> Option<(f64, f64)> {
    let (_, [paper, randomised]) = MASKED.iter().find(|m| m.0 == id)?;
    Some(if protocol == Protocol::Paper { *paper } else { *randomised })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{EffectPlan, NoisePlan, Plan};
    use crate::series_traits::SessionTraits;

    #[test]
    fn masked_effects_change_three_percent() {
        for protocol in [Protocol::Paper, Protocol::Randomised] {
            for (id, _) in MASKED {
                let study = effect_named(id).unwrap().description().study;
                if (protocol, study.paper) == (Protocol::Paper, PaperProtocol::Hidden) {
                    continue;
                }
                let mut plan = if protocol == Protocol::Paper { Plan::default() } else { Plan::randomised() };
                plan.noise = NoisePlan::default();
                let mut random = rand::SeedableRng::seed_from_u64(3);
                let rows = crate::protocol::rows(&plan, &mut random);
                let without = crate::twin::readings(&plan, &rows, &SessionTraits::default());
                let values = study.values_at(sizes(id, protocol).map(|s| s.0));
                plan.effects.push(EffectPlan { id: id.to_owned(), values, form: 0 });
                let with = crate::twin::readings(&plan, &rows, &SessionTraits::default());
                let change = rows
                    .iter()
                    .zip(without.iter().zip(&with))
                    .map(|(row, (a, b))| {
                        let (reading, friction) = ((b - a).abs() / a, (b - a).abs() / (a - row.load_n).abs());
                        if id == "load_cell_gain" { reading } else { friction }
                    })
                    .fold(0.0, f64::max);
                assert!(change >= 0.0299, "{id} in {protocol:?}: {change}");
            }
        }
    }
}
