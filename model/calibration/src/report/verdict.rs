//! Verdict of a calibration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{TrialOutcome, TrialReport};

/// Verdict on the paper's model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Neither an effect nor structure without a name is probable, every relevant size of every effect that acts on this table is
    /// excluded, and series and mounts differ by less than such a size.
    None,
    /// No effect is attributed, and a relevant effect is not excluded.
    Inconclusive,
    /// Every effect of the model is named and without rivals.
    Attributed,
    /// At least one effect has rivals that this table cannot separate.
    Ambiguous,
    /// Structure remains that no effect explains.
    Unattributed,
}

impl Verdict {
    /// Returns the word used in reports.
    pub fn as_str(self) -> &'static str {
        match self {
            Verdict::None => "none",
            Verdict::Inconclusive => "inconclusive",
            Verdict::Attributed => "attributed",
            Verdict::Ambiguous => "ambiguous",
            Verdict::Unattributed => "unattributed",
        }
    }

    /// Returns the verdict in view of the tests of user-defined effects: a confirmed effect is not
    /// excluded.
    #[must_use]
    pub fn in_view_of(self, trials: &[TrialReport]) -> Self {
        match self {
            Verdict::None if trials.iter().any(|t| t.outcome == TrialOutcome::Confirmed) => {
                Verdict::Inconclusive
            }
            verdict => verdict,
        }
    }
}
