//! Defects of a log.

use std::fmt;

use pinswitch_friction::Direction;
use serde::Serialize;

/// A defect of a log.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
