//! The option `--effects`: files with effects of one's own.

use std::path::PathBuf;

use clap::Args;
use pinswitch_calibration::effects::Vocabulary;

use super::Failure;

/// Files with effects of one's own.
#[derive(Args, Clone, Debug)]
pub(super) struct OwnEffects {
    /// A file with effects of your own, written as formulas (see `pinswitch init effects`); may be repeated.
    #[arg(long = "effects", value_name = "FILE")]
    own_effects: Vec<PathBuf>,
}

impl OwnEffects {
    /// The built-in effects and those of the files, in the order given.
    ///
    /// # Errors
    /// [`Failure::BadInput`] names file, line and column of the first thing that is wrong.
    pub(super) fn vocabulary(&self) -> Result<Vocabulary, Failure> {
        self.own_effects.iter().try_fold(Vocabulary::built_in(), |vocabulary, path| {
            let text = crate::input::read_text_file(path)?;
            vocabulary.read(&text, &path.display().to_string()).map_err(Failure::bad_input)
        })
    }
}
