//! Why a law cannot predict a contact.

use crate::physics::PhysicsError;

/// Why a law cannot predict a contact.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// The law does not describe such a contact, or needs more than the contact.
    #[error("{why}")]
    DoesNotApply {
        /// What it describes instead, and what to use.
        why: &'static str,
    },
    /// The physics has no solution.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
}
