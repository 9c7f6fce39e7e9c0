//! Configurations.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use pinswitch::diagnostic::{Diagnostic, Location, codes};
use pinswitch::switch::config::{
    self, Configuration as Parameters, FieldLocations, Name, parameter::Parameter, read_clamped, to_toml,
};
use pinswitch::switch::design::Design;
use pinswitch::switch::{feasibility, templates as switch_templates};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::error::{OrRaise, exception};
use crate::values::{to_python, to_toml as value_to_toml};

/// A configuration. Threads may share it: each call sees the values before or after an assignment.
#[pyclass(module = "pinswitch._pinswitch", frozen)]
#[derive(Debug)]
pub(crate) struct Configuration(Mutex<Snapshot>);

/// The values of a configuration, with the text that they were read from for the location of an error.
#[derive(Clone, Debug)]
pub(crate) struct Snapshot {
    values: Parameters,
    file: Option<String>,
    locations: FieldLocations,
    /// Fields that were set after the text was read.
    assigned: BTreeSet<String>,
}

/// A field with its old value, its new value, and the reason.
type ChangedField = (String, String, String, String);

/// Returns the parameter at `table.key`.
fn parameter(path: &str) -> Result<&'static Parameter<Parameters>, Diagnostic> {
    let find = |path: &str| Parameters::PARAMETERS.iter().find(|parameter| parameter.path() == path);
    find(path).ok_or_else(|| {
        // The error of an assignment names the nearest parameter.
        let error = config::assign(&mut Parameters::default(), &format!("{path}=0")).err();
        error.unwrap_or_else(|| {
            Diagnostic::new(codes::UNKNOWN_FIELD, "unknown field").with_location(Location::field(path, ""))
        })
    })
}

impl Snapshot {
    /// Returns the values.
    pub(crate) fn values(&self) -> &Parameters {
        &self.values
    }

    /// Returns the design.
    ///
    /// # Errors
    /// A diagnostic of the first broken rule, with the line of the field.
    pub(crate) fn design(&self) -> Result<Design, Diagnostic> {
        feasibility::design(self.values.clone()).map_err(|error| self.located(error))
    }

    /// Locates an error in the text, unless its field was set later.
    pub(crate) fn located(&self, error: Diagnostic) -> Diagnostic {
        let field = error.location().and_then(|location| location.field.clone()).unwrap_or_default();
        let Some(file) = self.file.as_ref().filter(|_| !self.assigned.contains(&field)) else { return error };
        error.or_at(self.locations.get(&field).unwrap_or(&Location::file(file)))
    }
}

impl Configuration {
    /// Returns the present values.
    pub(crate) fn snapshot(&self) -> Snapshot {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn of(snapshot: Snapshot) -> Self {
        Self(Mutex::new(snapshot))
    }

    fn without_text(values: Parameters) -> Self {
        let (locations, assigned) = (FieldLocations::default(), BTreeSet::new());
        Self::of(Snapshot { values, file: None, locations, assigned })
    }
}

#[pymethods]
impl Configuration {
    /// Returns the defaults.
    #[new]
    fn new() -> Self {
        Self::without_text(Parameters::default())
    }

    /// Reads a TOML text over a base.
    #[staticmethod]
    #[pyo3(signature = (text, file, base=None))]
    fn read(py: Python<'_>, text: &str, file: &str, base: Option<PyRef<'_, Self>>) -> PyResult<Self> {
        let base = base.map_or_else(Parameters::default, |base| base.snapshot().values);
        let mut reading = read_clamped(base, text, file).or_raise(py)?;
        if let Some(error) = reading.out_of_range.into_iter().next() {
            return Err(exception(py, error));
        }
        if !reading.locations.contains("switch.name") {
            reading.configuration.switch.name = Name::from_file_stem(file);
        }
        Ok(Self::of(Snapshot {
            values: reading.configuration,
            file: Some(file.to_owned()),
            locations: reading.locations,
            assigned: BTreeSet::new(),
        }))
    }

