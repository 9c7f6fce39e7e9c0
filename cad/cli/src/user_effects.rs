//! The option `--effects`: files with user-defined effects.

use std::path::PathBuf;

use clap::Args;
use pinswitch_calibration::effects::Vocabulary;

use super::Failure;

/// Files with user-defined effects.
#[derive(Args, Clone, Debug)]
pub(super) struct UserEffects {
    /// File with user-defined effects, written as formulas (see `pinswitch init effects`); may be repeated.
    #[arg(long = "effects", value_name = "FILE")]
    user_effects: Vec<PathBuf>,
}

impl UserEffects {
    /// Returns the built-in effects and those of the files, in the given order.
    ///
    /// # Errors
    /// [`Failure::bad_input`] with the file, line and column of the first error.
    pub(super) fn vocabulary(&self) -> Result<Vocabulary, Failure> {
        self.user_effects.iter().try_fold(Vocabulary::built_in(), |vocabulary, path| {
            let text = crate::input::read_text_file(path)?;
            vocabulary.read(&text, &path.display().to_string()).map_err(Failure::bad_input)
        })
    }
}
