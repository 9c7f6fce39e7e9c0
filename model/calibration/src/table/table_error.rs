//! Why a plateau table cannot be used.

use pinswitch_diagnostic::excerpt;

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
    /// Loads that are no newtons.
    #[error(
        "{file}, column 'load_N': half of the loads are above {load_n} N; {} to {} N are possible of a tendon on a printed switch. \
         Give newtons: divide grams by 101.97, multiply kilonewtons by 1000",
        bounds.start(), bounds.end()
    )]
    NoNewtons {
        /// File name as given.
        file: String,
        /// The median load.
        load_n: f64,
        /// What is possible.
        bounds: std::ops::RangeInclusive<f64>,
    },
    /// Readings in another unit than the loads.
    #[error(
        "{file}, column 'force_N': over both directions the readings are {factor:.3} times the loads, {} to {} are possible; give \
         both columns in newtons at the tendon, and divide by what a pulley between tendon and cell multiplies",
        bounds.start(), bounds.end()
    )]
    ReadingUnit {
        /// File name as given.
        file: String,
        /// Readings over loads, friction fallen out.
        factor: f64,
        /// What is possible.
        bounds: std::ops::RangeInclusive<f64>,
    },
    /// One direction, on the wrong side of its loads.
    #[error(
        "{file}, column 'direction': what was {direction} lies on the wrong side of its load in {conditions} of {of} condition(s), where the reading changes by {slope:.2} N \
         for each newton; what is pulled (concentric) reads more than its load and what is released (eccentric) less. Write the \
         other word, or check load_N"
    )]
    WrongSide {
        /// File name as given.
        file: String,
        /// The word of the column.
        direction: &'static str,
        /// Newtons per newton, the median over the conditions on the wrong side.
        slope: f64,
        /// Conditions on the wrong side.
        conditions: usize,
        /// Conditions that can tell.
        of: usize,
    },
    /// A series on two conditions or at several loads.
    #[error(
        "{file}, column '{column}': series '{}' holds {} and {}; a series is recorded in one go, on one condition and at one load. Give \
         each its own name in column series",
        excerpt(series, 80),
        excerpt(one, 80),
        excerpt(other, 80)
    )]
    MixedSeries {
        /// File name as given.
        file: String,
        /// The series.
        series: String,
        /// The column that holds both.
        column: &'static str,
        /// One of its values.
        one: String,
        /// The other.
        other: String,
    },
    /// A series that stands in the table twice.
    #[error(
        "{file}, column 'force_N': the {rows} readings of series '{}' are those of series '{}' to the last digit; a copy is no second \
         measurement: leave it out",
        excerpt(series, 80),
        excerpt(other, 80)
    )]
    CopiedSeries {
        /// File name as given.
        file: String,
        /// The series.
        series: String,
        /// The one that it is a copy of.
        other: String,
        /// Its rows.
        rows: usize,
    },
    /// Directions exchanged in more series than can be set aside.
    #[error(
        "{file}, column 'direction': in {count} of {of} series less was read pulling than releasing ({}); friction takes from what is \
         released and adds to what is pulled. Exchange the words concentric and eccentric there, or leave these series out",
        excerpt(series, 200)
    )]
    ExchangedSeries {
        /// File name as given.
        file: String,
        /// How many.
        count: usize,
        /// Of so many.
        of: usize,
        /// Their names, the first of them.
        series: String,
    },
    /// A wrap angle measured row by row.
    #[error(
        "{file}, column 'wrap_angle_deg': {count} different angles of one layout, from {least_deg:.2} to {most_deg:.2} degrees; each would be \
         a condition with constants of its own, and at most {most} are possible. Give the nominal angle of each mount"
    )]
    ScatteredWraps {
        /// File name as given.
        file: String,
        /// How many.
        count: usize,
        /// The smallest.
        least_deg: f64,
        /// The largest.
        most_deg: f64,
        /// How many are possible.
        most: usize,
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
