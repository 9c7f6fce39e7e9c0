//! The study's chapter on the next experiment: rigs whose first table leaves open what is true, and what one proposed session
//! makes of them, beside as many minutes of the paper's protocol.

use pinswitch_calibration::effects::{Vocabulary, effect_named};
use pinswitch_calibration::experiment::{
    Known, PlannedRun, Proposal, QuestionOutlook, RigLimits, paper_runs, propose, rows_of,
};
use pinswitch_calibration::inference::{FoundEffect, Levels};
use pinswitch_calibration::table::{PlateauRow, PlateauTable};
use pinswitch_calibration::{Answer, Asked, AskedQuestion, Calibration, ModelFile, Verdict, calibrate};

use super::answer_forecasts::{AnswerForecast, table_of};
use super::case::{Case, Group, Truth};
use super::cases::plan_of;
use super::figures::median_text;
use crate::next_session::plan_for;
use crate::plan::{Plan, Protocol};
use crate::simulate::{simulate, simulate_rows};

/// Minutes of the proposed session.
const MINUTES: f64 = 60.0;

/// Effects that the paper's protocol may leave open: rate against compliance against saturation, adhesion against drag, gain
/// against nonlinearity. Each with the share of its drawn size that is put in: small ones are left open more often.
const OPEN: [(&str, f64); 7] = [
    ("rate_dependence", 1.0),
    ("fixture_compliance", 1.0),
    ("substrate_saturation", 0.5),
    ("adhesion", 0.4),
    ("guide_drag", 0.4),
    ("load_cell_gain", 0.25),
    ("load_cell_nonlinearity", 0.25),
];

/// What a table says, as far as this chapter asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attribution {
    /// The true effect is attributed, alone.
    Alone,
    /// `ambiguous` or `inconclusive`.
    Open,
    /// Anything else.
    Other,
}

/// What became of one rig.
#[derive(Clone, Debug, PartialEq)]
pub struct ExperimentOutcome {
    /// After the paper's protocol.
    pub first: Attribution,
    /// After one proposed session more; `None` where nothing was open.
    pub proposed: Option<Attribution>,
    /// After as many minutes of the paper's protocol instead.
    pub repeated: Option<Attribution>,
    /// Minutes that the proposal took.
    pub minutes: f64,
    /// What was told of each question, and whether the proposed session answered it.
    pub forecasts: Vec<AnswerForecast>,
    /// The same of the paper's protocol.
    pub repetition_forecasts: Vec<AnswerForecast>,
}

/// The kinds of rig of this chapter.
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

/// The plan of a kind and a seed: the form is the fitter's, and the size its share of that drawn, times `factor`.
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

