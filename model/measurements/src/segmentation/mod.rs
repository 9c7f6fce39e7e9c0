//! Segmentation of raw 200 Hz logs into one row per repetition (`model/doc/file-formats.md`).

mod finding;
mod log;
mod plateaus;
mod run;
mod run_plan;

pub use finding::Finding;
pub use log::Log;
pub use plateaus::{Plateau, Segmented, segment};
pub use run::{RunSegmentation, SegmentationReport, SegmentedRun, SegmentedSeries, segment_run};
pub use run_plan::{Rig, RunPlan, SeriesPlan};
