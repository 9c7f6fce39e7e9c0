//! What can be wrong with a log.

use std::fmt;

use pinswitch_friction::Direction;
use serde::Serialize;

/// Something that is wrong with a log.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "what")]
pub enum Finding {
    /// Samples that stand out from their plateau.
    Spikes {
        /// How many.
        samples: usize,
    },
    /// Samples that are missing between time stamps.
    LostSamples {
        /// How many.
        samples: usize,
    },
    /// Lines of the file that are no samples.
    UnusableLines {
        /// How many.
        lines: usize,
    },
    /// A channel that stands at its end.
    Clipped {
        /// The force at which it stands, in newtons.
        #[serde(rename = "force_N")]
        force_n: f64,
        /// Share of the samples.
        share: f64,
    },
    /// A move of another length than the others in its direction.
    OddSpeed {
        /// Direction of the move.
        direction: Direction,
        /// The plateau after it.
        repetition: u32,
        /// Its length over the median length.
        ratio: f64,
    },
    /// A pause that is too long: a repetition is missing.
    MissingRepetition {
        /// Direction of the move before it.
        direction: Direction,
        /// The repetition after which one is missing.
        after: u32,
    },
    /// A rest too short or too broken to be read.
    UnreadableRest {
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
        }
    }
}
