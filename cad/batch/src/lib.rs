//! Sweeps of many variants, made in parallel, resumed where they were stopped, on one machine or on many.
//!
//! It knows sweeps, destinations and tables; how a switch is built and predicted it leaves to `pinswitch-switch`.
//!
//! Data flows: sweep file → axes → variants → sets (equal parts once) → rows → table, plots, page.

mod axis;
mod constraint;
mod content;
mod destination;
mod estimate;
mod forecast;
mod gallery;
mod make;
mod merge;
mod page;
mod plots;
mod products;
mod run;
mod shard;
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
pub use destination::{Destination, DestinationError, DestinationLock, Folder};
pub use estimate::{Estimate, Measured, RefusalGroup, estimate};
pub use make::Outcome;
pub use merge::{MergeError, merge};
pub use products::ProductError;
pub use run::{Observer, Options, RunError, ShardStamp, partial_folder, run};
pub use shard::{Shard, ShardError};
pub use source::SweepSource;
pub use stamp::{Stamp, StampError};
pub use sweep::Sweep;
pub use table::{Cell, Column, ColumnType, Row, Schema};
pub use table_files::{TableError, TableWriter, read_rows};
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
