//! Curves of a table of configurations.

use std::collections::BTreeMap;

use numpy::PyArray1;
use pinswitch::batch::{ConfigurationTable, CurveJob, RowOutcome, predict_table};
use pinswitch::diagnostic::Diagnostic;
use pinswitch::friction::{FrictionCurve, Transition};
use pinswitch::store::LockPolicy;
use pinswitch::switch::design::Design;
use pinswitch::switch::prediction::loads_n;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use toml_edit::Value;

use crate::config::Configuration;
use crate::curve::{ModelText, curve_of, law_named, parsed_model};
use crate::error::OrRaise;
use crate::task;
use crate::values::to_python;

/// Columns of numbers, one value per row and load.
#[derive(Default)]
struct Numbers {
    /// Number of lines of each row.
    counts: Vec<i64>,
    load_n: Vec<f64>,
    eccentric_n: Vec<f64>,
    concentric_n: Vec<f64>,
    friction_n: Vec<f64>,
    band_low_n: Vec<f64>,
    band_high_n: Vec<f64>,
    silicone_share: Vec<f64>,
}

impl Numbers {
    fn add(&mut self, curve: &FrictionCurve) {
        self.counts.push(i64::try_from(curve.load_n.len()).unwrap_or_default());
        self.load_n.extend(&curve.load_n);
        self.eccentric_n.extend(&curve.eccentric_n);
        self.concentric_n.extend(&curve.concentric_n);
        self.friction_n.extend(&curve.friction_n);
        self.band_low_n.extend(&curve.band_low_n);
        self.band_high_n.extend(&curve.band_high_n);
        self.silicone_share.extend(&curve.silicone_share);
    }

    /// Adds a line without a curve.
    fn add_empty(&mut self) {
        self.counts.push(1);
        for column in [
            &mut self.load_n,
            &mut self.eccentric_n,
            &mut self.concentric_n,
            &mut self.friction_n,
            &mut self.band_low_n,
            &mut self.band_high_n,
            &mut self.silicone_share,
        ] {
            column.push(f64::NAN);
        }
    }
}

/// Everything about the rows, without Python objects.
struct Predicted {
    fields: Vec<String>,
    values: Vec<Vec<Value>>,
    status: Vec<&'static str>,
    reason: Vec<String>,
    law: Vec<&'static str>,
    trust: Vec<&'static str>,
    threshold_n: Vec<f64>,
    numbers: Numbers,
}

impl Predicted {
    fn new(fields: Vec<String>, rows: Vec<(Vec<Value>, RowOutcome)>) -> Self {
        let mut predicted = Self {
            fields,
            values: Vec::with_capacity(rows.len()),
            status: Vec::new(),
            reason: Vec::new(),
            law: Vec::new(),
            trust: Vec::new(),
            threshold_n: Vec::new(),
            numbers: Numbers::default(),
        };
        for (values, outcome) in rows {
            predicted.values.push(values);
            let (status, error) = match outcome {
                RowOutcome::Predicted(curve) => {
                    let threshold_n = Transition::threshold_n(&curve.load_n, &curve.silicone_share);
                    predicted.add("predicted", String::new(), curve.law.as_str(), curve.status.as_str());
                    predicted.threshold_n.push(threshold_n.unwrap_or(f64::NAN));
                    predicted.numbers.add(&curve);
                    continue;
                }
                RowOutcome::Refused(error) => ("refused", error),
                RowOutcome::Failed(error) => ("failed", error),
            };
            predicted.add(status, error.to_string(), "", "");
            predicted.threshold_n.push(f64::NAN);
            predicted.numbers.add_empty();
        }
        predicted
    }

    fn add(&mut self, status: &'static str, reason: String, law: &'static str, trust: &'static str) {
        self.status.push(status);
        self.reason.push(reason);
        self.law.push(law);
        self.trust.push(trust);
    }

    /// Returns (columns per row, number of lines of each row, columns per line).
    fn into_python<'py>(self, py: Python<'py>) -> PyResult<Columns<'py>> {
        let rows = PyDict::new(py);
        // Equal cells share one Python object: rows of a sweep repeat few values.
        let mut objects: BTreeMap<String, Bound<'py, PyAny>> = BTreeMap::new();
        for (i, field) in self.fields.iter().enumerate() {
            let mut cells = Vec::with_capacity(self.values.len());
            for values in &self.values {
                let Some(value) = values.get(i) else { continue };
                let cell = match value {
                    Value::Array(_) => {
                        let text = value.clone().decorated("", "").to_string();
                        match objects.get(&text) {
                            Some(object) => object.clone(),
                            None => {
                                let object = text.clone().into_pyobject(py)?.into_any();
                                objects.insert(text, object.clone());
                                object
                            }
                        }
                    }
                    other => to_python(py, other)?,
                };
                cells.push(cell);
            }
            rows.set_item(field, cells)?;
        }
        rows.set_item("status", self.status)?;
        rows.set_item("reason", self.reason)?;
        rows.set_item("law", self.law)?;
        rows.set_item("trust", self.trust)?;
        rows.set_item("threshold_N", PyArray1::from_vec(py, self.threshold_n))?;
        let lines = PyDict::new(py);
        for (name, values) in [
            ("load_N", self.numbers.load_n),
            ("eccentric_N", self.numbers.eccentric_n),
            ("concentric_N", self.numbers.concentric_n),
            ("friction_N", self.numbers.friction_n),
            ("band_low_N", self.numbers.band_low_n),
            ("band_high_N", self.numbers.band_high_n),
            ("silicone_share", self.numbers.silicone_share),
        ] {
            lines.set_item(name, PyArray1::from_vec(py, values))?;
        }
        Ok((rows, PyArray1::from_vec(py, self.numbers.counts), lines))
    }
}

/// Columns per row, lines per row, and columns per line.
type Columns<'py> = (Bound<'py, PyDict>, Bound<'py, PyArray1<i64>>, Bound<'py, PyDict>);

/// Predicts the rows of a CSV or Parquet table, each of which changes the configuration.
#[pyfunction]
#[pyo3(signature = (configuration, table, name, law=None, model=None, threads=0, progress=None))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn predict_rows<'py>(
    py: Python<'py>,
    configuration: PyRef<'_, Configuration>,
    table: Vec<u8>,
    name: String,
    law: Option<String>,
    model: Option<ModelText>,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Columns<'py>> {
    let base = configuration.snapshot().values().clone();
    let predicted = task::run(py, progress.as_ref(), move |task| -> Result<Option<Predicted>, Diagnostic> {
        let table = ConfigurationTable::read(table, &name)?;
        let law = law.as_deref().map(law_named).transpose()?;
        let model = parsed_model(model)?;
        let chosen = |design: &Design| curve_of(design, &loads_n(design), law, model.as_ref());
        task.begin(table.count());
        let job = CurveJob {
            table: &table,
            base: &base,
            law: if law.is_some() || model.is_some() { Some((String::new(), &chosen)) } else { None },
            threads,
            policy: LockPolicy::Refuse,
            progress: &|rows| task.add(rows),
        };
        let rows = predict_table(&job, &|| task.is_stopped()).map_err(Diagnostic::from)?;
        let fields = table.fields().iter().map(|field| field.path()).collect();
        Ok(rows.map(|rows| Predicted::new(fields, rows)))
    })?;
    match predicted.or_raise(py)? {
        Some(predicted) => predicted.into_python(py),
        None => Err(pyo3::exceptions::PyKeyboardInterrupt::new_err("stopped")),
    }
}
