//! Simulated rigs.

use pinswitch::calibration::ModelFile;
use pinswitch::diagnostic::Diagnostic;
use pinswitch::simulation::{NoisePlan, Plan, next_session, power as detection, simulate as simulate_plan};
use pyo3::prelude::*;

use crate::calibration::{NamedText, vocabulary};
use crate::error::{OrRaise, json};
use crate::task;

/// Reads a plan: a text, or "paper" or "randomised".
fn plan(
    text: Option<NamedText>,
    randomised: bool,
    effects: &[NamedText],
    noise: Option<NamedText>,
) -> Result<(Plan, String), Diagnostic> {
    let vocabulary = vocabulary(effects)?;
    let (mut plan, name) = match text {
        Some((text, name)) => (Plan::parse_among(&text, &name, &vocabulary)?, name),
        None if randomised => (Plan::randomised(), "the randomised plan".to_owned()),
        None => (Plan::default(), "the plan of the paper's rig".to_owned()),
    };
    plan.vocabulary = vocabulary;
    if let Some((text, name)) = noise {
        plan.noise = NoisePlan::from_estimate(ModelFile::parse(&text, &name)?.noise());
    }
    plan.check(&name)?;
    Ok((plan, name))
}

/// Simulates a rig; returns the plateau table, the table without noise, and the plan.
#[pyfunction]
#[pyo3(signature = (text, randomised, acting, effects, noise=None, seed=None, next=false))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn simulate(
    py: Python<'_>,
    text: Option<NamedText>,
    randomised: bool,
    acting: Vec<(String, Vec<f64>)>,
    effects: Vec<NamedText>,
    noise: Option<NamedText>,
    seed: Option<u64>,
    next: bool,
) -> PyResult<(String, String, String)> {
    let simulated = task::run(py, None, move |_| -> Result<_, Diagnostic> {
        let (mut plan, name) = plan(text, randomised, &effects, noise)?;
        plan.seed = seed.unwrap_or(plan.seed);
        for (id, values) in acting {
            plan.add_effect(&id, values);
            plan.check(&format!("effect {id}"))?;
        }
        let session = if next { next_session(&plan) } else { simulate_plan(&plan) };
        session.check(&name)?;
        Ok((session.table(&plan), session.fresh_table(&plan), plan.to_text()?))
    })?;
    simulated.or_raise(py)
}

/// Returns the detection rates of a plan as JSON.
#[pyfunction]
#[pyo3(signature = (text, randomised, effects, noise=None, runs=3))]
pub(crate) fn power(
    py: Python<'_>,
    text: Option<NamedText>,
    randomised: bool,
    effects: Vec<NamedText>,
    noise: Option<NamedText>,
    runs: u64,
) -> PyResult<String> {
    let rates = task::run(py, None, move |_| -> Result<_, Diagnostic> {
        let (plan, _) = plan(text, randomised, &effects, noise)?;
        Ok(detection(&plan, runs))
    })?;
    json(py, &rates.or_raise(py)?)
}
