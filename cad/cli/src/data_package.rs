//! `datapackage.json` of a folder: whether it is ours.

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_report::DATA_PACKAGE;

use crate::Failure;
use crate::write::SetFolder;

/// Returns whether the folder contains a descriptor that `command` wrote.
///
/// # Errors
/// [`Failure`] of another descriptor: repositories take this name only, so that it may be a person's own, or one of ours with
/// authors and licence added.
pub(crate) fn has_own_descriptor(folder: &SetFolder, command: &str) -> Result<bool, Failure> {
    if folder.existing(DATA_PACKAGE)?.is_none() {
        return Ok(false);
    }
    if folder.written_by(command)?.iter().any(|name| name == DATA_PACKAGE) {
        return Ok(true);
    }
    let path = folder.folder().join(DATA_PACKAGE);
    Err(Failure::bad_input(
        Diagnostic::new(codes::FILE_IN_THE_WAY, "pinswitch did not write this file, or it was changed since")
            .with_location(Location::file(path.display().to_string()))
            .with_help("give another folder with --out, or move the file away"),
    ))
}
