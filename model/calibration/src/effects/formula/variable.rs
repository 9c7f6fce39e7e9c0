//! Variables of a formula.

use crate::table::{Condition, Point};
use pinswitch_friction::Substrate;

/// Values of one row for a formula.
#[derive(Clone, Copy, Debug)]
pub(in crate::effects) struct Moment<'a> {
    /// The row.
    pub(in crate::effects) point: &'a Point,
    /// Condition of the row.
    pub(in crate::effects) condition: &'a Condition,
    /// Load in newtons, after effects on the load.
    pub(in crate::effects) load_n: f64,
    /// Tension or reading in newtons, where it is known.
    pub(in crate::effects) tension_n: f64,
}

/// A variable: one line of [`VARIABLES`].
#[derive(Debug)]
pub(in crate::effects) struct Variable {
    /// Name in formulas.
    pub(in crate::effects) name: &'static str,
    /// Unit.
    pub(in crate::effects) unit: &'static str,
    /// Whether it may vary between the rows of one setting.
    pub(in crate::effects) moves: bool,
    /// Description.
    pub(in crate::effects) meaning: &'static str,
    /// Returns the value in a row.
    pub(in crate::effects) of: fn(&Moment<'_>) -> f64,
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

/// The variable that is known only after the contact.
pub(in crate::effects) const TENSION: &str = "tension_n";

/// All variables.
pub(in crate::effects) static VARIABLES: [Variable; 23] = [
    fixed("load_n", "N", "load, including effects on the load", |m| m.load_n),
    fixed(TENSION, "N", "tension or reading before the effect; only for acts_on tension or reading", |m| {
        m.tension_n
    }),
    fixed("direction", "1", "-1 eccentric, +1 concentric", |m| m.point.sign),
    moving("repetition", "1", "1, 2, ... in each series and direction", |m| m.point.repetition),
    moving("position_mm", "mm", "position of the actuator", |m| m.point.position_mm),
    moving("stroke", "1", "position as a share of the stroke, 0 to 1", |m| m.point.position),
    fixed("speed_pct", "%", "speed of the actuator; 0 counts as mean_speed_pct", |m| m.point.speed_pct),
    fixed("mean_speed_pct", "%", "geometric mean of all speeds in the table", |m| {
        m.point.speed_pct * libm::exp(-m.point.log_speed)
    }),
    fixed("dwell_s", "s", "pause before the reading; 0 counts as 3 s", |m| m.point.dwell_s),
    moving("time_s", "s", "time since the session began", |m| m.point.time_s),
    moving("time", "1", "time as a share of the session, 0 to 1", |m| m.point.time),
    moving("travel", "1", "share of the session's repetitions made so far, 0 to 1", |m| m.point.travel),
    fixed("descending", "1", "1 where the loads descend, else 0", |m| m.point.descending),
    fixed("pin_count", "1", "pins that touch the tendon", |m| m.condition.pins.len() as f64),
    fixed("turn_per_pin_rad", "rad", "mean deflection angle of the tendon at a pin; 0 without pins", |m| {
        m.condition.turn_rad
    }),
    fixed(
        "turn_unevenness",
        "1",
        "1 if the tendon is deflected equally at every pin, more if the pins are in groups; 0 without pins",
        |m| m.condition.turn_unevenness(),
    ),
    fixed("is_silicone", "1", "1 on silicone, with or without pins, else 0", |m| {
        f64::from(u8::from(m.condition.substrate == Some(Substrate::Silicone)))
    }),
    fixed("is_device", "1", "1 on silicone with pins, else 0", |m| {
        f64::from(u8::from(m.condition.device.is_some()))
    }),
    moving("previous_load_n", "N", "load of the previous series of the session; 0 for the first", |m| {
        if m.point.begins_session { 0.0 } else { m.point.previous_load_n }
    }),
    moving("repetitions_so_far", "1", "repetitions made so far in the series, in both directions", |m| {
        m.point.through
    }),
    moving("session", "1", "1, 2, ... in the order of the table", |m| m.point.session),
    moving("mount", "1", "number of the mount; 1 without mounts in the table", |m| m.point.mount),
    moving("operator", "1", "1, 2, ... in the order of the operators' names; 1 if there is only one", |m| {
        m.point.operator
    }),
];

/// Returns the variable of a name.
pub(in crate::effects) fn variable(name: &str) -> Option<&'static Variable> {
    VARIABLES.iter().find(|v| v.name == name)
}
