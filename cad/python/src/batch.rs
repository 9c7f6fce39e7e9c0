//! Sweeps.

use std::path::PathBuf;

use pinswitch::batch::{
    Destination, Observer, Options, Reach, Shard, Sweep, SweepSource, Tally, VariantOutcome, Variants,
    mesh_file, partial_folder, run,
};
use pinswitch::diagnostic::{Diagnostic, Location};
use pyo3::prelude::*;

use crate::error::{OrRaise, json};
use crate::task::{self, Task};

/// Passes the progress of a run to a task, and its stop to the run.
struct Watch<'a>(&'a Task);

impl Observer for Watch<'_> {
    fn variant_done(&self, _: &VariantOutcome) {
        self.0.add(1);
    }

    fn stop_requested(&self) -> bool {
        self.0.is_stopped()
    }
}

/// Makes the variants of a sweep in a folder; returns the totals as JSON.
#[pyfunction]
#[pyo3(signature = (sweep, out, shard=None, threads=0, read_outside=false, progress=None))]
pub(crate) fn batch(
    py: Python<'_>,
    sweep: PathBuf,
    out: String,
    shard: Option<String>,
    threads: usize,
    read_outside: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let tally = task::run(py, progress.as_ref(), move |task| -> Result<Tally, Diagnostic> {
        let at_shard = |text: &str| {
            text.parse::<Shard>()
                .map_err(|e| Diagnostic::from(e).with_location(Location::field("shard", text)))
        };
        let shard = shard.as_deref().map_or(Ok(Shard::WHOLE), at_shard)?;
        let reach = if read_outside { Reach::Anywhere } else { Reach::SweepFolder };
        let source = SweepSource::read_within(&sweep, reach)?;
        let variants = Variants::new(Sweep::new(&source)?, &source);
        let range = shard.range(variants.count());
        task.begin(range.end - range.start);
        let destination = Destination::open(&out, &partial_folder(shard))?;
        let options =
            Options { shard, threads, fail_fast: false, mesh_maker: mesh_file, slicer: None, kernel: None };
        Ok(run(&variants, &source, &destination, options, &Watch(task))?)
    })?;
    json(py, &tally.or_raise(py)?)
}
