//! Segmentation of raw logs into one row per repetition (`model/doc/logs.md`).
//!
//! Imports run downwards: `run` uses `plateaus`, which uses `defects`, `moves`, `cycles` and `direction`,
//! which use `force_moves`, `interval`, `log`, `change_points`, `steady_force` and `two_levels`.

mod change_points;
mod clock;
mod cycles;
mod defects;
mod direction;
mod finding;
mod force_moves;
mod interval;
mod log;
mod moves;
mod plateaus;
mod run;
mod run_plan;
mod segmented;
mod steady_force;
mod steady_moves;
mod two_levels;

pub use direction::Protocol;
pub use finding::Finding;
pub use log::{DeclaredLoad, Log, Part};
pub use moves::Source;
pub use plateaus::segment;
pub use run::{RunSegmentation, SegmentationReport, SegmentedRun, SegmentedSeries, segment_run};
pub use run_plan::{Rig, RunPlan, SeriesPlan};
pub use segmented::{Motion, MoveMark, Plateau, Segmented};
