//! A local or network folder: temporary files in the same folder, renames, hard links, and a lock.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::{DestinationError, PARTIAL};

/// A folder with a subfolder for unfinished files.
#[derive(Debug)]
pub struct Folder {
    pub(super) root: PathBuf,
    partial: PathBuf,
    counter: AtomicU64,
}

/// A lock on a destination; dropping it removes the folder for unfinished files.
#[derive(Debug)]
pub struct DestinationLock(Option<LockedFolder>);

/// A locked folder.
#[derive(Debug)]
struct LockedFolder {
    /// Keeps the lock until the folder is removed.
    _file: File,
    partial: PathBuf,
    /// Folders that were created for the lock, the innermost first.
    created: Vec<PathBuf>,
}

impl DestinationLock {
    /// The lock of a destination that needs none.
    #[cfg(feature = "cloud")]
    pub(super) fn unlocked() -> Self {
        Self(None)
    }
}

impl Drop for DestinationLock {
    fn drop(&mut self) {
        if let Some(locked) = &self.0 {
            // The next run removes the remaining files.
            let _ = std::fs::remove_dir_all(&locked.partial);
            for folder in &locked.created {
                // Fails for a folder that is not empty, as intended.
                let _ = std::fs::remove_dir(folder);
            }
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

/// A builder of temporary files with the permissions of ordinary files: temporary files are private
/// by default.
#[cfg(unix)]
pub fn temporary_file() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
    builder
}

/// A builder of temporary files.
#[cfg(not(unix))]
pub fn temporary_file() -> tempfile::Builder<'static, 'static> {
    tempfile::Builder::new()
}

/// Returns whether `path` or a parent of it is a dangling or cyclic symlink; for these, the system
/// reports only that a file exists.
pub fn is_dangling_symlink(path: &Path) -> bool {
    let is_link = |path: &Path| std::fs::symlink_metadata(path).is_ok_and(|file| file.is_symlink());
    path.ancestors().any(|path| is_link(path) && std::fs::metadata(path).is_err())
}

/// Returns the remedy for a file or folder at `path` that cannot be written.
pub fn write_help(path: &Path, error: &std::io::Error) -> &'static str {
    if is_dangling_symlink(path) {
        return "remove it, or give another --out";
    }
    match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
            "a file is in place of a folder: move it away, or give another --out"
        }
        ErrorKind::IsADirectory => "a folder is in place of a file: move it away, or give another --out",
        ErrorKind::WouldBlock => "wait for the other run or end it, or give another --out",
        ErrorKind::NotFound => "create its folder, or give another --out",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "make room, or give another --out",
        ErrorKind::InvalidFilename => "give a shorter --out without characters that the system refuses",
        _ => "give an --out that can be written",
    }
}

impl Folder {
    /// The folder `root`, which need not exist.
    pub(super) fn new(root: &str, partial: &str) -> Self {
        let root = PathBuf::from(root);
        Self { partial: root.join(partial), root, counter: AtomicU64::new(0) }
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
        let diagnosed = DestinationError::new(path.display().to_string(), problem, help, is_refusal);
        DestinationError { is_refusal, ..diagnosed.with_source(error) }
    }

    pub(super) fn get(&self, name: &str) -> std::io::Result<Option<Vec<u8>>> {
        if_exists(std::fs::read(self.root.join(name)))
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
        same_file::is_same_file(self.root.join(one), self.root.join(other)).unwrap_or(false)
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

    /// Locks the folder for one shard, and removes unfinished files of a killed run; `None` if
    /// another process has the lock.
    pub(super) fn lock(&self) -> std::io::Result<Option<DestinationLock>> {
        let exists = |path: &&Path| path.as_os_str().is_empty() || path.exists();
        let created: Vec<_> =
            self.root.ancestors().take_while(|path| !exists(path)).map(Path::to_owned).collect();
        std::fs::create_dir_all(&self.partial)?;
        let path = self.partial.join("lock");
        let file = File::create(&path)?;
        if file.try_lock().is_err() {
            return Ok(None);
        }
        // A run that ended in the meantime has removed the file that was opened here: locking it
        // has no effect.
        let opened = same_file::Handle::from_file(file.try_clone()?)?;
        if same_file::Handle::from_path(&path).ok().as_ref() != Some(&opened) {
            return Ok(None);
        }
        for entry in std::fs::read_dir(&self.partial)?.filter_map(Result::ok) {
            if entry.file_name() != "lock" {
                std::fs::remove_file(entry.path())?;
            }
        }
        Ok(Some(DestinationLock(Some(LockedFolder { _file: file, partial: self.partial.clone(), created }))))
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
