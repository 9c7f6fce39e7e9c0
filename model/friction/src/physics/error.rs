//! Why a tendon cannot be computed.

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
