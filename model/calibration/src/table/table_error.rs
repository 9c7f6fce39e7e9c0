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
    /// Two files hold rows of one session.
    #[error(
        "{file}: its session '{}' is in {other} too; name the sessions in a column session, or leave one of the files out",
        excerpt(session, 80)
    )]
    Session {
        /// File name as given.
        file: String,
        /// The other file.
        other: String,
        /// The session.
        session: String,
    },
    /// Two tables are one, or parts of one.
    #[error(
        "{file}: {rows} of its readings stand in {other} too, with their times; a table and a copy of it are one session: leave one \
         of the files out"
    )]
    Copied {
        /// File name as given.
        file: String,
        /// The other file.
        other: String,
        /// Rows that both have.
        rows: usize,
    },
    /// A column is absent from the header.
    #[error(
        "{file}, line 1: column '{column}' is missing; the header must name {}; a raw log becomes such a table by \
         `pinswitch segment`",
        COLUMNS.join(", ")
    )]
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
        "{file}, column 'force_N': the reading changes by {slope:.2} N for each newton of load_N in {conditions} of {of} \
         condition(s) (rank correlation over all {correlation:.2}), {:.2} to {:.2} and a correlation above 0.5 are possible; check the sign and the unit of both columns, and the load cell's cable",
        bounds.start(), bounds.end()
    )]
    Unrelated {
        /// File name as given.
        file: String,
        /// Newtons per newton, the median over the conditions that do not follow.
        slope: f64,
        /// Rank correlation of readings and loads, the median over all conditions.
        correlation: f64,
        /// What is possible.
        bounds: std::ops::RangeInclusive<f64>,
        /// Conditions whose readings do not follow.
        conditions: usize,
        /// Conditions whose loads differ enough to tell.
        of: usize,
    },
    /// Two columns stand in each other's place.
    #[error(
        "{file}, columns '{first}' and '{second}': they stand in each other's place: {because}; exchange the two names in \
         line 1, or repair what wrote the table"
    )]
    SwappedColumns {
        /// File name as given.
        file: String,
        /// The column that comes first in a header.
        first: &'static str,
        /// The other.
        second: &'static str,
        /// How it was told.
        because: &'static str,
    },
    /// The directions differ the wrong way round.
    #[error(
        "{file}, column 'direction': in {conditions} of {of} condition(s) the concentric readings lie below the eccentric \
         ones, at {load_n:.2} N of load {concentric_n:.2} N below {eccentric_n:.2} N; a load takes more to pull than to \
         release. Exchange the words concentric and eccentric, or load_N and force_N if these are swapped"
    )]
    SwappedDirections {
        /// File name as given.
        file: String,
        /// Conditions where it is so.
        conditions: usize,
        /// Conditions with both directions.
        of: usize,
        /// A load.
        load_n: f64,
        /// The reading there while the load is pulled.
        concentric_n: f64,
        /// The reading there while it is released.
        eccentric_n: f64,
    },
    /// The readings hold no friction.
    #[error(
        "{file}, column 'force_N': no friction was measured: in none of {conditions} condition(s) does the reading depart \
         from the load by more than its scatter, pulled or released; check that force_N is the load cell beyond the \
         switch, and no copy of load_N"
    )]
    NoFriction {
        /// File name as given.
        file: String,
        /// Conditions looked at.
        conditions: usize,
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
