//! Values of parameters in Python and in TOML.

use pinswitch::diagnostic::{Diagnostic, codes};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyList, PyString};
use toml_edit::{Array, Value};

use crate::error::exception;

/// Converts a Python value to TOML.
///
/// # Errors
/// `PinswitchError` for a value that is not a number, a text, a truth value or a sequence of these.
pub(crate) fn to_toml(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if value.is_instance_of::<PyBool>() {
        return Ok(Value::from(value.extract::<bool>()?));
    }
    if value.is_instance_of::<PyString>() {
        return Ok(Value::from(value.extract::<String>()?));
    }
    if !value.is_instance_of::<PyFloat>()
        && let Ok(whole) = value.extract::<i64>()
    {
        return Ok(Value::from(whole));
    }
    if let Ok(real) = value.extract::<f64>() {
        return Ok(Value::from(real));
    }
    let Ok(items) = value.try_iter() else {
        let problem = format!("{} is not a number, a text or a list", value.repr()?);
        return Err(exception(
            value.py(),
            Diagnostic::new(codes::WRONG_TYPE, problem).with_help("give a plain value"),
        ));
    };
    items.map(|item| to_toml(&item?)).collect::<PyResult<Array>>().map(Value::from)
}

/// Converts a TOML value to Python.
pub(crate) fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Boolean(value) => PyBool::new(py, *value.value()).to_owned().into_any(),
        Value::Integer(value) => PyInt::new(py, *value.value()).into_any(),
        Value::Float(value) => PyFloat::new(py, *value.value()).into_any(),
        Value::Array(items) => {
            let items = items.iter().map(|item| to_python(py, item)).collect::<PyResult<Vec<_>>>()?;
            PyList::new(py, items)?.into_any()
        }
        Value::String(value) => PyString::new(py, value.value()).into_any(),
        other => PyString::new(py, other.to_string().trim()).into_any(),
    })
}
