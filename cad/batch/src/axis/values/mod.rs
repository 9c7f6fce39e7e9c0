//! Notations for the values of one field: one file each, with a line in the list below. Grids take
//! every value, samples take the value at a coordinate.

mod range;

use pinswitch_diagnostic::Diagnostic;
use toml_edit::{Item, Value};

use super::ParameterRef;

/// A notation for the values of one field.
pub(super) struct Notation {
    /// Whether the values are in this notation.
    pub(super) matches: fn(&Item) -> bool,
    /// All values in their order, for a grid.
    pub(super) series: fn(ParameterRef, &Item) -> Result<Series, Diagnostic>,
    /// The value at a coordinate, for a sample.
    pub(super) sampler: fn(ParameterRef, &Item) -> Result<Sampler, Diagnostic>,
}

/// The value at a coordinate of 0 to 1.
pub(super) type Sampler = Box<dyn Fn(f64) -> Value + Send + Sync>;

/// Values in their order, each computed on request.
pub(super) struct Series {
    /// Their number.
    pub(super) count: u64,
    /// The value with an index below the count.
    pub(super) at: Box<dyn Fn(u64) -> Value + Send + Sync>,
}

impl Series {
    fn new(count: u64, at: impl Fn(u64) -> Value + Send + Sync + 'static) -> Self {
        Self { count, at: Box::new(at) }
    }
}

/// Declares the files of the notations and their list.
macro_rules! notations {
    ($($file:ident;)*) => {
        $(mod $file;)*

        /// Every notation; the first that matches is used.
        const NOTATIONS: &[Notation] = &[$($file::NOTATION),*];
    };
}

notations! {
    list;
    step;
    count;
    span;
}

/// Returns whether `item` is in a notation for values, rather than a table of fields.
pub(super) fn is_range_or_list(item: &Item) -> bool {
    NOTATIONS.iter().any(|notation| (notation.matches)(item))
}

/// Returns the notation of the values of `field`.
///
/// # Errors
/// An unknown notation, with how to write a list or a range.
pub(super) fn notation(field: ParameterRef, item: &Item) -> Result<&'static Notation, Diagnostic> {
    let found = NOTATIONS.iter().find(|notation| (notation.matches)(item));
    found.ok_or_else(|| range::unknown_notation(field, item))
}
