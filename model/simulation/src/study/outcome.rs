//! What the calibrator says of one simulated rig, against the truth.

use pinswitch_calibration::effects::{CATALOGUE, effect_named};
use pinswitch_calibration::inference::{
    FoundEffect, Levels, Model, Observations, Selection, UNATTRIBUTED, Weighed, averaged_intervals,
    degrees_of_freedom, family_p_value, select,
};
use pinswitch_calibration::table::{Frame, PlateauRow, PlateauTable};
use pinswitch_calibration::{Verdict, calibrate};

use super::answer::CalibratorAnswer;
use super::case::Case;
use super::cases::plan_of;
use super::visibility::is_visible;
use crate::next_session::next_session;
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
    /// Root mean square errors on the readings of the next session of the same rig, baseline and augmented, in newtons.
    pub next_n: [f64; 2],
    /// Error promised for a new session over that on the next one; none unless one was promised.
    pub expected_error_ratio: Option<f64>,
    /// Whether the answer is the right one: the truth alone, or both rivals where the protocol confounds them.
    pub exact: bool,
    /// Whether every true effect is named or among the rivals, and nothing else stands alone.
    pub honest: bool,
    /// Whether it said nothing beside the truth and left every true effect possible that it did not name: within its
    /// limits, or told as one that the session cannot show.
    pub open: bool,
    /// Whether the session could show all that is true of the rig: generalised least squares, told the noise, would find
    /// each effect beside the others, and a disturbance beside mounts that differ, with a probability of at least
    /// [`VISIBLE`](pinswitch_calibration::inference::VISIBLE).
    pub visible: bool,
    /// What it said beside the truth.
    pub extras: Vec<String>,
    /// For each size of a true effect in the form of `model/doc/effect-catalogue.md`: whether its 95 % interval holds
    /// it.
    pub covered: Vec<bool>,
    /// For each name that is attributed, and whose size is free: whether its 95 % interval holds zero. None should.
    pub across_zero: Vec<bool>,
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
///
/// `promised` asks for the error promised for a new session too, which repeats the whole procedure four times.
pub fn run_case(case: &Case, seed: u64, levels: Levels, with_expected_error: bool) -> Option<CaseOutcome> {
    let plan = plan_of(case, seed);
    let simulated = simulate(&plan);
    let rows = PlateauTable::read(PlateauTable::write(&simulated.rows).as_bytes(), "simulated").ok()?.rows;
    let frame = Frame::new(&rows);
    let mut data = Observations::new(&frame, &rows)?;
    let found = select(&Model::baseline(frame.clone()), &mut data, levels);
    let (baseline, augmented) = (&found.baseline.model, &found.augmented.model);
    let next = next_session(&plan).rows;
    let next_n = [error_n(baseline, &frame, &next)?, error_n(augmented, &frame, &next)?];
    let fresh = &simulated.fresh;
    let sets: Vec<Vec<&str>> = found.effects.iter().map(FoundEffect::ids).collect();
    let verdict = Verdict::of(&found);
    let mut named: Vec<String> = sets.iter().map(|s| s.join("|")).collect();
    named.extend(found.structure.map(|s| format!("{UNATTRIBUTED}:{}", s.covariate.as_str())));
    named.sort();
    let answer = CalibratorAnswer { sets: &sets, place: found.structure.map(|s| s.covariate), verdict };
    let (exact, honest) = answer.grade(case, &plan);
    let largest_gain = found.candidates.first().map_or(0.0, |c| c.gain);
    let degrees = degrees_of_freedom(&data, found.baseline.model.values().len());
    let reaches = averaged_intervals(&found.augmented, &Weighed::new(&data, found.noise));
    Some(CaseOutcome {
        verdict,
        fresh_n: [error_n(baseline, &frame, fresh)?, error_n(augmented, &frame, fresh)?],
        next_n,
        expected_error_ratio: with_expected_error
            .then(|| calibrate(&rows, levels).ok()?.report.promise_n)
            .flatten()
            .map(|promise_n| promise_n / next_n[1].max(1e-9)),
        exact,
        honest,
        open: answer.extras(case).is_empty() && left_open(&plan, &found),
        visible: is_visible(&plan, &simulated.traits, levels)?,
        extras: answer.extras(case),
        covered: covered(&plan, &found, &reaches),
        across_zero: across_zero(verdict, &found, &reaches),
        largest_gain,
        p_value: family_p_value(largest_gain, CATALOGUE.len(), degrees),
        structure_gain: found.structure_gain,
        excluded: data.excluded_series(),
        named,
    })
}

/// Whether every true effect that is not named is left possible: told as invisible, or within the limits of its size (one
/// of consequence where its form has another size).
fn left_open(plan: &Plan, found: &Selection) -> bool {
    let is_named = |id: &str| found.effects.iter().any(|named| named.ids().contains(&id));
    plan.effects.iter().filter(|e| !is_named(&e.id)).all(|e| {
        let hidden = found.invisible().any(|candidate| candidate.effect.id() == e.id);
        hidden
            || found.limits.iter().filter(|limit| limit.effect.id() == e.id).any(|limit| {
                let [low, high] = limit.interval;
                match e.values.first() {
                    Some(size) if e.form == 0 => (low..=high).contains(size),
                    _ => !limit.is_excluded(),
                }
            })
    })
}

/// Root mean square of prediction minus reading, in newtons.
pub(super) fn error_n(model: &Model, frame: &Frame, rows: &[PlateauRow]) -> Option<f64> {
    let predicted = model.predict(&frame.points(rows)?);
    let sum: f64 = predicted.iter().zip(rows).map(|(p, r)| (p - r.force_n).powi(2)).sum();
    Some((sum / predicted.len().max(1) as f64).sqrt())
}

/// Whether the interval of each true size holds it. Other forms than the fitter's have other sizes.
fn covered(plan: &Plan, found: &Selection, reaches: &[[f64; 2]]) -> Vec<bool> {
    let (names, values) = (found.augmented.model.names(), found.augmented.model.values());
    plan.effects
        .iter()
        .filter(|e| e.form == 0)
        .filter_map(|e| {
            let parameter = effect_named(&e.id)?.parameters().first()?;
            let at = names.iter().position(|(n, _)| *n == format!("{}.{}", e.id, parameter.name))?;
            let (truth, [below, above]) = (e.values.first()?, reaches[at]);
            Some((values[at] - below..=values[at] + above).contains(truth))
        })
        .collect()
}

/// Whether the interval of each attributed name holds zero; of those whose size starts at zero.
fn across_zero(verdict: Verdict, found: &Selection, reaches: &[[f64; 2]]) -> Vec<bool> {
    let (model, values) = (&found.augmented.model, found.augmented.model.values());
    found
        .effects
        .iter()
        .filter(|named| verdict == Verdict::Attributed && named.effect.description().scales)
        .filter(|named| named.effect.parameters().first().is_some_and(|p| p.bounds.is_none()))
        .map(|named| {
            let at = model.term_offset(named.term);
            (values[at] - reaches[at][0]..=values[at] + reaches[at][1]).contains(&0.0)
        })
        .collect()
}
