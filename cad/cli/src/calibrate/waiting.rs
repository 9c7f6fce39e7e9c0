//! What a terminal shows while a table is calibrated; in a pipe nothing is shown.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A line that moves until the calibration ends.
pub(super) struct Waiting(ProgressBar);

impl Waiting {
    pub(super) fn new(rows: usize) -> Self {
        let bar = ProgressBar::new_spinner().with_message(format!("{rows} rows"));
        // The form is a constant; if it were wrong, the default form would do.
        if let Ok(style) = ProgressStyle::with_template("{spinner} calibrating {msg}, {elapsed}") {
            bar.set_style(style);
        }
        if log::max_level() < log::LevelFilter::Info {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    /// Takes the line away.
    pub(super) fn end(self) {
        self.0.finish_and_clear();
    }
}
