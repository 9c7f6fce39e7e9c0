//! Friction from contact mechanics: a tendon over sinking pins on a silicone foundation, for any
//! layout.
//!
//! The equation of the paper has constants for three layouts only. This model predicts any layout:
//! the shape of the tendon follows from the balance of forces (`equilibrium.rs`,
//! `model/doc/friction-laws.md`), the friction of each contact from its force (`march.rs`), and the
//! materials have three constants, fitted to the published maxima (`fit.rs`). [`hypotheses`] and
//! the reasons of every curve list the facts that it does not explain.

mod banded;
mod constants;
mod continuation;
mod coupled;
mod equilibrium;
mod error;
mod fit;
mod grid;
pub mod hypotheses;
mod line_search;
mod made;
mod march;
mod pair;
mod profile;
mod switch;
mod threshold;

#[cfg(test)]
mod tests;

pub use crate::bed::{Bed, OutsidePins, modulus_of_shore_a_mpa, shore_a_of_modulus_mpa};
pub use constants::Constants;
pub(crate) use constants::PUBLISHED_FIT;
pub use continuation::Continuation;
pub use error::PhysicsError;
pub use fit::{
    FitError, LayoutLeftOut, MaximaFit, fit_maxima, leave_one_condition_out, leave_one_layout_out,
};
pub use made::{Dimension, MadeDimensions};
pub use profile::{ContactProfile, contact_profile, contact_profiles};
pub use switch::{PhysicsSwitch, Sensitivities};