/// Calibrates one rig whose effect is `factor` times as large as this chapter's, proposes a session where something is open,
/// makes it, and calibrates both tables together. `None` if a table cannot be used.
pub fn run_experiment_case(case: &Case, seed: u64, factor: f64, levels: Levels) -> Option<ExperimentOutcome> {
    let plan = open_plan(case, seed, factor);
    let rows = simulate(&plan).rows;
    let found = calibrate(&rows, levels).ok()?;
    let first = attribution(case, &found);
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
    let proposal = proposed(&found, &rows, &rig, levels)?;
    let after = |runs: &[PlannedRun], probability: fn(&QuestionOutlook) -> f64| {
        let asked = Asked {
            minutes: proposal.minutes,
            runs: Vec::new(),
            questions: proposal.questions.iter().map(|q| asked(q, probability(q))).collect(),
        };
        let Some(session) = session(&plan, runs, &rig) else { return (None, Vec::new()) };
        let Some(rows) = joined(&rows, session) else { return (None, Vec::new()) };
        let Ok(both) = calibrate(&rows, levels) else { return (None, Vec::new()) };
        let highest_n = rows.iter().map(|row| row.load_n).fold(0.0, f64::max);
        let answers = asked.answered(&both.report, highest_n).questions;
        let promised = answers.iter().map(|q| AnswerForecast {
            probability: q.resolved_probability,
            is_answered: q.answer != Answer::Open,
        });
        (Some(attribution(case, &both)), promised.collect())
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

/// A question as a plan's file holds it.
fn asked(question: &QuestionOutlook, resolved_probability: f64) -> AskedQuestion {
    AskedQuestion {
        between: question.between.clone(),
        size: question.size,
        resolved_probability,
        by_repeating: None,
        answer: Answer::Open,
    }
}

fn attribution(case: &Case, found: &Calibration) -> Attribution {
    let named: Vec<Vec<&str>> = found.selection.effects.iter().map(FoundEffect::ids).collect();
    match found.report.verdict {
        Verdict::Attributed if named == [vec![case.name.as_str()]] => Attribution::Alone,
        Verdict::Ambiguous | Verdict::Inconclusive => Attribution::Open,
        _ => Attribution::Other,
    }
}

fn proposed(found: &Calibration, rows: &[PlateauRow], rig: &RigLimits, levels: Levels) -> Option<Proposal> {
    let model = ModelFile::new(&found.selection.augmented, &found.data, found.selection.noise);
    let vocabulary = Vocabulary::built_in();
    let known = Known { report: &found.report, model: &model, rows, vocabulary: &vocabulary, name: "study" };
    propose(known, rig, MINUTES, levels).ok()
}

/// The runs made on the rig of a plan, as a later session.
fn session(plan: &Plan, runs: &[PlannedRun], rig: &RigLimits) -> Option<Vec<PlateauRow>> {
    let rows = rows_of(runs, rig, "");
    if rows.is_empty() {
        return None;
    }
    Some(simulate_rows(&plan_for(plan, &rows), rows).rows)
}

/// Both tables as the command line joins them.
fn joined(first: &[PlateauRow], second: Vec<PlateauRow>) -> Option<Vec<PlateauRow>> {
    let table = |rows: &[PlateauRow], name: &str| {
        Some((PlateauTable::read(PlateauTable::write(rows).as_bytes(), name).ok()?, name.to_owned()))
    };
    let tables = vec![table(first, "first.csv")?, table(&second, "second.csv")?];
    Some(PlateauTable::joined(tables).ok()?.rows)
}

/// The outcomes by kind.
#[derive(Clone, Debug, Default)]
pub struct ExperimentStudy {
    outcomes: Vec<(Case, Vec<ExperimentOutcome>)>,
}

impl ExperimentStudy {
    /// Adds the outcomes of a kind.
    pub fn add(&mut self, case: Case, outcomes: Vec<ExperimentOutcome>) {
        self.outcomes.push((case, outcomes));
    }

    /// A row for each kind, and one for all, in Markdown.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "| rig | rigs | attributed alone at first | open at first | of these attributed alone after one proposed session | after as many minutes of the paper's protocol | median minutes |\n|---|---|---|---|---|---|---|\n",
        );
        for (case, outcomes) in &self.outcomes {
            text.push_str(&row(&case.name, &outcomes.iter().collect::<Vec<_>>()));
        }
        let all: Vec<&ExperimentOutcome> = self.outcomes.iter().flat_map(|(_, o)| o).collect();
        text.push_str(&row("all", &all));
        let promised = |of: fn(&ExperimentOutcome) -> &Vec<AnswerForecast>| -> Vec<AnswerForecast> {
            all.iter().flat_map(|outcome| of(outcome)).copied().collect()
        };
        format!("{text}\n{}", table_of(&promised(|o| &o.forecasts), &promised(|o| &o.repetition_forecasts)))
    }
}

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
    fn a_proposed_hour_settles_what_the_paper_leaves_open() {
        let case = experiment_cases().remove(0);
        let outcomes: Vec<_> = (900_001..900_004)
            .filter_map(|seed| run_experiment_case(&case, seed, 1.0, Levels::default()))
            .collect();
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
