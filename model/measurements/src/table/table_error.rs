//! Errors of plateau tables.

use std::fmt;
use std::ops::RangeInclusive;

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes, excerpt};

use super::columns::COLUMNS;

/// Most characters of a series or session name in a message.
const LONGEST_NAME: usize = 80;

/// Reason why a plateau table cannot be used; converts to a [`Diagnostic`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// The file contains no rows.
    Empty {
        /// File name as given.
        file: String,
    },
    /// Two files contain rows of the same session.
    Session {
        /// File name as given.
        file: String,
        /// The other file.
        other: String,
        /// The session.
        session: String,
    },
    /// Two tables share most of their readings.
    Copied {
        /// File name as given.
        file: String,
        /// The other file.
        other: String,
        /// Number of shared readings.
        rows: usize,
    },
    /// The header lacks a column.
    MissingColumn {
        /// The header.
        location: Box<Location>,
        /// The missing column.
        column: &'static str,
    },
    /// A cell cannot be read.
    Cell {
        /// The cell, with its column and its text.
        location: Box<Location>,
        /// What is wrong with it.
        problem: String,
        /// How to correct it.
        help: String,
    },
    /// The file cannot be read, or a line is not CSV of the header's width in UTF-8.
    Malformed {
        /// Kind of fault: the file cannot be read, is not UTF-8, or is malformed.
        code: Code,
        /// The file, and the line if it is known.
        location: Box<Location>,
        /// What is wrong.
        problem: String,
        /// How to correct it; empty where the problem does not suggest a way.
        help: &'static str,
    },
    /// The readings do not follow the loads.
    Unrelated {
        /// File name as given.
        file: String,
        /// Change of the reading in newtons per newton of load: median over the conditions that do
        /// not follow.
        slope: f64,
        /// Rank correlation of readings and loads: median over all conditions.
        correlation: f64,
        /// Plausible slopes.
        bounds: RangeInclusive<f64>,
        /// Number of conditions whose readings do not follow.
        conditions: usize,
        /// Number of conditions whose loads vary enough to judge.
        of: usize,
    },
    /// Two columns are swapped.
    SwappedColumns {
        /// File name as given.
        file: String,
        /// The column that comes first in a header.
        first: &'static str,
        /// The other column.
        second: &'static str,
        /// What shows it.
        evidence: &'static str,
    },
    /// The labels of the two directions are swapped.
    SwappedDirections {
        /// File name as given.
        file: String,
        /// Number of conditions with swapped labels.
        conditions: usize,
        /// Number of conditions with both directions.
        of: usize,
        /// Load of an example in newtons.
        load_n: f64,
        /// Concentric reading of the example in newtons.
        concentric_n: f64,
        /// Eccentric reading of the example in newtons.
        eccentric_n: f64,
    },
    /// The readings show no friction.
    NoFriction {
        /// File name as given.
        file: String,
        /// Number of conditions that were checked.
        conditions: usize,
    },
    /// Loads and masses contradict each other.
    LoadUnit {
        /// File name as given.
        file: String,
        /// Load over weight.
        factor: f64,
        /// Plausible factors.
        bounds: RangeInclusive<f64>,
    },
    /// The loads cannot be newtons.
    ImplausibleLoads {
        /// File name as given.
        file: String,
        /// Median load in newtons.
        load_n: f64,
        /// Plausible median loads in newtons.
        bounds: RangeInclusive<f64>,
    },
    /// The readings have another unit than the loads.
    ReadingUnit {
        /// File name as given.
        file: String,
        /// Readings over loads, averaged over both directions so that friction cancels.
        factor: f64,
        /// Plausible factors.
        bounds: RangeInclusive<f64>,
    },
    /// The table has one direction, and its readings are on the wrong side of their loads.
    WrongSide {
        /// File name as given.
        file: String,
        /// Word of the column.
        direction: &'static str,
        /// Change of the reading in newtons per newton of load: median over the conditions.
        slope: f64,
        /// Number of conditions on the wrong side.
        conditions: usize,
        /// Number of conditions whose loads vary enough to judge.
        of: usize,
    },
    /// A series has several conditions or loads.
    MixedSeries {
        /// File name as given.
        file: String,
        /// The series.
        series: String,
        /// The column with several values.
        column: &'static str,
        /// One of its values.
        one: String,
        /// Another of its values.
        other: String,
    },
    /// A series is a copy of another one.
    CopiedSeries {
        /// File name as given.
        file: String,
        /// The series.
        series: String,
        /// The series that it copies.
        other: String,
        /// Number of rows.
        rows: usize,
    },
    /// The labels of the directions are swapped in more series than a fit can exclude.
    ExchangedSeries {
        /// File name as given.
        file: String,
        /// Number of series with swapped labels.
        count: usize,
        /// Number of all series.
        of: usize,
        /// Names of the first of them.
        series: String,
    },
    /// A layout has too many different wrap angles.
    ScatteredWraps {
        /// File name as given.
        file: String,
        /// Number of different angles.
        count: usize,
        /// Smallest angle in degrees.
        least_deg: f64,
        /// Largest angle in degrees.
        most_deg: f64,
        /// Largest number that is possible.
        most: usize,
    },
    /// Too few loads determine the baseline.
    TooFewLoads {
        /// File name as given.
        file: String,
        /// Last line of the table, from 1.
        last_line: usize,
        /// Number of different loads above zero.
        found: usize,
        /// Number that is needed.
        needed: usize,
    },
}

