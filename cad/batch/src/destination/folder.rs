//! A local or network folder: temporary files in the same folder, renames, hard links, and a lock.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use pinswitch_diagnostic::codes;
use pinswitch_store::{FolderLock, LockPolicy, is_dangling_symlink, read_own, temporary_file, write_help};

use super::{DestinationError, PARTIAL};

/// Longest file that is read, in bytes: some times the largest table.
const MAX_FILE: u64 = 4 << 30;

/// A folder with a subfolder for unfinished files.
#[derive(Debug)]
pub struct Folder {
    pub(super) root: PathBuf,
    partial: PathBuf,
    policy: LockPolicy,
    counter: AtomicU64,
}

/// A lock on a destination; dropping it removes the folder for unfinished files.
#[derive(Debug)]
pub struct DestinationLock(Option<FolderLock>);

impl DestinationLock {
    /// The lock of a destination that needs none.
    #[cfg(feature = "cloud")]
    pub(super) fn unlocked() -> Self {
        Self(None)
    }
}

impl Drop for DestinationLock {
    fn drop(&mut self) {
        if let Some(lock) = &self.0 {
            // The next run removes the remaining files. The lock removes the folders that it created.
            let _ = std::fs::remove_dir_all(lock.folder());
        }
    }
}

/// Returns `Ok(None)` for a missing file, or one whose folder is not a folder.
fn if_exists<T>(outcome: std::io::Result<T>) -> std::io::Result<Option<T>> {
    match outcome {
        Ok(value) => Ok(Some(value)),
        Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => Ok(None),
        Err(e) => Err(e),
    }
}

impl Folder {
    /// The folder `root`, which need not exist.
    pub(super) fn new(root: &str, partial: &str) -> Self {
        let root = PathBuf::from(root);
        Self { partial: root.join(partial), root, policy: LockPolicy::Refuse, counter: AtomicU64::new(0) }
    }

    /// The folder with another policy for the lock.
    pub(super) fn with_lock_policy(self, policy: LockPolicy) -> Self {
        Self { policy, ..self }
    }

    /// The error of a system call on file `name`; an empty name is the folder itself.
    pub(super) fn error(&self, name: &str, error: std::io::Error) -> DestinationError {
        self.error_of("cannot use the path", name, error)
    }

    /// The error of a system call that writes file `name`; an empty name is the folder itself.
    pub(super) fn write_error(&self, name: &str, error: std::io::Error) -> DestinationError {
        self.error_of("cannot write", name, error)
    }

    fn error_of(&self, failed: &str, name: &str, error: std::io::Error) -> DestinationError {
        use ErrorKind::{PermissionDenied, QuotaExceeded, ReadOnlyFilesystem, StorageFull};
        let is_refusal =
            matches!(error.kind(), PermissionDenied | QuotaExceeded | ReadOnlyFilesystem | StorageFull);
        let path = if name.is_empty() { self.root.clone() } else { self.root.join(name) };
        let problem = if is_dangling_symlink(&path) {
            "the path is a dangling symlink".to_owned()
        } else {
            format!("{failed}: {error}")
        };
        let help = write_help(&path, &error);
        let diagnosed =
            DestinationError::new(codes::CANNOT_WRITE, path.display().to_string(), problem, help, is_refusal);
        DestinationError { is_refusal, ..diagnosed.with_source(error) }
    }

    pub(super) fn get(&self, name: &str) -> std::io::Result<Option<Vec<u8>>> {
        read_own(&self.root.join(name), MAX_FILE)
    }

    pub(super) fn size(&self, name: &str) -> std::io::Result<Option<u64>> {
        Ok(if_exists(std::fs::metadata(self.root.join(name)))?.map(|facts| facts.len()))
    }

    pub(super) fn put(&self, name: &str, bytes: &[u8]) -> std::io::Result<()> {
        let scratch = self.scratch();
        let written = File::create(&scratch).and_then(|mut file| file.write_all(bytes));
        let renamed = written.and_then(|()| rename(&scratch, &self.root.join(name)));
        if renamed.is_err() {
            // Frees space on a full disk.
            let _ = std::fs::remove_file(&scratch);
        }
        renamed
    }

