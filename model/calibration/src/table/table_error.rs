//! Why a plateau table cannot be used.

use pinswitch_friction::excerpt;

use super::columns::COLUMNS;

/// Why a plateau table cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The file holds no rows.
    #[error("{file}: no rows; a plateau table has a header line and one line per repetition")]
    Empty {
        /// File name as given.
        file: String,
    },
    /// A column is absent from the header.
    #[error("{file}, line 1: column '{column}' is missing; the header must name {}", COLUMNS.join(", "))]
    MissingColumn {
        /// File name as given.
        file: String,
        /// The absent column.
        column: &'static str,
    },
    /// A cell cannot be read.
    #[error("{file}, line {line}, column '{column}': '{}' {}", excerpt(value, 120), excerpt(problem, 300))]
    Cell {
        /// File name as given.
        file: String,
        /// Line in the file, counted from 1.
        line: u64,
        /// Name of the column.
        column: &'static str,
        /// The cell's text.
        value: String,
        /// What is wrong with it and what would be right.
        problem: String,
    },
    /// A line is no CSV of the header's width, or no UTF-8.
    #[error("{file}{}: {}", line.map(|l| format!(", line {l}")).unwrap_or_default(), excerpt(problem, 300))]
    Malformed {
        /// File name as given.
        file: String,
        /// Line in the file, counted from 1.
        line: Option<u64>,
        /// What is wrong.
        problem: String,
    },
    /// The readings do not follow the loads.
    #[error(
        "{file}, column 'force_N': the reading changes by {slope:.2} N for each newton of load_N, {} to {} are possible; \
         check the sign and the unit of both columns, and the load cell's cable", bounds.start(), bounds.end()
    )]
    Unrelated {
        /// File name as given.
        file: String,
        /// Newtons per newton.
        slope: f64,
        /// What is possible.
        bounds: std::ops::RangeInclusive<f64>,
    },
    /// Loads and masses contradict each other.
    #[error(
        "{file}, column 'load_N': the loads are {factor:.3} times what load_mass_g weighs, {} to {} are possible; \
         give newtons and grams, or 0 for a mass that is not known", bounds.start(), bounds.end()
    )]
    LoadUnit {
        /// File name as given.
        file: String,
        /// Load over weight.
        factor: f64,
        /// What is possible.
        bounds: std::ops::RangeInclusive<f64>,
    },
    /// The loads cannot fix the baseline.
    #[error(
        "{file}, lines 2 to {last_line}, column 'load_N': {found} different load(s) above zero; the baseline needs at least {needed}, \
         add series with other weights. One load leaves open how friction grows with load, where the switch stands, \
         and every effect that lies in load"
    )]
    TooFewLoads {
        /// File name as given.
        file: String,
        /// Last line of the table, counted from 1.
        last_line: usize,
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
}