impl TableError {
    fn location(&self) -> Location {
        let column =
            |file: &str, name: &str| Location { field: Some(name.to_owned()), ..Location::file(file) };
        match self {
            Self::Empty { file } | Self::Session { file, .. } | Self::Copied { file, .. } => {
                Location::file(file)
            }
            Self::MissingColumn { location, .. }
            | Self::Cell { location, .. }
            | Self::Malformed { location, .. } => Location::clone(location),
            Self::SwappedColumns { file, first, .. } => column(file, first),
            Self::MixedSeries { file, column: name, .. } => column(file, name),
            Self::SwappedDirections { file, .. }
            | Self::WrongSide { file, .. }
            | Self::ExchangedSeries { file, .. } => column(file, "direction"),
            Self::Unrelated { file, .. }
            | Self::NoFriction { file, .. }
            | Self::ReadingUnit { file, .. }
            | Self::CopiedSeries { file, .. } => column(file, "force_N"),
            Self::LoadUnit { file, .. }
            | Self::ImplausibleLoads { file, .. }
            | Self::TooFewLoads { file, .. } => column(file, "load_N"),
            Self::ScatteredWraps { file, .. } => column(file, "wrap_angle_deg"),
        }
    }

    fn code(&self) -> Code {
        match self {
            Self::Empty { .. } => codes::TABLE_WITHOUT_ROWS,
            Self::Session { .. } => codes::SESSION_IN_TWO_FILES,
            Self::Copied { .. } | Self::CopiedSeries { .. } => codes::COPIED_READINGS,
            Self::MissingColumn { .. } => codes::MISSING_COLUMN,
            Self::Cell { .. } => codes::INVALID_CELL,
            Self::Malformed { code, .. } => *code,
            Self::Unrelated { .. } => codes::READINGS_DO_NOT_FOLLOW,
            Self::SwappedColumns { .. } => codes::SWAPPED_COLUMNS,
            Self::SwappedDirections { .. } | Self::WrongSide { .. } | Self::ExchangedSeries { .. } => {
                codes::SWAPPED_DIRECTIONS
            }
            Self::NoFriction { .. } => codes::NO_FRICTION,
            Self::LoadUnit { .. } | Self::ImplausibleLoads { .. } => codes::LOAD_UNIT,
            Self::ReadingUnit { .. } => codes::READING_UNIT,
            Self::MixedSeries { .. } => codes::MIXED_SERIES,
            Self::ScatteredWraps { .. } => codes::SCATTERED_WRAPS,
            Self::TooFewLoads { .. } => codes::TOO_FEW_LOADS,
        }
    }

