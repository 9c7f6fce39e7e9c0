//! What a formula may read of one row.

use crate::table::{Condition, Point};
use pinswitch_friction::Substrate;

/// One row as a formula sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment<'a> {
    /// The row.
    pub(super) point: &'a Point,
    /// Its contact.
    pub(super) condition: &'a Condition,
    /// Load in newtons, after what changes it.
    pub(super) load_n: f64,
    /// Tension, or reading, in newtons where it is known.
    pub(super) tension_n: f64,
}

/// A variable: one line of [`VARIABLES`].
#[derive(Debug)]
pub(super) struct Variable {
    /// Its name in formulas.
    pub(super) name: &'static str,
    /// Its unit.
    pub(super) unit: &'static str,
    /// Whether it may change from row to row of one setting.
    pub(super) moves: bool,
    /// What it is.
    pub(super) meaning: &'static str,
    /// Its value.
    pub(super) of: fn(&Moment<'_>) -> f64,
}

impl PartialEq for Variable {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

const fn fixed(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    of: fn(&Moment<'_>) -> f64,
) -> Variable {
    Variable { name, unit, moves: false, meaning, of }
}

const fn moving(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    of: fn(&Moment<'_>) -> f64,
) -> Variable {
    Variable { name, unit, moves: true, meaning, of }
}

/// The one variable that is known only behind the contact.
pub(super) const TENSION: &str = "tension_n";

/// All variables.
pub(super) static VARIABLES: [Variable; 23] = [
    fixed("load_n", "N", "load, with what effects on the load have changed", |m| m.load_n),
    fixed(TENSION, "N", "tension or reading so far; only where it acts on tension or reading", |m| {
        m.tension_n
    }),
    fixed("direction", "1", "-1 eccentric, +1 concentric", |m| m.point.sign),
    moving("repetition", "1", "1, 2, ... inside a series and direction", |m| m.point.repetition),
    moving("position_mm", "mm", "position of the actuator", |m| m.point.position_mm),
    moving("stroke", "1", "position as a share of the stroke, 0 to 1", |m| m.point.position),
    fixed("speed_pct", "%", "speed of the actuator; 0 counts as mean_speed_pct", |m| m.point.speed_pct),
    fixed("mean_speed_pct", "%", "geometric mean of all speeds of the table", |m| {
        m.point.speed_pct * libm::exp(-m.point.log_speed)
    }),
    fixed("dwell_s", "s", "pause before the reading; 0 counts as 3 s", |m| m.point.dwell_s),
    moving("time_s", "s", "time since the session began", |m| m.point.time_s),
    moving("time", "1", "time as a share of the session, 0 to 1", |m| m.point.time),
    moving("travel", "1", "share of all repetitions of the session made so far, 0 to 1", |m| m.point.travel),
    fixed("descending", "1", "1 where the loads descend, else 0", |m| m.point.descending),
    fixed("pin_count", "1", "pins that touch the tendon", |m| m.condition.pins.len() as f64),
    fixed("turn_per_pin_rad", "rad", "mean turn of the tendon at one pin; 0 without pins", |m| {
        m.condition.turn_rad
    }),
    fixed(
        "turn_unevenness",
        "1",
        "1 where the tendon turns equally at every pin, more where pins stand in groups; 0 without",
        |m| m.condition.turn_unevenness(),
    ),
    fixed("is_silicone", "1", "1 on silicone, also on a device, else 0", |m| {
        f64::from(u8::from(m.condition.substrate == Some(Substrate::Silicone)))
    }),
    fixed("is_device", "1", "1 where pins stand in silicone, else 0", |m| {
        f64::from(u8::from(m.condition.device.is_some()))
    }),
    moving("previous_load_n", "N", "load of the series before in the session; 0 for the first", |m| {
        if m.point.begins_session { 0.0 } else { m.point.previous_load_n }
    }),
    moving(
        "repetitions_so_far",
        "1",
        "repetitions made so far in the series, both directions counted",
        |m| m.point.through,
    ),
    moving("session", "1", "1, 2, ... in the order of the table", |m| m.point.session),
    moving("mount", "1", "the number of the mount; 1 where the table names none", |m| m.point.mount),
    moving("operator", "1", "1, 2, ... in the order of their names; 1 where there is but one", |m| {
        m.point.operator
    }),
];

/// The variable of a name.
pub(super) fn variable(name: &str) -> Option<&'static Variable> {
    VARIABLES.iter().find(|v| v.name == name)
}
