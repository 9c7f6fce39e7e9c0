//! Files are written whole or not at all, and so are sets: staged beside their target, then renamed into their names.
//!
//! One process writes into a folder at a time, under a lock. What a run that was killed has left is removed by the next.

mod folder_lock;
mod record;
mod set_folder;
mod steps;

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use pinswitch_batch::{is_dangling_symlink, temporary_file, write_help};
use pinswitch_switch::output::OutputFile;

use folder_lock::{FolderLock, Waiting};
pub(crate) use record::source_of_set_with;
pub use set_folder::{PublishError, SetFolder};

use crate::Failure;
use crate::input::was_read;

/// Beginning of the names of everything that is not there to stay.
const OURS: &str = ".pinswitch-";

/// A file or folder cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The system does not let us.
    #[error("{}: cannot write: {}; {}", path.display(), reason(path, source), write_help(path, source))]
    System {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// This command has read the file: its input would be lost.
    #[error("{}: is read by this very command; give another --out", .0.display())]
    Input(PathBuf),
}

impl WriteError {
    fn at(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        |source| Self::System { path: path.to_owned(), source }
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::System { .. } => Self::failed(error),
            WriteError::Input(_) => Self::bad_input(error),
        }
    }
}

/// What is in the way; what the system says of it ("File exists") would not tell.
fn reason(path: &Path, error: &std::io::Error) -> String {
    match error.kind() {
        _ if is_dangling_symlink(path) => "a link that leads nowhere stands there".to_owned(),
        ErrorKind::NotFound => "the folder for it is not there".to_owned(),
        ErrorKind::AlreadyExists => "something stands there already".to_owned(),
        _ => error.to_string(),
    }
}

/// Before anything changes: neither a folder nor a file that was read may stand where `path` is to be written.
fn refuse_obstacle(path: &Path) -> Result<(), WriteError> {
    if std::fs::symlink_metadata(path).is_ok_and(|there| there.is_dir()) {
        return Err(WriteError::at(path)(ErrorKind::IsADirectory.into()));
    }
    if was_read(path) { Err(WriteError::Input(path.to_owned())) } else { Ok(()) }
}

/// Writes `bytes` to `path`: a reader sees the old file or the new one, never a part of it.
///
/// # Errors
/// [`WriteError`] names the path; the old file is untouched.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    refuse_obstacle(path)?;
    write_whole(path, bytes)
}

/// The same for a file that was read in order to be changed. A link to it stays one: the file that it names is written.
///
/// # Errors
/// As [`write_file`].
pub fn write_back(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let file = if path.is_symlink() { path.canonicalize() } else { Ok(path.to_owned()) };
    write_whole(&file.map_err(WriteError::at(path))?, bytes)
}

fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    match std::fs::metadata(path) {
        Ok(there) if there.is_dir() => return Err(WriteError::at(path)(ErrorKind::IsADirectory.into())),
        // A pipe or a terminal has no old content, and is not replaced by a file.
        Ok(there) if !there.is_file() => return std::fs::write(path, bytes).map_err(WriteError::at(path)),
        _ => {}
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    if !folder.is_dir() {
        return Err(WriteError::at(path)(ErrorKind::NotFound.into()));
    }
    let lock = FolderLock::take(folder, Waiting::UntilFree).map_err(WriteError::at(path))?;
    lock.sweep().map_err(WriteError::at(path))?;
    let mut temporary = temporary_file().prefix(OURS).tempfile_in(folder).map_err(WriteError::at(path))?;
    temporary.write_all(bytes).map_err(WriteError::at(path))?;
    temporary.persist(path).map_err(|e| WriteError::at(path)(e.error))?;
    Ok(())
}

/// Writes all files into `folder`, which is made if need be. Every file is complete on disk before the first takes its
/// name. The last one stands for the whole: it is taken away first and comes back last.
///
/// # Errors
/// [`WriteError`] names the path.
pub fn write_set(folder: &Path, files: &[OutputFile]) -> Result<(), WriteError> {
    SetFolder::wait(folder)?.replace(files)
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
    fn what_is_written_back_through_a_link_is_its_file() {
        let place = tempfile::tempdir().unwrap();
        let [file, link] = ["there/mine.toml", "link.toml"].map(|name| place.path().join(name));
        std::fs::create_dir(place.path().join("there")).unwrap();
        std::fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink("there/mine.toml", &link).unwrap();
        write_back(&link, b"new").unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "new");
        std::fs::remove_file(&file).unwrap();
        let said = write_back(&link, b"new").unwrap_err().to_string();
        assert!(said.contains("leads nowhere"), "{said}");
    }

    #[cfg(unix)]
    #[test]
    fn what_stands_in_the_way_is_named_as_what_it_is() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        for (link, target) in [("dangling", "nowhere"), ("looping", "looping")] {
            std::os::unix::fs::symlink(at(target), at(link)).unwrap();
            for out in [at(link), at(link).join("set")] {
                let said = write_set(&out, &[OutputFile::new("a", "new")]).unwrap_err().to_string();
                assert!(said.contains("a link that leads nowhere") && said.contains("remove it"), "{said}");
            }
        }
        let said = write_file(&at("no/such.png"), b"new").unwrap_err().to_string();
        assert!(said.contains("the folder for it is not there; create its folder"), "{said}");
        std::fs::create_dir_all(at("s/manifest.json")).unwrap();
        let said = SetFolder::lock(&at("s")).unwrap().check_source(&SourceEntry::new("x")).unwrap_err();
        let said = said.to_string();
        assert!(said.contains("manifest.json: cannot write") && said.contains("a folder stands"), "{said}");
    }

    #[test]
    fn what_was_read_is_not_written_over_under_any_name() {
        let folder = tempfile::tempdir().unwrap();
        let input = folder.path().join("rows.csv");
        std::fs::write(&input, "dear").unwrap();
        crate::input::read_file(&input).unwrap();
        std::fs::create_dir(folder.path().join("sub")).unwrap();
        for name in ["rows.csv", "sub/../rows.csv"] {
            let error = write_file(&folder.path().join(name), b"new").unwrap_err().to_string();
            assert!(error.ends_with("is read by this very command; give another --out"), "{error}");
        }
        let set = [OutputFile::new("a", "new"), OutputFile::new("rows.csv", "new")];
        assert!(matches!(write_set(folder.path(), &set), Err(WriteError::Input(_))));
        assert_eq!(std::fs::read(&input).unwrap(), b"dear");
        assert!(!folder.path().join("a").exists());
    }

    #[test]
    fn a_single_file_sweeps_what_a_dead_run_left_and_never_takes_the_place_of_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(".pinswitch-gone"), "half").unwrap();
        write_file(&folder.path().join("a"), b"one").unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        std::fs::create_dir(folder.path().join("b")).unwrap();
        let error = write_file(&folder.path().join("b"), b"one").unwrap_err().to_string();
        assert!(error.contains("a folder is in place of a file"), "{error}");
    }
}