    fn problem(&self) -> String {
        let name = |text: &str| excerpt(text, LONGEST_NAME);
        let range = |bounds: &RangeInclusive<f64>| format!("{} to {}", bounds.start(), bounds.end());
        match self {
            Self::Empty { .. } => "the table contains no rows".to_owned(),
            Self::Session { other, session, .. } => {
                format!("session '{}' is also in {}", name(session), name(other))
            }
            Self::Copied { other, rows, .. } => {
                format!("{rows} of its readings are also in {}, at the same times", name(other))
            }
            Self::MissingColumn { column, .. } => format!("column '{column}' is missing"),
            Self::Cell { problem, .. } | Self::Malformed { problem, .. } => problem.clone(),
            Self::Unrelated { slope, correlation, bounds, conditions, of, .. } => format!(
                "the readings do not follow the loads in {conditions} of {of} condition(s): they change by {slope:.2} N per \
                 newton of load_N (plausible: {:.2} to {:.2}), with a rank correlation of {correlation:.2} over all conditions \
                 (plausible: above 0.5)",
                bounds.start(),
                bounds.end()
            ),
            Self::SwappedColumns { second, evidence, .. } => {
                format!("swapped with column {second}: {evidence}")
            }
            Self::SwappedDirections { conditions, of, load_n, concentric_n, eccentric_n, .. } => format!(
                "the concentric readings are below the eccentric ones in {conditions} of {of} condition(s), such as \
                 {concentric_n:.2} N below {eccentric_n:.2} N at a load of {load_n:.2} N; pulling a load takes more force than \
                 releasing it"
            ),
            Self::NoFriction { conditions, .. } => format!(
                "no friction was measured: in none of {conditions} condition(s) does the reading differ from the load by more \
                 than its scatter, pulled or released"
            ),
            Self::LoadUnit { factor, bounds, .. } => format!(
                "the loads are {factor:.3} times the weight of load_mass_g (plausible: {})",
                range(bounds)
            ),
            Self::ImplausibleLoads { load_n, bounds, .. } => format!(
                "the median load is {load_n} N (plausible for a tendon on a printed switch: {} N)",
                range(bounds)
            ),
            Self::ReadingUnit { factor, bounds, .. } => format!(
                "the readings are {factor:.3} times the loads, averaged over both directions (plausible: {})",
                range(bounds)
            ),
            Self::WrongSide { direction, slope, conditions, of, .. } => format!(
                "the {direction} readings are on the wrong side of their loads in {conditions} of {of} condition(s) ({slope:.2} N \
                 per newton); concentric (pulled) readings are above their loads, eccentric (released) ones below"
            ),
            Self::MixedSeries { series, one, other, .. } => format!(
                "series '{}' contains {} and {}; a series is recorded without a break, on one condition and at one load",
                name(series),
                name(one),
                name(other)
            ),
            Self::CopiedSeries { series, other, rows, .. } => format!(
                "the {rows} readings of series '{}' equal those of series '{}' to the last digit",
                name(series),
                name(other)
            ),
            Self::ExchangedSeries { count, of, series, .. } => format!(
                "the pulled readings are below the released ones in {count} of {of} series ({}); friction adds to a pulled load \
                 and takes from a released one",
                excerpt(series, 200)
            ),
            Self::ScatteredWraps { count, least_deg, most_deg, most, .. } => format!(
                "one layout has {count} different angles, from {least_deg:.2} to {most_deg:.2} degrees; at most {most} are \
                 possible, since each is a condition with its own constants"
            ),
            Self::TooFewLoads { last_line, found, needed, .. } => format!(
                "{found} different load(s) above zero in lines 2 to {last_line}; at least {needed} are needed to fit the baseline"
            ),
        }
    }

    fn help(&self) -> String {
        let fixed = match self {
            Self::MissingColumn { .. } => {
                return format!(
                    "name the columns {}; `pinswitch segment` converts raw logs to such a table",
                    COLUMNS.join(", ")
                );
            }
            Self::Cell { help, .. } => return help.clone(),
            Self::Malformed { help, .. } => help,
            Self::Empty { .. } => "write a header line and one line per repetition",
            Self::Session { .. } => "name the sessions in a column session, or leave out one of the files",
            Self::Copied { .. } => "leave out one of the files: a table and its copy are one session",
            Self::Unrelated { .. } => {
                "check the sign and the unit of both columns, and the load cell's cable"
            }
            Self::SwappedColumns { .. } => {
                "swap the two names in line 1, or correct the program that wrote the table"
            }
            Self::SwappedDirections { .. } => {
                "swap the words concentric and eccentric, or load_N and force_N if these are swapped"
            }
            Self::NoFriction { .. } => {
                "check that force_N is the load cell behind the switch, and not a copy of load_N"
            }
            Self::LoadUnit { .. } => {
                "convert the loads to newtons (kilograms x 9.80665), and leave load_mass_g empty if it is unknown"
            }
            Self::ImplausibleLoads { .. } => {
                "give newtons: divide grams by 101.97, multiply kilonewtons by 1000"
            }
            Self::ReadingUnit { .. } => {
                "give both columns in newtons at the tendon, and divide by the ratio of a pulley between tendon and cell"
            }
            Self::WrongSide { .. } => "write the other word, or check load_N",
            Self::MixedSeries { .. } => "give each its own name in column series",
            Self::CopiedSeries { .. } => "leave out the copy: it is not another measurement",
            Self::ExchangedSeries { .. } => {
                "swap the words concentric and eccentric in these series, or leave the series out"
            }
            Self::ScatteredWraps { .. } => "give the nominal angle of each mount",
            Self::TooFewLoads { .. } => {
                "add series with other weights, or with other wrap angles of a plain contact: one load at one angle does not \
                 determine how friction grows"
            }
        };
        fixed.to_owned()
    }
}

impl From<&TableError> for Diagnostic {
    fn from(error: &TableError) -> Self {
        Self::new(error.code(), error.problem()).with_location(error.location()).with_help(error.help())
    }
}

impl From<TableError> for Diagnostic {
    fn from(error: TableError) -> Self {
        Self::from(&error)
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Diagnostic::from(self).fmt(f)
    }
}

impl std::error::Error for TableError {}
