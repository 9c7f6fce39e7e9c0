//! A synthetic rig: plateau tables and raw logs with known effects, for planning, for tests and for the study of the
//! calibrator. The crate knows physics of its own and must not take a formula of an effect from the fitter.
//!
//! A [`Plan`] says what the rig does, what the paper's model lacks on it and how noisy it is. [`simulate`] makes the
//! table that it would record, [`next_session`] that of a later session, [`RawRun`] the logs. [`power()`] tells before any measurement which effects a plan could
//! show, and [`run_case`] asks the calibrator about rigs whose truth is known.
//!
//! ```
//! use pinswitch_calibration::inference::Levels;
//! use pinswitch_calibration::{Verdict, calibrate};
//! use pinswitch_simulation::{EffectPlan, Plan, simulate};
//!
//! let mut plan = Plan::randomised();
//! plan.effects.push(EffectPlan { id: "load_cell_offset".to_owned(), values: vec![0.8], form: 0 });
//! let report = calibrate(&simulate(&plan).rows, Levels::default())?.report;
//! assert_eq!(report.verdict, Verdict::Attributed);
//! assert_eq!(report.effects[0].id, "load_cell_offset");
//! # Ok::<(), pinswitch_calibration::CalibrationError>(())
//! ```
//!
//! The same plan makes the same bytes on every machine. `model/doc/calibration.md` reports what the study found.

#[cfg(test)]
mod calibrator_tests;
mod disturbance;
mod effect_forms;
mod model_session;
mod next_session;
mod plan;
mod power;
mod protocol;
mod raw;
mod row_covariates;
mod series_traits;
mod simulate;
mod study;
mod twin;

pub use disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget, OperatorSchedule};
pub use model_session::simulate_from_model;
pub use next_session::next_session;
pub use plan::{ColumnsPlan, EffectPlan, NoisePlan, Plan, Protocol, RawPlan, RigConstants};
pub use power::{Power, power};
pub use raw::{Faults, RawLog, RawRun};
pub use series_traits::{SeriesTraits, SessionTraits};
pub use simulate::{Simulated, simulate, simulate_rows};
pub use study::{
    AnswerForecast, Attribution, Case, CaseOutcome, ExperimentOutcome, ExperimentStudy, FormOutcome,
    FormStudy, Group, Study, Truth, experiment_cases, plan_of, run_case, run_experiment_case, run_form_case,
    study_cases,
};
