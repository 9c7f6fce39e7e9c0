//! The segmentation of one log: its plateaus, moves and findings.

use pinswitch_friction::Direction;
use schemars::JsonSchema;
use serde::Serialize;

use super::direction::Evidence;
use super::finding::Finding;
use super::interval::Move;
use super::moves::Source;

/// Kind of the motion in a log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Moves with rests between them.
    #[default]
    Rests,
    /// Continuous cycles.
    Cycles,
}

impl Motion {
    /// Returns the word of reports.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Rests => "rests",
            Self::Cycles => "cycles",
        }
    }
}

/// One plateau: the steady reading after a move, or in the middle of a half-cycle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Plateau {
    /// Direction of the move.
    pub direction: Direction,
    /// Number of the repetition in its direction, from 1.
    pub repetition: u32,
    /// Settled force in newtons.
    #[serde(rename = "force_N")]
    pub force_n: f64,
    /// Actuator position in millimetres, if the log has it.
    pub position_mm: Option<f64>,
    /// Measured load in newtons, if the log has it.
    #[serde(rename = "load_N")]
    pub load_n: Option<f64>,
    /// Rest before the end of the reading, in seconds.
    pub dwell_s: f64,
    /// End of the reading in seconds since the log began.
    pub time_s: f64,
    /// Number of averaged samples, without spikes.
    pub samples: usize,
}

/// A move for a figure of the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveMark {
    /// Start in seconds since the log began.
    pub from_s: f64,
    /// End in seconds since the log began.
    pub to_s: f64,
    /// Direction; `None` for a move that is left out.
    pub direction: Option<Direction>,
}

/// Plateaus and findings of one log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Segmented {
    /// Plateaus in the order of time.
    pub plateaus: Vec<Plateau>,
    /// Defects of the log.
    pub findings: Vec<Finding>,
    /// Kind of the motion.
    pub motion: Motion,
    /// Column that shows the moves.
    pub source: Source,
    /// Moves in the order of time.
    pub moves: Vec<MoveMark>,
    /// Median speed of the moves in millimetres per second, if the log has a position.
    pub speed_mm_s: Option<f64>,
}

/// A move with its reading, before its direction is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    pub(super) span: Move,
    pub(super) evidence: Evidence,
    pub(super) position_mm: Option<f64>,
    pub(super) load_n: Option<f64>,
    pub(super) dwell_s: f64,
    pub(super) time_s: f64,
    pub(super) samples: usize,
}
