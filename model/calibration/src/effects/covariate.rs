//! Covariates of a table.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::table::Optional;

/// Covariate along which an effect shows (`model/doc/effect-catalogue.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Covariate {
    /// The declared load.
    Load,
    /// Eccentric or concentric.
    Direction,
    /// Repetition in a series and direction.
    Repetition,
    /// Position along the stroke.
    Position,
    /// Speed of the actuator.
    Speed,
    /// Pause before the reading.
    Dwell,
    /// Ascending or descending loads.
    Sweep,
    /// Time since the session began.
    Time,
    /// Substrate and pins.
    Condition,
}

impl Covariate {
    /// All covariates, in the order of the effect catalogue.
    pub const ALL: [Covariate; 9] = [
        Covariate::Load,
        Covariate::Direction,
        Covariate::Repetition,
        Covariate::Position,
        Covariate::Speed,
        Covariate::Dwell,
        Covariate::Sweep,
        Covariate::Time,
        Covariate::Condition,
    ];

    /// Returns the column without which the covariate is not known; `None` for what every table has.
    pub(crate) fn column(self) -> Option<Optional> {
        match self {
            Covariate::Repetition => Some(Optional::Repetition),
            Covariate::Position => Some(Optional::Position),
            Covariate::Speed => Some(Optional::Speed),
            Covariate::Dwell => Some(Optional::Dwell),
            Covariate::Sweep => Some(Optional::Sweep),
            Covariate::Time => Some(Optional::Time),
            Covariate::Load | Covariate::Direction | Covariate::Condition => None,
        }
    }

    /// Returns the word used in reports and model files.
    pub fn as_str(self) -> &'static str {
        match self {
            Covariate::Load => "load",
            Covariate::Direction => "direction",
            Covariate::Repetition => "repetition",
            Covariate::Position => "position",
            Covariate::Speed => "speed",
            Covariate::Dwell => "dwell",
            Covariate::Sweep => "sweep",
            Covariate::Time => "time",
            Covariate::Condition => "condition",
        }
    }
}
