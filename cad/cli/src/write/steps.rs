//! The steps in which a folder gets new files. Between any two of them a process may be killed.

use std::io::ErrorKind;
use std::path::PathBuf;

/// One change of a folder, which the file system makes at once or not at all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// A staged file takes its name.
    Rename {
        /// Where it is staged.
        from: PathBuf,
        /// Its name.
        to: PathBuf,
    },
    /// A file goes; it may be gone already.
    Remove(PathBuf),
}

impl Step {
    /// The file whose name is concerned.
    pub(super) fn target(&self) -> &PathBuf {
        match self {
            Self::Rename { to, .. } => to,
            Self::Remove(path) => path,
        }
    }

    /// Makes the change.
    ///
    /// # Errors
    /// The system's.
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
