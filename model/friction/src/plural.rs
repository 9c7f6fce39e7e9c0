//! Counts in messages.

/// Returns a count with its noun, in the plural unless the count is one.
///
/// ```
/// use pinswitch_friction::pluralise;
///
/// assert_eq!(pluralise(1, "pin"), "1 pin");
/// assert_eq!(pluralise(2, "pin"), "2 pins");
/// ```
pub fn pluralise(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}
