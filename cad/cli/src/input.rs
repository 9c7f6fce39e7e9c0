//! Reading a file that the user names, and knowing afterwards which ones were read: no command writes over its own input.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::Failure;
use pinswitch_switch::config::text;

/// Longest configuration, plan, model or report: some hundred times the longest that anybody writes.
const MAX_TEXT: u64 = 16 << 20;
/// Longest configuration, if a 3MF holds it.
const MAX_PACKAGE: u64 = 256 << 20;
/// Longest table or log: some million rows.
const MAX_TABLE: u64 = 1 << 30;

/// The text of the file at `path`: of a configuration, a plan, a model.
///
/// # Errors
/// [`Failure::BadInput`] names the file, where it is no text, and what to do.
pub(super) fn read_text_file(path: &Path) -> Result<String, Failure> {
    text(read_at_most(path, MAX_TEXT)?, &path.display().to_string()).map_err(Failure::bad_input)
}

/// The bytes of the configuration at `path`: a text, or the 3MF of a set.
///
/// # Errors
/// [`Failure::BadInput`] names the file and what to do.
pub(super) fn read_configuration(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut begin = [0; 2];
    let is_package = path.is_file()
        && File::open(path).and_then(|mut f| f.read_exact(&mut begin)).is_ok()
        && begin == *b"PK";
    read_at_most(path, if is_package { MAX_PACKAGE } else { MAX_TEXT })
}

/// Every file that was read, without links and dots.
static READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Whether this run of the program has read the file at `path`, under whatever name.
pub(super) fn was_read(path: &Path) -> bool {
    let Ok(real) = path.canonicalize() else { return false };
    READ.lock().unwrap_or_else(PoisonError::into_inner).contains(&real)
}

/// The bytes of the table or log at `path`.
///
/// # Errors
/// [`Failure::BadInput`] names the file and what to do.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, Failure> {
    read_at_most(path, MAX_TABLE)
}

/// The bytes of the file at `path`, which is input from now on. A file without an end is no more than any other that is
/// too long.
fn read_at_most(path: &Path, most: u64) -> Result<Vec<u8>, Failure> {
    let name = path.display();
    if path.is_dir() {
        return Err(Failure::bad_input(format!("{name}: is a folder; give a file")));
    }
    let bytes = pinswitch_batch::read_at_most(path, most).map_err(|e| match e.kind() {
        std::io::ErrorKind::FileTooLarge => {
            Failure::bad_input(format!("{name}: {e}; give a file of what is asked for"))
        }
        _ => Failure::bad_input(format!("{name}: cannot read: {e}; give a file that exists and can be read")),
    })?;
    // A pipe has no content that could be written over.
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
    fn what_is_too_long_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.toml");
        // It takes no room on the disk.
        std::fs::File::create(&file).unwrap().set_len(MAX_TEXT + 1).unwrap();
        for path in [file.as_path(), Path::new("/dev/zero")] {
            let error = read_text_file(path).unwrap_err();
            assert!(error.message().contains("more than 16777216 bytes"), "{}", error.message());
        }
    }

    #[test]
    fn what_is_no_text_is_named_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.toml");
        std::fs::write(&file, b"a = 1\nb = \"\xff\"\n").unwrap();
        let error = read_text_file(&file).unwrap_err();
        assert!(
            error
                .message()
                .ends_with("a.toml:2: byte 0xff is no UTF-8 text; give a text file, saved as UTF-8")
        );
        assert!(read_text_file(folder.path()).unwrap_err().message().contains("is a folder; give a file"));
    }
}
