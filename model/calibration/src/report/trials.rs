//! Trials of user-defined effects in a report.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Estimate;

/// Outcome of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TrialOutcome {
    /// The effect is present in readings from which it was not derived, with the sign of its start
    /// value if it was derived or is one-sided.
    Confirmed,
    /// The effect is present, but its file does not exclude that it was derived from these readings.
    Suggested,
    /// The 95 % interval of the size excludes the derived size, or half the typical one.
    Refuted,
    /// Not decided.
    Open,
    /// The effect was derived from these readings, which cannot confirm it.
    Drawn,
}

impl TrialOutcome {
    /// Returns the word in reports.
    pub fn as_str(self) -> &'static str {
        match self {
            TrialOutcome::Confirmed => "confirmed",
            TrialOutcome::Suggested => "suggested",
            TrialOutcome::Refuted => "refuted",
            TrialOutcome::Open => "open",
            TrialOutcome::Drawn => "drawn",
        }
    }
}

/// Trial of one user-defined effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrialReport {
    /// Id.
    pub id: String,
    /// Outcome.
    pub outcome: TrialOutcome,
    /// Posterior probability that it acts; absent if it could not be tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// Size, if it acts; absent if it could not be tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<Estimate>,
    /// Start value of the size: the derived size of a form.
    pub start: f64,
    /// Whether the start value was derived from other readings, rather than given as typical.
    #[serde(default)]
    pub was_drawn: bool,
    /// Further information, such as effects that take its place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

impl TrialReport {
    /// Returns probability, size, hypothesis and note in one line.
    pub fn words(&self) -> String {
        let known = if self.was_drawn { "derived before" } else { "typical" };
        let size = self.size.as_ref().zip(self.probability).map(|(size, probability)| {
            let [low, high] = size.ci95;
            let unit = if size.unit == "1" { String::new() } else { format!(" {}", size.unit) };
            format!(
                "probability {probability:.3}; size if it acts: {:.4}{unit} [{low:.4}, {high:.4}] ({known}: {:.4})",
                size.value, self.start
            )
        });
        let words: Vec<String> = size.into_iter().chain(self.note.clone()).collect();
        words.join("; ")
    }
}
