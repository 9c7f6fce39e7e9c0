//! Ways to write the values of one field: one file per kind, and its line in the list below. Grids take every value,
//! samples the value at a coordinate.

mod range;

use toml_edit::{Item, Value};

use super::ParameterRef;
use pinswitch_switch::config::ConfigError;

/// A way to write the values of one field.
pub(super) struct ValueKind {
    /// Whether the values are written in this way.
    pub(super) is_written: fn(&Item) -> bool,
    /// All values in their order, for a grid.
    pub(super) every_value: fn(ParameterRef, &Item) -> Result<Series, ConfigError>,
    /// The value at a coordinate, for a sample.
    pub(super) sampler: fn(ParameterRef, &Item) -> Result<Sampler, ConfigError>,
}

/// The value at a coordinate of 0 to 1.
pub(super) type Sampler = Box<dyn Fn(f64) -> Value + Send + Sync>;

/// Values in their order, each put together when it is asked for.
pub(super) struct Series {
    /// How many.
    pub(super) count: u64,
    /// The value of a number below that.
    pub(super) at: Box<dyn Fn(u64) -> Value + Send + Sync>,
}

impl Series {
    fn new(count: u64, at: impl Fn(u64) -> Value + Send + Sync + 'static) -> Self {
        Self { count, at: Box::new(at) }
    }
}

/// Declares the files of the kinds and their list.
macro_rules! value_kinds {
    ($($file:ident;)*) => {
        $(mod $file;)*

        /// Every kind; the first that is written counts.
        const KINDS: &[ValueKind] = &[$($file::KIND),*];
    };
}

value_kinds! {
    list;
    step;
    count;
    span;
}

/// Whether `item` is written as values of any kind, rather than as a table of fields.
pub(super) fn is_written(item: &Item) -> bool {
    KINDS.iter().any(|kind| (kind.is_written)(item))
}

/// The kind in which the values of `field` are written.
///
/// # Errors
/// [`ConfigError`] says how to write a list or a range.
pub(super) fn kind(field: ParameterRef, item: &Item) -> Result<&'static ValueKind, ConfigError> {
    KINDS.iter().find(|kind| (kind.is_written)(item)).ok_or_else(|| range::not_written(field, item))
}
