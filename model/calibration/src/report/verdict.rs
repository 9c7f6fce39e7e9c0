//! Verdict of a calibration.

use serde::{Deserialize, Serialize};

use crate::inference::Selection;
use crate::trial::{TrialOutcome, TrialReport};

/// Verdict on the paper's model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The paper's model explains the data down to its noise, and every identifiable relevant
    /// effect is excluded.
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

    /// Returns the verdict of a selection.
    pub fn of(selection: &Selection) -> Self {
        if selection.structure.is_some() {
            Verdict::Unattributed
        } else if selection.effects.is_empty() {
            let hidden = selection.limits.iter().any(|limit| !limit.is_excluded());
            if hidden { Verdict::Inconclusive } else { Verdict::None }
        } else if selection.effects.iter().any(|e| !e.rivals.is_empty()) {
            Verdict::Ambiguous
        } else {
            Verdict::Attributed
        }
    }

    /// Returns the verdict in view of the tests of user-defined effects: a confirmed effect is not
    /// excluded.
    #[must_use]
    pub fn beside(self, trials: &[TrialReport]) -> Self {
        match self {
            Verdict::None if trials.iter().any(|t| t.outcome == TrialOutcome::Confirmed) => {
                Verdict::Inconclusive
            }
            verdict => verdict,
        }
    }
}
