//! Calibrations, and their models.

use std::sync::Arc;

use numpy::PyArray1;
use pinswitch::calibration::effects::Vocabulary;
use pinswitch::calibration::evidence::Session;
use pinswitch::calibration::experiment::{Known, RigLimits, propose, write_runs};
use pinswitch::calibration::table::PlateauTable;
use pinswitch::calibration::{
    self as library, Calibration as Found, ModelFile, Report, SessionReport, calibrate as calibrate_rows,
    calibrate_below,
};
use pinswitch::diagnostic::{Diagnostic, codes};
use pinswitch::report::{calibration_files, data_package, run_sheet};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use sha2::{Digest, Sha256};

use crate::error::{OrRaise, json};
use crate::task;

/// Seed of the interval of the expected error, as in the command line.
const SEED: u64 = 1;

/// The text of a file and its name in errors.
pub(crate) type NamedText = (String, String);
/// The content of a file and its name in errors.
type NamedBytes = (String, Vec<u8>);
/// Numbers of a column.
type Column<'py> = Bound<'py, PyArray1<f64>>;

/// Returns the built-in effects with those of files.
pub(crate) fn vocabulary(effects: &[NamedText]) -> Result<Vocabulary, Diagnostic> {
    effects.iter().try_fold(Vocabulary::built_in(), |vocabulary, (name, text)| vocabulary.read(text, name))
}

/// Checks files of effects; returns the ids of all effects, the built-in ones first.
#[pyfunction]
pub(crate) fn check_effects(py: Python<'_>, effects: Vec<NamedText>) -> PyResult<Vec<String>> {
    let vocabulary = py.detach(|| vocabulary(&effects)).or_raise(py)?;
    Ok(vocabulary.effects().map(|effect| effect.id().to_owned()).collect())
}

/// A model file of a calibration.
#[pyclass(module = "pinswitch._pinswitch", frozen)]
pub(crate) struct Model {
    file: ModelFile,
    text: String,
    name: String,
}

impl Model {
    fn new(file: ModelFile, name: &str) -> Result<Self, Diagnostic> {
        Ok(Self { text: file.to_text()?, name: name.to_owned(), file })
    }
}

#[pymethods]
impl Model {
    /// Parses the text of a file.
    #[staticmethod]
    fn parse(py: Python<'_>, text: String, name: String) -> PyResult<Self> {
        let file = py.detach(|| ModelFile::parse(&text, &name)).or_raise(py)?;
        Ok(Self { file, text, name })
    }

    /// Returns the text of the file.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// Returns the name in errors.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Predicts readings and standard deviations of a plateau table in N.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        table: &[u8],
        name: &str,
        fitted_session: bool,
    ) -> PyResult<(Column<'py>, Column<'py>)> {
        let session = if fitted_session { Session::Fitted } else { Session::New };
        let predicted = py.detach(|| -> Result<_, Diagnostic> {
            let table = PlateauTable::read_conditions(table, name)?;
            self.file.predict(&table.rows, session, &self.name)
        });
        let (predicted, sd) = predicted.or_raise(py)?;
        Ok((PyArray1::from_vec(py, predicted), PyArray1::from_vec(py, sd)))
    }

    /// Returns the number of variates of a draw.
    fn dimension(&self) -> usize {
        self.file.constants_drawn()
    }

    /// Returns (name, unit, value) of the constants of a draw; zeros give the fitted ones.
    fn constants(&self, py: Python<'_>, z: Vec<f64>) -> PyResult<Vec<(String, String, f64)>> {
        self.file.drawn_constants(&z, &self.name).or_raise(py)
    }
}

/// A calibration.
#[pyclass(module = "pinswitch._pinswitch", frozen)]
pub(crate) struct Calibration {
    report: Arc<Report>,
    baseline: ModelFile,
    augmented: ModelFile,
    baseline_n: Vec<f64>,
    model_n: Vec<f64>,
    weights: Vec<f64>,
    /// Files of the calibration.
    files: Vec<NamedBytes>,
    table: Arc<PlateauTable>,
    vocabulary: Vocabulary,
    name: String,
}

#[pymethods]
impl Calibration {
    /// Returns `report.json`.
    fn report(&self, py: Python<'_>) -> PyResult<String> {
        json(py, &*self.report)
    }

    /// Returns the best model.
    fn model(&self, py: Python<'_>) -> PyResult<Model> {
        Model::new(self.augmented.clone(), "model.toml").or_raise(py)
    }

    /// Returns the refitted model of the paper.
    fn baseline(&self, py: Python<'_>) -> PyResult<Model> {
        Model::new(self.baseline.clone(), "baseline.toml").or_raise(py)
    }

