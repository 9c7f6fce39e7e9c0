//! Study of estimated forms of unattributed structure: are they correct, do they predict a later
//! session as well as the true form, and are they confirmed or refuted by other sessions?

use pinswitch_calibration::effects::{OwnEffect, Vocabulary};
use pinswitch_calibration::table::PlateauRow;
use pinswitch_calibration::{Calibration, TrialOutcome, TrialReport, calibrate};

use super::answer::CalibratorAnswer;
use super::case::{Case, Truth};
use super::cases::plan_of;
use super::figures::median_text;
use super::outcome::error_n;
use super::true_form::{true_forms, true_shapes};
use super::visibility::is_visible;
use crate::disturbance::Disturbance;
use crate::next_session::next_session;
use crate::plan::Plan;
use crate::simulate::simulate;

/// Offset of the seed for a rig without the disturbance.
const OTHER_RIG: u64 = 500_000_000;
/// Probability above which a trial finds an effect present.
const PRESENT: f64 = 0.9;

/// Outcome of a rig with a disturbance outside the vocabulary.
#[derive(Clone, Debug, PartialEq)]
pub struct FormOutcome {
    /// Whether the calibration reports structure over a correct covariate.
    pub is_covariate_right: bool,
    /// Whether the session could detect the disturbance despite mount effects.
    pub visible: bool,
    /// Estimated shape; `None` without structure.
    pub shape: Option<String>,
    /// Whether the estimated shape or a rival is the true one; `None` if no shape is expected.
    pub is_shape_right: Option<bool>,
    /// Root mean square errors on a later session, in newtons: of the refitted baseline, of the
    /// calibration's model, and of that model with the estimated form in place of the structure.
    pub next_n: [Option<f64>; 3],
    /// The same error of a calibration whose vocabulary has the true form; `None` if no formula
    /// describes it.
    pub truth_n: Option<f64>,
    /// Test of the estimated form on a later session of the same rig.
    pub later_trial: Option<TrialReport>,
    /// Test of the estimated form on a session of another rig without the disturbance.
    pub absent_trial: Option<TrialReport>,
}

impl FormOutcome {
    /// Returns the error of the calibration's model on a later session, over that of the true form.
    pub fn over_truth(&self) -> Option<f64> {
        Some(self.next_n[1]? / self.truth_n?.max(1e-9))
    }
}

/// Estimates the form of the disturbance of a rig, and tests it on two other sessions. Returns
/// `None` if a table is not usable, or the kind of rig has no disturbance.
pub fn run_form_case(case: &Case, seed: u64) -> Option<FormOutcome> {
    let Truth::Outside { covariates, .. } = case.truth else { return None };
    let plan = plan_of(case, seed);
    let disturbance = plan.disturbances.first()?;
    let simulated = simulate(&plan);
    let rows = simulated.rows;
    let Calibration { report, baseline, augmented, form, .. } =
        calibrate(&rows, &Vocabulary::built_in(), seed).ok()?;
    let next = next_session(&plan).rows;
    let mut structures = CalibratorAnswer::new(&report).parts.into_iter().filter_map(|part| part.structure);
    let trial = |rows: &[PlateauRow]| {
        let own = OwnEffect::new(form.as_ref()?.definition.clone()).ok()?;
        trial_on(rows, &Vocabulary::built_in().with(vec![own]).ok()?, seed)
    };
    let truth_n = || {
        let (vocabulary, _) = true_forms(disturbance, &baseline.model.frame)?;
        error_n(&calibrate(&rows, &vocabulary, seed).ok()?.augmented, &next)
    };
    let without = Plan { disturbances: Vec::new(), seed: seed + OTHER_RIG, ..plan.clone() };
    Some(FormOutcome {
        is_covariate_right: structures.any(|covariate| covariates.contains(&covariate)),
        visible: is_visible(&plan, &simulated.traits)?,
        shape: form.as_ref().map(|f| f.report.shape.clone()),
        is_shape_right: is_shape_right(disturbance, form.as_ref().map(|f| &f.report)),
        next_n: [
            error_n(&baseline, &next),
            error_n(&augmented, &next),
            form.as_ref().and_then(|f| error_n(&f.fitted, &next)),
        ],
        truth_n: truth_n(),
        later_trial: trial(&next),
        absent_trial: trial(&simulate(&without).rows),
    })
}

