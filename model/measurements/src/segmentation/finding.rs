//! Defects of a log.

use std::fmt;

use pinswitch_friction::Direction;
use schemars::JsonSchema;
use serde::Serialize;

/// A defect of a log.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", tag = "what")]
pub enum Finding {
    /// Samples far from the median of their plateau.
    Spikes {
        /// Number of samples.
        samples: usize,
    },
    /// Samples that are missing between time stamps.
    LostSamples {
        /// Number of samples.
        samples: usize,
    },
    /// Lines of the file that are not samples.
    UnusableLines {
        /// Number of lines.
        lines: usize,
    },
    /// A force at the end of the channel's range.
    Clipped {
        /// Force at the end of the range, in newtons.
        #[serde(rename = "force_N")]
        force_n: f64,
        /// Share of the samples.
        share: f64,
    },
    /// A move whose length differs from that of the others in its direction.
    OddSpeed {
        /// Direction of the move.
        direction: Direction,
        /// Repetition that follows the move.
        repetition: u32,
        /// Length over the median length.
        ratio: f64,
    },
    /// A pause that is so long that a repetition is missing.
    MissingRepetition {
        /// Direction of the previous move.
        direction: Direction,
        /// Repetition before the missing one.
        after: u32,
    },
    /// A rest that is too short, or has too few samples, to be read.
    UnreadableRest {
        /// Seconds since the log began.
        time_s: f64,
    },
    /// A move that is left out, since its direction is uncertain.
    UncertainDirection {
        /// Seconds since the log began.
        time_s: f64,
        /// Probability of the likelier direction.
        probability: f64,
        /// Witnesses and their directions.
        reason: String,
    },
    /// A declared value that the log contradicts.
    Departure {
        /// Name of the declared field.
        field: &'static str,
        /// Declared value.
        declared: f64,
        /// Measured value.
        measured: f64,
    },
    /// Moves that leave the force unchanged, and are where the declared schedule has them.
    ScheduledMoves {
        /// Number of moves.
        moves: usize,
    },
    /// Cycles so fast that the force still settles after a reversal where it is read: the readings
    /// are between the branches.
    UnsettledCycles {
        /// Bend of the difference of the branches within the reading, over the difference.
        share: f64,
    },
    /// Rests that only the force shows, where the actuator may as well move at a steady force:
    /// their dwell is that of the steady force.
    DwellByForce,
    /// A position that decreases when the load is released.
    ReversedPosition,
    /// Plateaus without load, which are left out.
    Unloaded {
        /// Number of plateaus.
        plateaus: usize,
    },
    /// Times in another unit than declared.
    TimeUnit {
        /// Declared length of a count in seconds.
        declared_s: f64,
        /// Measured length of a count in seconds.
        measured_s: f64,
    },
    /// A clock whose steps are longer than the sampling period.
    CoarseClock {
        /// Step of the clock in seconds.
        step_s: f64,
    },
    /// A counter that restarts at the end of its range.
    ClockRollOver {
        /// Seconds since the log began.
        time_s: f64,
        /// Range of the counter in seconds.
        modulus_s: f64,
    },
    /// A clock that restarts inside the log; the pause is unknown.
    ClockReset {
        /// Seconds since the log began.
        time_s: f64,
    },
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Spikes { samples: 1 } => write!(f, "1 spike"),
            Self::Spikes { samples } => write!(f, "{samples} spikes"),
            Self::LostSamples { samples } => write!(f, "{samples} lost samples"),
            Self::UnusableLines { lines } => write!(f, "{lines} unusable lines"),
            Self::Clipped { force_n, share } => {
                write!(f, "clipped at {force_n:.2} N in {:.1} % of the samples", 100.0 * share)
            }
            Self::OddSpeed { direction, repetition, ratio } => {
                let word = direction.as_str();
                write!(f, "{word} {repetition}: the move takes {ratio:.2} times the usual time")
            }
            Self::MissingRepetition { direction, after } => {
                write!(f, "{} repetition missing after {after}", direction.as_str())
            }
            Self::UnreadableRest { time_s } => write!(f, "rest at {time_s:.1} s unreadable"),
            Self::UncertainDirection { time_s, probability, reason } => {
                write!(f, "move at {time_s:.1} s left out: direction {probability:.2} certain ({reason})")
            }
            Self::Departure { field, declared, measured } => {
                write!(f, "{field} = {declared} declared, {measured:.4} measured")
            }
            Self::ScheduledMoves { moves } => {
                write!(f, "{moves} moves placed by rig.on_s and rig.dwell_s: the force does not show them")
            }
            Self::UnsettledCycles { share } => write!(
                f,
                "the force still settles in the middle of the strokes (bend {share:.2}), use slower cycles"
            ),
            Self::DwellByForce => {
                write!(f, "dwell_s is the time of steady force, which does not show if the actuator rests")
            }
            Self::ReversedPosition => write!(f, "the position decreases when the load is released"),
            Self::Unloaded { plateaus } => write!(f, "{plateaus} plateaus without load left out"),
            Self::TimeUnit { declared_s, measured_s } => {
                write!(f, "time in units of {measured_s} s, {declared_s} s declared")
            }
            Self::CoarseClock { step_s } => write!(f, "clock in steps of {step_s} s"),
            Self::ClockRollOver { time_s, modulus_s } => {
                write!(f, "counter of {modulus_s} s rolls over at {time_s:.1} s")
            }
            Self::ClockReset { time_s } => write!(f, "clock reset at {time_s:.1} s, pause unknown"),
        }
    }
}
