//! Friction from physics: a string over sinking pins on a silicone foundation, for any layout.
//!
//! The paper's equation cannot predict a layout that it was not fitted to. This model can: the tendon's shape follows
//! from a balance of forces (`equilibrium.rs`, `model/doc/friction-laws.md`), each contact's friction from its force
//! (`march.rs`), and three constants fitted to the published maxima (`fit.rs`) carry the materials. What it does not
//! explain stands in [`hypotheses`] and in every curve's reasons.

mod banded;
mod bed;
mod constants;
mod device;
mod equilibrium;
mod fit;
mod grid;
pub mod hypotheses;
mod march;
mod profile;

#[cfg(test)]
mod tests;

pub use bed::{Bed, OutsidePins, modulus_of_shore_a_mpa, shore_a_of_modulus_mpa};
pub use constants::Constants;
pub use device::PhysicsSwitch;
pub(crate) use device::{states, uncertain, unexplained};
pub use fit::{
    FitError, LayoutLeftOut, MaximaFit, fit_maxima, leave_one_condition_out, leave_one_layout_out,
};
pub use profile::{ContactProfile, contact_profile, contact_profiles};

/// Why a tendon cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PhysicsError {
    /// Newton's method left a force unbalanced.
    #[error(
        "the tendon's shape did not settle: {unbalanced_n:.1e} N unbalanced after {steps} Newton steps; use --law layout, and please report the configuration"
    )]
    NotConverged {
        /// Largest unbalanced force, N.
        unbalanced_n: f64,
        /// Newton steps taken.
        steps: usize,
    },
    /// Shape and tension did not agree.
    #[error(
        "shape and tension did not agree at a load of {load_n:.2} N after {rounds} rounds; use --law layout, and please report the configuration"
    )]
    TensionUnsettled {
        /// The load, N.
        load_n: f64,
        /// Rounds tried.
        rounds: usize,
    },
    /// Neither pins nor silicone touch the tendon.
    #[error("nothing carries the tendon: it touches neither pins nor silicone")]
    NothingCarries,
}
