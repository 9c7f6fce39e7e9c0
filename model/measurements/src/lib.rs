//! Measurements of friction: raw logs, and tables of plateaus.
//!
//! 1. [`segmentation`] converts `run.toml` and its logs to the rows of a plateau table.
//! 2. [`table`] reads, checks, joins and writes plateau tables.
//!
//! Readers take text, bytes or [`std::io::Read`], and writers return text: the crate does not open
//! files. `model/doc/file-formats.md` describes the files, `model/doc/glossary.md` the terms.
//!
//! # Examples
//!
//! Errors have the line and the column of the cell, and the way to correct it:
//!
//! ```
//! use pinswitch_measurements::table::PlateauTable;
//!
//! let error = PlateauTable::read("series,substrate\na,wood\n".as_bytes(), "t.csv").unwrap_err();
//! assert!(error.to_string().starts_with("t.csv:1: "), "{error}");
//! ```

#![warn(clippy::disallowed_methods)]

mod correlation;
mod median;
pub mod segmentation;
pub mod table;
#[cfg(test)]
mod test_session;
mod toml_text;

pub use correlation::{correlation, rank_correlation, ranks};
pub use median::median;
pub use toml_text::{field_location, locate_field, toml_error};
