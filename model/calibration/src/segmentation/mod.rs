//! From raw 200 Hz logs to one row per repetition: what the paper did by hand (`model/doc/file-formats.md`).

mod finding;
mod log;
mod plateaus;
mod run;
mod run_plan;

pub use finding::Finding;
pub use log::{Log, LogError};
pub use plateaus::{Plateau, Segmented, segment};
pub use run::{
    RunSegmentation, SegmentationError, SegmentationReport, SegmentedRun, SegmentedSeries, segment_run,
};
pub use run_plan::{Rig, RunPlan, RunPlanError, SeriesPlan};
