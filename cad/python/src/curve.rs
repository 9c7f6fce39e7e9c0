//! Friction curves of one configuration.

use numpy::PyArray1;
use pinswitch::calibration::ModelFile;
use pinswitch::diagnostic::{Diagnostic, Location, codes};
use pinswitch::friction::{
    Contact, FrictionCurve, Law, Transition, other_laws, predict as predict_contact, predict_by,
};
use pinswitch::report::friction_svg;
use pinswitch::switch::design::Design;
use pinswitch::switch::documents::friction_csv;
use pinswitch::switch::prediction::loads_n;
use pinswitch_app::calibrated_curve_at;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::config::Configuration;
use crate::error::{OrRaise, json};
use crate::task;

/// A model of a calibration as text, with its name for errors.
pub(crate) type ModelText = (String, String);

/// A curve with those of the other laws.
#[pyclass(module = "pinswitch._pinswitch", frozen)]
pub(crate) struct Curve {
    name: String,
    contact: Contact,
    curve: FrictionCurve,
    others: Vec<FrictionCurve>,
}

impl Curve {
    pub(crate) fn curve(&self) -> &FrictionCurve {
        &self.curve
    }
}

/// Returns the numbers of a curve as arrays.
fn columns<'py>(py: Python<'py>, curve: &FrictionCurve) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    for (name, values) in [
        ("load_n", &curve.load_n),
        ("eccentric_n", &curve.eccentric_n),
        ("concentric_n", &curve.concentric_n),
        ("friction_n", &curve.friction_n),
        ("band_low_n", &curve.band_low_n),
        ("band_high_n", &curve.band_high_n),
        ("silicone_share", &curve.silicone_share),
    ] {
        columns.set_item(name, PyArray1::from_slice(py, values))?;
    }
    Ok(columns)
}

#[pymethods]
impl Curve {
    /// Returns the columns by name.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        columns(py, &self.curve)
    }

    /// Returns law, status and reasons, and the transition or `null`, as JSON.
    fn facts(&self, py: Python<'_>) -> PyResult<String> {
        #[derive(serde::Serialize)]
        struct Facts<'a> {
            law: Law,
            status: pinswitch::friction::PredictionStatus,
            reasons: &'a [String],
            transition: Option<Transition>,
        }
        let FrictionCurve { law, status, reasons, .. } = &self.curve;
        let transition = Transition::of(&self.curve);
        json(py, &Facts { law: *law, status: *status, reasons, transition })
    }

    /// Returns the other laws: name and columns.
    fn other_laws<'py>(&self, py: Python<'py>) -> PyResult<Vec<(&'static str, Bound<'py, PyDict>)>> {
        self.others.iter().map(|curve| Ok((curve.law.as_str(), columns(py, curve)?))).collect()
    }

    /// Returns the figure as SVG.
    fn svg(&self, py: Python<'_>) -> PyResult<String> {
        let drawn = py.detach(|| friction_svg(&self.name, &self.contact, &self.curve, &self.others));
        drawn.map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e)).or_raise(py)
    }

    /// Returns `friction.csv`.
    fn csv(&self) -> String {
        friction_csv(&self.curve)
    }
}

/// Returns a law by name.
pub(crate) fn law_named(name: &str) -> Result<Law, Diagnostic> {
    let known = || Law::predictive().map(Law::as_str).collect::<Vec<_>>().join(", ");
    let law = Law::predictive().find(|law| law.as_str() == name);
    law.ok_or_else(|| {
        Diagnostic::new(codes::UNKNOWN_WORD, "unknown friction law")
            .with_location(Location::field("law", name))
            .with_help(format!("give one of {}", known()))
    })
}

/// Checks loads in newtons: positive, finite and ascending.
fn checked_loads(loads_n: Vec<f64>) -> Result<Vec<f64>, Diagnostic> {
    let refused = |value: String, problem: &str| {
        Diagnostic::new(codes::OUT_OF_RANGE, problem)
            .with_location(Location::field("loads_n", value))
            .with_help("give positive loads in newtons, in ascending order")
    };
    if loads_n.is_empty() {
        return Err(refused("[]".to_owned(), "no load"));
    }
    if let Some(load_n) = loads_n.iter().find(|load_n| !(load_n.is_finite() && **load_n > 0.0)) {
        return Err(refused(load_n.to_string(), "not a positive number"));
    }
    match loads_n.windows(2).find(|pair| pair[1] <= pair[0]) {
        Some(pair) => Err(refused(pair[1].to_string(), "not above the load before it")),
        None => Ok(loads_n),
    }
}

/// Returns the curve of a design at loads in newtons.
pub(crate) fn curve_of(
    design: &Design,
    loads_n: &[f64],
    law: Option<Law>,
    model: Option<&(ModelFile, String)>,
) -> Result<FrictionCurve, Diagnostic> {
    match (model, law) {
        (Some((model, name)), _) => calibrated_curve_at(design, model, name, loads_n),
        (None, Some(law)) => Ok(predict_by(law, design.contact(), loads_n)?),
        (None, None) => Ok(predict_contact(design.contact(), loads_n)),
    }
}

/// Parses a model.
pub(crate) fn parsed_model(model: Option<ModelText>) -> Result<Option<(ModelFile, String)>, Diagnostic> {
    model.map(|(text, name)| Ok((ModelFile::parse(&text, &name)?, name))).transpose()
}

/// Predicts the curve of a configuration.
#[pyfunction]
#[pyo3(signature = (configuration, loads_n=None, law=None, model=None))]
pub(crate) fn predict(
    py: Python<'_>,
    configuration: PyRef<'_, Configuration>,
    loads_n: Option<Vec<f64>>,
    law: Option<String>,
    model: Option<ModelText>,
) -> PyResult<Curve> {
    let configuration = configuration.snapshot();
    let predicted = task::run(py, None, move |_| -> Result<Curve, Diagnostic> {
        let design = configuration.design()?;
        let loads_n = loads_n.map_or_else(|| Ok(self::loads_n(&design)), checked_loads)?;
        let law = law.as_deref().map(law_named).transpose()?;
        let model = parsed_model(model)?;
        let curve = curve_of(&design, &loads_n, law, model.as_ref())?;
        let others = other_laws(curve.law, design.contact(), &loads_n);
        let name = design.configuration().switch.name.to_string();
        Ok(Curve { name, contact: design.contact().clone(), curve, others })
    })?;
    predicted.or_raise(py)
}
