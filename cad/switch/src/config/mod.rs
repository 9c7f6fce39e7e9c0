//! Configurations: what a user may set, how it is read, and what can be built.

mod error;
mod name;
pub mod parameter;
mod parameters;
mod read;
mod reference;
mod rewrite;
mod text;

pub use error::{ConfigError, Place};
pub use name::Name;
pub use parameter::{Choice, Origin};
pub use parameters::{
    Configuration, FastenerKind, MouldKind, MouldTable, MountKind, Paper, Projection, SlotKind, Slots,
};
pub use read::{Places, assign, read, read_over};
pub use reference::{reference_toml, to_toml};
pub use rewrite::rewritten;
pub use text::text;
