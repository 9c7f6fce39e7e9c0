//! `unattributed`: structure along one covariate that no effect explains, as an empirical term.

use pinswitch_friction::published;
use serde::{Deserialize, Serialize};

use super::{ContactState, Covariate};
use crate::table::{Condition, Frame, Point, interpolate};

/// Id of structure that no effect explains.
pub const UNATTRIBUTED: &str = "unattributed";

/// Quantity that a structure changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// Adds newtons to the reading, with the same sign in both directions.
    Reading,
    /// Scales the reading, as a change of the load cell's gain does.
    Gain,
    /// Adds newtons of friction, with opposite signs in the two directions.
    Drag,
    /// Scales the friction exponent.
    Friction,
    /// Scales the friction exponent of the pins.
    Pins,
    /// Scales the friction exponent of the silicone.
    Silicone,
    /// Scales the friction exponent, with opposite signs in the two directions.
    #[serde(rename = "friction_by_direction")]
    FrictionByDirection,
    /// Scales the half load of every device.
    #[serde(rename = "half_load")]
    HalfLoad,
}

impl Channel {
    /// Returns whether it is a constant of the switch: friction that is the same in both directions, or the half load.
    pub(crate) fn is_of_switch(self) -> bool {
        matches!(self, Self::Friction | Self::Pins | Self::Silicone | Self::HalfLoad)
    }
}

/// Covariate of a tabulated shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Abscissa {
    /// Time over session, 0..1; a later session has the mean of the values.
    Time,
    /// Position over stroke, 0..1.
    Position,
    /// Logarithm of the repetition.
    LogRepetition,
    /// Readings so far in the series.
    SeriesReadings,
    /// +1 for odd repetitions, -1 for even ones.
    Alternation,
    /// Repetition, negative in the eccentric direction.
    DirectedRepetition,
    /// Load in newtons.
    Load,
    /// `ln(v/v0)`.
    LogSpeed,
    /// `ln(dwell / 3 s)`.
    LogDwell,
    /// 1 when the loads descend, else 0.
    Descending,
    /// Index of the condition.
    Condition,
    /// Number of the operator, from 1.
    Operator,
    /// Index of the session among those of the frame; any other one has the last value.
    Session,
    /// Index of the specimen among those of the frame; -1 for an unknown one.
    Specimen,
}

impl Abscissa {
    /// Returns its value at a point.
    pub fn value(self, p: &Point) -> f64 {
        match self {
            Self::Time => p.time,
            Self::Position => p.position,
            Self::LogRepetition => libm::log(p.repetition),
            Self::SeriesReadings => p.through,
            Self::Alternation => {
                if p.repetition % 2.0 > 0.5 {
                    1.0
                } else {
                    -1.0
                }
            }
            Self::DirectedRepetition => p.sign * p.repetition,
            Self::Load => p.load_n,
            Self::LogSpeed => p.log_speed,
            Self::LogDwell => p.log_dwell,
            Self::Descending => p.descending,
            Self::Condition => p.condition as f64,
            Self::Operator => p.operator,
            Self::Session => p.session_group.map_or(f64::INFINITY, |group| group as f64),
            Self::Specimen => p.specimen_group.map_or(-1.0, |group| group as f64),
        }
    }
}

