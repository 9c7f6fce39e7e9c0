//! The last line of a model file: a comment with the SHA-256 of the lines above it.
//!
//! A model file is copied to other folders and dropped on a page, where no manifest lists it.

use pinswitch_diagnostic::{Diagnostic, codes};
use sha2::{Digest, Sha256};

/// Begin of the line.
const MARK: &str = "# SHA-256 of the lines above: ";
/// Digits of a hash that an error shows.
const SHOWN_DIGITS: usize = 8;

/// Appends the line to a text that ends with a line feed.
pub(crate) fn with_content_hash(text: String) -> String {
    let hash = content_hash(&text);
    format!("{text}{MARK}{hash}\n")
}

/// Compares a text with its last line. A text without this line is accepted.
///
/// # Errors
/// A [`Diagnostic`] without a location if the text was changed.
pub(crate) fn check_content_hash(text: &str) -> Result<(), Diagnostic> {
    let Some((content, listed)) = text.rsplit_once(MARK) else { return Ok(()) };
    let (hash, listed) = (content_hash(content), listed.trim());
    if hash == listed {
        return Ok(());
    }
    let digits = |hash: &str| hash.chars().take(SHOWN_DIGITS).collect::<String>();
    let problem = format!(
        "was changed since pinswitch wrote it (SHA-256 {}..., not {}...)",
        digits(&hash),
        digits(listed)
    );
    Err(Diagnostic::new(codes::CHANGED_FILE, problem)
        .with_help("restore it; to use the changed file, delete its last line"))
}

/// Returns the SHA-256 in hexadecimal digits, independent of the kind of line ends.
fn content_hash(text: &str) -> String {
    Sha256::digest(text.replace('\r', "")).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_lines_are_found() {
        let text = with_content_hash("a = 1.25\nb = 3\n".to_owned());
        assert!(check_content_hash(&text).is_ok());
        assert!(check_content_hash(&text.replace('\n', "\r\n")).is_ok());
        assert!(check_content_hash("a = 1.35\nb = 3\n").is_ok());
        for changed in [
            text.replace("1.25", "1.35"),
            format!("{text}c = 1\n"),
            text.trim_end_matches("\n").replace(": ", ": 0"),
        ] {
            let error = check_content_hash(&changed).unwrap_err();
            assert!(error.help().is_some_and(|help| help.contains("delete its last line")), "{changed}");
        }
    }
}
