//! A line on the terminal while a table is calibrated; nothing in a pipe.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A line that moves until the calibration ends.
pub(super) struct Spinner(ProgressBar);

impl Spinner {
    pub(super) fn new(rows: usize) -> Self {
        let bar = ProgressBar::new_spinner().with_message(format!("{rows} rows"));
        // The template is a constant; an invalid one would leave the default style.
        if let Ok(style) = ProgressStyle::with_template("{spinner} calibrating {msg}, {elapsed}") {
            bar.set_style(style);
        }
        if log::max_level() < log::LevelFilter::Info {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    /// Removes the line.
    pub(super) fn end(self) {
        self.0.finish_and_clear();
    }
}
