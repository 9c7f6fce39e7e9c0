//! Shortened texts of any length.

/// The text, if it has at most `most` characters; else its beginning and its end, with its length between them.
///
/// ```
/// use pinswitch_diagnostic::excerpt;
///
/// assert_eq!(excerpt("a short one", 60), "a short one");
/// let long = excerpt(&"x".repeat(1_000_000), 60);
/// assert!(long.chars().count() <= 60 && long.contains("[... 1000000 characters in all ...]"));
/// ```
pub fn excerpt(text: &str, most: usize) -> String {
    let total = text.chars().count();
    if total <= most {
        return text.to_owned();
    }
    let note = format!(" [... {total} characters in all ...] ");
    let kept = most.saturating_sub(note.len());
    let at_the_end = kept * 2 / 5;
    let begin: String = text.chars().take(kept - at_the_end).collect();
    let end: String = text.chars().skip(total - at_the_end).collect();
    begin + &note + &end
}