    /// Returns the columns that `residuals.csv` adds to the table.
    fn residuals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        let readings: Vec<f64> = self.table.rows.iter().map(|row| row.force_n).collect();
        columns.set_item("baseline_N", PyArray1::from_slice(py, &self.baseline_n))?;
        columns.set_item("model_N", PyArray1::from_slice(py, &self.model_n))?;
        columns.set_item("force_N", PyArray1::from_vec(py, readings))?;
        columns.set_item("weight", PyArray1::from_slice(py, &self.weights))?;
        Ok(columns)
    }

    /// Returns the files of the calibration by name.
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for (name, bytes) in &self.files {
            files.set_item(name, PyBytes::new(py, bytes))?;
        }
        Ok(files)
    }

    /// Plans the next session; returns the proposal as JSON, the runs as CSV, and the run sheet as HTML.
    #[pyo3(signature = (minutes, rig=None))]
    fn experiment(
        &self,
        py: Python<'_>,
        minutes: f64,
        rig: Option<NamedText>,
    ) -> PyResult<(String, String, String)> {
        let (report, table) = (Arc::clone(&self.report), Arc::clone(&self.table));
        let model = self.augmented.clone();
        let (vocabulary, name) = (self.vocabulary.clone(), self.name.clone());
        let proposal = task::run(py, None, move |_| -> Result<_, Diagnostic> {
            let rig = rig.map(|(text, name)| RigLimits::parse(&text, &name)).transpose()?;
            let rig = rig.or_else(|| RigLimits::of_plain_table(&table.rows)).unwrap_or_default();
            let known = Known {
                report: &report,
                model: &model,
                rows: &table.rows,
                vocabulary: &vocabulary,
                name: &name,
            };
            let proposal = propose(known, &rig, minutes)?;
            let sheet = run_sheet(&name, &proposal, &rig);
            Ok((proposal, sheet))
        })?;
        let (proposal, sheet) = proposal.or_raise(py)?;
        Ok((json(py, &proposal)?, write_runs(&proposal.runs), sheet))
    }
}

/// Reads and joins tables; also returns their names for errors.
fn joined(tables: &[NamedBytes]) -> Result<(PlateauTable, String), Diagnostic> {
    let read = |(name, bytes): &NamedBytes| Ok((PlateauTable::read(bytes.as_slice(), name)?, name.clone()));
    let mut read = tables.iter().map(read).collect::<Result<Vec<_>, Diagnostic>>()?;
    let name = read.iter().map(|(_, name)| name.as_str()).collect::<Vec<_>>().join(" + ");
    let table = match read.len() {
        0 => return Err(Diagnostic::new(codes::USAGE, "no plateau table").with_help("give at least one")),
        1 => read.remove(0).0,
        _ => PlateauTable::joined(read)?,
    };
    table.require_baseline(&name)?;
    Ok((table, name))
}

/// Returns the name of a table without its folder.
fn title_of(name: &str) -> String {
    name.rsplit(['/', '\\']).next().unwrap_or(name).to_owned()
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Calibrates plateau tables, which are sessions of one rig.
#[pyfunction]
#[pyo3(signature = (tables, effects, fit_below=None))]
pub(crate) fn calibrate(
    py: Python<'_>,
    tables: Vec<NamedBytes>,
    effects: Vec<NamedText>,
    fit_below: Option<f64>,
) -> PyResult<Calibration> {
    let calibrated = task::run(py, None, move |_| -> Result<Calibration, Diagnostic> {
        let vocabulary = vocabulary(&effects)?;
        let sources = tables.iter().map(|(name, bytes)| (title_of(name), sha256(bytes))).collect();
        let (mut table, name) = joined(&tables)?;
        // The results after the first table, the first two, and so on, as the command line reports them.
        let mut sessions = Vec::new();
        for count in 1..tables.len() {
            let (table, name) = joined(&tables[..count])?;
            let found = calibrate_rows(&table.rows, &vocabulary, SEED);
            let found = found.map_err(|error| Diagnostic::from(error).or_in_file(&name))?;
            sessions.push(SessionReport::after(tables[count - 1].0.clone(), &found.report));
        }
        let found: Result<Found, library::CalibrationError> = match fit_below {
            None => calibrate_rows(&table.rows, &vocabulary, SEED),
            Some(share) => {
                let found = calibrate_below(&table.rows, share, &vocabulary, SEED);
                let highest = table.rows.iter().map(|row| row.load_n).fold(0.0, f64::max);
                table.retain(|row| row.load_n <= share * highest);
                found
            }
        };
        let mut found = found.map_err(|error| Diagnostic::from(error).or_in_file(&name))?;
        found.report.ignored_columns = table.ignored_columns();
        if let Some((last, _)) = tables.last().filter(|_| !sessions.is_empty()) {
            sessions.push(SessionReport::after(last.clone(), &found.report));
            found.report.sessions = sessions;
        }
        let title = title_of(&name);
        let mut files = calibration_files(&title, &table, &found)?;
        let report = serde_json::to_string_pretty(&found.report);
        let report = report.map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))?;
        files.push(("report.json".to_owned(), (report + "\n").into_bytes()));
        files.insert(0, data_package(&title, &sources, &files)?);
        Ok(Calibration {
            baseline: ModelFile::new(&found.baseline),
            augmented: ModelFile::new(&found.augmented),
            baseline_n: found.baseline.predicted_n,
            model_n: found.augmented.predicted_n,
            weights: found.evidence.weights(),
            report: Arc::new(found.report),
            files,
            table: Arc::new(table),
            vocabulary,
            name,
        })
    })?;
    calibrated.or_raise(py)
}
