//! Study of proposed experiments: rigs whose first session is ambiguous, after one proposed
//! session, and after as many minutes of the paper's protocol instead.

use pinswitch_calibration::effects::{Vocabulary, effect_named};
use pinswitch_calibration::experiment::{
    Known, PlannedRun, Proposal, QuestionOutlook, RigLimits, paper_runs, propose, rows_of,
};
use pinswitch_calibration::table::{PlateauRow, PlateauTable};
use pinswitch_calibration::{Answer, Calibration, ModelFile, PlanQuestion, SessionPlan, Verdict, calibrate};

use super::answer::CalibratorAnswer;
use super::case::{Case, Group, Truth};
use super::cases::plan_of;
use super::figures::median_text;
use super::forecast::{Forecast, reliability_table};
use crate::next_session::plan_for;
use crate::plan::{Plan, Protocol};
use crate::simulate::{simulate, simulate_rows};

/// Duration of the proposed session in minutes.
const MINUTES: f64 = 60.0;

/// Effects that the paper's protocol may leave ambiguous: rate, compliance or saturation; adhesion
/// or drag; gain or nonlinearity. Each has a factor on its random size, because small effects are
/// ambiguous more often.
const OPEN: [(&str, f64); 7] = [
    ("rate_dependence", 1.0),
    ("fixture_compliance", 1.0),
    ("substrate_saturation", 0.5),
    ("adhesion", 0.4),
    ("guide_drag", 0.4),
    ("load_cell_gain", 0.25),
    ("load_cell_nonlinearity", 0.25),
];

/// State of the attribution after a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attribution {
    /// The true effect alone is attributed.
    Alone,
    /// The verdict is `ambiguous` or `inconclusive`.
    Open,
    /// Any other answer.
    Other,
}

/// Outcome of a rig.
#[derive(Clone, Debug, PartialEq)]
pub struct ExperimentOutcome {
    /// Attribution after the paper's protocol.
    pub first: Attribution,
    /// Attribution after one more session, as proposed; `None` if the first was not open.
    pub proposed: Option<Attribution>,
    /// Attribution after as many minutes of the paper's protocol instead.
    pub repeated: Option<Attribution>,
    /// Duration of the proposed session in minutes.
    pub minutes: f64,
    /// Forecasts for the questions of the proposed session.
    pub forecasts: Vec<Forecast>,
    /// Forecasts for the same questions with the paper's protocol.
    pub repetition_forecasts: Vec<Forecast>,
}

/// Returns the kinds of rig of this study.
pub fn experiment_cases() -> Vec<Case> {
    OPEN.map(|(id, _)| Case {
        name: id.to_owned(),
        protocol: Protocol::Paper,
        group: Group::Confounded,
        truth: Truth::Effects(vec![id]),
        every_noise: false,
    })
    .to_vec()
}

/// Returns the plan of a kind and a seed, with the fitter's form and a size multiplied by the
/// factor of [`OPEN`] and by `factor`.
fn open_plan(case: &Case, seed: u64, factor: f64) -> Plan {
    let mut plan = plan_of(case, seed);
    let share = OPEN.iter().find(|(id, _)| *id == case.name).map_or(1.0, |(_, share)| factor * *share);
    for effect in &mut plan.effects {
        effect.form = 0;
        let has_size = effect_named(&effect.id).is_some_and(|e| e.description().study.size.is_some());
        effect.values.iter_mut().take(usize::from(has_size)).for_each(|size| *size *= share);
    }
    plan
}

/// Calibrates a rig whose effect is larger by `factor` than usual in this study. If the result is
/// open, proposes a session, simulates it, and calibrates both tables together. Returns `None` if a
/// table is not usable.
pub fn run_experiment_case(case: &Case, seed: u64, factor: f64) -> Option<ExperimentOutcome> {
    let plan = open_plan(case, seed, factor);
    let rows = simulate(&plan).rows;
    let calibration = calibrate(&rows, &Vocabulary::built_in(), seed).ok()?;
    let first = attribution(case, &calibration);
    if first != Attribution::Open {
        return Some(ExperimentOutcome {
            first,
            proposed: None,
            repeated: None,
            minutes: 0.0,
            forecasts: Vec::new(),
            repetition_forecasts: Vec::new(),
        });
    }
    let rig = RigLimits::default();
    let proposal = proposed(&calibration, &rows, &rig)?;
    let after = |runs: &[PlannedRun], probability: fn(&QuestionOutlook) -> f64| {
        let asked = SessionPlan {
            minutes: proposal.minutes,
            runs: Vec::new(),
            questions: proposal.questions.iter().map(|q| asked(q, probability(q))).collect(),
        };
        let Some(session) = session(&plan, runs, &rig) else { return (None, Vec::new()) };
        let Some(rows) = joined(&rows, session) else { return (None, Vec::new()) };
        let Ok(both) = calibrate(&rows, &Vocabulary::built_in(), seed) else { return (None, Vec::new()) };
        let highest_n = rows.iter().map(|row| row.load_n).fold(0.0, f64::max);
        let answers = asked.answered(&both.report, highest_n).questions;
        let forecasts = answers
            .iter()
            .map(|q| Forecast { probability: q.resolved_probability, is_true: q.answer != Answer::Open });
        (Some(attribution(case, &both)), forecasts.collect())
    };
    let (proposed, forecasts) = after(&proposal.runs, |q| q.resolved_probability);
    let (repeated, repetition_forecasts) = after(&paper_runs(&rig, proposal.minutes), |q| q.by_repeating);
    Some(ExperimentOutcome {
        first,
        proposed,
        repeated,
        minutes: proposal.minutes,
        forecasts,
        repetition_forecasts,
    })
}

