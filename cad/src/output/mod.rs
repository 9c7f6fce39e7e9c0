//! What a run writes: parts, friction curve, plot and manifest, made in memory and written whole.

mod bill;
mod friction_csv;
mod friction_plot;
mod manifest;
mod set;
mod write;

pub use bill::{Bill, bill_of_materials};
pub use friction_csv::friction_csv;
pub use friction_plot::{PlotError, friction_svg};
pub(crate) use manifest::plain;
pub use manifest::{BatchEntry, Derived, FileEntry, Manifest, derived, manifest, threshold_n};
pub use set::{OutputFile, Set, SetError, curve_of, loads_of, make_set, make_set_with, mesh_file};
pub use write::{WriteError, write_file, write_set};
