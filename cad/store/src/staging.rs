//! Staged files of a locked folder, and their commit: a write-ahead log, as databases have.
//!
//! All files are staged. Then a log of the changes gets its name, which is the commit: from here on the changes are made,
//! by this process or, if it is killed, by the next one that writes or reads in the folder ([`recover`]). Before the
//! commit the folder is the old one, after it the new one.

use std::fs::DirEntry;
use std::io::{Error, ErrorKind, Result};
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

use sha2::{Digest, Sha256};

use crate::TEMPORARY_PREFIX;
use crate::file::{TEMPORARY_SUFFIX, stage_at};
use crate::lock::{FolderLock, LockPolicy};
use crate::place::read_own;

/// Name of the folder for staged files.
const STAGED: &str = ".pinswitch-staged";
/// Name of the log of committed changes, which remains when a run is killed.
pub(crate) const LOG: &str = ".pinswitch-commit";
/// First field of the log.
const LOG_SCHEMA: &str = "pinswitch-commit/1";
/// Longest file that is hashed, in bytes: some times the largest part.
const MAX_HASHED: u64 = 4 << 30;
/// Longest log that is read, in bytes: some times the names of the largest set.
const MAX_LOG: u64 = 16 << 20;
/// Time for which a reader waits for a run that is making its changes.
const READER_TIME: Duration = Duration::from_secs(2);

/// A locked folder with a place for staged files. Dropping it removes them, unless they are committed.
#[derive(Debug)]
pub struct Staging(FolderLock);

/// A change of a file in the folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// The staged file of this name gets its place.
    Rename(String),
    /// The file of this name is removed, if it exists.
    Remove(String),
}

impl Step {
    /// Returns the name of the file.
    pub fn name(&self) -> &str {
        match self {
            Self::Rename(name) | Self::Remove(name) => name,
        }
    }
}

/// Why a commit failed.
#[derive(Debug)]
pub struct CommitError {
    /// Name of the file that cannot be changed; empty for the folder.
    pub name: String,
    /// The error of the file system.
    pub source: Error,
}

impl CommitError {
    fn at(name: &str) -> impl FnOnce(Error) -> Self + '_ {
        |source| Self { name: name.to_owned(), source }
    }
}

impl From<CommitError> for Error {
    fn from(error: CommitError) -> Self {
        error.source
    }
}

/// A change with the SHA-256 of the file before and after it, `None` without a file.
#[derive(Clone, Debug, PartialEq, Eq)]
struct LoggedStep {
    step: Step,
    before: Option<String>,
    after: Option<String>,
}

impl Staging {
    /// Makes the committed changes of a killed run, and removes unfinished files.
    ///
    /// # Errors
    /// `InvalidData` for a log that is not one of pinswitch, or that would change files which pinswitch did not see when
    /// it wrote the log; the error of the file system.
    pub fn new(lock: FolderLock) -> Result<Self> {
        let staging = Self(lock);
        if let Some(log) = read_own(&staging.folder().join(LOG), MAX_LOG)? {
            let invalid =
                |problem: &str| Error::new(ErrorKind::InvalidData, format!("{LOG} in it {problem}"));
            let logged = parse(&log).ok_or_else(|| invalid("is not a log of pinswitch"))?;
            if !staging.is_own(&logged)? {
                return Err(invalid("lists files that have changed since: remove it to keep them"));
            }
            let steps: Vec<Step> = logged.into_iter().map(|logged| logged.step).collect();
            staging.make(&steps)?;
        }
        staging.remove_unfinished()?;
        Ok(staging)
    }

