//! Calibration of a simulated rig, compared with the truth.

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

/// Outcome of the calibration of a rig.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseOutcome {
    /// Verdict.
    pub verdict: Verdict,
    /// Reported effects, sorted: `a|b` for rivals, `unattributed:covariate` for unattributed
    /// structure.
    pub named: Vec<String>,
    /// Root mean square errors on noise-free rows, baseline and augmented, in newtons.
    pub fresh_n: [f64; 2],
    /// Root mean square errors on the next session of the same rig, baseline and augmented, in
    /// newtons.
    pub next_n: [f64; 2],
    /// Expected error of a new session over the actual error on the next one, if it was computed.
    pub expected_error_ratio: Option<f64>,
    /// Whether the answer is exact: the truth alone, or both rivals if the protocol confounds them.
    pub exact: bool,
    /// Whether the answer is consistent with the truth: every true effect is reported or a rival,
    /// and every reported set contains a true effect.
    pub consistent: bool,
    /// Whether nothing false was reported, and every unreported true effect was left open: its size
    /// is within the reported limits, or it was reported as invisible.
    pub left_open: bool,
    /// Whether the session could detect the truth: generalised least squares with the true noise
    /// would detect each effect in addition to the others, and a disturbance despite mount effects,
    /// with a probability of at least [`VISIBLE`](pinswitch_calibration::inference::VISIBLE).
    pub visible: bool,
    /// False parts of the answer.
    pub extras: Vec<String>,
    /// Whether the 95 % interval contains the true size, for each true effect with the form of
    /// `model/doc/effect-catalogue.md`.
    pub covered: Vec<bool>,
    /// Whether the 95 % interval contains zero, for each attributed effect with a free size. None
    /// should.
    pub across_zero: Vec<bool>,
    /// Largest gain of an effect of the vocabulary over the baseline, in whitened squares.
    pub largest_gain: f64,
    /// p-value of the largest gain.
    pub p_value: f64,
    /// Largest gain of unattributed structure, in whitened squares.
    pub structure_gain: f64,
    /// Number of excluded series.
    pub excluded: usize,
}

/// Simulates a rig, and calibrates it from the text of its table. Returns `None` if the table
/// cannot be read.
///
/// With `with_expected_error` it also computes the expected error of a new session, which repeats
/// the calibration four times.
pub fn run_case(case: &Case, seed: u64, levels: Levels, with_expected_error: bool) -> Option<CaseOutcome> {
    let plan = plan_of(case, seed);
    let simulated = simulate(&plan);
    let rows = PlateauTable::read(PlateauTable::write(&simulated.rows).as_bytes(), "simulated").ok()?.rows;
    let frame = Frame::new(&rows);
    let mut data = Observations::new(&frame, &rows)?;
    let selection = select(&Model::baseline(frame.clone()), &mut data, levels);
    let (baseline, augmented) = (&selection.baseline.model, &selection.augmented.model);
    let next = next_session(&plan).rows;
    let next_n = [error_n(baseline, &frame, &next)?, error_n(augmented, &frame, &next)?];
    let fresh = &simulated.fresh;
    let sets: Vec<Vec<&str>> = selection.effects.iter().map(FoundEffect::ids).collect();
    let verdict = Verdict::of(&selection);
    let mut named: Vec<String> = sets.iter().map(|s| s.join("|")).collect();
    named.extend(selection.structure.map(|s| format!("{UNATTRIBUTED}:{}", s.covariate.as_str())));
    named.sort();
    let answer =
        CalibratorAnswer { sets: &sets, covariate: selection.structure.map(|s| s.covariate), verdict };
    let (exact, consistent) = answer.grade(case, &plan);
    let largest_gain = selection.candidates.first().map_or(0.0, |c| c.gain);
    let degrees = degrees_of_freedom(&data, selection.baseline.model.values().len());
    let reaches = averaged_intervals(&selection.augmented, &Weighed::new(&data, selection.noise));
    Some(CaseOutcome {
        verdict,
        fresh_n: [error_n(baseline, &frame, fresh)?, error_n(augmented, &frame, fresh)?],
        next_n,
        expected_error_ratio: with_expected_error
            .then(|| calibrate(&rows, levels).ok()?.report.promise_n)
            .flatten()
            .map(|promise_n| promise_n / next_n[1].max(1e-9)),
        exact,
        consistent,
        left_open: answer.extras(case).is_empty() && left_open(&plan, &selection),
        visible: is_visible(&plan, &simulated.traits, levels)?,
        extras: answer.extras(case),
        covered: covered(&plan, &selection, &reaches),
        across_zero: across_zero(verdict, &selection, &reaches),
        largest_gain,
        p_value: family_p_value(largest_gain, CATALOGUE.len(), degrees),
        structure_gain: selection.structure_gain,
        excluded: data.excluded_series(),
        named,
    })
}

/// Whether every unreported true effect is left open: reported as invisible, or with a size within
/// its limits. A form other than the fitter's has another size; its limits must not exclude an
/// effect of consequence.
fn left_open(plan: &Plan, selection: &Selection) -> bool {
    let is_named = |id: &str| selection.effects.iter().any(|named| named.ids().contains(&id));
    plan.effects.iter().filter(|e| !is_named(&e.id)).all(|e| {
        let hidden = selection.invisible().any(|candidate| candidate.effect.id() == e.id);
        hidden
            || selection.limits.iter().filter(|limit| limit.effect.id() == e.id).any(|limit| {
                let [low, high] = limit.interval;
                match e.values.first() {
                    Some(size) if e.form == 0 => (low..=high).contains(size),
                    _ => !limit.is_excluded(),
                }
            })
    })
}

/// Returns the root mean square of prediction minus reading, in newtons.
pub(super) fn error_n(model: &Model, frame: &Frame, rows: &[PlateauRow]) -> Option<f64> {
    let predicted = model.predict(&frame.points(rows)?);
    let sum: f64 = predicted.iter().zip(rows).map(|(p, r)| (p - r.force_n).powi(2)).sum();
    Some((sum / predicted.len().max(1) as f64).sqrt())
}

/// Whether the interval of each true effect contains its size. Forms other than the fitter's have
/// other sizes.
fn covered(plan: &Plan, selection: &Selection, reaches: &[[f64; 2]]) -> Vec<bool> {
    let (names, values) = (selection.augmented.model.names(), selection.augmented.model.values());
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

/// Whether the interval of each attributed effect contains zero, for effects with a free size.
fn across_zero(verdict: Verdict, selection: &Selection, reaches: &[[f64; 2]]) -> Vec<bool> {
    let (model, values) = (&selection.augmented.model, selection.augmented.model.values());
    selection
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
