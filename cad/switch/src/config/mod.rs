//! Configurations: the parameters of a switch, their ranges, and their TOML.

mod error;
mod name;
pub mod parameter;
mod parameters;
mod read;
mod reference;
mod rewrite;
mod schema;
mod text;

pub(crate) use error::field_location;
pub use error::{ConfigError, ValueError, syntax_error};
pub use name::Name;
pub use parameter::{Choice, Origin};
pub use parameters::{
    CellKind, Configuration, DriveKind, FastenerKind, MouldKind, MouldTable, MountKind, Paper, Projection,
    SlotKind, Slots,
};
pub use pinswitch_diagnostic::{Change, Diagnostic, Location};
pub(crate) use read::shown;
pub use read::{ClampedReading, FieldLocations, assign, read, read_clamped, read_over};
pub use reference::{reference_toml, to_toml};
pub use rewrite::{rewritten, rewritten_fields};
pub(crate) use schema::DIALECT;
pub use schema::closed_object;
pub use schema::json_schema;
pub use text::text;
