//! Files of a laboratory, and raw logs.

use std::collections::HashMap;

use pinswitch::calibration::segmentation::{RunPlan, RunSegmentation};
use pinswitch::calibration::table::PlateauTable;
use pinswitch::diagnostic::{Diagnostic, Location, codes};
use pinswitch::import::{Map, Pattern, Source, import_with_pattern};
use pinswitch::report::log_svg;
use pyo3::prelude::*;

use crate::error::{OrRaise, json};
use crate::task;

/// The text of a file and its name in errors.
type NamedText = (String, String);
/// The content of a file and its name in errors.
type NamedBytes = (String, Vec<u8>);

/// Imports files; returns (CSV or `None`, kind, understanding as text, as JSON, map as TOML, questions as JSON).
#[pyfunction]
#[pyo3(signature = (files, map=None, assignments=Vec::new(), pattern=None))]
pub(crate) fn import_files(
    py: Python<'_>,
    files: Vec<NamedBytes>,
    map: Option<NamedText>,
    assignments: Vec<String>,
    pattern: Option<String>,
) -> PyResult<(Option<String>, String, String, String, String)> {
    let imported = task::run(py, None, move |_| -> Result<_, Diagnostic> {
        let mut map = map.map_or_else(|| Ok(Map::default()), |(text, name)| Map::parse(&text, &name))?;
        for assignment in assignments {
            let location = Location::field("set", assignment.clone());
            map.set(&assignment).map_err(|error| error.or_at(&location))?;
        }
        let pattern = pattern.as_deref().map(Pattern::parse).transpose()?;
        let sources: Vec<Source<'_>> = files.iter().map(|(name, bytes)| Source::new(name, bytes)).collect();
        import_with_pattern(&sources, &map, pattern.as_ref())
    })?;
    let imported = imported.or_raise(py)?;
    let understanding = &imported.understanding;
    Ok((
        imported.output.as_ref().map(pinswitch::import::Output::to_csv),
        understanding.kind.to_owned(),
        understanding.to_string(),
        json(py, understanding)?,
        imported.map.to_toml(),
    ))
}

/// Returns the files that the description of a run names: the logs, and the map.
#[pyfunction]
pub(crate) fn run_files(py: Python<'_>, text: &str, file: &str) -> PyResult<(Vec<String>, Option<String>)> {
    let plan = RunPlan::parse(text, file).or_raise(py)?;
    let logs = plan.series.iter().flat_map(|series| series.file_names()).map(str::to_owned).collect();
    Ok((logs, plan.map))
}

/// Segments the logs of a run, by name; returns (plateau table as CSV, report as JSON, summary, figures by name).
#[pyfunction]
#[pyo3(signature = (text, file, logs, map=None, figures=true))]
#[allow(clippy::type_complexity)]
pub(crate) fn segment(
    py: Python<'_>,
    text: String,
    file: String,
    logs: HashMap<String, Vec<u8>>,
    map: Option<NamedText>,
    figures: bool,
) -> PyResult<(String, String, String, Vec<(String, String)>)> {
    let segmented = task::run(py, None, move |_| -> Result<_, Diagnostic> {
        let plan = RunPlan::parse(&text, &file)?;
        let map = map.map(|(text, name)| Map::parse(&text, &name)).transpose()?;
        let (mut run, mut plots) = (RunSegmentation::new(&plan), Vec::new());
        for series in &plan.series {
            let mut of_series = Vec::new();
            for name in series.file_names() {
                let bytes = logs.get(name).ok_or_else(|| {
                    Diagnostic::new(codes::FILE_NOT_FOUND, "the log is missing")
                        .with_location(Location::file(name))
                })?;
                let bytes = match &map {
                    Some(map) => map.read_log(bytes, name)?.to_csv().into_bytes(),
                    None => bytes.clone(),
                };
                of_series.push((bytes, name.to_owned()));
            }
            let (log, segmented) = run.add(series, &of_series)?;
            if figures {
                let svg = log_svg(series.name(), &log, &segmented)
                    .map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))?;
                plots.push((series.name().to_owned(), svg));
            }
        }
        let run = run.finish(&file)?;
        let summary: String = run.report.series.iter().map(|series| format!("{series}\n")).collect();
        Ok((PlateauTable::write(&run.rows), run.report, summary, plots))
    })?;
    let (csv, report, summary, plots) = segmented.or_raise(py)?;
    Ok((csv, json(py, &report)?, summary, plots))
}
