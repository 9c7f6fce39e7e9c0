//! Rows of a plateau table: the force at which the load cell settles after the actuator stops
//! (`model/doc/file-formats.md`).

use pinswitch_friction::{Direction, Substrate};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::unknown::Unknown;

/// Order of the loads in the sweep of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Sweep {
    /// Loads ascending.
    Up,
    /// Loads descending.
    Down,
}

impl Sweep {
    /// Returns the word of the `sweep` column.
    pub fn as_str(self) -> &'static str {
        match self {
            Sweep::Up => "up",
            Sweep::Down => "down",
        }
    }
}

/// One row of a plateau table: one repetition.
#[derive(Clone, Debug, PartialEq)]
pub struct PlateauRow {
    /// Name of the series.
    pub series: String,
    /// What the tendon touches; `None` for `plain`, a contact of unknown material and wrap.
    pub substrate: Option<Substrate>,
    /// Occupied grooves, numbered from 1, ascending; empty without pins.
    pub pins: Vec<usize>,
    /// Order of the loads.
    pub sweep: Sweep,
    /// Declared mass of the weight in grams.
    pub load_mass_g: f64,
    /// Declared load in newtons.
    pub load_n: f64,
    /// Actuator speed in percent of full speed.
    pub speed_pct: f64,
    /// Pause after the move and before the reading, in seconds.
    pub dwell_s: f64,
    /// Direction of the move before the reading.
    pub direction: Direction,
    /// Number of the repetition in its series and direction, from 1.
    pub repetition: u32,
    /// Actuator position at the plateau in millimetres.
    pub position_mm: f64,
    /// Seconds since the session began.
    pub time_s: f64,
    /// Reading of the load cell in newtons.
    pub force_n: f64,
    /// Wrap angle of the tendon in degrees; meaningless for `plain`.
    pub wrap_angle_deg: f64,
    /// Session, mount, operator and specimen.
    pub labels: Labels,
    /// Quantities that the table lacks in this row; their fields have neutral values.
    pub unknown: Unknown,
}

/// Labels that group rows for random effects; empty where the table has none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Labels {
    /// Session, such as a day; time restarts in each.
    pub session: String,
    /// Number that increases each time the switch is removed and mounted again.
    pub mount: String,
    /// Person who measured.
    pub operator: String,
    /// Printed part or tendon.
    pub specimen: String,
}

impl Labels {
    /// Returns all labels, in the order of their columns.
    pub(super) fn all(&self) -> [&str; 4] {
        [&self.session, &self.mount, &self.operator, &self.specimen]
    }
}
