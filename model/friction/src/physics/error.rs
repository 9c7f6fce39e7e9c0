//! Reasons why the equilibrium of a tendon cannot be computed.

use pinswitch_diagnostic::{Diagnostic, codes};

/// Reason why the equilibrium of a tendon cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", Diagnostic::from(self.clone()))]
#[non_exhaustive]
pub enum PhysicsError {
    /// Newton's method did not balance the forces.
    NotConverged {
        /// Largest unbalanced force at a node, N.
        unbalanced_n: f64,
        /// Newton steps taken.
        steps: usize,
    },
    /// The iteration between shape and tension did not converge.
    TensionNotConverged {
        /// Load, N.
        load_n: f64,
        /// Iterations made.
        iterations: usize,
    },
    /// Neither pins nor silicone touch the tendon.
    NoSupport,
}

impl From<PhysicsError> for Diagnostic {
    fn from(error: PhysicsError) -> Self {
        let other_law = "choose the layout law (--law layout), and report this configuration";
        match error {
            PhysicsError::NotConverged { unbalanced_n, steps } => Self::new(codes::PHYSICS_NOT_CONVERGED, format!(
                "the tendon's shape did not converge: {unbalanced_n:.1e} N are unbalanced after {steps} Newton steps"
            ))
            .with_help(other_law),
            PhysicsError::TensionNotConverged { load_n, iterations } => Self::new(codes::PHYSICS_NOT_CONVERGED, format!(
                "shape and tension did not converge in {iterations} iterations at a load of {load_n:.2} N"
            ))
            .with_help(other_law),
            PhysicsError::NoSupport => Self::new(codes::NO_SUPPORT, "the tendon touches neither pins nor silicone")
                .with_help("move a pin into the wrap, or use silicone"),
        }
    }
}
