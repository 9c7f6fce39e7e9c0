//! `PLAN.toml`: a synthetic rig with its session, effects, disturbances and noise.

mod check;
mod columns;
mod noise;
mod raw;
mod rig_plan;
mod text;

pub use columns::ColumnsPlan;
pub use noise::NoisePlan;
pub use raw::RawPlan;
pub use rig_plan::{EffectPlan, Plan, Protocol, RigConstants};