    /// Whether each file that a log names is as it was before the changes or after them, and each staged file as it was
    /// staged. The log of a folder from elsewhere could name other files.
    fn is_own(&self, logged: &[LoggedStep]) -> Result<bool> {
        let staged = self.folder().join(STAGED);
        if std::fs::symlink_metadata(&staged).is_ok_and(|facts| !facts.is_dir()) {
            return Ok(false);
        }
        let known: Vec<&LoggedStep> = logged.iter().collect();
        for LoggedStep { step, after, .. } in logged {
            let now = hash(&self.folder().join(step.name()))?;
            let of_name = || known.iter().filter(|other| other.step.name() == step.name());
            let is_known = now.is_none() || of_name().any(|other| now == other.before || now == other.after);
            let waiting =
                if matches!(step, Step::Rename(_)) { hash(&staged.join(step.name()))? } else { None };
            if !is_known || (waiting.is_some() && waiting != *after) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        self.0.folder()
    }

    /// Writes the file `name` with the permissions and the owner of the file that it will replace.
    /// Returns the step that replaces it.
    ///
    /// # Errors
    /// `InvalidInput` if the name is a path; `PermissionDenied` if the file that it would replace is write-protected;
    /// the error of the file system.
    pub fn stage(&self, name: &str, bytes: &[u8]) -> Result<Step> {
        if !is_plain(name) {
            return Err(ErrorKind::InvalidInput.into());
        }
        let staged = self.folder().join(STAGED);
        std::fs::create_dir_all(&staged)?;
        stage_at(&staged.join(name), &self.folder().join(name), bytes)?;
        Ok(Step::Rename(name.to_owned()))
    }

    /// Makes all changes, in their order: all or, if this process is killed before the commit, none.
    ///
    /// # Errors
    /// [`CommitError`]. If it is at the first change, nothing has changed; later, the next run completes the changes.
    pub fn commit(&self, steps: &[Step]) -> std::result::Result<(), CommitError> {
        self.log(steps)?;
        self.make(steps)
    }

    /// Writes the log.
    fn log(&self, steps: &[Step]) -> std::result::Result<(), CommitError> {
        let staged = self.folder().join(STAGED);
        let logged = |step: &Step| {
            let hash = |path: PathBuf| hash(&path).map_err(CommitError::at(step.name()));
            let after = if matches!(step, Step::Rename(_)) { hash(staged.join(step.name()))? } else { None };
            Ok(LoggedStep { step: step.clone(), before: hash(self.folder().join(step.name()))?, after })
        };
        let logged = steps.iter().map(logged).collect::<std::result::Result<Vec<_>, CommitError>>()?;
        let written = std::fs::create_dir_all(&staged)
            .and_then(|()| std::fs::write(staged.join(LOG), text(&logged)))
            .and_then(|()| std::fs::rename(staged.join(LOG), self.folder().join(LOG)));
        written.map_err(CommitError::at(LOG))
    }

    /// Makes the changes of a log, of which some may have been made, and removes the log.
    fn make(&self, steps: &[Step]) -> std::result::Result<(), CommitError> {
        for (nth, step) in steps.iter().enumerate() {
            let (name, path) = (step.name(), self.folder().join(step.name()));
            let staged = self.folder().join(STAGED).join(name);
            let made = match step {
                Step::Rename(_) => std::fs::rename(&staged, &path),
                // A killed run has removed the old file and put the new one in its place.
                Step::Remove(_) if is_replaced(steps, name) && !staged.exists() => Ok(()),
                Step::Remove(_) => std::fs::remove_file(&path),
            };
            match made {
                // A killed run has made it.
                Err(e) if e.kind() == ErrorKind::NotFound => {}
                Err(e) => {
                    if nth == 0 {
                        let _ = std::fs::remove_file(self.folder().join(LOG));
                    }
                    return Err(CommitError::at(name)(e));
                }
                Ok(()) => {}
            }
        }
        std::fs::remove_file(self.folder().join(LOG)).map_err(CommitError::at(LOG))
    }

    /// Removes the unfinished files of killed runs: temporary and staged ones. Other files stay, whatever their names.
    fn remove_unfinished(&self) -> Result<()> {
        remove_temporaries(self.folder())?;
        let staged = self.folder().join(STAGED);
        match std::fs::symlink_metadata(&staged) {
            Ok(facts) if facts.is_dir() => {
                for entry in std::fs::read_dir(&staged)?.filter_map(Result::ok).filter(is_file) {
                    remove(&entry.path())?;
                }
                // Fails for a folder with folders of a user, as intended; a later run that stages reports it.
                let _ = std::fs::remove_dir(&staged);
                Ok(())
            }
            Ok(_) => remove(&staged),
            Err(_) => Ok(()),
        }
    }
}

/// Removes the temporary files of killed runs from a locked folder.
///
/// # Errors
/// The error of the file system.
pub fn remove_temporaries(folder: &Path) -> Result<()> {
    for entry in std::fs::read_dir(folder)?.filter_map(Result::ok).filter(is_file) {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with(TEMPORARY_PREFIX) && name.ends_with(TEMPORARY_SUFFIX) {
            remove(&entry.path())?;
        }
    }
    Ok(())
}

fn is_file(entry: &DirEntry) -> bool {
    entry.file_type().is_ok_and(|kind| kind.is_file())
}

/// Removes a file, if it exists.
fn remove(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(e) if e.kind() != ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // Committed files are needed by the next run, which also removes files that cannot be removed now.
        if !self.folder().join(LOG).exists() {
            let _ = self.remove_unfinished();
        }
    }
}

