//! Writes files and sets of files as a whole: staged next to their targets, then renamed.
//!
//! A folder has a lock, so that one process writes at a time. The next run removes the unfinished files of a killed run.

mod record;
mod set_folder;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_store::{LockPolicy, is_dangling_symlink, replace_file, write_help};
use pinswitch_switch::output::OutputFile;

pub(crate) use record::source_of_set_with;
pub use set_folder::{PublishError, SetFolder};

use crate::Failure;
use crate::input::was_read;
pub use crate::provenance::ManifestError;

/// How long this process waits for folders that others write into; set once, from `--wait`.
static LOCK_POLICY: OnceLock<LockPolicy> = OnceLock::new();

/// Longest `--wait`, in seconds: a day.
pub(crate) const MAX_WAIT_S: u64 = 86_400;

/// Lets every later lock of this process wait at most this long.
pub(crate) fn wait_for_locks(seconds: u64) {
    let policy =
        if seconds == 0 { LockPolicy::Refuse } else { LockPolicy::Wait(Duration::from_secs(seconds)) };
    // The first call decides; there is one.
    let _ = LOCK_POLICY.set(policy);
}

/// Returns what this process does while another one writes into a folder.
pub(crate) fn lock_policy() -> LockPolicy {
    LOCK_POLICY.get().copied().unwrap_or(LockPolicy::Refuse)
}

/// A file or folder that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The error of the file system.
    #[error("{}: cannot write: {}", path.display(), reason(path, source))]
    System {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The command has read the file, and would overwrite its input.
    #[error("{}: is an input of this command", .0.display())]
    Input(PathBuf),
    /// The manifest of the folder cannot be extended.
    #[error("{}: cannot extend the manifest", path.display())]
    Manifest {
        /// The manifest.
        path: PathBuf,
        /// Why.
        problem: ManifestError,
    },
}

impl WriteError {
    fn at(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        |source| Self::System { path: path.to_owned(), source }
    }
}

impl From<WriteError> for Diagnostic {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::System { path, source } => {
                let is_busy = source.get_ref().is_some_and(|e| e.is::<pinswitch_store::Busy>());
                let code = if is_busy { codes::FOLDER_IN_USE } else { codes::CANNOT_WRITE };
                let diagnostic = Self::new(code, format!("cannot write: {}", reason(&path, &source)))
                    .with_location(Location::file(path.display().to_string()))
                    .with_help(write_help(&path, &source));
                // An error that was constructed here adds nothing to the reason.
                if source.raw_os_error().is_some() { diagnostic.with_source(source) } else { diagnostic }
            }
            WriteError::Input(path) => Self::new(codes::OUTPUT_IS_INPUT, "is an input of this command")
                .with_location(Location::file(path.display().to_string()))
                .with_help("give another --out"),
            WriteError::Manifest { path, problem } => problem.diagnostic(&path),
        }
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::System { .. } => Self::failed(error),
            WriteError::Input(_) | WriteError::Manifest { .. } => Self::bad_input(error),
        }
    }
}

/// The error of the system for the file or folder at `path`.
pub(crate) fn write_error(path: &Path, source: std::io::Error) -> WriteError {
    WriteError::at(path)(source)
}

/// Describes the obstacle, which the message of the system ("File exists") does not name.
fn reason(path: &Path, error: &std::io::Error) -> String {
    match error.kind() {
        _ if is_dangling_symlink(path) => "the path is a dangling symlink".to_owned(),
        ErrorKind::NotFound => "its folder does not exist".to_owned(),
        ErrorKind::AlreadyExists => "another file has this name".to_owned(),
        _ => error.to_string(),
    }
}

/// Refuses, before anything changes, to replace a folder or an input.
///
/// # Errors
/// [`WriteError`].
pub(crate) fn check_file(path: &Path) -> Result<(), WriteError> {
    if std::fs::symlink_metadata(path).is_ok_and(|existing| existing.is_dir()) {
        return Err(WriteError::at(path)(ErrorKind::IsADirectory.into()));
    }
    if was_read(path) { Err(WriteError::Input(path.to_owned())) } else { Ok(()) }
}

