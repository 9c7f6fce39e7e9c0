//! The check of mesh files.

use std::io::Cursor;

use pinswitch::diagnostic::{Diagnostic, codes};
use pinswitch::solid::file_check::{Judgement, Purpose, Verdict};
use pinswitch::solid::validity::{Expectation, Level};
use pyo3::prelude::*;

use crate::error::{OrRaise, exception, json};
use crate::task;

/// Examines a file; returns the verdict as JSON and as text.
#[pyfunction]
#[pyo3(signature = (bytes, name, bodies=None, min_wall_mm=0.4, strict=false, purpose=None))]
pub(crate) fn check(
    py: Python<'_>,
    bytes: Vec<u8>,
    name: String,
    bodies: Option<usize>,
    min_wall_mm: f64,
    strict: bool,
    purpose: Option<&str>,
) -> PyResult<(String, String)> {
    let purpose = match purpose {
        None => None,
        Some("print") => Some(Purpose::Print),
        Some("spec") => Some(Purpose::Spec),
        Some(other) => {
            let error = Diagnostic::new(codes::UNKNOWN_WORD, format!("unknown purpose {other:?}"))
                .with_help("give \"print\" or \"spec\"");
            return Err(exception(py, error));
        }
    };
    if !(min_wall_mm >= 0.0 && min_wall_mm.is_finite()) {
        let error = Diagnostic::new(
            codes::OUT_OF_RANGE,
            format!("min_wall_mm = {min_wall_mm} is not a wall thickness"),
        );
        return Err(exception(py, error.with_help("give 0 or more mm")));
    }
    let level = if strict { Level::Warning } else { Level::Error };
    let verdict = task::run(py, None, move |_| {
        let expected = Expectation { bodies, min_wall_mm, ..Expectation::default() };
        let (length, file) = (bytes.len() as u64, name.clone());
        let judgement = Judgement { purpose, level };
        let verdict = Verdict::read(&mut Cursor::new(bytes), length, name, &expected, judgement);
        verdict.map_err(|error| error.or_in_file(&file))
    })?;
    let verdict = verdict.or_raise(py)?;
    Ok((json(py, &verdict)?, verdict.describe()))
}
