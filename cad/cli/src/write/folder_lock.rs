//! An advisory lock on a folder, through a file in it: one process writes at a time. The system releases the lock when
//! the process ends.

use std::fs::{File, TryLockError};
use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

use super::TEMPORARY_PREFIX;

/// Name of the locked file.
const LOCK_FILE: &str = ".pinswitch-lock";
/// Name of the journal of planned changes, which remains when a run is killed.
pub(super) const JOURNAL: &str = ".pinswitch-journal";

/// Most times that a folder may disappear before it is locked. A folder like `/proc`, in which no file can be created,
/// looks the same.
const MAX_VANISHED: usize = 100;

/// Behaviour while another process writes into the folder.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum LockMode {
    /// Fail at once.
    FailIfBusy,
    /// Wait; files that are ready take milliseconds to write.
    WaitUntilFree,
}

/// A lock on a folder. Dropping it removes the folders that it created, if they are empty.
#[derive(Debug)]
pub(super) struct FolderLock {
    folder: PathBuf,
    /// Folders that the lock created, innermost first.
    created: Vec<PathBuf>,
    /// The open file, dropped last; the system unlocks it when the process ends.
    _file: File,
}

impl FolderLock {
    /// Locks `folder`, which is created if necessary.
    ///
    /// # Errors
    /// `WouldBlock` if another process has locked it; otherwise the error of the file system.
    pub(super) fn take(folder: &Path, mode: LockMode) -> Result<Self> {
        let (mut created, mut vanished) = (Vec::new(), 0);
        loop {
            created.extend(missing(folder));
            std::fs::create_dir_all(folder)?;
            let path = folder.join(LOCK_FILE);
            let file = match File::options().create(true).truncate(false).write(true).open(&path) {
                // Another process has just removed the folder that it created.
                Err(e) if e.kind() == ErrorKind::NotFound && vanished < MAX_VANISHED => {
                    vanished += 1;
                    continue;
                }
                other => other?,
            };
            match mode {
                LockMode::FailIfBusy => match file.try_lock() {
                    Err(TryLockError::WouldBlock) => {
                        let busy = "another run is writing into this folder";
                        return Err(Error::new(ErrorKind::WouldBlock, busy));
                    }
                    Err(TryLockError::Error(e)) => tolerate(e)?,
                    Ok(()) => {}
                },
                LockMode::WaitUntilFree => file.lock().or_else(tolerate)?,
            }
            // The previous process may have removed the file after it was opened here; others then lock a new one.
            let same = same_file::Handle::from_file(file.try_clone()?)
                .and_then(|opened| Ok(opened == same_file::Handle::from_path(&path)?));
            if same.unwrap_or(false) {
                return Ok(Self { folder: folder.to_owned(), created, _file: file });
            }
        }
    }

    /// Removes the unfinished files of killed runs.
    ///
    /// # Errors
    /// The error of the file system.
    pub(super) fn remove_unfinished(&self) -> Result<()> {
        for entry in std::fs::read_dir(&self.folder)?.filter_map(Result::ok) {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if !name.starts_with(TEMPORARY_PREFIX) || name == LOCK_FILE || name == JOURNAL {
                continue;
            }
            if entry.file_type()?.is_dir() {
                std::fs::remove_dir_all(entry.path())?;
            } else {
                std::fs::remove_file(entry.path())?;
            }
        }
        Ok(())
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // Removed while it is locked: a process that opened it in the meantime finds another file in the folder.
        let _ = std::fs::remove_file(self.folder.join(LOCK_FILE));
        for folder in &self.created {
            // This removes only empty folders.
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// Accepts that some network file systems have no locks.
fn tolerate(error: Error) -> Result<()> {
    if error.kind() == ErrorKind::Unsupported { Ok(()) } else { Err(error) }
}

/// Lists the missing folders on the path to `folder`, innermost first.
fn missing(folder: &Path) -> Vec<PathBuf> {
    let exists = |path: &&Path| path.as_os_str().is_empty() || path.exists();
    folder.ancestors().take_while(|path| !exists(path)).map(Path::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_excludes_and_leaves_nothing() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("a/b");
        let first = FolderLock::take(&folder, LockMode::FailIfBusy).unwrap();
        let second = FolderLock::take(&folder, LockMode::FailIfBusy).unwrap_err();
        assert_eq!(second.kind(), ErrorKind::WouldBlock);
        drop(first);
        assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0);
    }

    #[test]
    fn one_process_writes_at_a_time() {
        let place = tempfile::tempdir().unwrap();
        let (inside, folder) = (std::sync::atomic::AtomicU32::new(0), place.path().join("out"));
        std::fs::create_dir(&folder).unwrap();
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..50 {
                        let lock = FolderLock::take(&folder, LockMode::WaitUntilFree).unwrap();
                        assert_eq!(inside.fetch_add(1, std::sync::atomic::Ordering::SeqCst), 0);
                        inside.fetch_sub(1, std::sync::atomic::Ordering::SeqCst);
                        drop(lock);
                    }
                });
            }
        });
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
    }
}