    pub(super) fn link(&self, content: &str, name: &str) -> std::io::Result<()> {
        let (content, target) = (self.root.join(content), self.root.join(name));
        let linked = match std::fs::hard_link(&content, &target) {
            Err(e) if e.kind() == ErrorKind::NotFound => {
                target.parent().map_or(Ok(()), std::fs::create_dir_all)?;
                std::fs::hard_link(&content, &target)
            }
            done => done,
        };
        match linked {
            Err(e) if matches!(e.kind(), ErrorKind::StorageFull | ErrorKind::NotADirectory) => Err(e),
            // An older file exists, the limit of links is reached, or the file system has no hard
            // links.
            Err(_) => {
                let scratch = self.scratch();
                if std::fs::hard_link(&content, &scratch).is_err() {
                    std::fs::copy(&content, &scratch)?;
                }
                rename(&scratch, &target)?;
                // Renaming a link to another link of the same file does nothing, and leaves both.
                let _ = std::fs::remove_file(&scratch);
                Ok(())
            }
            Ok(()) => Ok(()),
        }
    }

    pub(super) fn is_same(&self, one: &str, other: &str) -> bool {
        is_same(&self.root.join(one), &self.root.join(other))
    }

    pub(super) fn local_file(&self) -> std::io::Result<tempfile::NamedTempFile> {
        std::fs::create_dir_all(&self.partial)?;
        temporary_file().tempfile_in(&self.partial)
    }

    pub(super) fn put_file(&self, name: &str, file: tempfile::NamedTempFile) -> std::io::Result<()> {
        let target = self.root.join(name);
        target.parent().map_or(Ok(()), std::fs::create_dir_all)?;
        file.persist(&target).map(drop).map_err(|e| e.error)
    }

    /// Returns whether `name` is a folder; `None` if it does not exist.
    pub(super) fn is_folder(&self, name: &str) -> std::io::Result<Option<bool>> {
        Ok(if_exists(std::fs::metadata(self.root.join(name)))?.map(|facts| facts.is_dir()))
    }

    /// Lists the entries of `folder`, each with whether it is a folder.
    pub(super) fn entries(&self, folder: &str) -> std::io::Result<Vec<(String, bool)>> {
        let Some(entries) = if_exists(std::fs::read_dir(self.root.join(folder)))? else {
            return Ok(Vec::new());
        };
        let named = entries.filter_map(Result::ok);
        Ok(named.map(|e| (e.file_name().to_string_lossy().into_owned(), e.path().is_dir())).collect())
    }

    pub(super) fn folders(&self, folder: &str) -> std::io::Result<Vec<String>> {
        let Some(entries) = if_exists(std::fs::read_dir(self.root.join(folder)))? else {
            return Ok(Vec::new());
        };
        let folders = entries.filter_map(Result::ok).filter(|e| e.path().is_dir());
        Ok(folders.map(|e| e.file_name().to_string_lossy().into_owned()).collect())
    }

    /// Returns whether the folder contains unfinished files at most.
    pub(super) fn is_empty(&self) -> std::io::Result<bool> {
        let entries = match std::fs::read_dir(&self.root) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(true),
            other => other?,
        };
        let mut names = entries.filter_map(Result::ok).map(|e| e.file_name());
        Ok(names.all(|name| name.to_string_lossy().starts_with(PARTIAL)))
    }

    /// Locks the folder for one shard, and removes unfinished files of a killed run.
    pub(super) fn lock(&self) -> std::io::Result<DestinationLock> {
        let lock = FolderLock::take(&self.partial, self.policy)?;
        lock.clear()?;
        Ok(DestinationLock(Some(lock)))
    }

    /// Returns the path of a new unfinished file.
    fn scratch(&self) -> PathBuf {
        self.partial.join(self.counter.fetch_add(1, Ordering::Relaxed).to_string())
    }
}

/// Renames a file, and creates the target's folder if it is missing.
fn rename(scratch: &Path, target: &Path) -> std::io::Result<()> {
    match std::fs::rename(scratch, target) {
        Err(e) if e.kind() == ErrorKind::NotFound => {
            target.parent().map_or(Ok(()), std::fs::create_dir_all)?;
            std::fs::rename(scratch, target)
        }
        done => done,
    }
}

/// Whether two paths are links to one file, which is not opened: it may be a pipe.
#[cfg(unix)]
fn is_same(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |path: &Path| std::fs::metadata(path).ok().map(|facts| (facts.dev(), facts.ino()));
    let one = identity(one);
    one.is_some() && one == identity(other)
}

#[cfg(not(unix))]
fn is_same(one: &Path, other: &Path) -> bool {
    same_file::is_same_file(one, other).unwrap_or(false)
}
