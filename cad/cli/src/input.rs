//! Reads the files that the user names, and records which were read: no command overwrites its own input.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use pinswitch_diagnostic::{Diagnostic, Location};
use pinswitch_switch::config::text;

use super::Failure;

/// Longest configuration, plan, model or report, in bytes: some hundred times the longest in practice.
const MAX_TEXT: u64 = 16 << 20;
/// Longest 3MF that contains a configuration, in bytes.
const MAX_PACKAGE: u64 = 256 << 20;
/// Longest table or log, in bytes: some million rows.
const MAX_TABLE: u64 = 1 << 30;

/// Reads a text file, such as a configuration, a plan or a model.
///
/// # Errors
/// [`Failure::bad_input`] if the file cannot be read, is too long, or is not UTF-8; the last with the line.
pub(super) fn read_text_file(path: &Path) -> Result<String, Failure> {
    let bytes = read_at_most(path, MAX_TEXT)?;
    text(bytes, &path.display().to_string()).map_err(Failure::bad_input)
}

/// Reads the bytes of a configuration: a text, or the 3MF of a set.
///
/// # Errors
/// [`Failure::bad_input`] if the file cannot be read or is too long.
pub(super) fn read_configuration(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut begin = [0; 2];
    let is_package = path.is_file()
        && File::open(path).and_then(|mut f| f.read_exact(&mut begin)).is_ok()
        && begin == *b"PK";
    read_at_most(path, if is_package { MAX_PACKAGE } else { MAX_TEXT })
}

/// Every file that was read, as a canonical path.
static READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Whether this process has read the file at `path`, through this path or another one.
pub(super) fn was_read(path: &Path) -> bool {
    let Ok(real) = path.canonicalize() else { return false };
    READ.lock().unwrap_or_else(PoisonError::into_inner).contains(&real)
}

/// Reads the bytes of a table or log.
///
/// # Errors
/// [`Failure::bad_input`] if the file cannot be read or is too long.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, Failure> {
    read_at_most(path, MAX_TABLE)
}

/// Reads a file of at most `most` bytes and records it as input. A file without an end, such as `/dev/zero`, is too
/// long.
fn read_at_most(path: &Path, most: u64) -> Result<Vec<u8>, Failure> {
    let refused = |problem: &str, help: &str| {
        Diagnostic::new(problem).with_location(Location::file(path.display().to_string())).with_help(help)
    };
    if path.is_dir() {
        return Err(Failure::bad_input(refused("is a folder", "give a file")));
    }
    let bytes = pinswitch_batch::read_at_most(path, most).map_err(|e| {
        Failure::bad_input(match e.kind() {
            std::io::ErrorKind::FileTooLarge => {
                refused(&format!("is longer than {most} bytes"), "check that this is the right file")
            }
            _ => refused("cannot read", "give a file that exists and can be read").with_source(e),
        })
    })?;
    // A pipe has no content that could be overwritten.
    if path.is_file()
        && let Ok(real) = path.canonicalize()
    {
        READ.lock().unwrap_or_else(PoisonError::into_inner).insert(real);
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_too_long_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.toml");
        // A sparse file: it takes no room on the disk.
        std::fs::File::create(&file).unwrap().set_len(MAX_TEXT + 1).unwrap();
        for path in [file.as_path(), Path::new("/dev/zero")] {
            let error = read_text_file(path).unwrap_err().to_string();
            assert!(error.contains("longer than 16777216 bytes"), "{error}");
        }
    }

    #[test]
    fn a_byte_outside_utf8_has_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.toml");
        std::fs::write(&file, b"a = 1\nb = \"\xff\"\n").unwrap();
        let error = read_text_file(&file).unwrap_err();
        let [diagnostic] = error.diagnostics() else { panic!("{error}") };
        let location = diagnostic.location().unwrap();
        assert_eq!((location.file.as_deref(), location.line), (Some(&*file.to_string_lossy()), Some(2)));
        assert!(error.to_string().contains("byte 0xff"), "{error}");
        assert_eq!(diagnostic.help(), Some("save the file as UTF-8 text"));
    }

    #[test]
    fn a_folder_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = read_text_file(folder.path()).unwrap_err().to_string();
        assert!(error.ends_with(": is a folder; give a file"), "{error}");
    }
}
