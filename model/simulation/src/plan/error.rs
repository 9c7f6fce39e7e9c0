//! Why a plan cannot be run.

use pinswitch_diagnostic::excerpt;

/// Why a plan cannot be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The text is no plan.
    #[error("{file}: {}; model/doc/file-formats.md shows the form", excerpt(problem, 300))]
    Malformed {
        /// File name as given, with the line.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// A value is out of bounds.
    #[error("{file}: {field} = {} is outside {bound}; {remedy}", excerpt(value, 200))]
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
    /// The rig that is planned cannot be read.
    #[error(
        "{file}: the plan makes a reading of {reading} N in row {row}, {most} are possible; lower its constants, effects or \
         noise"
    )]
    Reading {
        /// File name as given.
        file: String,
        /// Row of the table, from 1.
        row: usize,
        /// The reading.
        reading: String,
        /// The largest one.
        most: f64,
    },
    /// An effect the library does not have, or with the wrong number of constants.
    #[error("{file}: effects: '{}' with {found} value(s); {}", excerpt(id, 80), excerpt(remedy, 380))]
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
