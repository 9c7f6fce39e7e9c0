//! How far a search has come, as a bar on a terminal; in a pipe nothing is shown.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use pinswitch_switch::design_search::Progress;

/// The bar of the stage that runs.
pub(super) struct Bar(ProgressBar);

impl Bar {
    pub(super) fn new() -> Self {
        let bar = ProgressBar::new(0);
        // The form is a constant; if it were wrong, the default form would do.
        if let Ok(style) = ProgressStyle::with_template("{msg:14} {bar:30} {pos} of {len}, {elapsed}") {
            bar.set_style(style);
        }
        if log::max_level() < log::LevelFilter::Info {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.enable_steady_tick(Duration::from_millis(500));
        Self(bar)
    }

    /// Takes the bar away.
    pub(super) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

impl Progress for Bar {
    fn begin(&self, stage: &'static str, steps: usize) {
        self.0.set_message(stage);
        self.0.set_length(steps as u64);
        self.0.set_position(0);
    }

    fn step(&self) {
        self.0.inc(1);
    }
}
