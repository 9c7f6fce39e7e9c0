//! The text of a file.

use super::{ConfigError, Place};

/// The text of the bytes of `file`.
///
/// # Errors
/// [`ConfigError`] names the line where they are no text.
///
/// ```
/// use pinswitch_switch::config::text;
///
/// let error = text(b"a = 1\nb = \"\xff\"\n".to_vec(), "my.toml").unwrap_err();
/// assert_eq!(error.to_string(), "my.toml:2: byte 0xff is no UTF-8 text; give a text file, saved as UTF-8");
/// ```
pub fn text(bytes: Vec<u8>, file: &str) -> Result<String, ConfigError> {
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let before = e.as_bytes().get(..at).unwrap_or_default();
        let byte = e.as_bytes().get(at).copied().unwrap_or_default();
        ConfigError {
            field: format!("byte 0x{byte:02x}"),
            value: None,
            problem: "is no UTF-8 text".to_owned(),
            remedy: "give a text file, saved as UTF-8".to_owned(),
            changes: Vec::new(),
            place: Some(Place {
                file: file.to_owned(),
                line: Some(1 + before.iter().filter(|b| **b == b'\n').count()),
            }),
        }
    })
}