/// A dimensionless function of one covariate, of order one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "shape")]
pub enum Shape {
    /// 0 before a time, 1 after it.
    TimeStep {
        /// Time, as a share of the session, 0..1.
        at: f64,
    },
    /// 1 between two times.
    TimeWindow {
        /// Start, as a share of the session.
        from: f64,
        /// End, as a share of the session.
        to: f64,
    },
    /// A power of the time, as a share of the session.
    TimePower {
        /// Exponent.
        power: i32,
    },
    /// Sine over the session.
    TimeWave {
        /// Cycles over the session.
        cycles: f64,
        /// Phase in quarter periods: 0 sine, 1 cosine.
        quarter: u8,
    },
    /// Sine along the stroke.
    PositionWave {
        /// Cycles over the stroke.
        cycles: f64,
        /// Phase in quarter periods: 0 sine, 1 cosine.
        quarter: u8,
    },
    /// A Gaussian bump along the stroke, `exp(-((s - at)/width)^2 / 2)`.
    PositionBump {
        /// Centre, as a share of the stroke.
        at: f64,
        /// Width, as a share of the stroke.
        width: f64,
    },
    /// A power of the position relative to the middle of the stroke.
    PositionPower {
        /// Exponent.
        power: i32,
    },
    /// 1 at one speed.
    SpeedLevel {
        /// `ln(v/v0)`.
        log_speed: f64,
        /// Half width in `ln v`.
        half_width: f64,
    },
    /// A Gaussian bump in the logarithm of speed.
    SpeedBump {
        /// Centre, `ln(v/v0)`.
        log_speed: f64,
        /// Width in `ln v`.
        width: f64,
    },
    /// A power of `ln(v/v0)`.
    SpeedPower {
        /// Exponent.
        power: i32,
    },
    /// 1 at one dwell.
    DwellLevel {
        /// `ln(dwell / 3 s)`.
        log_dwell: f64,
    },
    /// 1 at one load.
    LoadLevel {
        /// Load in newtons.
        load_n: f64,
        /// Half width in newtons.
        half_width: f64,
    },
    /// A power of `F/F0`.
    LoadPower {
        /// Exponent.
        power: i32,
        /// Highest load in newtons.
        unit_n: f64,
    },
    /// A power of the load in one condition.
    ConditionLoad {
        /// Index of the condition.
        condition: usize,
        /// Exponent.
        power: i32,
        /// Highest load in newtons.
        unit_n: f64,
    },
    /// 1 for the listed conditions.
    ConditionIs {
        /// Indices of the conditions.
        conditions: Vec<usize>,
    },
    /// 1 for one operator, numbered from 1.
    OperatorIs {
        /// Number of the operator.
        operator: usize,
    },
    /// `exp(-(r - 1)/r0)` of the repetition `r`.
    Repetition {
        /// `r0`.
        r0: f64,
    },
    /// Remaining influence of the previous load: `(F_before - F)/F0 exp(-r/r0)` after `r`
    /// repetitions of the series.
    Memory {
        /// Number of repetitions after which a share `1/e` remains.
        r0: f64,
        /// Highest load in newtons.
        unit_n: f64,
    },
    /// 1 when the loads descend.
    Descending,
    /// A constant.
    Constant,
    /// A table of values, interpolated linearly between its nodes and constant outside.
    Table {
        /// Covariate of the nodes.
        over: Abscissa,
        /// Nodes, ascending.
        at: Vec<f64>,
        /// Values at the nodes.
        value: Vec<f64>,
        /// Whether the nodes are the levels of a factor: the value is zero elsewhere.
        is_factor: bool,
    },
    /// `d` times the load.
    DirectionLoad {
        /// Exponent of the load.
        power: i32,
        /// Highest load in newtons.
        unit_n: f64,
    },
}

impl Shape {
    /// Returns its value at a point.
    pub fn value(&self, p: &Point) -> f64 {
        let flag = |b: bool| f64::from(u8::from(b));
        let wave = |share: f64, cycles: f64, quarter: u8| {
            libm::sin(
                std::f64::consts::TAU * cycles * share + f64::from(quarter) * std::f64::consts::FRAC_PI_2,
            )
        };
        match self {
            Shape::TimeStep { at } => flag(p.time >= *at),
            Shape::TimeWindow { from, to } => flag(p.time >= *from && p.time < *to),
            Shape::TimePower { power } => p.time.powi(*power),
            Shape::TimeWave { cycles, quarter } => wave(p.time, *cycles, *quarter),
            Shape::PositionWave { cycles, quarter } => wave(p.position, *cycles, *quarter),
            Shape::PositionBump { at, width } => libm::exp(-0.5 * ((p.position - at) / width).powi(2)),
            Shape::PositionPower { power } => (2.0 * p.position - 1.0).powi(*power),
            Shape::SpeedLevel { log_speed, half_width } => {
                flag((p.log_speed - log_speed).abs() <= *half_width)
            }
            Shape::SpeedBump { log_speed, width } => {
                libm::exp(-0.5 * ((p.log_speed - log_speed) / width).powi(2))
            }
            Shape::SpeedPower { power } => p.log_speed.powi(*power),
            Shape::DwellLevel { log_dwell } => flag((p.log_dwell - log_dwell).abs() < 0.02),
            Shape::LoadLevel { load_n, half_width } => flag((p.load_n - load_n).abs() <= *half_width),
            Shape::LoadPower { power, unit_n } => (p.load_n / unit_n).powi(*power),
            Shape::ConditionLoad { condition, power, unit_n } => {
                flag(p.condition == *condition) * (p.load_n / unit_n).powi(*power)
            }
            Shape::ConditionIs { conditions } => flag(conditions.contains(&p.condition)),
            Shape::OperatorIs { operator } => flag(p.operator == *operator as f64),
            Shape::Repetition { r0 } => libm::exp(-(p.repetition - 1.0) / r0),
            Shape::Memory { r0, unit_n } => {
                (p.previous_load_n - p.load_n) / unit_n * libm::exp(-p.through / r0)
            }
            Shape::Descending => p.descending,
            Shape::DirectionLoad { power, unit_n } => p.sign * (p.load_n / unit_n).powi(*power),
            Shape::Constant => 1.0,
            Shape::Table { over: Abscissa::Time, value, .. } if p.is_new_session => {
                value.iter().sum::<f64>() / value.len().max(1) as f64
            }
            Shape::Table { over, at, value, is_factor } => {
                let x = over.value(p);
                if *over == Abscissa::Session && x.is_infinite() {
                    value.last().copied().unwrap_or(0.0)
                } else if *is_factor {
                    let level = at.iter().position(|node| (node - x).abs() < LEVEL_TOLERANCE);
                    level.and_then(|level| value.get(level)).copied().unwrap_or(0.0)
                } else {
                    interpolate(at, value, x)
                }
            }
        }
    }
}

