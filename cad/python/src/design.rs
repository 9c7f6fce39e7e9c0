//! Design from a request.

use pinswitch::diagnostic::Diagnostic;
use pinswitch::switch::config::to_toml;
use pinswitch::switch::design_search::{
    Belief, Found, Options, Progress, PublishedPhysics, load_range_n, search,
};
use pinswitch::switch::request::Request;
use pinswitch_app::CalibratedSwitch;
use pyo3::prelude::*;

use crate::config::Configuration;
use crate::curve::{ModelText, parsed_model};
use crate::error::{OrRaise, json};
use crate::task::{self, Task};

/// Passes the progress of a search to a task.
struct Bar<'a>(&'a Task);

impl Progress for Bar<'_> {
    fn begin(&self, _: &'static str, steps: usize) {
        self.0.begin(steps as u64);
    }

    fn step(&self) {
        self.0.add(1);
    }
}

/// Searches designs; returns proposals as JSON and as TOML, the obstacle as JSON or `null`, and the patterns as
/// (threshold, friction, pins).
#[pyfunction]
#[pyo3(signature = (configuration, request, name, model=None, best=5, draws=1000, seed=1, starts=16, progress=None))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)]
pub(crate) fn design(
    py: Python<'_>,
    configuration: PyRef<'_, Configuration>,
    request: String,
    name: String,
    model: Option<ModelText>,
    best: usize,
    draws: usize,
    seed: u64,
    starts: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, Vec<String>, String, Vec<(Option<f64>, f64, Vec<usize>)>)> {
    let configuration = configuration.snapshot();
    let found = task::run(py, progress.as_ref(), move |task| -> Result<Found, Diagnostic> {
        let request = Request::read(&request, &name)?;
        let base = configuration.design()?;
        request.check_loads(load_range_n(base.configuration(), &request))?;
        let model =
            parsed_model(model)?.map(|(model, name)| CalibratedSwitch::new(model, name)).transpose()?;
        let published = PublishedPhysics::default();
        let belief: &dyn Belief = match &model {
            Some(model) => model,
            None => &published,
        };
        let options = Options { best, draws, seed, starts: starts.max(best) };
        Ok(search(&base, &request, belief, options, &Bar(task)))
    })?;
    let found = found.or_raise(py)?;
    let texts = found.proposals.iter().map(|proposal| to_toml(&proposal.configuration)).collect();
    let patterns = found.candidates.into_iter().map(|c| (c.threshold_n, c.friction_n, c.pins)).collect();
    Ok((json(py, &found.proposals)?, texts, json(py, &found.blocked)?, patterns))
}
