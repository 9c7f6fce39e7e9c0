//! The closed loop: a table in, a verdict with errors before and after out (data.md sections 5 and 6).

mod extrapolation;
mod heldout;
mod model_file;
mod part_curve;
mod published_loop;
mod report;
mod schema;
mod transfer;

pub use extrapolation::calibrate_below;
pub use heldout::{HeldOut, held_out};
pub use model_file::{ModelFile, ModelFileError};
pub use published_loop::{Explanation, explain_published};
pub use report::{Calibration, CalibrationError, calibrate};
pub use schema::{
    BadSeries, Candidate, DataSummary, EffectReport, Estimate, Extrapolation, Fate, Invisible, ModelReport,
    Report, RivalReport, Verdict,
};
pub use transfer::layouts_left_out;
