//! Reading a text that the user names.

use std::path::Path;

use super::Failure;

/// The text of the file at `path`.
///
/// # Errors
/// [`Failure::BadInput`] names the file, where it is no text, and what to do.
pub(super) fn read_text_file(path: &Path) -> Result<String, Failure> {
    let name = path.display();
    if path.is_dir() {
        return Err(Failure::bad_input(format!("{name}: is a folder; give a file")));
    }
    let bytes = std::fs::read(path).map_err(|e| {
        Failure::bad_input(format!("{name}: cannot read: {e}; give a file that exists and can be read"))
    })?;
    String::from_utf8(bytes).map_err(|e| Failure::bad_input(format!("{name}{}", no_text(&e))))
}

/// Where bytes stop being text, and what to do: continues the name of the file.
fn no_text(error: &std::string::FromUtf8Error) -> String {
    let at = error.utf8_error().valid_up_to();
    let before = error.as_bytes().get(..at).unwrap_or_default();
    let line = 1 + before.iter().filter(|b| **b == b'\n').count();
    let byte = error.as_bytes().get(at).copied().unwrap_or_default();
    format!(":{line}: byte 0x{byte:02x} is no UTF-8 text; give a text file, saved as UTF-8")
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
