//! Control characters made visible.

use std::borrow::Cow;

/// Returns the text with every control character replaced by its escape, such as `\u{1b}`.
///
/// Line feeds stay and tabs become a space. Replaced are the C0 and C1 controls and DEL, which terminals obey, the
/// marks that change the direction of text (Unicode TR 36, section 3.2), which make a line read as another, and characters
/// without a width, such as the zero-width space and the soft hyphen, which make two different words look equal.
///
/// ```
/// use pinswitch_diagnostic::neutral;
///
/// assert_eq!(neutral("plain, 1.5 µm"), "plain, 1.5 µm");
/// assert_eq!(neutral("\u{1b}[2Jgone"), "\\u{1b}[2Jgone");
/// ```
pub fn neutral(text: &str) -> Cow<'_, str> {
    if !text.contains(|c| c != '\n' && is_active(c)) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            '\t' => shown.push(' '),
            c if c != '\n' && is_active(c) => shown.extend(c.escape_unicode()),
            c => shown.push(c),
        }
    }
    Cow::Owned(shown)
}

/// Returns the text on one line: [`neutral`], with line feeds as `\n`. For foreign names and values, which could
/// otherwise forge a line of the program's own output.
///
/// ```
/// assert_eq!(pinswitch_diagnostic::neutral_line("a\nerror: b"), "a\\nerror: b");
/// ```
pub fn neutral_line(text: &str) -> Cow<'_, str> {
    match neutral(text) {
        shown if shown.contains('\n') => Cow::Owned(shown.replace('\n', "\\n")),
        shown => shown,
    }
}

/// Whether a terminal or a text layout acts on this character, or hides it, instead of showing it.
fn is_active(c: char) -> bool {
    let is_direction_mark = matches!(
        c,
        '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    let is_invisible = matches!(c, '\u{ad}' | '\u{200b}'..='\u{200d}' | '\u{2060}' | '\u{feff}');
    c.is_control() || is_direction_mark || is_invisible || matches!(c, '\u{2028}' | '\u{2029}')
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_control_character_passes(text in any::<String>()) {
            let shown = neutral(&text);
            prop_assert!(!shown.contains(|c: char| c != '\n' && is_active(c)));
            prop_assert_eq!(neutral(&shown), shown.clone());
        }
    }

    #[test]
    fn escape_sequences_become_visible() {
        assert_eq!(neutral("a\u{1b}]0;title\u{7}b"), "a\\u{1b}]0;title\\u{7}b");
        assert_eq!(
            neutral("wid\u{ad}th\u{200b}_\u{200d}\u{2060}m"),
            "wid\\u{ad}th\\u{200b}_\\u{200d}\\u{2060}m"
        );
        assert_eq!(neutral("a\rb\tc\u{9b}d\u{202e}e"), "a\\u{d}b c\\u{9b}d\\u{202e}e");
    }
}
