//! Diagnostics about the fields of a sweep, and those of other crates at their place in it.

use std::ops::Range;

use pinswitch_diagnostic::{Code, Diagnostic, Location};

/// An error in a field of a sweep; `value` is the value as written.
pub(crate) fn field_error(
    code: Code,
    field: &str,
    value: Option<&str>,
    problem: impl Into<String>,
    help: impl Into<String>,
) -> Diagnostic {
    let value = value.map(|value| value.trim().to_owned());
    let location = Location { field: Some(field.to_owned()), value, ..Location::default() };
    Diagnostic::new(code, problem).with_location(location).with_help(help)
}

/// The same diagnostic at the bytes `span` of `text`, the content of `file`, unless it has a file
/// already.
pub(crate) fn at_span(diagnostic: Diagnostic, file: &str, text: &str, span: Range<usize>) -> Diagnostic {
    let known = diagnostic.location().cloned().unwrap_or_default();
    if known.file.is_some() {
        return diagnostic;
    }
    let location = Location::in_text(file, text, span);
    diagnostic.with_location(Location { field: known.field, value: known.value, ..location })
}

/// Implements `Display`, `Error` and the conversion to a [`Diagnostic`] for an error with the
/// methods `diagnostic` and `cause`.
macro_rules! diagnostic_error {
    ($($error:ty),*) => {$(
        impl std::fmt::Display for $error {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                std::fmt::Display::fmt(&self.diagnostic(), f)
            }
        }

        impl std::error::Error for $error {
            fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
                self.cause()
            }
        }

        impl From<$error> for pinswitch_diagnostic::Diagnostic {
            fn from(error: $error) -> Self {
                error.diagnostic()
            }
        }
    )*};
}
pub(crate) use diagnostic_error;