/// Writes `bytes` to `path`. A reader finds the old file or the new one, never a part.
///
/// # Errors
/// [`WriteError`]; the old file is unchanged.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    check_file(path)?;
    replace_file(path, bytes, lock_policy()).map_err(WriteError::at(path))
}

/// Writes all files into `folder`, which is created if necessary. Every file is complete on disk before the first one gets
/// its name. The last file marks the set as complete: it is removed first and renamed last.
///
/// # Errors
/// [`WriteError`] with the path.
pub fn write_set(folder: &Path, files: &[OutputFile]) -> Result<(), WriteError> {
    SetFolder::lock(folder)?.replace(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_switch::documents::SourceEntry;

    #[test]
    fn a_failed_set_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| OutputFile { name: name.to_owned(), bytes: b"new".to_vec() };
        std::fs::write(folder.path().join("a"), "old").unwrap();
        for bad in ["no/such/folder", "..", "", "/x"] {
            let failed = write_set(folder.path(), &[file("a"), file(bad), file("z")]);
            assert!(failed.unwrap_err().to_string().contains("cannot write"));
            assert_eq!(std::fs::read_to_string(folder.path().join("a")).unwrap(), "old");
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        }
        write_set(folder.path(), &[file("a"), file("b")]).unwrap();
        assert_eq!(std::fs::read_to_string(folder.path().join("a")).unwrap(), "new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn obstacles_are_named() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        for (link, target) in [("dangling", "nowhere"), ("looping", "looping")] {
            std::os::unix::fs::symlink(at(target), at(link)).unwrap();
            for out in [at(link), at(link).join("set")] {
                let error = write_set(&out, &[OutputFile::new("a", "new")]).unwrap_err();
                let text = Diagnostic::from(error).to_string();
                assert!(text.contains("a dangling symlink") && text.contains("remove it"), "{text}");
            }
        }
        let text = Diagnostic::from(write_file(&at("no/such.png"), b"new").unwrap_err()).to_string();
        assert!(text.contains("cannot write: its folder does not exist; "), "{text}");
        std::fs::create_dir_all(at("s/manifest.json")).unwrap();
        let error = SetFolder::lock(&at("s")).unwrap().check_source(&SourceEntry::new("x")).unwrap_err();
        let text = Diagnostic::from(error).to_string();
        assert!(text.contains("manifest.json: cannot write") && text.contains("folder"), "{text}");
    }

    #[test]
    fn inputs_are_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let input = folder.path().join("rows.csv");
        std::fs::write(&input, "dear").unwrap();
        crate::input::read_file(&input).unwrap();
        std::fs::create_dir(folder.path().join("sub")).unwrap();
        for name in ["rows.csv", "sub/../rows.csv"] {
            let error =
                Diagnostic::from(write_file(&folder.path().join(name), b"new").unwrap_err()).to_string();
            assert!(error.ends_with("is an input of this command; give another --out"), "{error}");
        }
        let set = [OutputFile::new("a", "new"), OutputFile::new("rows.csv", "new")];
        assert!(matches!(write_set(folder.path(), &set), Err(WriteError::Input(_))));
        assert_eq!(std::fs::read(&input).unwrap(), b"dear");
        assert!(!folder.path().join("a").exists());
    }

    #[test]
    fn unfinished_files_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(".pinswitch-gone.part"), "half").unwrap();
        write_file(&folder.path().join("a"), b"one").unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_file_does_not_replace_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("b")).unwrap();
        let error = write_file(&folder.path().join("b"), b"one").unwrap_err();
        let WriteError::System { path, source } = error else { panic!("{error}") };
        assert_eq!((path, source.kind()), (folder.path().join("b"), ErrorKind::IsADirectory));
    }
}
