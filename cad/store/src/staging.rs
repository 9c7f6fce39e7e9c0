//! Staged files of a locked folder, and the steps that give them their names. A process may be killed between any two
//! steps.

use std::io::{ErrorKind, Result};
use std::path::{Path, PathBuf};

use crate::file::stage_at;
use crate::lock::FolderLock;

/// Name of the folder for staged files.
const STAGED: &str = ".pinswitch-staged";
/// Name of the journal of planned changes, which remains when a run is killed.
pub const JOURNAL: &str = ".pinswitch-journal";

/// A locked folder with a place for staged files. Dropping it removes them.
#[derive(Debug)]
pub struct Staging(FolderLock);

/// An atomic change of a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
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
    pub fn target(&self) -> &PathBuf {
        match self {
            Self::Rename { to, .. } => to,
            Self::Remove(path) => path,
        }
    }

    /// Makes the change.
    ///
    /// # Errors
    /// The error of the file system.
    pub fn take(&self) -> Result<()> {
        match self {
            Self::Rename { from, to } => std::fs::rename(from, to),
            Self::Remove(path) => match std::fs::remove_file(path) {
                Err(e) if e.kind() == ErrorKind::NotFound => Ok(()),
                other => other,
            },
        }
    }
}

impl Staging {
    /// Removes the unfinished files of killed runs from a locked folder.
    ///
    /// # Errors
    /// The error of the file system.
    pub fn new(lock: FolderLock) -> Result<Self> {
        lock.remove_unfinished()?;
        Ok(Self(lock))
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        self.0.folder()
    }

    /// Writes the file `name`, a name without folders, with the permissions and the owner of the file that it will
    /// replace. Returns the step that replaces it.
    ///
    /// # Errors
    /// `PermissionDenied` if the file that it would replace is write-protected; the error of the file system.
    pub fn stage(&self, name: &str, bytes: &[u8]) -> Result<Step> {
        let staged = self.folder().join(STAGED);
        std::fs::create_dir_all(&staged)?;
        let (from, to) = (staged.join(name), self.folder().join(name));
        stage_at(&from, &to, bytes)?;
        Ok(Step::Rename { from, to })
    }

    /// Returns the step that removes the file `name`.
    pub fn remove(&self, name: &str) -> Step {
        Step::Remove(self.folder().join(name))
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // The next run removes files that cannot be removed now.
        let _ = self.0.remove_unfinished();
    }
}
