//! Numbers of things in words: one is one.

/// A number of things in words.
///
/// ```
/// use pinswitch_friction::pluralise;
///
/// assert_eq!((pluralise(1, "pin"), pluralise(2, "pin")), ("1 pin".to_owned(), "2 pins".to_owned()));
/// ```
pub fn pluralise(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}
