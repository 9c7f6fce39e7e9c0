//! Reasons why a law cannot predict a contact.

use pinswitch_diagnostic::{Diagnostic, codes};

use crate::physics::PhysicsError;

/// Reason why a law cannot predict a contact.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", Diagnostic::from(self.clone()))]
#[non_exhaustive]
pub enum LawError {
    /// The law does not describe such a contact, or needs more than the contact.
    DoesNotApply {
        /// Contacts that the law describes, or what it needs.
        problem: &'static str,
        /// Laws to use instead, or where to get what it needs.
        help: &'static str,
    },
    /// The physics does not converge.
    Physics(#[from] PhysicsError),
}

impl From<LawError> for Diagnostic {
    fn from(error: LawError) -> Self {
        match error {
            LawError::DoesNotApply { problem, help } => {
                Self::new(codes::LAW_DOES_NOT_APPLY, problem).with_help(help)
            }
            LawError::Physics(error) => error.into(),
        }
    }
}
