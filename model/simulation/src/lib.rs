//! A synthetic friction rig: plateau tables and raw logs with known effects and noise.
//!
//! The crate serves three purposes: to plan experiments (which effects could a session detect?), to
//! test the calibrator, and to study its error rates on rigs with known effects.
//!
//! # Vocabulary
//!
//! - [`Plan`]: a synthetic rig and its session: [`Protocol`], layouts and loads, [`RigConstants`],
//!   effects ([`EffectPlan`]), noise ([`NoisePlan`]), [`Disturbance`]s outside the vocabulary of
//!   effects, and logs ([`RawPlan`]).
//! - [`simulate`]: makes the table of a plan, a [`SimulatedSession`]. [`next_session`]
//!   makes that of a later session of the same rig, [`simulate_rows`] that of given runs, and
//!   [`simulate_from_model`] that of a calibrated model.
//! - [`SessionTraits`]: the random effects of each series: mount, operator, friction factor and
//!   offset.
//! - [`RawRun`]: raw logs of a session, with [`Faults`].
//! - [`power()`]: the detection rate of each effect with a plan.
//! - [`Case`], [`Truth`], [`Group`]: kinds of rig in the study, with their true effects.
//!   [`run_case`] calibrates one rig, and [`Study`] collects the outcomes. [`FormStudy`] does the
//!   same for discovered effects, and [`ExperimentStudy`] for proposed sessions.
//!
//! # Equation
//!
//! A reading without noise follows from eq. 4 of the paper. The effects of the plan change its
//! terms:
//!
//! ```text
//! R = F + (1 + w)(1 - S) (F exp(d x_p) - F) + (1 - w) S (F exp(d x_s) - F)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `R` | reading | N |
//! | `F` | load | N |
//! | `d` | direction: -1 eccentric, +1 concentric | 1 |
//! | `x_p`, `x_s` | friction exponents on pins and silicone: `mu_p a`, `mu_s a`, and effects | 1 |
//! | `a` | wrap angle | rad |
//! | `S` | share of the contact that has switched, `1/(1 + exp(-s (F/F_half - 1)))` | 1 |
//! | `s`, `F_half` | steepness, and half load of the layout | 1, N |
//! | `w` | weight, a thirtieth of the number of pins | 1 |
//!
//! The noise adds offsets of a series and direction, of a series, and of a repetition, scales
//! friction by series and by mount, and adds gross errors. [`NoisePlan`] has the parameters.
//!
//! # Examples
//!
//! The calibrator attributes an offset of the load cell:
//!
//! ```
//! use pinswitch_calibration::effects::Vocabulary;
//! use pinswitch_calibration::{Verdict, calibrate};
//! use pinswitch_simulation::{EffectPlan, Plan, simulate};
//!
//! let mut plan = Plan::randomised();
//! plan.effects.push(EffectPlan { id: "load_cell_offset".to_owned(), values: vec![0.8], form: 0 });
//! let report = calibrate(&simulate(&plan).rows, &Vocabulary::built_in(), 1)?.report;
//! assert_eq!(report.verdict, Verdict::Attributed);
//! assert_eq!(report.effects[0].id, "load_cell_offset");
//! # Ok::<(), pinswitch_calibration::CalibrationError>(())
//! ```
//!
//! A plan is a TOML file, and an error has its location:
//!
//! ```
//! use pinswitch_simulation::{Plan, simulate};
//!
//! let plan = Plan::parse("seed = 7\n[noise]\nseries_scale = 0.02", "plan.toml")?;
//! assert_eq!(simulate(&plan).rows, simulate(&plan).rows, "the same plan makes the same rows");
//! let error = Plan::parse("[noise]\nseries_scale = 2", "plan.toml").unwrap_err();
//! assert_eq!(error.problem(), "must be from 0 to 0.5");
//! let location = error.location().map(ToString::to_string);
//! assert_eq!(location.as_deref(), Some("plan.toml:2:16: noise.series_scale = 2"));
//! # Ok::<(), pinswitch_diagnostic::Diagnostic>(())
//! ```
//!
//! # Conventions
//!
//! The same plan makes the same bytes on every machine. `model/doc/calibration.md` reports the
//! results of the study.
//!
//! Architecture invariant: the crate has its own formulas of the effects and does not use those of
//! the fit, so that the study also tests effects whose true form differs from the fitted one.

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
#[cfg(test)]
mod raw_variants;
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
pub use simulate::{SimulatedSession, simulate, simulate_rows};
pub use study::{
    Attribution, Case, CaseOutcome, ExperimentOutcome, ExperimentStudy, Forecast, FormOutcome, FormStudy,
    Group, StudiedRig, Study, Truth, experiment_cases, plan_of, run_case, run_experiment_case, run_form_case,
    study_cases,
};
