//! A synthetic rig: plateau tables with known effects, for planning, for tests and for the study of the calibrator.

mod disturbance;
mod plan;
mod power;
mod protocol;
mod raw;
mod rig;
mod study;
mod twin;

pub use disturbance::{Disturbance, Kind, Target};
pub use plan::{Constants, EffectPlan, NoisePlan, Plan, PlanError, Protocol};
pub use power::{Power, power};
pub use raw::{Faults, RawLog, RawPlan, RawRun};
pub use rig::{Simulated, simulate};
pub use study::{Case, Outcome, Strength, Study, Truth, plan_of, run_case, study_cases};
