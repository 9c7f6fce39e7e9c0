//! A folder of this machine, or of a network: temporary files beside the batch, renames, hard links, and a lock.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::{DestinationError, PARTIAL};

/// A folder, with a folder inside it for files that are not yet whole.
#[derive(Debug)]
pub struct Folder {
    pub(super) root: PathBuf,
    partial: PathBuf,
    counter: AtomicU64,
}

/// A lock on a destination; dropping it removes the folder for unfinished files.
#[derive(Debug)]
pub struct DestinationLock(Option<HeldFolder>);

/// A locked folder.
#[derive(Debug)]
struct HeldFolder {
    /// Held until all else is dropped.
    _file: File,
    partial: PathBuf,
    /// Folders that were made for the lock, the innermost first.
    made: Vec<PathBuf>,
}

impl DestinationLock {
    #[cfg(feature = "cloud")]
    /// For a destination that needs none.
    pub(super) fn not_needed() -> Self {
        Self(None)
    }
}

impl Drop for DestinationLock {
    fn drop(&mut self) {
        if let Some(held) = &self.0 {
            // What cannot be removed is removed by the next run.
            let _ = std::fs::remove_dir_all(&held.partial);
            for folder in &held.made {
                // Only an empty one goes.
                let _ = std::fs::remove_dir(folder);
            }
        }
    }
}

/// `Ok(None)` for a missing file, or one whose folder is something else.
fn found<T>(outcome: std::io::Result<T>) -> std::io::Result<Option<T>> {
    match outcome {
        Ok(value) => Ok(Some(value)),
        Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => Ok(None),
        Err(e) => Err(e),
    }
}

/// Temporary files are private; what takes a name is an ordinary file.
#[cfg(unix)]
pub fn temporary_file() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
    builder
}

/// What takes a name is an ordinary file.
#[cfg(not(unix))]
pub fn temporary_file() -> tempfile::Builder<'static, 'static> {
    tempfile::Builder::new()
}

/// Whether `path` is, or lies in, a link that leads nowhere or to itself: the system says only that something is there.
pub fn is_dead_link(path: &Path) -> bool {
    let is_link = |path: &Path| std::fs::symlink_metadata(path).is_ok_and(|there| there.is_symlink());
    path.ancestors().any(|path| is_link(path) && std::fs::metadata(path).is_err())
}

/// What to do about the file or folder at `path`, which cannot be written.
pub fn remedy_at(path: &Path, error: &std::io::Error) -> &'static str {
    if is_dead_link(path) { "remove it, or give another --out" } else { remedy(error) }
}

pub(crate) fn remedy(error: &std::io::Error) -> &'static str {
    match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
            "a file stands where a folder must be: move it away, or give another --out"
        }
        ErrorKind::IsADirectory => {
            "a folder stands where a file must be: move it away, or give another --out"
        }
        ErrorKind::WouldBlock => "wait for it or end it, or give another --out",
        ErrorKind::NotFound => "make its folder, or give another --out",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "make room, or give another --out",
        ErrorKind::InvalidFilename => "give a shorter --out, without characters that the system refuses",
        _ => "give an --out that can be written",
    }
}

impl Folder {
    /// The folder `root`, whether it is there or not.
    pub(super) fn new(root: &str, partial: &str) -> Self {
        let root = PathBuf::from(root);
        Self { partial: root.join(partial), root, counter: AtomicU64::new(0) }
    }

    pub(super) fn failed(&self, name: &str, error: &std::io::Error) -> DestinationError {
        use ErrorKind::{PermissionDenied, QuotaExceeded, ReadOnlyFilesystem, StorageFull};
        let is_fatal =
            matches!(error.kind(), PermissionDenied | QuotaExceeded | ReadOnlyFilesystem | StorageFull);
        let place = if name.is_empty() { self.root.clone() } else { self.root.join(name) };
        let problem = if is_dead_link(&place) {
            "cannot use it: a link that leads nowhere stands there".to_owned()
        } else {
            format!("cannot use it: {error}")
        };
        let remedy = remedy_at(&place, error);
        DestinationError { place: place.display().to_string(), problem, remedy, is_fatal }
    }

    pub(super) fn get(&self, name: &str) -> std::io::Result<Option<Vec<u8>>> {
        found(std::fs::read(self.root.join(name)))
    }