/// Makes the changes that a killed run has committed in `folder`, before a file in it is read.
///
/// # Errors
/// `WouldBlock` if a run is making changes for longer than two seconds; the error of the file system.
pub fn recover(folder: &Path) -> Result<()> {
    if !folder.join(LOG).exists() {
        return Ok(());
    }
    FolderLock::take(folder, LockPolicy::Wait(READER_TIME)).and_then(Staging::new).map(drop)
}

/// Whether `name` is a plain file name, not a path.
pub fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    matches!((parts.next(), parts.next()), (Some(Component::Normal(only)), None) if only == name)
}

/// Whether a staged file gets this name.
fn is_replaced(steps: &[Step], name: &str) -> bool {
    steps.iter().any(|step| matches!(step, Step::Rename(renamed) if renamed == name))
}

/// SHA-256 of the file at `path` in hexadecimal digits; `None` if there is none.
fn hash(path: &Path) -> Result<Option<String>> {
    let digits = |bytes: Vec<u8>| Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(read_own(path, MAX_HASHED)?.map(digits))
}

/// The log: fields that end with a zero byte, which no file name contains. A step has four: its kind, the name, and the
/// hashes of the file before and after it, which are empty without a file.
fn text(steps: &[LoggedStep]) -> Vec<u8> {
    let fields = steps.iter().flat_map(|LoggedStep { step, before, after }| {
        let (kind, name) = match step {
            Step::Rename(name) => ("rename", name),
            Step::Remove(name) => ("remove", name),
        };
        [kind, name, before.as_deref().unwrap_or_default(), after.as_deref().unwrap_or_default()]
    });
    std::iter::once(LOG_SCHEMA).chain(fields).flat_map(|field| field.bytes().chain([0])).collect()
}

