//! Diagnostic of an unknown name, with the closest known one.

use pinswitch_diagnostic::{Code, Diagnostic};
use pinswitch_formula::NameError;

/// Returns a diagnostic of an unknown name whose help suggests the closest known name, or lists
/// all.
pub(crate) fn unknown_name<'a>(
    code: Code,
    what: &str,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> Diagnostic {
    NameError::unknown(what, name, known).with_code(code).into()
}
