//! Calibration of a simulated rig, compared with the truth.

use pinswitch_calibration::effects::{Vocabulary, effect_named};
use pinswitch_calibration::evidence::{Fitted, Session};
use pinswitch_calibration::table::{PlateauRow, PlateauTable};
use pinswitch_calibration::{Calibration, ModelFile, Report, Verdict, calibrate};
use schemars::JsonSchema;
use serde::Serialize;

use super::answer::{Answer, CalibratorAnswer};
use super::case::Case;
use super::cases::plan_of;
use super::forecast::Forecast;
use super::visibility::is_visible;
use crate::next_session::next_session;
use crate::plan::Plan;
use crate::simulate::simulate;

/// Outcome of the calibration of a rig.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CaseOutcome {
    /// Seed of the rig's noise.
    pub seed: u64,
    /// Verdict.
    pub verdict: Verdict,
    /// Reported effects, sorted: `a|b` for rivals, `unattributed:covariate` for unattributed
    /// structure.
    pub named: Vec<String>,
    /// Root mean square errors on noise-free rows, baseline and augmented, in newtons.
    pub fresh_n: [f64; 2],
    /// Root mean square errors on the next session of the same rig without gross errors, baseline and
    /// augmented, in newtons.
    pub next_n: [f64; 2],
    /// Expected error of a new session over the actual error on the next one; absent if the report
    /// has no expected error.
    pub expected_error_ratio: Option<f64>,
    /// Whether the actual error is in the 90 % interval of the expected one.
    pub is_error_covered: Option<bool>,
    /// Whether the answer is exact: the truth alone, or both rivals if the protocol confounds them.
    pub exact: bool,
    /// Whether the answer is consistent with the truth: every true effect is reported or a rival,
    /// and every reported set contains a true effect.
    pub consistent: bool,
    /// Whether nothing false was reported, and every unreported true effect was left open: its size
    /// is within the reported limits, or it was reported as invisible.
    pub left_open: bool,
    /// Whether the session could detect the truth: a detector that knows the noise and the true shape
    /// would detect each effect in addition to the others, and a disturbance despite mount effects,
    /// with a probability of 95 %.
    pub visible: bool,
    /// False parts of the answer.
    pub extras: Vec<String>,
    /// Whether the 95 % interval contains the true size, for each reported true effect with the form
    /// of `model/doc/effect-catalogue.md`.
    pub covered: Vec<bool>,
    /// Probability of every reported effect, with whether the rig has it.
    pub reported: Vec<Forecast>,
    /// Probability of every effect of the vocabulary, with whether the rig has it.
    pub candidates: Vec<Forecast>,
    /// Number of series that are reported as bad.
    pub bad_series: usize,
}

/// Simulates a rig, and calibrates it from the text of its table. Returns `None` if the table
/// cannot be read.
pub fn run_case(case: &Case, seed: u64) -> Option<CaseOutcome> {
    let plan = plan_of(case, seed);
    let simulated = simulate(&plan);
    let rows = read_back(&simulated.table(&plan))?;
    let calibration = calibrate(&rows, &Vocabulary::built_in(), seed).ok()?;
    let Calibration { report, baseline, augmented, .. } = &calibration;
    // The expected error excludes gross errors.
    let mut sound = plan.clone();
    sound.noise.outlier_share = 0.0;
    let next = read_back(&next_session(&sound).table(&sound))?;
    let next_n = [error_n(baseline, &next)?, error_n(augmented, &next)?];
    let answer = CalibratorAnswer::new(report);
    let (exact, consistent) = answer.grade(case, &plan);
    let extras = answer.extras(case);
    let mut named: Vec<String> = answer.parts.iter().map(Answer::text).collect();
    named.sort();
    let expected = report.expected_error_n;
    let forecast =
        |id: &str, probability| Forecast { probability, is_true: plan.effects.iter().any(|e| e.id == id) };
    let reported = report.effects.iter().zip(&answer.parts).map(|(effect, part)| match part.structure {
        Some(_) => Forecast { probability: effect.probability, is_true: !extras.contains(&part.text()) },
        None => forecast(&effect.id, effect.probability),
    });
    Some(CaseOutcome {
        seed,
        verdict: report.verdict,
        fresh_n: [
            in_session_error_n(baseline, &simulated.fresh)?,
            in_session_error_n(augmented, &simulated.fresh)?,
        ],
        next_n,
        expected_error_ratio: expected.map(|e| e.value / next_n[1].max(1e-9)),
        is_error_covered: expected.map(|e| (e.ci90[0]..=e.ci90[1]).contains(&next_n[1])),
        exact,
        consistent,
        left_open: extras.is_empty() && left_open(&plan, report),
        visible: is_visible(&plan, &simulated.traits)?,
        covered: covered(&plan, report),
        reported: reported.collect(),
        candidates: report.candidates.iter().map(|c| forecast(&c.id, c.probability)).collect(),
        bad_series: report.bad_series.len(),
        extras,
        named,
    })
}

/// Reads the text of a table.
fn read_back(table: &str) -> Option<Vec<PlateauRow>> {
    Some(PlateauTable::read(table.as_bytes(), "simulated").ok()?.rows)
}

/// Whether every unreported true effect is left open: reported as invisible, or with a size within
/// its limits. A form other than the fitter's has another size; its limits must not exclude an
/// effect of consequence.
fn left_open(plan: &Plan, report: &Report) -> bool {
    let is_named =
        |id: &str| report.effects.iter().any(|e| e.id == id || e.rivals.iter().any(|rival| rival.id == id));
    plan.effects.iter().filter(|e| !is_named(&e.id)).all(|e| {
        report.invisible.iter().any(|invisible| invisible.id == e.id)
            || report.limits.iter().filter(|limit| limit.id == e.id).any(|limit| match e.values.first() {
                Some(size) if e.form == 0 => (limit.low..=limit.high).contains(size),
                _ => !limit.excluded,
            })
    })
}

/// Returns the root mean square error of the model file's predictions of a new session, in newtons.
pub(super) fn error_n(fitted: &Fitted, rows: &[PlateauRow]) -> Option<f64> {
    let (predicted, _) = ModelFile::new(fitted).predict(rows, Session::New, "study").ok()?;
    root_mean_square_n(&predicted, rows)
}

/// Returns the root mean square error on rows of the fitted session, in newtons.
fn in_session_error_n(fitted: &Fitted, rows: &[PlateauRow]) -> Option<f64> {
    root_mean_square_n(&fitted.model.predict(&fitted.model.frame.points(rows)?), rows)
}

fn root_mean_square_n(predicted: &[f64], rows: &[PlateauRow]) -> Option<f64> {
    let sum: f64 = predicted.iter().zip(rows).map(|(p, r)| (p - r.force_n).powi(2)).sum();
    (predicted.len() == rows.len()).then(|| (sum / predicted.len().max(1) as f64).sqrt())
}

/// Whether the interval of each reported true effect contains its size. Forms other than the fitter's
/// have other sizes.
fn covered(plan: &Plan, report: &Report) -> Vec<bool> {
    let covers = |e: &crate::plan::EffectPlan| {
        let parameter = effect_named(&e.id)?.parameters().first()?;
        let estimate = report.effects.iter().find(|r| r.id == e.id)?.parameters.get(&*parameter.name)?;
        Some((estimate.ci95[0]..=estimate.ci95[1]).contains(e.values.first()?))
    };
    plan.effects.iter().filter(|e| e.form == 0).filter_map(covers).collect()
}
