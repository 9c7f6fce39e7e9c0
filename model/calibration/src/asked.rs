//! What a plan asked before a table was recorded, and what the table answers: an expectation is to be held against what came.

use pinswitch_diagnostic::excerpt;
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
    /// The same of the paper's protocol repeated for as long.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_repeating: Option<f64>,
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
    /// Its runs in words, contact by contact.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub runs: Vec<String>,
    /// Its questions.
    pub questions: Vec<AskedQuestion>,
}

/// Why a plan asks nothing that can be answered.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field} = {value} is {fault}")]
pub struct AskedError {
    /// The field, as `questions[0].between[1]`.
    pub field: String,
    /// Its value.
    pub value: String,
    /// What is wrong with it, and what may stand there.
    pub fault: String,
}

impl Asked {
    /// Whether each field holds what a plan may hold. `is_known` says which ids are those of an effect.
    ///
    /// # Errors
    /// [`AskedError`] at the first field that no plan has.
    pub fn check(&self, is_known: impl Fn(&str) -> bool) -> Result<(), AskedError> {
        let refused = |field: String, value: String, fault: &str| {
            Err(AskedError { field, value, fault: fault.to_owned() })
        };
        if !(self.minutes > 0.0 && self.minutes.is_finite()) {
            return refused("minutes".to_owned(), self.minutes.to_string(), "not above 0");
        }
        for (i, question) in self.questions.iter().enumerate() {
            let of = |key: &str| format!("questions[{i}].{key}");
            let probability = question.resolved_probability;
            if !(0.0..=1.0).contains(&probability) {
                return refused(of("resolved_probability"), probability.to_string(), "outside 0..1");
            }
            for (at, id) in question.between.iter().enumerate() {
                let stands_for_none = at == 1 && id == NONE;
                if !(is_known(id) || id.starts_with(FRICTION_ABOVE) || stands_for_none) {
                    let value = format!("\"{}\"", excerpt(id, 60));
                    let fault = "no effect that is known here: where it is one of your own, give its file by --effects";
                    return refused(of(&format!("between[{at}]")), value, fault);
                }
            }
        }
        Ok(())
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_that_no_plan_has_is_named() {
        let asked = |minutes: f64, between: [&str; 2], resolved_probability: f64| Asked {
            minutes,
            runs: Vec::new(),
            questions: vec![
                AskedQuestion {
                    between: ["friction_above_26_N".to_owned(), NONE.to_owned()],
                    size: None,
                    resolved_probability: 1.0,
                    by_repeating: None,
                    answer: Answer::Open,
                },
                AskedQuestion {
                    between: between.map(str::to_owned),
                    size: None,
                    resolved_probability,
                    by_repeating: None,
                    answer: Answer::Open,
                },
            ],
        };
        let check = |asked: Asked| asked.check(|id| id == "adhesion" || id == "wear_drift");
        assert_eq!(check(asked(9.0, ["adhesion", "wear_drift"], 0.0)), Ok(()));
        for (asked, words) in [
            (asked(0.0, ["adhesion", "none"], 0.5), "minutes = 0 is not above 0"),
            (asked(f64::NAN, ["adhesion", "none"], 0.5), "minutes = NaN"),
            (
                asked(9.0, ["adhesion", "none"], 1.5),
                "questions[1].resolved_probability = 1.5 is outside 0..1",
            ),
            (asked(9.0, ["gravity", "none"], 0.5), "questions[1].between[0] = \"gravity\" is no effect"),
            (asked(9.0, ["none", "adhesion"], 0.5), "questions[1].between[0] = \"none\""),
            (asked(9.0, ["adhesion", "gravity"], 0.5), "questions[1].between[1] = \"gravity\""),
        ] {
            let error = check(asked).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
