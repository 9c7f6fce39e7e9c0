//! Shortened texts of any length.

/// The text, if it has at most `most` characters; else its beginning and its end, with its length between them. If
/// the length would take more than half of it, three dots are between them.
///
/// ```
/// use pinswitch_diagnostic::excerpt;
///
/// assert_eq!(excerpt("a short one", 60), "a short one");
/// let long = excerpt(&"x".repeat(1_000_000), 80);
/// assert!(long.chars().count() <= 80 && long.contains("[... 1000000 characters in all ...]"));
/// assert_eq!(excerpt("Force of the left load cell [N]", 20), "Force of th...ll [N]");
/// ```
pub fn excerpt(text: &str, most: usize) -> String {
    let total = text.chars().count();
    if total <= most {
        return text.to_owned();
    }
    let length = format!(" [... {total} characters in all ...] ");
    let note = if 2 * length.len() > most { "..." } else { &length };
    let kept = most.saturating_sub(note.len());
    let at_the_end = kept * 2 / 5;
    let begin: String = text.chars().take(kept - at_the_end).collect();
    let end: String = text.chars().skip(total - at_the_end).collect();
    begin + note + &end
}
