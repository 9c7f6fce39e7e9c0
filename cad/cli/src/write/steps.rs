//! The steps that replace the files of a folder. A process may be killed between any two of them.

use std::io::ErrorKind;
use std::path::PathBuf;

/// An atomic change of a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Renames a staged file to its final name.
    Rename {
        /// Path of the staged file.
        from: PathBuf,
        /// Final path.
        to: PathBuf,
    },
    /// Removes a file, if it exists.
    Remove(PathBuf),
}

impl Step {
    /// Returns the final path, or the path that is removed.
    pub(super) fn target(&self) -> &PathBuf {
        match self {
            Self::Rename { to, .. } => to,
            Self::Remove(path) => path,
        }
    }

    /// Makes the change.
    ///
    /// # Errors
    /// The error of the file system.
    pub(super) fn take(&self) -> std::io::Result<()> {
        match self {
            Self::Rename { from, to } => std::fs::rename(from, to),
            Self::Remove(path) => match std::fs::remove_file(path) {
                Err(e) if e.kind() == ErrorKind::NotFound => Ok(()),
                other => other,
            },
        }
    }
}