/// Smallest factor of a half load, as in a fit. With a half load of zero, friction at no load is not a number.
const LEAST_HALF_LOAD: f64 = 0.1;

/// Distance of a value from a level of a factor up to which it has that level; loads are levels to a
/// hundredth of a newton.
const LEVEL_TOLERANCE: f64 = 0.006;

/// A shape of a channel, with its size as the only constant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Structure {
    /// Covariate of the shape.
    pub covariate: Covariate,
    /// Quantity that it changes.
    pub channel: Channel,
    /// Index of the only condition where it acts; every one if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub only_in: Option<usize>,
    /// Function of the covariate.
    #[serde(flatten)]
    pub form: Shape,
}

impl Structure {
    /// Returns the value of the shape at a point.
    pub fn value(&self, p: &Point) -> f64 {
        if self.only_in.is_some_and(|condition| condition != p.condition) { 0.0 } else { self.form.value(p) }
    }

    /// Changes the contact; `k` is the size.
    pub fn on_contact(&self, k: f64, point: &Point, state: &mut ContactState) {
        if self.is_of_reading() {
            return;
        }
        let value = k * self.value(point);
        let factor = (1.0 + value).max(0.0);
        match self.channel {
            Channel::Reading | Channel::Gain => {}
            Channel::Drag => state.drag_n += value,
            Channel::Friction => state.exponent_factor *= factor,
            Channel::FrictionByDirection => state.exponent_factor *= (1.0 + point.sign * value).max(0.0),
            Channel::Pins => {
                state.mu_pins *= factor;
                state.extra_exponent_pins *= factor;
            }
            Channel::Silicone => state.mu_silicone *= factor,
            Channel::HalfLoad => state.half_load_n *= factor.max(LEAST_HALF_LOAD),
        }
    }

    /// Changes the reading in newtons; `k` is the size.
    pub fn on_reading(&self, k: f64, point: &Point, reading_n: f64) -> f64 {
        match self.channel {
            Channel::Reading => reading_n + k * self.value(point),
            Channel::Gain => reading_n * (1.0 + k * self.value(point)),
            _ => reading_n,
        }
    }

    /// Returns whether it changes only the reading, and not the contact.
    pub fn is_of_reading(&self) -> bool {
        matches!(self.channel, Channel::Reading | Channel::Gain)
    }

    /// Returns whether it is a constant of the switch that differs between sessions or specimens.
    pub(crate) fn is_change(&self) -> bool {
        let is_of_group =
            matches!(self.form, Shape::Table { over: Abscissa::Session | Abscissa::Specimen, .. });
        is_of_group && self.channel.is_of_switch()
    }

