//! Reading a file that the user names.

use std::path::Path;

use super::Failure;
use pinswitch_switch::config::text;

/// The text of the file at `path`.
///
/// # Errors
/// [`Failure::BadInput`] names the file, where it is no text, and what to do.
pub(super) fn read_text_file(path: &Path) -> Result<String, Failure> {
    text(read_file(path)?, &path.display().to_string()).map_err(Failure::bad_input)
}

/// The bytes of the file at `path`.
///
/// # Errors
/// [`Failure::BadInput`] names the file and what to do.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, Failure> {
    let name = path.display();
    if path.is_dir() {
        return Err(Failure::bad_input(format!("{name}: is a folder; give a file")));
    }
    std::fs::read(path).map_err(|e| {
        Failure::bad_input(format!("{name}: cannot read: {e}; give a file that exists and can be read"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
