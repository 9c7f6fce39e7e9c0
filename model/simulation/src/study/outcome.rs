//! What the calibrator says of one simulated rig, against the truth.

use pinswitch_calibration::Verdict;
use pinswitch_calibration::effects::{CATALOGUE, effect_named};
use pinswitch_calibration::inference::{
    FoundEffect, Levels, Model, Observations, Selection, UNATTRIBUTED, Weighed, degrees_of_freedom, family_p_value,
    interval_half_widths, select,
};
use pinswitch_calibration::table::{Frame, PlateauTable};

use super::cases::{Case, Truth, plan_of};
use crate::plan::Plan;
use crate::simulate::simulate;

/// What the calibrator said of one rig.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseOutcome {
    /// The verdict.
    pub verdict: Verdict,
    /// What it named, `a|b` for rivals, sorted; `unattributed:covariate` for what has no name.
    pub named: Vec<String>,
    /// Root mean square errors on fresh rows, baseline and augmented, in newtons.
    pub fresh_n: [f64; 2],
    /// Whether the answer is the right one: the truth alone, or both rivals where the protocol confounds them.
    pub exact: bool,
    /// Whether every true effect is named or among the rivals, and nothing else stands alone.
    pub honest: bool,
    /// For each size of a true effect in the form of `model/doc/effect-catalogue.md`: whether its 95 % interval holds
    /// it.
    pub covered: Vec<bool>,
    /// Largest gain over the vocabulary on top of the baseline, in whitened squares.
    pub largest_gain: f64,
    /// Its probability by chance.
    pub p_value: f64,
    /// Gain of the best structure without a name, in whitened squares.
    pub structure_gain: f64,
    /// Series excluded as wrong as a whole.
    pub excluded: usize,
}

/// Simulates one rig and calibrates it from the table's text alone. `None` if its table cannot be read back.
pub fn run_case(case: &Case, seed: u64, levels: Levels) -> Option<CaseOutcome> {
    let plan = plan_of(case, seed);
    let simulated = simulate(&plan);
    let rows = PlateauTable::read(PlateauTable::write(&simulated.rows).as_bytes(), "simulated").ok()?.rows;
    let frame = Frame::new(&rows);
    let mut data = Observations::new(&frame, &rows)?;
    let found = select(&Model::baseline(frame.clone()), &mut data, levels);
    let points = frame.points(&simulated.fresh)?;
    let error = |model: &Model| {
        let predicted = model.predict(&points);
        let sum: f64 = predicted.iter().zip(&simulated.fresh).map(|(p, r)| (p - r.force_n).powi(2)).sum();
        (sum / predicted.len().max(1) as f64).sqrt()
    };
    let sets: Vec<Vec<&str>> = found.effects.iter().map(FoundEffect::ids).collect();
    let verdict = Verdict::of(&found);
    let mut named: Vec<String> = sets.iter().map(|s| s.join("|")).collect();
    named.extend(found.structure.map(|s| format!("{UNATTRIBUTED}:{}", s.covariate.as_str())));
    named.sort();
    let holds = |truth: &[&str]| {
        found.structure.is_none()
            && sets.iter().all(|s| truth.iter().any(|t| s.contains(t)))
            && truth.iter().all(|t| sets.iter().any(|s| s.contains(t)))
    };
    let (exact, honest) = match &case.truth {
        Truth::Nothing => (named.is_empty(), named.is_empty()),
        Truth::Effects(ids) => (holds(ids) && verdict == Verdict::Attributed, holds(ids)),
        Truth::Confounded(id) => (holds(&[id]) && verdict == Verdict::Ambiguous, holds(&[id])),
        Truth::Outside(covariate) => {
            let right = found.structure.is_some_and(|s| s.covariate == *covariate);
            (right && sets.is_empty(), right)
        }
    };
    let largest_gain = found.candidates.first().map_or(0.0, |c| c.gain);
    let degrees = degrees_of_freedom(&data, found.baseline.model.values().len());
    Some(CaseOutcome {
        verdict,
        named,
        fresh_n: [error(&found.baseline.model), error(&found.augmented.model)],
        exact,
        honest,
        covered: covered(&plan, &found, &data),
        largest_gain,
        p_value: family_p_value(largest_gain, CATALOGUE.len(), degrees),
        structure_gain: found.structure_gain,
        excluded: data.excluded_series(),
    })
}

/// Whether the interval of each true size holds it. Other forms than the fitter's have other sizes.
fn covered(plan: &Plan, found: &Selection, data: &Observations) -> Vec<bool> {
    let widths = interval_half_widths(&found.augmented, &Weighed::new(data, found.noise));
    let (names, values) = (found.augmented.model.names(), found.augmented.model.values());
    plan.effects
        .iter()
        .filter(|e| e.form == 0)
        .filter_map(|e| {
            let parameter = effect_named(&e.id)?.parameters().first()?;
            let at = names.iter().position(|(n, _)| *n == format!("{}.{}", e.id, parameter.name))?;
            Some((values[at] - e.values.first()?).abs() <= widths[at])
        })
        .collect()
}
