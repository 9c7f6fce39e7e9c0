//! Documents of a set: manifest, bill of materials, friction table, and the layout as text.

mod bill;
mod friction_csv;
mod layout;
mod manifest;
mod plate_entry;
mod print_entry;

pub(crate) use bill::{AXLE_NUT_MM, AXLE_WASHER_MM, BEARING_MM};
pub use bill::{Bill, STOP_SCREWS, bill_of_materials};
pub use friction_csv::friction_csv;
pub use layout::layout_text;
pub use manifest::{
    BatchEntry, DerivedDimension, FileEntry, Manifest, PartEntry, SourceEntry, derived, toml_to_json,
};
pub use plate_entry::{PlacedPart, PlateEntry, plate_entries};
pub use print_entry::PrintEntry;