/// Converts a question to the form of a plan's file.
fn asked(question: &QuestionOutlook, resolved_probability: f64) -> PlanQuestion {
    PlanQuestion {
        between: question.between.clone(),
        size: question.size,
        resolved_probability,
        by_repeating: None,
        answer: Answer::Open,
    }
}

/// Returns the state of the attribution of a calibration.
fn attribution(case: &Case, calibration: &Calibration) -> Attribution {
    let parts = CalibratorAnswer::new(&calibration.report).parts;
    match calibration.report.verdict {
        Verdict::Attributed if parts.len() == 1 && parts[0].names == [case.name.as_str()] => {
            Attribution::Alone
        }
        Verdict::Ambiguous | Verdict::Inconclusive => Attribution::Open,
        _ => Attribution::Other,
    }
}

/// Proposes a session after a calibration.
fn proposed(calibration: &Calibration, rows: &[PlateauRow], rig: &RigLimits) -> Option<Proposal> {
    let model = ModelFile::new(&calibration.augmented);
    let vocabulary = Vocabulary::built_in();
    let known =
        Known { report: &calibration.report, model: &model, rows, vocabulary: &vocabulary, name: "study" };
    propose(known, rig, MINUTES).ok()
}

/// Simulates the runs as a later session of the rig of a plan.
fn session(plan: &Plan, runs: &[PlannedRun], rig: &RigLimits) -> Option<Vec<PlateauRow>> {
    let rows = rows_of(runs, rig, "");
    if rows.is_empty() {
        return None;
    }
    Some(simulate_rows(&plan_for(plan, &rows), rows).rows)
}

/// Joins both tables like the command line.
fn joined(first: &[PlateauRow], second: Vec<PlateauRow>) -> Option<Vec<PlateauRow>> {
    let table = |rows: &[PlateauRow], name: &str| {
        Some((PlateauTable::read(PlateauTable::write(rows).as_bytes(), name).ok()?, name.to_owned()))
    };
    let tables = vec![table(first, "first.csv")?, table(&second, "second.csv")?];
    Some(PlateauTable::joined(tables).ok()?.rows)
}

/// Outcomes by kind of rig.
#[derive(Clone, Debug, Default)]
pub struct ExperimentStudy {
    outcomes: Vec<(Case, Vec<ExperimentOutcome>)>,
}

impl ExperimentStudy {
    /// Adds the outcomes of a kind.
    pub fn add(&mut self, case: Case, outcomes: Vec<ExperimentOutcome>) {
        self.outcomes.push((case, outcomes));
    }

    /// Returns a row for each kind, one for all, and the reliability of the forecasts, in Markdown.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "| rig | rigs | attributed alone after the first session | open | of these attributed alone after one proposed session | after as many minutes of the paper's protocol | median minutes |\n|---|---|---|---|---|---|---|\n",
        );
        for (case, outcomes) in &self.outcomes {
            text.push_str(&row(&case.name, &outcomes.iter().collect::<Vec<_>>()));
        }
        let all: Vec<&ExperimentOutcome> = self.outcomes.iter().flat_map(|(_, o)| o).collect();
        text.push_str(&row("all", &all));
        let forecasts = |of: fn(&ExperimentOutcome) -> &Vec<Forecast>| -> Vec<Forecast> {
            all.iter().flat_map(|outcome| of(outcome)).copied().collect()
        };
        let kinds = ["questions of proposed sessions", "questions of repeated protocols"];
        let (proposed, repeated) = (forecasts(|o| &o.forecasts), forecasts(|o| &o.repetition_forecasts));
        let forecasts = reliability_table("forecast probability of an answer", kinds, [&proposed, &repeated]);
        format!("{text}\n{forecasts}")
    }
}

/// Returns a row of the table.
fn row(name: &str, outcomes: &[&ExperimentOutcome]) -> String {
    let count = |of: &dyn Fn(&ExperimentOutcome) -> bool| outcomes.iter().filter(|o| of(o)).count();
    format!(
        "| {name} | {} | {} | {} | {} | {} | {} |\n",
        outcomes.len(),
        count(&|o| o.first == Attribution::Alone),
        count(&|o| o.first == Attribution::Open),
        count(&|o| o.proposed == Some(Attribution::Alone)),
        count(&|o| o.repeated == Some(Attribution::Alone)),
        median_text(outcomes.iter().filter(|o| o.proposed.is_some()).map(|o| o.minutes), 0)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn proposed_sessions_resolve_more_than_repetitions() {
        let case = experiment_cases().remove(0);
        let outcomes: Vec<_> =
            (900_001..900_004).filter_map(|seed| run_experiment_case(&case, seed, 1.0)).collect();
        assert_eq!(outcomes.len(), 3);
        let open: Vec<_> = outcomes.iter().filter(|o| o.first == Attribution::Open).collect();
        assert!(!open.is_empty(), "{outcomes:?}");
        assert!(open.iter().all(|o| o.minutes <= MINUTES), "{open:?}");
        let settled = open.iter().filter(|o| o.proposed == Some(Attribution::Alone)).count();
        let repeated = open.iter().filter(|o| o.repeated == Some(Attribution::Alone)).count();
        assert!(settled > repeated, "{outcomes:?}");
        let mut study = ExperimentStudy::default();
        study.add(case, outcomes);
        assert!(study.table().contains("| rate_dependence | 3 |"), "{}", study.table());
    }
}
