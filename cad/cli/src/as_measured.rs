//! `--measured`: what was measured on a made switch.

use std::path::PathBuf;

use clap::Args;
use pinswitch_switch::design::Design;
use pinswitch_switch::measured::{Comparison, Measured};

use super::Failure;
use crate::input::read_text_file;

/// The file with the readings of a made switch.
#[derive(Args, Clone, Debug)]
pub(super) struct AsMeasured {
    /// Readings of the made switch (`pinswitch init measured`): the curve is corrected for them. `generate` also
    /// writes MEASURED.md, with what to change; the parts stay those of the configuration.
    #[arg(long, value_name = "TOML", conflicts_with_all = ["law", "model"])]
    measured: Option<PathBuf>,
}

impl AsMeasured {
    /// Returns the made design, and its comparison with the plan; `None` without readings.
    ///
    /// # Errors
    /// [`Failure::bad_input`] for a file that is not of this kind, with its line.
    pub(super) fn of(&self, design: &Design) -> Result<Option<(Design, Comparison)>, Failure> {
        let Some(path) = &self.measured else { return Ok(None) };
        let text = read_text_file(path)?;
        let measured = Measured::read(&text, &path.display().to_string()).map_err(Failure::bad_input)?;
        Ok(Some((measured.apply(design), measured.compare(design))))
    }
}

/// Reports what to do about the differences between a made switch and its plan.
pub(super) fn report(comparison: &Comparison) {
    comparison.advice.iter().for_each(|advice| log::info!("as measured: {advice}"));
}
