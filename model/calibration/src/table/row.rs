//! One repetition: the force the load cell settles to after the actuator stops (`model/doc/file-formats.md`).

use pinswitch_friction::{Direction, Substrate};
use serde::{Deserialize, Serialize};

/// Order of the loads in the sweep that a series belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sweep {
    /// Loads ascending.
    Up,
    /// Loads descending.
    Down,
}

impl Sweep {
    /// The word of the `sweep` column.
    pub fn as_str(self) -> &'static str {
        match self {
            Sweep::Up => "up",
            Sweep::Down => "down",
        }
    }
}

/// One row of a plateau table.
#[derive(Clone, Debug, PartialEq)]
pub struct PlateauRow {
    /// Name of the rows recorded in one go.
    pub series: String,
    /// What the tendon lies on; `None` for `plain`, one contact of one unknown material and wrap.
    pub substrate: Option<Substrate>,
    /// Occupied grooves, numbered from 1, ascending; empty without pins.
    pub pins: Vec<usize>,
    /// Order of the loads.
    pub sweep: Sweep,
    /// The weight as declared, in grams.
    pub load_mass_g: f64,
    /// The loading force as declared, in newtons.
    pub load_n: f64,
    /// Actuator speed in percent of full speed.
    pub speed_pct: f64,
    /// Pause after the move and before the reading, in seconds.
    pub dwell_s: f64,
    /// Load released or pulled.
    pub direction: Direction,
    /// 1, 2, ... inside a series and direction.
    pub repetition: u32,
    /// Actuator position at the plateau in millimetres.
    pub position_mm: f64,
    /// Seconds since the session began.
    pub time_s: f64,
    /// The reading in newtons.
    pub force_n: f64,
    /// Wrap angle of the tendon in degrees; without meaning for `plain`.
    pub wrap_angle_deg: f64,
    /// Session, mount, operator and specimen, where the table names them.
    pub labels: Labels,
}

/// What a row was recorded in, with and by: each is a grouping with a scatter of its own. Empty where not told.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Labels {
    /// A day; the time restarts in each.
    pub session: String,
    /// A number that grows each time the switch is taken off and put back.
    pub mount: String,
    /// Who measured.
    pub operator: String,
    /// Which printed part or tendon.
    pub specimen: String,
}

impl Labels {
    /// All of them, in the order of their columns.
    pub(super) fn all(&self) -> [&str; 4] {
        [&self.session, &self.mount, &self.operator, &self.specimen]
    }
}