    /// Reads the configuration in a 3MF that pinswitch wrote.
    #[staticmethod]
    fn from_3mf(py: Python<'_>, bytes: &[u8], file: &str) -> PyResult<Self> {
        let package = pinswitch::solid::files::read_three_mf(bytes);
        let package = package.map_err(|e| Diagnostic::from(e).or_in_file(file)).or_raise(py)?;
        let text = package.configuration.ok_or_else(|| {
            Diagnostic::new(codes::OTHER_KIND_OF_FILE, "the 3MF contains no configuration")
                .with_location(Location::file(file))
                .with_help("give a TOML file, or an assembly.3mf that pinswitch wrote")
        });
        Self::read(py, &text.or_raise(py)?, file, None)
    }

    /// Returns the value of a field.
    fn get<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        let parameter = parameter(path).or_raise(py)?;
        to_python(py, &(parameter.get)(&self.snapshot().values))
    }

    /// Sets a field.
    fn set(&self, py: Python<'_>, path: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let parameter = parameter(path).or_raise(py)?;
        let value = value_to_toml(value)?;
        let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let set = (parameter.set)(&mut held.values, &value);
        if set.is_ok() {
            held.assigned.insert(path.to_owned());
        }
        // An exception runs Python, which may wait for another thread.
        drop(held);
        set.map_err(|error| error.in_field(path, value.to_string().trim())).or_raise(py)
    }

    /// Returns the TOML text of the values that differ from the defaults.
    fn to_toml(&self) -> String {
        to_toml(&self.snapshot().values)
    }

    /// Returns a copy.
    fn copy(&self) -> Self {
        Self::of(self.snapshot())
    }

    /// Whether two configurations have the same values.
    fn equals(&self, other: PyRef<'_, Self>) -> bool {
        self.snapshot().values == other.snapshot().values
    }

    /// Checks every rule; returns the warnings.
    fn check(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let snapshot = self.snapshot();
        py.detach(|| snapshot.design())
            .or_raise(py)
            .map(|design| design.warnings().iter().map(ToString::to_string).collect())
    }

    /// Returns the nearest valid configuration, with the changes as (field, old, new, reason).
    fn repaired(&self, py: Python<'_>) -> PyResult<(Self, Vec<ChangedField>)> {
        let snapshot = self.snapshot();
        let proposal = py.detach(|| feasibility::repair(&snapshot.values)).or_raise(py)?;
        let Some(proposal) = proposal else { return Ok((Self::of(snapshot), Vec::new())) };
        let changes = proposal.changes.into_iter().map(|c| (c.field, c.from, c.to, c.reason)).collect();
        Ok((Self::without_text(proposal.configuration), changes))
    }
}

/// Returns every parameter: table, key, unit, range, origin, reason, default.
#[pyfunction]
pub(crate) fn parameters(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let default = Parameters::default();
    let entries = Parameters::PARAMETERS.iter().map(|parameter| {
        let entry = PyDict::new(py);
        entry.set_item("table", parameter.section)?;
        entry.set_item("key", parameter.key)?;
        entry.set_item("unit", parameter.unit())?;
        entry.set_item("range", (parameter.range)())?;
        entry.set_item("origin", parameter.origin.to_string())?;
        entry.set_item("reason", parameter.reason)?;
        entry.set_item("default", to_python(py, &(parameter.get)(&default))?)?;
        Ok(entry)
    });
    PyList::new(py, entries.collect::<PyResult<Vec<_>>>()?)
}

/// Returns the names of the templates.
#[pyfunction]
pub(crate) fn templates() -> Vec<&'static str> {
    switch_templates::names()
}

/// Returns the text of a template.
#[pyfunction]
pub(crate) fn template_text(name: &str) -> Option<String> {
    switch_templates::text(name)
}
