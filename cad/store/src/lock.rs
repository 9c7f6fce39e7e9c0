//! An advisory lock on a folder, through a file in it: one process writes at a time. The system releases the lock when
//! the process ends.

use std::fmt;
use std::fs::{File, Metadata, TryLockError};
use std::io::{Error, ErrorKind, Read, Result, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use crate::TEMPORARY_PREFIX;
use crate::place::{require_ordinary, require_path, without_waiting};
use crate::staging::LOG;

/// Name of the locked file.
const LOCK_FILE: &str = ".pinswitch-lock";
/// Most times that a folder may disappear before it is locked. A folder like `/proc`, in which no file can be created,
/// looks the same.
const MAX_VANISHED: usize = 100;
/// Interval of attempts to lock a folder that is in use.
const RETRY_INTERVAL: Duration = Duration::from_millis(20);
/// Most attempts to read who has the lock.
const HOLDER_ATTEMPTS: usize = 5;
/// Longest content of a lock file that is read: a process and a time have at most 42 bytes.
const MAX_HOLDER: u64 = 64;

/// Behaviour while another process writes into the folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LockPolicy {
    /// Fail at once.
    Refuse,
    /// Wait at most this long, then fail.
    Wait(Duration),
}

impl LockPolicy {
    /// The policy that also waits as long as `shortest`.
    #[must_use]
    pub fn at_least(self, shortest: Duration) -> Self {
        match self {
            Self::Wait(time) => Self::Wait(time.max(shortest)),
            Self::Refuse => Self::Wait(shortest),
        }
    }

    fn time(self) -> Duration {
        match self {
            Self::Refuse => Duration::ZERO,
            Self::Wait(time) => time,
        }
    }
}

/// The error of a folder that another process has locked; the source of an [`Error`] of kind `WouldBlock`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Busy {
    /// Process that has the lock, and for how long; `None` if it has not written them.
    holder: Option<(u32, Duration)>,
}

impl Busy {
    /// Returns ": process 7, for 3 s", or nothing if it is unknown.
    pub fn holder(&self) -> String {
        self.holder.map_or_else(String::new, |(process, age)| {
            format!(": process {process}, for {} s", age.as_secs())
        })
    }

    /// Reads the holder from the lock file. A process writes its name just after it has locked the file.
    fn of(file: &mut File) -> Self {
        for _ in 0..HOLDER_ATTEMPTS {
            let busy = Self::read(file);
            if busy.holder.is_some() {
                return busy;
            }
            std::thread::sleep(RETRY_INTERVAL);
        }
        Self { holder: None }
    }

    fn read(file: &mut File) -> Self {
        let mut text = String::new();
        let read = file.rewind().and_then(|()| file.take(MAX_HOLDER).read_to_string(&mut text));
        let holder = read.ok().and_then(|_| {
            let (process, start) = text.trim_end().split_once(' ')?;
            let age = seconds().saturating_sub(start.parse().ok()?);
            Some((process.parse().ok()?, Duration::from_secs(age)))
        });
        Self { holder }
    }
}

impl fmt::Display for Busy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "another run is writing into this folder{}", self.holder())
    }
}

impl std::error::Error for Busy {}

/// Seconds since 1970.
fn seconds() -> u64 {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_secs()
}

