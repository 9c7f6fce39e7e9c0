//! Progress of a search, as a bar on a terminal; nothing in a pipe.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use pinswitch_switch::design_search::Progress;

/// Progress bar of the current stage.
pub(super) struct Bar(ProgressBar);

impl Bar {
    pub(super) fn new() -> Self {
        let bar = ProgressBar::new(0);
        // The template is a constant; an invalid one would leave the default style.
        if let Ok(style) = ProgressStyle::with_template("{msg:14} {bar:30} {pos} of {len}, {elapsed}") {
            bar.set_style(style);
        }
        if log::max_level() < log::LevelFilter::Info {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.enable_steady_tick(Duration::from_millis(500));
        Self(bar)
    }

    /// Removes the bar.
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
