//! Measured friction data: from raw logs to plateau tables, from a table to the effects that the paper's model lacks on
//! it, and to a model that predicts. The crate knows data and what explains it; it must not know how a rig is
//! simulated, nor parts, files or plots.
//!
//! The way of the data, each step usable alone:
//!
//! 1. [`segmentation`]: `run.toml` and its 200 Hz logs become the rows of a plateau table.
//! 2. [`table`]: a plateau table is read and checked; errors name file, line and column.
//! 3. [`calibrate`] refits the paper's model, names the effects that it lacks ([`effects`], [`inference`]) and returns a
//!    [`Report`] with the errors before and after, on data held out from the fit.
//! 4. [`ModelFile`] keeps the fitted model: it predicts readings, and the curve of a printed part without the effects
//!    that belong to the rig.
//!
//! ```
//! use pinswitch_calibration::explain_published;
//!
//! // The loop on the paper's own seven maxima: what explains most of what its model misses?
//! let explanations = explain_published();
//! assert_eq!(explanations[1].id, "coating_ploughing");
//! assert!(explanations[1].left_out_rms_pct < Some(0.3 * explanations[0].rms_pct));
//! ```
//!
//! Readers take text, bytes or [`std::io::Read`], writers return text: nothing here opens a file, starts a thread, or
//! reads a clock or the environment. `model/doc/file-formats.md` describes the files, `model/doc/effect-catalogue.md`
//! the effects and `model/doc/naming-an-effect.md` how one is named.

#![warn(clippy::disallowed_methods)]

mod aliasing;
mod beyond_range;
mod calibrate;
pub mod effects;
pub mod experiment;
mod extrapolation;
mod forms;
mod held_out;
pub mod inference;
mod layouts_left_out;
mod median;
mod model_check;
mod model_file;
mod own_values;
mod parallel;
mod part_curve;
mod promise;
mod published_maxima;
mod report;
pub mod segmentation;
mod session_plan;
pub mod table;
mod telling;
#[cfg(test)]
mod test_session;
mod toml_text;
mod trial;

pub use aliasing::{Aliasing, aliasing};

pub use calibrate::{Calibration, CalibrationError, calibrate, calibrate_among};
pub use extrapolation::calibrate_below;
pub use forms::{DrawnForm, FormReport, FormRival, draw_form};
pub use held_out::{HeldOut, held_out};
pub use layouts_left_out::layouts_left_out;
pub use median::median;
pub use model_file::ModelFile;
pub use published_maxima::{Explanation, explain_published};
pub use report::{
    BadSeries, CandidateReport, ChangeReport, DataSummary, EffectReport, Estimate, Extrapolation, Fate,
    Invisible, LimitReport, ModelReport, NoisePart, Report, RivalReport, SessionReport, SizeInSession,
    UnequalReport, Verdict,
};
pub use session_plan::{Answer, PlanQuestion, SessionPlan};
pub use toml_text::toml_error;
pub use trial::{CERTAIN_P, CONFIRMED_P, CONFIRMED_SHARE, TrialOutcome, TrialReport, trials};
