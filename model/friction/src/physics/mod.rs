//! Friction from physics: a string over sinking pins on a silicone foundation, for any layout.
//!
//! The paper's equation cannot predict a layout that it was not fitted to. This model can: the tendon's shape follows
//! from a balance of forces (`equilibrium.rs`, `model/doc/friction-laws.md`), each contact's friction from its force
//! (`march.rs`), and three constants fitted to the published maxima (`fit.rs`) carry the materials. What it does not
//! explain stands in [`hypotheses`] and in every curve's reasons.

mod banded;
mod constants;
mod equilibrium;
mod error;
mod fit;
mod grid;
pub mod hypotheses;
mod march;
mod profile;
mod switch;

#[cfg(test)]
mod tests;

pub use crate::bed::{Bed, OutsidePins, modulus_of_shore_a_mpa, shore_a_of_modulus_mpa};
pub use constants::Constants;
pub(crate) use constants::PUBLISHED_FIT;
pub use error::PhysicsError;
pub use fit::{
    FitError, LayoutLeftOut, MaximaFit, fit_maxima, leave_one_condition_out, leave_one_layout_out,
};
pub use profile::{ContactProfile, contact_profile, contact_profiles};
pub use switch::PhysicsSwitch;
