//! Measured friction data: from raw logs to plateau tables, from a table to the effects that the paper's model lacks on
//! it, and to a model that predicts. The crate knows data and what explains it; it must not know how a rig is simulated,
//! nor parts, files or plots.

mod calibrate;
pub mod effects;
mod extrapolation;
mod held_out;
pub mod inference;
mod layouts_left_out;
mod median;
mod model_file;
mod part_curve;
mod published_maxima;
mod report;
pub mod segmentation;
pub mod table;
#[cfg(test)]
mod test_session;

pub use calibrate::{Calibration, CalibrationError, calibrate};
pub use extrapolation::calibrate_below;
pub use held_out::{HeldOut, held_out};
pub use layouts_left_out::layouts_left_out;
pub use median::median;
pub use model_file::{ModelFile, ModelFileError};
pub use published_maxima::{Explanation, explain_published};
pub use report::{
    BadSeries, CandidateReport, DataSummary, EffectReport, Estimate, Extrapolation, Fate, Invisible,
    ModelReport, Report, RivalReport, Verdict,
};