/// A lock on a folder. Dropping it removes the folders that it created, if they are empty.
#[derive(Debug)]
pub struct FolderLock {
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
    /// `WouldBlock` with [`Busy`] if another process has locked it; `InvalidInput` for an empty path, or if the name
    /// of the lock is taken by a pipe or a device; otherwise the error of the file system.
    pub fn take(folder: &Path, policy: LockPolicy) -> Result<Self> {
        require_path(folder)?;
        let end = Instant::now() + policy.time();
        let (mut created, mut vanished) = (Vec::new(), 0);
        let path = folder.join(LOCK_FILE);
        loop {
            created.extend(missing(folder));
            std::fs::create_dir_all(folder)?;
            let mut file = match open(&path) {
                // Another process has just removed the folder that it created.
                Err(e) if e.kind() == ErrorKind::NotFound && vanished < MAX_VANISHED => {
                    vanished += 1;
                    continue;
                }
                other => other?,
            };
            match file.try_lock() {
                Err(TryLockError::WouldBlock) if Instant::now() < end => {
                    std::thread::sleep(RETRY_INTERVAL);
                    continue;
                }
                Err(TryLockError::WouldBlock) => {
                    return Err(Error::new(ErrorKind::WouldBlock, Busy::of(&mut file)));
                }
                Err(TryLockError::Error(e)) => tolerate(e)?,
                Ok(()) => {}
            }
            // The previous process may have removed the file after it was opened here; others then lock a new one.
            let same = same_file::Handle::from_file(file.try_clone()?)
                .and_then(|opened| Ok(opened == same_file::Handle::from_path(&path)?));
            if same.unwrap_or(false) {
                // Only others' messages need it: a full disk is found when the files are staged.
                let _ = file.set_len(0).and_then(|()| writeln!(file, "{} {}", std::process::id(), seconds()));
                return Ok(Self { folder: folder.to_owned(), created, _file: file });
            }
        }
    }

    /// Returns the locked folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Removes the unfinished files of killed runs, except a log of committed changes.
    ///
    /// # Errors
    /// The error of the file system.
    pub fn remove_unfinished(&self) -> Result<()> {
        self.remove_entries(|name| name.starts_with(TEMPORARY_PREFIX) && name != LOG)
    }

    /// Removes all entries of a folder that contains unfinished files only.
    ///
    /// # Errors
    /// The error of the file system.
    pub fn clear(&self) -> Result<()> {
        self.remove_entries(|_| true)
    }

    fn remove_entries(&self, is_removed: impl Fn(&str) -> bool) -> Result<()> {
        for entry in std::fs::read_dir(&self.folder)?.filter_map(Result::ok) {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if name == LOCK_FILE || !is_removed(&name) {
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

/// Opens the lock file, and creates it if necessary.
fn open(path: &Path) -> Result<File> {
    // The error is that of the folder.
    let ordinary = |facts: &Metadata| {
        require_ordinary(facts).map_err(|e| Error::new(e.kind(), format!("{LOCK_FILE} in it: {e}")))
    };
    if let Ok(facts) = std::fs::symlink_metadata(path) {
        ordinary(&facts)?;
    }
    let file = without_waiting().create(true).truncate(false).read(true).write(true).open(path)?;
    ordinary(&file.metadata()?)?;
    Ok(file)
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
        let first = FolderLock::take(&folder, LockPolicy::Refuse).unwrap();
        let start = Instant::now();
        for policy in [LockPolicy::Refuse, LockPolicy::Wait(Duration::from_millis(200))] {
            let error = FolderLock::take(&folder, policy).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::WouldBlock);
            let text = error.to_string();
            assert!(text.contains(&format!("process {}, for ", std::process::id())), "{text}");
        }
        assert!(start.elapsed() >= Duration::from_millis(200));
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
                    for _ in 0..10 {
                        let policy = LockPolicy::Wait(Duration::from_secs(60));
                        let lock = FolderLock::take(&folder, policy).unwrap();
                        assert_eq!(inside.fetch_add(1, std::sync::atomic::Ordering::SeqCst), 0);
                        inside.fetch_sub(1, std::sync::atomic::Ordering::SeqCst);
                        drop(lock);
                    }
                });
            }
        });
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
    }

    #[test]
    fn an_empty_path_is_refused() {
        let error = FolderLock::take(Path::new(""), LockPolicy::Refuse).unwrap_err();
        assert_eq!(error.to_string(), "the path is empty");
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_under_the_name_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let (cwd, mode) = (rustix::fs::CWD, rustix::fs::Mode::from_raw_mode(0o600));
        let path = folder.path().join(LOCK_FILE);
        rustix::fs::mknodat(cwd, &path, rustix::fs::FileType::Fifo, mode, 0).unwrap();
        let error = FolderLock::take(folder.path(), LockPolicy::Refuse).unwrap_err();
        assert!(error.to_string().contains("not an ordinary file"), "{error}");
    }
}
