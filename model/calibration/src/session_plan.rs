//! Plan of a session, and the answers of the recorded table to its questions.

use pinswitch_diagnostic::{Diagnostic, Location, codes, excerpt};
use pinswitch_friction::published;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::report::{Report, TrialOutcome};

/// Second explanation of a question about the presence of an effect.
pub(crate) const NONE: &str = "none";
/// Start of the name of a question about friction above a load.
pub(crate) const FRICTION_ABOVE: &str = "friction_above_";
/// Share of the paper's heaviest load from which friction counts as recorded up to it.
pub(crate) const COVERED: f64 = 0.9;

/// Answer to a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Answer {
    /// One of the two effects is attributed, without the other.
    Found,
    /// The effect is excluded at the size in question, or at any relevant size.
    Excluded,
    /// The load was recorded, and no structure along it is left.
    Recorded,
    /// Not answered.
    Open,
}

impl Answer {
    /// Returns the word in reports.
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlanQuestion {
    /// The two explanations: two ids, or an id and `none`.
    pub between: [String; 2],
    /// Size in question in the unit of the effect's first constant, for an effect against none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<f64>,
    /// Expected probability of an answer.
    pub resolved_probability: f64,
    /// Expected probability of an answer if the paper's protocol were repeated for the same time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_repeating: Option<f64>,
    /// The answer.
    #[serde(default = "open")]
    pub answer: Answer,
}

fn open() -> Answer {
    Answer::Open
}

/// Plan of a session: the content of `experiment.json`, and the answer to each question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SessionPlan {
    /// Duration in minutes.
    pub minutes: f64,
    /// The runs in words, contact by contact.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub runs: Vec<String>,
    /// The questions.
    pub questions: Vec<PlanQuestion>,
}

impl SessionPlan {
    /// Checks every field. `is_known` returns whether an id is that of an effect.
    ///
    /// # Errors
    /// A [`Diagnostic`] of the first invalid field, such as `questions[0].between[1]`.
    pub fn check(&self, is_known: impl Fn(&str) -> bool) -> Result<(), Diagnostic> {
        let refused = |field: String, value: String, problem: &str| {
            Diagnostic::new(codes::PLAN_NOT_USABLE, problem).with_location(Location::field(field, value))
        };
        if !(self.minutes > 0.0 && self.minutes.is_finite()) {
            return Err(refused("minutes".to_owned(), self.minutes.to_string(), "must be above 0"));
        }
        for (i, question) in self.questions.iter().enumerate() {
            let of = |key: &str| format!("questions[{i}].{key}");
            let probability = question.resolved_probability;
            if !(0.0..=1.0).contains(&probability) {
                return Err(refused(of("resolved_probability"), probability.to_string(), "outside 0 to 1"));
            }
            for (at, id) in question.between.iter().enumerate() {
                let is_none = at == 1 && id == NONE;
                if !(is_known(id) || id.starts_with(FRICTION_ABOVE) || is_none) {
                    let value = format!("\"{}\"", excerpt(id, 60));
                    return Err(refused(of(&format!("between[{at}]")), value, "unknown effect")
                        .with_help("give the file of a user-defined effect with --effects"));
                }
            }
        }
        Ok(())
    }

    /// Returns the plan with the answers of a report, whose rows have loads up to `highest_n` in
    /// newtons.
    #[must_use]
    pub fn answered(mut self, report: &Report, highest_n: f64) -> Self {
        for question in &mut self.questions {
            question.answer = answer(question, report, highest_n);
        }
        self
    }

    /// Returns the number of answered questions.
    pub fn answered_count(&self) -> usize {
        self.questions.iter().filter(|q| q.answer != Answer::Open).count()
    }
}

fn answer(question: &PlanQuestion, report: &Report, highest_n: f64) -> Answer {
    let [of, or] = &question.between;
    if let Some(trial) = report.trials.iter().find(|trial| trial.id == *of) {
        return match trial.outcome {
            TrialOutcome::Confirmed => Answer::Found,
            TrialOutcome::Refuted => Answer::Excluded,
            TrialOutcome::Open | TrialOutcome::Suggested | TrialOutcome::Drawn => Answer::Open,
        };
    }
    if of.starts_with(FRICTION_ABOVE) {
        let is_left = report.effects.iter().any(|e| e.side.is_none() && e.covariate == "load");
        let is_recorded = highest_n > COVERED * published::heaviest_load_n();
        return if is_recorded && !is_left { Answer::Recorded } else { Answer::Open };
    }
    let is_rival = |id: &String| report.effects.iter().any(|e| e.rivals.iter().any(|rival| rival.id == *id));
    let found = |id: &String| report.effects.iter().find(|effect| effect.id == *id);
    if [of, or].into_iter().filter_map(found).any(|effect| effect.rivals.is_empty()) {
        return Answer::Found;
    }
    if or != NONE || is_rival(of) || found(of).is_some() {
        return Answer::Open;
    }
    // The size in question may be larger than the smallest relevant size, so that an effect may be
    // smaller than it although no relevant size would be detected.
    let is_smaller = |[low, high]: [f64; 2]| question.size.is_some_and(|size| low > -size && high < size);
    let limits = report.limits.iter().filter(|limit| limit.id == *of);
    let hidden = report.invisible.iter().filter(|hidden| hidden.id == *of);
    let is_excluded = limits.into_iter().any(|limit| limit.excluded || is_smaller([limit.low, limit.high]))
        || hidden.filter_map(|hidden| hidden.possible).any(is_smaller);
    if is_excluded { Answer::Excluded } else { Answer::Open }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_fields_are_located() {
        let plan = |minutes: f64, between: [&str; 2], resolved_probability: f64| SessionPlan {
            minutes,
            runs: Vec::new(),
            questions: vec![
                PlanQuestion {
                    between: ["friction_above_26_N".to_owned(), NONE.to_owned()],
                    size: None,
                    resolved_probability: 1.0,
                    by_repeating: None,
                    answer: Answer::Open,
                },
                PlanQuestion {
                    between: between.map(str::to_owned),
                    size: None,
                    resolved_probability,
                    by_repeating: None,
                    answer: Answer::Open,
                },
            ],
        };
        let check = |plan: SessionPlan| plan.check(|id| id == "adhesion" || id == "wear_drift");
        assert_eq!(check(plan(9.0, ["adhesion", "wear_drift"], 0.0)), Ok(()));
        for (plan, words) in [
            (plan(0.0, ["adhesion", "none"], 0.5), "minutes = 0: must be above 0"),
            (plan(f64::NAN, ["adhesion", "none"], 0.5), "minutes = NaN: must be above 0"),
            (plan(9.0, ["adhesion", "none"], 1.5), "questions[1].resolved_probability = 1.5: outside 0 to 1"),
            (plan(9.0, ["gravity", "none"], 0.5), "questions[1].between[0] = \"gravity\": unknown effect"),
            (plan(9.0, ["none", "adhesion"], 0.5), "questions[1].between[0] = \"none\": unknown effect"),
            (plan(9.0, ["adhesion", "gravity"], 0.5), "questions[1].between[1] = \"gravity\": unknown"),
        ] {
            let error = check(plan).unwrap_err().to_string();
            assert!(error.starts_with(words), "{error}");
        }
    }
}