    /// Returns the unit of its size.
    pub fn unit(&self) -> &'static str {
        match self.channel {
            Channel::Reading | Channel::Drag => "N",
            Channel::Gain
            | Channel::Friction
            | Channel::FrictionByDirection
            | Channel::Pins
            | Channel::Silicone
            | Channel::HalfLoad => "1",
        }
    }

    /// Describes the structure in words, in the units of the frame's session.
    pub fn describe(&self, frame: &Frame) -> String {
        let on = match self.channel {
            Channel::Reading => "the reading",
            Channel::Gain => "the gain of the load cell",
            Channel::Drag => "the friction force",
            Channel::Friction => "the friction exponent",
            Channel::FrictionByDirection => "the friction exponent, with opposite signs in the directions",
            Channel::Pins => "the friction of the pins",
            Channel::Silicone => "the friction of the silicone",
            Channel::HalfLoad => "the half load",
        };
        let name = |i: &usize| frame.conditions.get(*i).map_or_else(String::new, Condition::name);
        let stroke = frame.stroke_mm;
        let what = match &self.form {
            Shape::TimeStep { at } => format!("a step {:.0} s into the session", at * frame.session_s),
            Shape::TimeWindow { from, to } => {
                format!(
                    "a different level from {:.0} to {:.0} s",
                    from * frame.session_s,
                    to * frame.session_s
                )
            }
            Shape::TimePower { power } => format!("a drift with time to the power {power}"),
            Shape::TimeWave { cycles, .. } => format!("a wave of period {:.0} s", frame.session_s / cycles),
            Shape::PositionWave { cycles, .. } => {
                format!("a wave of period {:.1} mm along the stroke", stroke / cycles)
            }
            Shape::PositionBump { at, width } => {
                format!("a bump at {:.0} mm of the stroke, {:.0} mm wide", at * stroke, 2.0 * width * stroke)
            }
            Shape::PositionPower { power } => format!("a trend along the stroke to the power {power}"),
            Shape::SpeedLevel { log_speed, .. } => {
                format!(
                    "a different level at a speed of {:.0} %",
                    frame.reference_speed_pct * libm::exp(*log_speed)
                )
            }
            Shape::SpeedBump { log_speed, width } => format!(
                "a resonance at a speed of {:.0} %, {:.0} % wide",
                frame.reference_speed_pct * libm::exp(*log_speed),
                200.0 * width
            ),
            Shape::SpeedPower { power } => format!("a trend with ln(speed) to the power {power}"),
            Shape::DwellLevel { log_dwell } => {
                format!("a different level at a dwell of {:.2} s", published::DWELL_S * libm::exp(*log_dwell))
            }
            Shape::LoadLevel { load_n, .. } => format!("a different level at a load of {load_n:.1} N"),
            Shape::LoadPower { power, .. } => format!("a trend with load to the power {power}"),
            Shape::ConditionLoad { condition, power, .. } => {
                format!("a trend with load to the power {power} on {}", name(condition))
            }
            Shape::ConditionIs { conditions } => {
                format!(
                    "a different level on {}",
                    conditions.iter().map(name).collect::<Vec<_>>().join(" and ")
                )
            }
            Shape::OperatorIs { operator } => {
                let name = operator.checked_sub(1).and_then(|i| frame.operators.get(i));
                format!("a different level of operator {}", name.map_or("?", String::as_str))
            }
            Shape::Repetition { r0 } => format!("a transient over {r0} repetitions"),
            Shape::Memory { r0, .. } if *r0 > 1e3 => "a lasting memory of the previous load".to_owned(),
            Shape::Memory { r0, .. } => {
                format!("a memory of the previous load that decays over {r0} repetitions")
            }
            Shape::Descending => "a different level for descending loads".to_owned(),
            Shape::Constant => "a constant".to_owned(),
            Shape::Table { over, value, .. } => {
                // The value after those of the sessions is what a new one is expected to have.
                let measured = if *over == Abscissa::Session { frame.sessions.len() } else { value.len() };
                table_words(*over, &value[..measured.min(value.len())], self.unit())
            }
            Shape::DirectionLoad { power, .. } => {
                format!("a difference between the directions with load to the power {power}")
            }
        };
        let only_in = self.only_in.map_or_else(String::new, |condition| format!(" on {}", name(&condition)));
        format!("{what}, in {on}{only_in}")
    }
}

/// Describes a table by its covariate and range.
fn table_words(over: Abscissa, value: &[f64], unit: &str) -> String {
    let low = value.iter().copied().fold(f64::INFINITY, f64::min);
    let high = value.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (kind, name) = match over {
        Abscissa::Time => ("a curve", "the session"),
        Abscissa::Position => ("a curve", "the position"),
        Abscissa::LogRepetition => ("a curve", "the repetition"),
        Abscissa::SeriesReadings => ("a curve", "the readings of a series"),
        Abscissa::Alternation => ("an alternation", "odd and even repetitions"),
        Abscissa::DirectedRepetition => ("levels", "the repetitions of each direction"),
        Abscissa::Load => ("a curve", "the load"),
        Abscissa::LogSpeed => ("a curve", "the speed"),
        Abscissa::LogDwell => ("a curve", "the dwell"),
        Abscissa::Descending => ("a difference", "ascending and descending loads"),
        Abscissa::Condition => ("levels", "the conditions"),
        Abscissa::Operator => ("levels", "the operators"),
        Abscissa::Session => ("levels", "the sessions"),
        Abscissa::Specimen => ("levels", "the specimens"),
    };
    let unit = if unit == "1" { "" } else { " N" };
    format!("{kind} of {low:+.3} to {high:+.3}{unit} over {name} ({} values)", value.len())
}
