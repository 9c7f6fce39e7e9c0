//! The verdict on a table.

use serde::{Deserialize, Serialize};

use crate::inference::Selection;
use crate::trial::{TrialOutcome, TrialReport};

/// What the data say about the paper's model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The paper's model explains the data down to its noise, and no visible effect of consequence is left possible.
    None,
    /// Nothing is believed, and a visible effect of consequence is not excluded.
    Inconclusive,
    /// Every effect found is named and has no rival.
    Attributed,
    /// At least one effect has rivals that this data cannot tell apart.
    Ambiguous,
    /// Structure is left that no named effect explains.
    Unattributed,
}

impl Verdict {
    /// Its word in the report.
    pub fn as_str(self) -> &'static str {
        match self {
            Verdict::None => "none",
            Verdict::Inconclusive => "inconclusive",
            Verdict::Attributed => "attributed",
            Verdict::Ambiguous => "ambiguous",
            Verdict::Unattributed => "unattributed",
        }
    }

    /// The verdict of a selection.
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

    /// The verdict beside the trials of effects of one's own: what is confirmed is not excluded.
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
