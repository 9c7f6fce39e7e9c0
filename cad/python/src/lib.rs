//! The native module of the Python package `pinswitch`.
//!
//! Each function calls the library crates and returns numbers as numpy arrays, and reports as JSON. The Python files
//! next to it add classes, tables and plots. The interpreter lock is released during every computation.

mod arrow;
mod batch;
mod calibration;
mod check;
mod config;
mod curve;
mod design;
mod error;
mod measurements;
mod parts;
mod rows;
mod simulation;
mod task;
mod values;

use pyo3::prelude::*;

/// Fills the module.
#[pymodule]
fn _pinswitch(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<config::Configuration>()?;
    module.add_class::<parts::Parts>()?;
    module.add_class::<curve::Curve>()?;
    module.add_class::<calibration::Calibration>()?;
    module.add_class::<calibration::Model>()?;
    for function in [
        wrap_pyfunction!(arrow::arrow_stream, module)?,
        wrap_pyfunction!(batch::batch, module)?,
        wrap_pyfunction!(calibration::calibrate, module)?,
        wrap_pyfunction!(calibration::check_effects, module)?,
        wrap_pyfunction!(check::check, module)?,
        wrap_pyfunction!(config::parameters, module)?,
        wrap_pyfunction!(config::template_text, module)?,
        wrap_pyfunction!(config::templates, module)?,
        wrap_pyfunction!(curve::predict, module)?,
        wrap_pyfunction!(design::design, module)?,
        wrap_pyfunction!(measurements::import_files, module)?,
        wrap_pyfunction!(measurements::run_files, module)?,
        wrap_pyfunction!(measurements::segment, module)?,
        wrap_pyfunction!(parts::build, module)?,
        wrap_pyfunction!(rows::predict_rows, module)?,
        wrap_pyfunction!(simulation::power, module)?,
        wrap_pyfunction!(simulation::simulate, module)?,
    ] {
        module.add_function(function)?;
    }
    Ok(())
}
