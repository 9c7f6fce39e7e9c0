//! One process writes into a folder at a time: an advisory lock on a file in it, which goes when the process does.

use std::fs::{File, TryLockError};
use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

use super::OURS;

/// Name of the file that is locked.
const LOCK: &str = ".pinswitch-lock";
/// Name of the note on what a run is about to change: it outlives the run that is killed.
pub(super) const JOURNAL: &str = ".pinswitch-journal";

/// How often a folder may vanish under the lock before it is taken for one in which nothing can be made, such as `/proc`.
const MAX_VANISHED: usize = 100;

/// What to do while another process writes into the folder.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Waiting {
    /// Refuse.
    Never,
    /// Wait: for files that are ready, which takes milliseconds.
    UntilFree,
}

/// The lock on a folder. When it is dropped, the folder goes too if the lock has made it and nothing is in it.
#[derive(Debug)]
pub(super) struct FolderLock {
    folder: PathBuf,
    /// Folders that were not there before, the innermost first.
    made: Vec<PathBuf>,
    /// Held until all else is dropped: unlocked by the system when the process ends, however it ends.
    _file: File,
}

impl FolderLock {
    /// Locks `folder`, which is made if need be.
    ///
    /// # Errors
    /// `WouldBlock` if another process holds it; else whatever keeps the lock from being written.
    pub(super) fn take(folder: &Path, waiting: Waiting) -> Result<Self> {
        let (mut made, mut vanished) = (Vec::new(), 0);
        loop {
            made.extend(missing(folder));
            std::fs::create_dir_all(folder)?;
            let path = folder.join(LOCK);
            let file = match File::options().create(true).truncate(false).write(true).open(&path) {
                // Another process has just removed the folder that it had made.
                Err(e) if e.kind() == ErrorKind::NotFound && vanished < MAX_VANISHED => {
                    vanished += 1;
                    continue;
                }
                other => other?,
            };
            match waiting {
                Waiting::Never => match file.try_lock() {
                    Err(TryLockError::WouldBlock) => {
                        let busy = "another run is writing into this folder";
                        return Err(Error::new(ErrorKind::WouldBlock, busy));
                    }
                    Err(TryLockError::Error(e)) => tolerate(e)?,
                    Ok(()) => {}
                },
                Waiting::UntilFree => file.lock().or_else(tolerate)?,
            }
            // The process before may have removed the file after it was opened here: then others lock another one.
            let same = same_file::Handle::from_file(file.try_clone()?)
                .and_then(|held| Ok(held == same_file::Handle::from_path(&path)?));
            if same.unwrap_or(false) {
                return Ok(Self { folder: folder.to_owned(), made, _file: file });
            }
        }
    }

    /// Removes what a dead run has left half written.
    ///
    /// # Errors
    /// If something cannot be removed.
    pub(super) fn sweep(&self) -> Result<()> {
        for entry in std::fs::read_dir(&self.folder)?.filter_map(Result::ok) {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if !name.starts_with(OURS) || name == LOCK || name == JOURNAL {
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
        // Removed while it is held: who opened it meanwhile sees that it is no longer the one in the folder.
        let _ = std::fs::remove_file(self.folder.join(LOCK));
        for folder in &self.made {
            // Only an empty one goes.
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// Some network file systems know no locks: there, nobody is kept out.
fn tolerate(error: Error) -> Result<()> {
    if error.kind() == ErrorKind::Unsupported { Ok(()) } else { Err(error) }
}

/// The folders on the way to `folder` that are not there, the innermost first.
fn missing(folder: &Path) -> Vec<PathBuf> {
    let there = |path: &&Path| path.as_os_str().is_empty() || path.exists();
    folder.ancestors().take_while(|path| !there(path)).map(Path::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_holds_the_folder_and_leaves_no_trace() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("a/b");
        let first = FolderLock::take(&folder, Waiting::Never).unwrap();
        let second = FolderLock::take(&folder, Waiting::Never).unwrap_err();
        assert_eq!(second.kind(), ErrorKind::WouldBlock);
        drop(first);
        assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0);
    }

    #[test]
    fn of_many_at_once_one_writes_at_a_time() {
        let place = tempfile::tempdir().unwrap();
        let (inside, folder) = (std::sync::atomic::AtomicU32::new(0), place.path().join("out"));
        std::fs::create_dir(&folder).unwrap();
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..50 {
                        let lock = FolderLock::take(&folder, Waiting::UntilFree).unwrap();
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
