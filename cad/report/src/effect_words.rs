//! Effects in words, for the terminal and for pages.

use std::collections::BTreeMap;

use pinswitch_calibration::{CandidateReport, EffectReport, Estimate, Fate, Report};
use pinswitch_friction::sort_by_number;

/// Built-in effects by id, each as a clause that follows `that`.
const CLAUSES: [(&str, &str); 21] = [
    ("adhesion", "the silicone adheres to the tendon without load"),
    ("coating_ploughing", "pins plough the coating of the tendon"),
    ("coating_stiffening", "friction of the coating grows with load"),
    ("direction_asymmetry", "friction differs between the directions"),
    ("dwell_relaxation", "friction of the silicone depends on the dwell"),
    ("fixture_compliance", "the fixture bends under load"),
    ("guide_drag", "the guide pulleys have drag"),
    ("hook_omitted", "the hook was not weighed"),
    ("load_cell_gain", "the load cell has a wrong scale"),
    ("load_cell_nonlinearity", "the load cell is not linear"),
    ("load_cell_offset", "the load cell has an offset"),
    ("load_cell_saturation", "the load cell saturates"),
    ("polygon_bending", "the tendon bends sharply at single pins"),
    ("rate_dependence", "friction depends on the speed"),
    ("run_in", "friction is higher in the first repetitions"),
    ("stroke_position", "the wrap angle changes along the stroke"),
    ("substrate_saturation", "friction of the silicone grows less than the load"),
    ("switch_local_tension", "the threshold follows the local tension along the wrap"),
    ("switching_hysteresis", "the threshold differs when the load falls"),
    ("thermal_drift", "the reading drifts with time"),
    ("wear_drift", "friction drifts with the travel"),
];

/// Returns the effect of an id as a clause, such as `the load cell has an offset`; a user-defined effect
/// acts.
pub fn effect_clause(id: &str) -> String {
    let known = CLAUSES.iter().find(|(known, _)| *known == id);
    known.map_or_else(|| format!("{id} acts"), |(_, clause)| (*clause).to_owned())
}

/// Returns a reported effect as a clause; unattributed structure with its covariate.
pub fn reported_clause(effect: &EffectReport) -> String {
    match effect.side {
        // On a rig without a switch only their sum is defined.
        Some(_) if effect.id == "guide_drag" && !effect.includes.is_empty() => {
            "the guides and the contact have a constant drag".to_owned()
        }
        Some(_) => effect_clause(&effect.id),
        None => format!("an effect without a name acts over {}", effect.covariate),
    }
}

/// Returns the constants of a reported effect with their 95 % intervals, such as
/// `-0.14 N [-0.18, -0.10]`; several constants have their names. Structure has none: its curve is in its
/// formula.
pub fn constants_words(effect: &EffectReport) -> String {
    if effect.side.is_none() {
        return String::new();
    }
    parameters_words(&effect.parameters)
}

/// Returns constants with their 95 % intervals; a single one without its name.
pub fn parameters_words(parameters: &BTreeMap<String, Estimate>) -> String {
    let each = parameters.iter().map(|(name, estimate)| {
        let name = if parameters.len() == 1 { String::new() } else { format!("{name} = ") };
        format!("{name}{}", estimate_words(estimate))
    });
    each.collect::<Vec<_>>().join(", ")
}

/// Most decimals of an estimate.
const MAX_DECIMALS: f64 = 9.0;

/// Returns an estimate with its unit and interval, rounded to one digit of half the interval.
pub fn estimate_words(estimate: &Estimate) -> String {
    let Estimate { value, ci95: [low, high], unit } = estimate;
    let digits = -libm::floor(libm::log10(0.5 * (high - low)));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to MAX_DECIMALS")]
    let decimals = if digits.is_finite() { digits.clamp(0.0, MAX_DECIMALS) as usize } else { 4 };
    let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
    format!("{value:.decimals$}{unit} [{low:.decimals$}, {high:.decimals$}]")
}

/// Returns the friction of a `plain` contact, such as `mu = 0.180 [0.178, 0.182]`; without wrap angles
/// only the exponent is known. `None` for a switch.
pub fn friction_words(report: &Report) -> Option<String> {
    let constants = &report.augmented.parameters;
    let mu = constants.get("mu").map(|mu| format!("mu = {}", estimate_words(mu)));
    let exponent = |x: &Estimate| {
        format!("friction exponent = {} (mu times the wrap; for mu, give wrap_angle_deg)", estimate_words(x))
    };
    mu.or_else(|| constants.get("x").map(exponent))
}

/// Returns identifiable effects and structures with a probability above `least` that are neither reported
/// nor rivals, the most probable first.
pub fn other_probabilities(report: &Report, least: f64) -> Vec<(&str, f64)> {
    let is_shown = |id: &str| {
        report.effects.iter().any(|effect| {
            effect.id == id
                || structure_name(effect) == Some(id)
                || effect.rivals.iter().any(|rival| rival.id == id)
        })
    };
    // The probability of an effect that is not identifiable is that of its prior.
    let is_visible = |candidate: &&CandidateReport| candidate.fate != Fate::Invisible;
    let effects = report.candidates.iter().filter(is_visible);
    let effects = effects.map(|candidate| (candidate.id.as_str(), candidate.probability));
    let structures =
        report.structures.iter().map(|structure| (structure.name.as_str(), structure.probability));
    let mut others: Vec<(&str, f64)> =
        effects.chain(structures).filter(|(id, probability)| *probability > least && !is_shown(id)).collect();
    sort_by_number(&mut others, |(_, probability)| -probability);
    others
}

/// Returns the name of the structure of an effect without a name, which precedes its shape.
pub(crate) fn structure_name(effect: &EffectReport) -> Option<&str> {
    let formula = effect.formula.as_str();
    effect.side.is_none().then(|| formula.split_once(": ").map_or(formula, |(name, _)| name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_calibration::effects::Vocabulary;

    #[test]
    fn every_built_in_effect_has_a_clause() {
        for effect in Vocabulary::built_in().effects() {
            assert!(CLAUSES.iter().any(|(id, _)| *id == effect.id()), "{}", effect.id());
        }
        assert!(CLAUSES.is_sorted_by_key(|(id, _)| *id));
        assert_eq!(effect_clause("lubricant_dip"), "lubricant_dip acts");
    }
    #[test]
    fn estimates_have_digits_of_their_interval() {
        let words =
            |value, ci95, unit: &str| estimate_words(&Estimate { value, ci95, unit: unit.to_owned() });
        assert_eq!(words(-0.1402, [-0.1803, -0.0998], "N"), "-0.14 N [-0.18, -0.10]");
        assert_eq!(words(9.9881, [9.9745, 10.0021], "N"), "9.99 N [9.97, 10.00]");
        assert_eq!(words(0.0304, [0.0299, 0.0308], "1"), "0.0304 [0.0299, 0.0308]");
        assert_eq!(words(1.0, [1.0, 1.0], "1"), "1.0000 [1.0000, 1.0000]");
    }

    #[test]
    fn single_constants_have_no_name() {
        let offset = |value| Estimate { value, ci95: [-0.18, -0.1], unit: "N".to_owned() };
        let one = BTreeMap::from([("b".to_owned(), offset(-0.14))]);
        assert_eq!(parameters_words(&one), "-0.14 N [-0.18, -0.10]");
        let two = BTreeMap::from([("b".to_owned(), offset(-0.14)), ("k".to_owned(), offset(-0.15))]);
        assert_eq!(parameters_words(&two), "b = -0.14 N [-0.18, -0.10], k = -0.15 N [-0.18, -0.10]");
    }
}
