//! What a run writes: parts, friction curve, plot and manifest, made in memory and written whole.

mod bill;
mod contact_plot;
mod formats;
mod friction_csv;
mod friction_plot;
mod guide;
mod manifest;
mod pareto_plot;
mod plot_scale;
mod set;
mod write;

pub use bill::{Bill, bill_of_materials};
pub use contact_plot::contact_svg;
pub use formats::{Format, make_set_in};
pub use friction_csv::friction_csv;
pub use friction_plot::{PlotError, friction_svg};
pub use guide::{Check, checks, printing_guide};
pub(crate) use manifest::plain;
pub use manifest::{BatchEntry, Derived, FileEntry, Manifest, derived, manifest};
pub use pareto_plot::pareto_svg;
pub(crate) use plot_scale::drawable;
pub use set::{
    OutputFile, Set, SetError, curve_of, curves_beside, loads_of, make_set, make_set_with, mesh_file,
};
pub use write::{WriteError, write_file, write_set};
