//! Calibration of the friction model with measured data.
//!
//! The crate computes the probability of each effect that the paper's model lacks, and writes a
//! model that predicts readings. The tables are those of [`pinswitch_measurements`], the statistics
//! those of [`pinswitch_inference`]; this crate has the friction model, the priors and the report.
//! It does not depend on simulated rigs, parts, files or plots. `model/doc/glossary.md` defines the
//! terms.
//!
//! Each step can be used alone:
//!
//! 1. [`segmentation`] converts `run.toml` and its logs to the rows of a plateau table.
//! 2. [`table`] reads and checks a plateau table.
//! 3. [`evidence`] computes the posterior over hypotheses: sets of [`effects`], and of structure
//!    without a name, in addition to the refitted model of the paper.
//! 4. [`calibrate`] returns the posterior as a [`Report`]: probabilities, rivals, limits, the
//!    verdict, held-out errors, and the expected error of a new session. It tests user-defined
//!    effects ([`TrialReport`]), and derives a formula of unnamed structure ([`DrawnForm`]).
//! 5. [`ModelFile`] stores the best hypothesis as a [`model`]. It predicts readings, and the
//!    friction curve of a printed part without the effects of the rig.
//! 6. [`experiment`] proposes the runs that answer most open questions of a report.
//!
//! # Model
//!
//! The baseline predicts the tension `T` of the tendon at a load `F`. On one material it is the
//! capstan equation; on a device (pins in silicone) friction passes from the pins to the silicone:
//!
//! ```text
//! one material:  T = F exp(d mu a)
//! device:        T = F + (1 + w) (1 - S) F (exp(d mu_p a) - 1) + (1 - w) S F (exp(d mu_s a) - 1)
//!                S = 1/(1 + exp(-s (F/F_half - 1)))
//! ```
//!
//! `d` is -1 for the eccentric and +1 for the concentric direction, `a` the wrap angle in radians,
//! `mu_p` and `mu_s` the friction coefficients of pins and silicone, `w = n/30` the weight for `n`
//! pins, `S` the share of the contact that has switched from pins to silicone, `F_half` the half
//! load and `s` the steepness (`model/doc/friction-laws.md`). A reading is this tension with the
//! effects of a hypothesis `H`, plus unnamed structure and noise with random effects. The score
//! `ln p(y | H) + ln p(H)` of the readings `y` gives the posterior probability of `H`.
//!
//! # Examples
//!
//! Which effect explains most of the model's errors on the paper's seven maxima?
//!
//! ```
//! use pinswitch_calibration::explain_published;
//!
//! let explanations = explain_published();
//! assert_eq!(explanations[1].id, "coating_ploughing");
//! assert!(explanations[1].left_out_rms_pct < Some(0.3 * explanations[0].rms_pct));
//! ```
//!
//! Readers report a [`Diagnostic`](pinswitch_diagnostic::Diagnostic) with location, problem and
//! help:
//!
//! ```
//! use pinswitch_calibration::experiment::RigLimits;
//!
//! let error = RigLimits::parse("stroke_mm = 0\n", "rig.toml").unwrap_err();
//! assert_eq!(error.problem(), "outside 1 to 10000 mm");
//! assert_eq!(error.location().and_then(|location| location.line), Some(1));
//! ```
//!
//! Readers take text, bytes or [`std::io::Read`], and writers return text: the crate does not open
//! files, and does not read clocks or environment variables. `model/doc/file-formats.md` describes
//! the files, `model/doc/effect-catalogue.md` the effects, and `model/doc/naming-an-effect.md` the
//! inference with its equations.

#![warn(clippy::disallowed_methods)]

mod adequacy;
mod aliasing;
mod calibrate;
mod confirmation;
mod content_hash;
mod discovery;
pub mod effects;
pub mod evidence;
pub mod experiment;
mod extrapolation;
mod least_squares;
pub mod model;
mod model_check;
mod model_file;
mod own_values;
mod parallel;
mod part_curve;
mod published_maxima;
mod report;
mod reporting;
mod session_plan;
mod session_spread;
pub mod table;
#[cfg(test)]
mod test_session;

pub use aliasing::{Aliasing, aliasing};

pub use calibrate::{Calibration, CalibrationError, calibrate};
pub use discovery::DrawnForm;
pub use extrapolation::calibrate_below;
pub use model_file::ModelFile;
pub use pinswitch_measurements::{median, segmentation, toml_error};
pub use published_maxima::{Explanation, explain_published};
pub use report::{
    BadSeries, CandidateReport, ChangeReport, DataSummary, EffectReport, Estimate, ExpectedErrorReport,
    ExternalInput, Extrapolation, Fate, FormReport, FormRival, Invisible, LimitReport, ModelReport,
    MountReport, NoisePart, ProvenanceReport, Report, RivalReport, SessionReport, StructureReport,
    TrialOutcome, TrialReport, Verdict,
};
pub use session_plan::{Answer, PlanQuestion, SessionPlan};
