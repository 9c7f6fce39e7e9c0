//! Sweeps of many variants, made in parallel, resumed where they were stopped, on one machine or on many.
//!
//! It knows sweeps, destinations and tables; how a switch is built and predicted it leaves to `pinswitch-switch`.
//!
//! Data flows: sweep file → axes → variants → sets (equal parts once) → rows → table, plots, page.
//!
//! ```
//! use pinswitch_batch::{Shard, Sweep, SweepSource, Variants};
//!
//! let text = r#"
//! [axes]
//! "shell.width_mm" = { from = 13, to = 15, step = 1 }
//! "layout.pins" = [[5, 8, 11], [4, 8, 12]]
//! "#;
//! // SweepSource::read takes a file, with all that it names.
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
//! // A variant is put together when it is asked for; its id says what it is.
//! let third = variants.get(2);
//! assert!(third.id.starts_with("width14_pins5.8.11-") && third.configuration.shell.width_mm == 14.0);
//! // One of four machines makes a block of neighbours.
//! assert_eq!("2/4".parse::<Shard>()?.range(variants.count()), 1..3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`run`] makes them at a [`Destination`]; `cad/examples/sweep.rs` is a whole program. `cad/doc/batch.md` says what a run
//! leaves, how it is resumed and spread over machines, and what it costs.

mod axis;
mod constraint;
mod content;
mod destination;
mod estimate;
mod forecast;
mod gallery;
mod inspect;
mod make;
mod merge;
mod obstacles;
mod page;
mod plots;
mod products;
mod run;
mod seal;
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
pub use constraint::Constraint;
pub use content::{MeshMaker, mesh_file};
#[cfg(feature = "cloud")]
pub use destination::Store;
pub use destination::{
    Destination, DestinationError, DestinationLock, Folder, is_dead_link, remedy_at, temporary_file,
};
pub use estimate::{Estimate, Measured, RefusalGroup, estimate};
pub use make::VariantOutcome;
pub use merge::{MergeError, merge};
pub use obstacles::would_fail;
pub use products::ProductError;
pub use run::{Observer, Options, RunError, ShardStamp, admit, partial_folder, run};
pub use shard::{Shard, ShardError};
pub use source::{Reach, SweepSource, read_at_most};
pub use stamp::{Stamp, StampError};
pub use sweep::{CountedSweep, Sweep};
pub use table::{Cell, Column, ColumnType, Row, Schema};
pub use table_files::{BatchTableError, TableWriter, read_rows};
pub use tally::Tally;
pub use variant::{Variant, Variants};

/// Bytes as lower-case hexadecimal digits.
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
