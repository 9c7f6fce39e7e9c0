//! A synthetic rig: plateau tables and raw logs with known effects, for planning, for tests and for the study of the
//! calibrator. The crate knows physics of its own and must not take a formula of an effect from the fitter.

#[cfg(test)]
mod calibrator_tests;
mod disturbance;
mod effect_forms;
mod plan;
mod power;
mod protocol;
mod raw;
mod simulate;
mod study;
mod twin;

pub use disturbance::{Course, Disturbance, DisturbanceTarget};
pub use plan::{EffectPlan, NoisePlan, Plan, PlanError, Protocol, RawPlan, RigConstants};
pub use power::{Power, power};
pub use raw::{Faults, RawLog, RawRun};
pub use simulate::{Simulated, simulate};
pub use study::{Case, Outcome, Study, Truth, plan_of, run_case, study_cases};
