//! The subset of Markdown in the texts of the guide.

/// A run of text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Run {
    /// Plain text.
    Plain(String),
    /// Emphasised text.
    Strong(String),
    /// Text of a computer, such as a parameter or a file.
    Code(String),
}

impl Run {
    /// Returns the text without markup.
    pub(crate) fn text(&self) -> &str {
        match self {
            Self::Plain(text) | Self::Strong(text) | Self::Code(text) => text,
        }
    }
}

/// Reads a text.
pub(crate) fn runs(text: &str) -> Vec<Run> {
    let mut all: Vec<Run> = Vec::new();
    let (mut current, mut is_strong) = (String::new(), false);
    let mut rest = text;
    let flush = |current: &mut String, is_strong: bool, all: &mut Vec<Run>| {
        if !current.is_empty() {
            let text = std::mem::take(current);
            all.push(if is_strong { Run::Strong(text) } else { Run::Plain(text) });
        }
    };
    while let Some(c) = rest.chars().next() {
        let after = &rest[c.len_utf8()..];
        rest = after;
        match c {
            '\\' => {
                let mut letters = after.chars();
                current.extend(letters.next());
                rest = letters.as_str();
            }
            '*' if after.starts_with('*') => {
                flush(&mut current, is_strong, &mut all);
                is_strong = !is_strong;
                rest = &after[1..];
            }
            '`' => match after.split_once('`') {
                Some((code, after)) => {
                    flush(&mut current, is_strong, &mut all);
                    all.push(Run::Code(code.to_owned()));
                    rest = after;
                }
                None => current.push('`'),
            },
            other => current.push(other),
        }
    }
    flush(&mut current, is_strong, &mut all);
    all
}

/// Returns a text without markup.
#[cfg(test)]
pub(crate) fn plain(text: &str) -> String {
    runs(text).iter().map(Run::text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::markdown::escape;

    #[test]
    fn markup_and_escapes_are_read() {
        let expected = [
            Run::Strong("Risk:".to_owned()),
            Run::Plain(" set ".to_owned()),
            Run::Code("a.b_mm".to_owned()),
            Run::Plain(" * 2".to_owned()),
        ];
        assert_eq!(runs("**Risk:** set `a.b_mm` \\* 2"), expected);
    }

    #[test]
    fn escaped_text_is_read_back() {
        for text in ["a_b *c* `d` <e> [5, 8]: #1 \\ &lt;", "`", "**", ""] {
            assert_eq!(plain(&escape(text)), text);
        }
        // Unfinished markup is plain text.
        assert_eq!(plain("5 ` 6"), "5 ` 6");
    }
}
