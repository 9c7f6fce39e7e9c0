//! What a plan asked before a table was recorded, and what the table answers: an expectation is to be held against what came.

use pinswitch_friction::published;
use serde::{Deserialize, Serialize};

use crate::experiment::{COVERED, FRICTION_ABOVE, NONE};
use crate::report::{Report, SessionReport};
use crate::trial::TrialOutcome;

/// What came of a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Answer {
    /// One of the two is believed, alone.
    Found,
    /// It is not there, at the size that was asked about, or at any of consequence.
    Excluded,
    /// The load was recorded, and nothing along it is left.
    Recorded,
    /// As open as before.
    Open,
}

impl Answer {
    /// The word for it.
    pub fn as_str(self) -> &'static str {
        match self {
            Answer::Found => "found",
            Answer::Excluded => "excluded",
            Answer::Recorded => "recorded",
            Answer::Open => "open",
        }
    }
}

/// A question of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AskedQuestion {
    /// What it lay between: two ids, or an id and `none`.
    pub between: [String; 2],
    /// Of an effect against none, the size that was asked about, in the unit of its first constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<f64>,
    /// Probability that was expected of an answer.
    pub resolved_probability: f64,
    /// What came of it.
    #[serde(default = "not_yet")]
    pub answer: Answer,
}

fn not_yet() -> Answer {
    Answer::Open
}

/// What a session was made for: what `experiment.json` holds of it, and what came of each question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// Minutes that the plan took.
    pub minutes: f64,
    /// Its questions.
    pub questions: Vec<AskedQuestion>,
}

impl Asked {
    /// The same with what a report of rows up to a load of `highest_n` answers.
    #[must_use]
    pub fn answered(mut self, report: &Report, highest_n: f64) -> Self {
        for question in &mut self.questions {
            question.answer = answer(question, report, highest_n);
        }
        self
    }

    /// How many questions are answered.
    pub fn settled(&self) -> usize {
        self.questions.iter().filter(|q| q.answer != Answer::Open).count()
    }
}

fn answer(question: &AskedQuestion, report: &Report, highest_n: f64) -> Answer {
    let [of, or] = &question.between;
    if let Some(trial) = report.trials.iter().find(|trial| trial.id == *of) {
        return match trial.outcome {
            TrialOutcome::Confirmed => Answer::Found,
            TrialOutcome::Refuted => Answer::Excluded,
            TrialOutcome::Open | TrialOutcome::Drawn => Answer::Open,
        };
    }
    if of.starts_with(FRICTION_ABOVE) {
        let is_left = report.effects.iter().any(|e| e.side.is_none() && e.covariate == "load");
        let is_recorded = highest_n > COVERED * published::heaviest_load_n();
        return if is_recorded && !is_left { Answer::Recorded } else { Answer::Open };
    }
    let said = SessionReport::after(String::new(), report);
    let is_alone = |id: &String| said.effects.iter().any(|ids| ids.len() == 1 && ids[0] == *id);
    let is_named = |id: &String| said.effects.iter().any(|ids| ids.contains(id));
    if is_alone(of) || is_alone(or) {
        return Answer::Found;
    }
    // As large as it was asked about, which may be more than what is of consequence.
    let is_smaller = |low: f64, high: f64| question.size.is_some_and(|size| low > -size && high < size);
    let is_out = report
        .limits
        .iter()
        .any(|limit| limit.id == *of && (limit.excluded || is_smaller(limit.low, limit.high)));
    // What is too weak to be seen at a typical size may still be known to be smaller than what was asked about.
    let is_below = report
        .invisible
        .iter()
        .any(|hidden| hidden.id == *of && hidden.possible.is_some_and(|[low, high]| is_smaller(low, high)));
    let is_out = is_out || is_below;
    if or == NONE && !is_named(of) && is_out { Answer::Excluded } else { Answer::Open }
}
