//! From raw 200 Hz logs to one row per repetition (data.md 2): what the paper did by hand.

mod finding;
mod log;
mod plateaus;
mod run_plan;

pub use finding::Finding;
pub use log::{Log, LogError};
pub use plateaus::{Plateau, Segmented, segment};
pub use run_plan::{Rig, RunPlan, RunPlanError, SeriesPlan};