/// Reads a log; `None` if it is not one, or contains paths.
fn parse(log: &[u8]) -> Option<Vec<LoggedStep>> {
    let mut fields = std::str::from_utf8(log).ok()?.strip_suffix('\0')?.split('\0');
    if fields.next() != Some(LOG_SCHEMA) {
        return None;
    }
    let mut steps = Vec::new();
    while let Some(kind) = fields.next() {
        let name = fields.next().filter(|name| is_plain(name))?.to_owned();
        let step = match kind {
            "rename" => Step::Rename(name),
            "remove" => Step::Remove(name),
            _ => return None,
        };
        let hash = |field: &str| (!field.is_empty()).then(|| field.to_owned());
        let (before, after) = (hash(fields.next()?), hash(fields.next()?));
        steps.push(LoggedStep { step, before, after });
    }
    Some(steps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn open(folder: &Path) -> Staging {
        Staging::new(FolderLock::take(folder, LockPolicy::Refuse).unwrap()).unwrap()
    }

    fn files(folder: &Path) -> BTreeMap<String, String> {
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
        files
            .map(|f| {
                (f.file_name().into_string().unwrap(), std::fs::read_to_string(f.path()).unwrap_or_default())
            })
            .collect()
    }

    /// Replaces `a` and `b`, adds `c`, and removes `gone`.
    fn staged(staging: &Staging) -> Vec<Step> {
        let mut steps = vec![Step::Remove("b".to_owned())];
        steps.extend(["a", "c", "b"].map(|name| staging.stage(name, b"new").unwrap()));
        steps.push(Step::Remove("gone".to_owned()));
        steps
    }

    fn old(folder: &Path) {
        for name in ["a", "b", "gone", "mine"] {
            std::fs::write(folder.join(name), "old").unwrap();
        }
    }

    #[test]
    fn a_killed_commit_is_completed() {
        let pairs = |list: &[(&str, &str)]| -> BTreeMap<String, String> {
            list.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
        };
        let before = pairs(&[("a", "old"), ("b", "old"), ("gone", "old"), ("mine", "old")]);
        let after = pairs(&[("a", "new"), ("b", "new"), ("c", "new"), ("mine", "old")]);
        for made in 0..=6 {
            let place = tempfile::tempdir().unwrap();
            let folder = place.path();
            old(folder);
            {
                let staging = open(folder);
                let steps = staged(&staging);
                // Before the commit, nothing has changed.
                if made == 0 {
                    drop(staging);
                    assert_eq!(files(folder), before);
                    continue;
                }
                staging.log(&steps).unwrap();
                for step in steps.iter().take(made - 1) {
                    let path = folder.join(step.name());
                    match step {
                        Step::Rename(name) => std::fs::rename(folder.join(STAGED).join(name), path).unwrap(),
                        Step::Remove(_) => std::fs::remove_file(path).unwrap(),
                    }
                }
            }
            recover(folder).unwrap();
            assert_eq!(files(folder), after, "after {made} changes");
            recover(folder).unwrap();
        }
        let place = tempfile::tempdir().unwrap();
        old(place.path());
        let staging = open(place.path());
        staging.commit(&staged(&staging)).unwrap();
        drop(staging);
        assert_eq!(files(place.path()), after);
    }

    #[test]
    fn a_foreign_log_changes_nothing() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("in");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(place.path().join("dear"), "dear").unwrap();
        for log in [
            "pinswitch-commit/1\0remove\0../dear\0\0\0",
            "pinswitch-commit/1\0remove\0/etc/x\0\0\0",
            "pinswitch-commit/1\0remove\0a\0",
            "pinswitch-commit/2\0remove\0a\0\0\0",
            "pinswitch-commit/1\0link\0a\0\0\0",
            "",
            "x",
        ] {
            std::fs::write(folder.join(LOG), log).unwrap();
            let error = recover(&folder).unwrap_err();
            assert!(error.to_string().contains("not a log of pinswitch"), "{log:?}: {error}");
        }
        assert!(place.path().join("dear").exists());
    }

    /// A folder from elsewhere cannot make a command remove or replace a file of a user.
    #[cfg(unix)]
    #[test]
    fn a_log_from_elsewhere_changes_no_file() {
        let place = tempfile::tempdir().unwrap();
        let [folder, other] = ["in", "other"].map(|name| place.path().join(name));
        for path in [&folder, &other] {
            std::fs::create_dir(path).unwrap();
            std::fs::write(path.join("dear"), "dear").unwrap();
        }
        let foreign = "0".repeat(64);
        for log in [
            "pinswitch-commit/1\0remove\0dear\0\0\0".to_owned(),
            format!("pinswitch-commit/1\0remove\0dear\0{foreign}\0\0"),
            format!("pinswitch-commit/1\0rename\0dear\0{foreign}\0{foreign}\0"),
        ] {
            for is_linked in [false, true] {
                let staged = folder.join(STAGED);
                if is_linked {
                    std::os::unix::fs::symlink("../other", &staged).unwrap();
                } else {
                    std::fs::create_dir(&staged).unwrap();
                    std::fs::write(staged.join("dear"), "theirs").unwrap();
                }
                std::fs::write(folder.join(LOG), &log).unwrap();
                let error = recover(&folder).unwrap_err();
                assert!(error.to_string().contains("changed since"), "{log:?}: {error}");
                for path in [&folder, &other] {
                    assert_eq!(std::fs::read(path.join("dear")).unwrap(), b"dear", "{log:?}");
                }
                let _ = std::fs::remove_file(&staged);
                let _ = std::fs::remove_dir_all(&staged);
            }
        }
    }

    #[test]
    fn files_of_a_user_with_our_prefix_stay() {
        let place = tempfile::tempdir().unwrap();
        let [notes, backup] = [".pinswitch-notes.txt", ".pinswitch-backup/f"].map(|n| place.path().join(n));
        std::fs::create_dir(place.path().join(".pinswitch-backup")).unwrap();
        std::fs::write(&notes, "dear").unwrap();
        std::fs::write(&backup, "dear").unwrap();
        drop(open(place.path()));
        assert!(notes.exists() && backup.exists());
    }

    #[test]
    fn an_obstacle_at_the_first_change_changes_nothing() {
        let place = tempfile::tempdir().unwrap();
        old(place.path());
        std::fs::create_dir(place.path().join("z")).unwrap();
        let staging = open(place.path());
        let steps = [staging.stage("z", b"new").unwrap(), staging.stage("a", b"new").unwrap()];
        assert_eq!(staging.commit(&steps).unwrap_err().name, "z");
        drop(staging);
        assert_eq!(std::fs::read(place.path().join("a")).unwrap(), b"old");
        assert!(!place.path().join(LOG).exists());
    }
}
