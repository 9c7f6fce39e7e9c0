//! Segmentation of raw logs into one row per repetition (`model/doc/logs.md`).
//!
//! Imports run downwards: `run` uses `plateaus`, which uses `defects`, `moves`, `cycles` and `direction`,
//! which use `log`, `change_points`, `steady_force` and `two_levels`.

mod change_points;
mod clock;
mod cycles;
mod defects;
mod direction;
mod finding;
mod log;
mod moves;
mod plateaus;
mod run;
mod run_plan;
mod segmented;
mod steady_force;
mod two_levels;

pub use direction::Protocol;
pub use finding::Finding;
pub use log::{DeclaredLoad, Log, Part};
pub use moves::Source;
pub use plateaus::segment;
pub use run::{RunSegmentation, SegmentationReport, SegmentedRun, SegmentedSeries, segment_run};
pub use run_plan::{Rig, RunPlan, SeriesPlan};
pub use segmented::{Motion, MoveMark, Plateau, Segmented};