    pub(super) fn size(&self, name: &str) -> std::io::Result<Option<u64>> {
        Ok(found(std::fs::metadata(self.root.join(name)))?.map(|facts| facts.len()))
    }

    pub(super) fn put(&self, name: &str, bytes: &[u8]) -> std::io::Result<()> {
        let scratch = self.scratch();
        let written = File::create(&scratch).and_then(|mut file| file.write_all(bytes));
        let moved = written.and_then(|()| place(&scratch, &self.root.join(name)));
        if moved.is_err() {
            // On a full disk the space is freed at once.
            let _ = std::fs::remove_file(&scratch);
        }
        moved
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
            // An older file is there, the number of links is at its limit, or the file system has no hard links.
            Err(_) => {
                let scratch = self.scratch();
                if std::fs::hard_link(&content, &scratch).is_err() {
                    std::fs::copy(&content, &scratch)?;
                }
                place(&scratch, &target)?;
                // Renaming a link onto another link of the same file does nothing, and leaves both.
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

    /// Whether `name` is a folder; `None` if there is nothing.
    pub(super) fn is_folder(&self, name: &str) -> std::io::Result<Option<bool>> {
        Ok(found(std::fs::metadata(self.root.join(name)))?.map(|facts| facts.is_dir()))
    }

    /// What stands directly in `folder`, and whether it is a folder.
    pub(super) fn entries(&self, folder: &str) -> std::io::Result<Vec<(String, bool)>> {
        let Some(entries) = found(std::fs::read_dir(self.root.join(folder)))? else { return Ok(Vec::new()) };
        let named = entries.filter_map(Result::ok);
        Ok(named.map(|e| (e.file_name().to_string_lossy().into_owned(), e.path().is_dir())).collect())
    }

    pub(super) fn folders(&self, folder: &str) -> std::io::Result<Vec<String>> {
        let Some(entries) = found(std::fs::read_dir(self.root.join(folder)))? else { return Ok(Vec::new()) };
        let folders = entries.filter_map(Result::ok).filter(|e| e.path().is_dir());
        Ok(folders.map(|e| e.file_name().to_string_lossy().into_owned()).collect())
    }

    /// Whether there is nothing but unfinished files.
    pub(super) fn is_empty(&self) -> std::io::Result<bool> {
        let entries = match std::fs::read_dir(&self.root) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(true),
            other => other?,
        };
        let mut names = entries.filter_map(Result::ok).map(|e| e.file_name());
        Ok(names.all(|name| name.to_string_lossy().starts_with(PARTIAL)))
    }

    /// `None` if another process holds the same shard. Unfinished files of a killed run are removed.
    pub(super) fn lock(&self) -> std::io::Result<Option<DestinationLock>> {
        let there = |path: &&Path| path.as_os_str().is_empty() || path.exists();
        let made: Vec<_> = self.root.ancestors().take_while(|p| !there(p)).map(Path::to_owned).collect();
        std::fs::create_dir_all(&self.partial)?;
        let path = self.partial.join("lock");
        let lock = File::create(&path)?;
        if lock.try_lock().is_err() {
            return Ok(None);
        }
        // A run that ended just now has removed the file that was opened here: it locks nothing any more.
        let held = same_file::Handle::from_file(lock.try_clone()?)?;
        if same_file::Handle::from_path(&path).ok().as_ref() != Some(&held) {
            return Ok(None);
        }
        for entry in std::fs::read_dir(&self.partial)?.filter_map(Result::ok) {
            if entry.file_name() != "lock" {
                std::fs::remove_file(entry.path())?;
            }
        }
        Ok(Some(DestinationLock(Some(HeldFolder { _file: lock, partial: self.partial.clone(), made }))))
    }

    /// A name for a file that is not yet whole.
    fn scratch(&self) -> PathBuf {
        self.partial.join(self.counter.fetch_add(1, Ordering::Relaxed).to_string())
    }
}

/// Renames, and makes the folder only when it turns out to be missing.
fn place(scratch: &Path, target: &Path) -> std::io::Result<()> {
    match std::fs::rename(scratch, target) {
        Err(e) if e.kind() == ErrorKind::NotFound => {
            target.parent().map_or(Ok(()), std::fs::create_dir_all)?;
            std::fs::rename(scratch, target)
        }
        done => done,
    }
}
