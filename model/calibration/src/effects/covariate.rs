//! What varies in a table, and so where the trace of an effect can lie.

use serde::{Deserialize, Serialize};

/// Where the trace of an effect lies (`model/doc/effect-catalogue.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Covariate {
    /// The declared load.
    Load,
    /// Eccentric or concentric.
    Direction,
    /// Repetition inside a series and direction.
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
    /// All of them, in the order of the effect catalogue.
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

    /// The word in reports and model files.
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
