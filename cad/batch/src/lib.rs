//! Sweeps: many variants of a switch, built in parallel on one or many machines, and resumed after
//! an interruption.
//!
//! This crate implements sweeps, destinations and tables; `pinswitch-switch` builds and predicts a
//! switch.
//!
//! Data flow: sweep file → axes → variants → sets (equal parts once) → rows → table, plots, page.
//!
//! | type | content |
//! | --- | --- |
//! | [`SweepSource`] | the texts of a sweep: its file, its base configuration and its rows |
//! | [`Sweep`] | a valid sweep: a base configuration, [axes](SweepAxis) and [constraints](Constraint) |
//! | [`Variants`] | the variants of a sweep, each computed on request |
//! | [`Shard`] | a contiguous block of the variants, for one machine |
//! | [`Destination`] | the folder or object store of a batch |
//! | [`VariantOutcome`] | the outcome of a variant: made, [refused](Refusal) or failed |
//! | [`Tally`] | totals of a batch or shard |
//!
//! ```
//! use pinswitch_batch::{Shard, Sweep, SweepSource, Variants};
//!
//! let text = r#"
//! [axes]
//! "shell.width_mm" = { from = 13, to = 15, step = 1 }
//! "layout.pins" = [[5, 8, 11], [4, 8, 12]]
//! "#;
//! // SweepSource::read reads a file, and the files that it names.
//! let source = SweepSource {
//!     slice: false,
//!     verify: false,
//!     name: "widths".to_owned(),
//!     file: "sweep.toml".to_owned(),
//!     sweep: text.to_owned(),
//!     base: String::new(),
//!     rows: None,
//! };
//! let variants = Variants::new(Sweep::new(&source)?, &source);
//! assert_eq!(variants.count(), 6);
//! // The id of a variant contains its settings.
//! let third = variants.get(2);
//! assert!(third.id.starts_with("width14_pins5.8.11-") && third.configuration.shell.width_mm == 14.0);
//! // One of four machines makes a contiguous block.
//! assert_eq!("2/4".parse::<Shard>()?.range(variants.count()), 1..3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`predict_rows`] predicts the curves of a [`ConfigurationTable`] without making parts;
//! [`predict_table`] does so in memory.
//!
//! [`run`] makes the variants at a [`Destination`]; `cad/examples/sweep.rs` is a complete program.
//! `cad/doc/batch.md` describes the files of a batch, how it is resumed and distributed, and what
//! it costs.
//!
//! Errors convert to a [`Diagnostic`](pinswitch_diagnostic::Diagnostic), and their `Display` is its
//! one-line form.

mod axis;
mod checksum;
mod constraint;
mod content;
mod curves;
mod destination;
mod diagnostics;
mod estimate;
mod gallery;
mod inspect;
mod make;
mod merge;
mod obstructions;
mod page;
mod parallel;
mod plots;
mod prediction_cache;
mod products;
mod run;
mod schema;
mod shard;
mod slicing;
mod source;
mod stamp;
mod sweep;
mod table;
mod table_files;
mod tally;
mod variant;

pub use axis::{Method, ParameterRef, SweepAxis, unit_points};
pub use checksum::{has_valid_checksum, with_checksum};
pub use constraint::{Constraint, Violation};
pub use content::{MeshMaker, mesh_file};
pub use curves::{
    ConfigurationTable, CurveFormat, CurveFunction, CurveJob, CurveOutcome, CurveTableError, CurveTally,
    PredictedRow, RowOutcome, predict_rows, predict_table,
};
#[cfg(feature = "cloud")]
pub use destination::Store;
pub use destination::{Destination, DestinationError, DestinationLock, Folder};
pub use estimate::{Estimate, Measured, RefusalGroup, estimate};
pub use make::{Refusal, VariantOutcome};
pub use merge::{MergeError, merge};
pub use obstructions::obstructed_paths;
pub use products::ProductError;
pub use run::{Observer, Options, RunError, ShardStamp, check_destination, partial_folder, run};
pub use schema::json_schema;
pub use shard::{Shard, ShardError};
pub use source::{Reach, SweepSource};
pub use stamp::{Stamp, StampError};
pub use sweep::{Sweep, UncheckedSweep};
pub use table::{Cell, Column, ColumnType, Row, Schema};
pub use table_files::{BatchTableError, TableWriter, read_rows};
pub use tally::Tally;
pub use variant::{Variant, Variants};

/// Returns bytes as lower-case hexadecimal digits.
fn hexadecimal(bytes: &[u8]) -> String {
    use std::fmt::Write;
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests;
