//! Decoding of the bytes of a file.

use pinswitch_diagnostic::{Diagnostic, Location, codes};

/// Decodes the bytes of `file` as UTF-8.
///
/// # Errors
/// A [`Diagnostic`] with the line of the first invalid byte.
///
/// ```
/// use pinswitch_switch::config::text;
///
/// let error = text(b"a = 1\nb = \"\xff\"\n".to_vec(), "my.toml").unwrap_err();
/// assert_eq!(error.to_string(), "my.toml:2: byte 0xff is not valid UTF-8; save the file as UTF-8 text");
/// ```
pub fn text(bytes: Vec<u8>, file: &str) -> Result<String, Diagnostic> {
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let before = e.as_bytes().get(..at).unwrap_or_default();
        let byte = e.as_bytes().get(at).copied().unwrap_or_default();
        let line = 1 + before.iter().filter(|b| **b == b'\n').count();
        Diagnostic::new(codes::NOT_UTF_8, format!("byte 0x{byte:02x} is not valid UTF-8"))
            .with_location(Location::line(file, line))
            .with_help("save the file as UTF-8 text")
    })
}
