//! Errors as Python exceptions.

use pinswitch::diagnostic::{Diagnostic, codes};
use pyo3::prelude::*;

/// Converts a diagnostic to `pinswitch.PinswitchError`, which has its fields as attributes.
pub(crate) fn exception(py: Python<'_>, error: impl Into<Diagnostic>) -> PyErr {
    let diagnostic: Diagnostic = error.into();
    let fields = serde_json::to_string(&diagnostic).unwrap_or_default();
    let made = py
        .import("pinswitch._errors")
        .and_then(|module| module.getattr("from_json"))
        .and_then(|from_json| from_json.call1((fields, diagnostic.render("error"))));
    match made {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// Converts the error of a result.
pub(crate) trait OrRaise<T> {
    /// Returns the value, or raises `pinswitch.PinswitchError`.
    fn or_raise(self, py: Python<'_>) -> PyResult<T>;
}

impl<T, E: Into<Diagnostic>> OrRaise<T> for Result<T, E> {
    fn or_raise(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| exception(py, error))
    }
}

/// Returns a value as JSON.
pub(crate) fn json(py: Python<'_>, value: &impl serde::Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e)).or_raise(py)
}
