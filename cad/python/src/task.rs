//! Long computations on a thread of their own, so that Ctrl-C and progress reach Python.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pinswitch::diagnostic::{Diagnostic, codes};
use pyo3::prelude::*;

use crate::error::exception;

/// Time between two checks of signals.
const INTERVAL: Duration = Duration::from_millis(50);
/// Stack of the thread in bytes, that of a main thread.
const STACK: usize = 8 << 20;

/// State that a computation shares with the caller.
#[derive(Debug, Default)]
pub(crate) struct Task {
    is_stopped: AtomicBool,
    done: AtomicU64,
    total: AtomicU64,
}

impl Task {
    /// Whether the caller has pressed Ctrl-C.
    pub(crate) fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    /// Sets the number of steps.
    pub(crate) fn begin(&self, total: u64) {
        self.total.store(total, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
    }

    /// Counts finished steps.
    pub(crate) fn add(&self, steps: u64) {
        self.done.fetch_add(steps, Ordering::Relaxed);
    }
}

/// Runs `work` without the interpreter lock. On Ctrl-C raises `KeyboardInterrupt` at once; `work` ends at its next
/// check of the task. Calls `progress(done, total)` while it runs.
///
/// # Errors
/// `KeyboardInterrupt`, an exception of `progress`, and an internal error if `work` panics.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Task) -> T + Send + 'static,
) -> PyResult<T> {
    let task = Arc::new(Task::default());
    let (sender, mut receiver) = channel();
    let of_thread = Arc::clone(&task);
    let panicked = |py| {
        exception(
            py,
            Diagnostic::new(codes::INTERNAL_ERROR, "internal error (panic)").with_help("report the inputs"),
        )
    };
    std::thread::Builder::new().name("pinswitch".to_owned()).stack_size(STACK).spawn(move || {
        // The receiver is gone after Ctrl-C.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(|| work(&of_thread))));
    })?;
    let report = |done: u64| -> PyResult<()> {
        let total = task.total.load(Ordering::Relaxed);
        match progress {
            Some(progress) if total > 0 => progress.call1(py, (done.min(total), total)).map(drop),
            _ => Ok(()),
        }
    };
    let outcome = loop {
        let received;
        (receiver, received) = py.detach(move || {
            let received = receiver.recv_timeout(INTERVAL);
            (receiver, received)
        });
        match received {
            Ok(outcome) => break outcome.map_err(|_| panicked(py)),
            Err(RecvTimeoutError::Disconnected) => break Err(panicked(py)),
            Err(RecvTimeoutError::Timeout) => {
                let outcome = py.check_signals().and_then(|()| report(task.done.load(Ordering::Relaxed)));
                if let Err(error) = outcome {
                    task.is_stopped.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
        }
    };
    let outcome = outcome?;
    report(task.total.load(Ordering::Relaxed))?;
    Ok(outcome)
}
