//! Escaping of text in markup.

/// Returns the text with the characters that SVG, XML and HTML interpret replaced by entities, for an element or a quoted
/// attribute.
#[must_use]
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}
