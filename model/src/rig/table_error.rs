//! Why a plateau table cannot be used.

use super::plateau_table::COLUMNS;

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
    #[error("{file}, line {line}, column '{column}': '{value}' {problem}")]
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
    #[error("{file}{}: {problem}", line.map(|l| format!(", line {l}")).unwrap_or_default())]
    Malformed {
        /// File name as given.
        file: String,
        /// Line in the file, counted from 1.
        line: Option<u64>,
        /// What is wrong.
        problem: String,
    },
    /// Every reading is the same.
    #[error(
        "{file}, column 'force_N': every reading is {force_n}; the channel is stuck, check the load cell and its cable"
    )]
    Stuck {
        /// File name as given.
        file: String,
        /// The reading in newtons.
        force_n: f64,
    },
    /// The loads cannot fix the baseline.
    #[error(
        "{file}, lines 2 to {last_line}, column 'load_N': {found} different load(s); the baseline needs at least {needed}, \
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