/// Whether the estimated shape or one of its rivals is the true one; `None` if no shape is
/// expected.
fn is_shape_right(
    disturbance: &Disturbance,
    form: Option<&pinswitch_calibration::FormReport>,
) -> Option<bool> {
    let right = true_shapes(disturbance);
    if right.is_empty() {
        return None;
    }
    Some(form.is_some_and(|form| {
        let rivals = form.rivals.iter().map(|r| r.shape.as_str());
        std::iter::once(form.shape.as_str()).chain(rivals).any(|shape| right.contains(&shape))
    }))
}

/// Tests the only user-defined effect of a vocabulary on a table.
fn trial_on(rows: &[PlateauRow], vocabulary: &Vocabulary, seed: u64) -> Option<TrialReport> {
    calibrate(rows, vocabulary, seed).ok()?.report.trials.pop()
}

/// Outcomes by kind of rig.
#[derive(Clone, Debug, Default)]
pub struct FormStudy {
    outcomes: Vec<(Case, Vec<FormOutcome>)>,
}

impl FormStudy {
    /// Adds the outcomes of a kind.
    pub fn add(&mut self, case: Case, outcomes: Vec<FormOutcome>) {
        self.outcomes.push((case, outcomes));
    }

    /// Returns a row for each kind, and one for all, in Markdown.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "| protocol | rig | rigs | right covariate | right covariate of the visible | right shape | later session, model / true form | form / true form | confirmed by a later session | refuted if absent | probability below 0.9 if absent |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
        );
        for (case, outcomes) in &self.outcomes {
            let protocol = format!("{:?}", case.protocol).to_lowercase();
            text.push_str(&row(&protocol, &case.name, &outcomes.iter().collect::<Vec<_>>()));
        }
        let all: Vec<&FormOutcome> = self.outcomes.iter().flat_map(|(_, outcomes)| outcomes).collect();
        text.push_str(&row("both", "all", &all));
        text
    }
}

/// Returns a row of the table.
fn row(protocol: &str, name: &str, outcomes: &[&FormOutcome]) -> String {
    // Two operators have no shape.
    let of = |values: Vec<bool>| match values.len() {
        0 => String::new(),
        all => format!("{} of {all}", values.iter().filter(|v| **v).count()),
    };
    let shapes = outcomes.iter().filter_map(|o| o.is_shape_right).collect();
    let form_over_truth = |o: &&FormOutcome| Some(o.next_n[2]? / o.truth_n?.max(1e-9));
    let later = outcomes.iter().filter_map(|o| o.later_trial.as_ref());
    let absent = || outcomes.iter().filter_map(|o| o.absent_trial.as_ref());
    format!(
        "| {protocol} | {name} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
        outcomes.len(),
        outcomes.iter().filter(|o| o.is_covariate_right).count(),
        of(outcomes.iter().filter(|o| o.visible).map(|o| o.is_covariate_right).collect()),
        of(shapes),
        median_text(outcomes.iter().filter_map(|o| o.over_truth()), 2),
        median_text(outcomes.iter().filter_map(form_over_truth), 2),
        of(later.map(|t| t.outcome == TrialOutcome::Confirmed).collect()),
        of(absent().map(|t| t.outcome == TrialOutcome::Refuted).collect()),
        of(absent().map(|t| t.probability.is_none_or(|p| p < PRESENT)).collect()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Protocol;
    use crate::study::cases::study_cases;

    #[test]
    fn memory_form_is_confirmed_and_refuted() {
        let case = study_cases()
            .into_iter()
            .find(|c| c.name == "memory of the load before" && c.protocol == Protocol::Randomised)
            .unwrap();
        let outcome = run_form_case(&case, 2).unwrap();
        assert!(outcome.is_covariate_right && outcome.is_shape_right == Some(true), "{outcome:?}");
        assert!(outcome.over_truth().unwrap() < 1.3, "{outcome:?}");
        assert_eq!(outcome.later_trial.as_ref().unwrap().outcome, TrialOutcome::Confirmed);
        assert_eq!(outcome.absent_trial.as_ref().unwrap().outcome, TrialOutcome::Refuted);
        let mut study = FormStudy::default();
        study.add(case, vec![outcome]);
        assert!(study.table().contains("| 1 | 1 | 1 of 1 | 1 of 1 |"), "{}", study.table());
    }
}
