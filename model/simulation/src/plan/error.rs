//! Why a plan cannot be run.

/// Why a plan cannot be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The text is no plan.
    #[error("{file}: {problem}")]
    Malformed {
        /// File name as given.
        file: String,
        /// What is wrong, with the line.
        problem: String,
    },
    /// A value is out of bounds.
    #[error("{file}: {field} = {value} is outside {bound}; {remedy}")]
    Bound {
        /// File name as given.
        file: String,
        /// Field of the plan.
        field: &'static str,
        /// Value found.
        value: String,
        /// What is allowed.
        bound: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// An effect the library does not have, or with the wrong number of constants.
    #[error("{file}: effects: '{id}' with {found} value(s); {remedy}")]
    Effect {
        /// File name as given.
        file: String,
        /// The id found.
        id: String,
        /// How many values came with it.
        found: usize,
        /// What is right.
        remedy: String,
    },
}
