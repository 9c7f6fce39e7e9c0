//! Escaping of text in Markdown.

/// Escapes a text so that a reader of Markdown shows it unchanged, on one line: without markup, HTML or an end of its cell.
pub(super) fn escape(text: &str) -> String {
    let characters: Vec<char> = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let at = |i: usize| characters.get(i).copied().unwrap_or(' ');
    let mut escaped = String::with_capacity(text.len());
    for (i, &c) in characters.iter().enumerate() {
        let marks = match c {
            '\\' | '`' | '*' | '<' | '>' | '|' | '&' | '~' => true,
            // Not markup within a word, so that names of fields are readable.
            '_' => i == 0 || !at(i - 1).is_alphanumeric() || !at(i + 1).is_alphanumeric(),
            // Not the end of a link, so that lists of numbers are readable.
            ']' => "([:".contains(at(i + 1)),
            '#' => i == 0 || i + 1 == characters.len(),
            _ => false,
        };
        if marks {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_is_escaped() {
        assert_eq!(escape("<script>a</script>"), "\\<script\\>a\\</script\\>");
        assert_eq!(
            escape("_x_ *y* `z` a|b &lt; [a](b)\nc"),
            "\\_x\\_ \\*y\\* \\`z\\` a\\|b \\&lt; [a\\](b) c"
        );
    }

    #[test]
    fn fields_and_lists_are_readable() {
        let text = "layout.pins = [5, 8, 11]: support.slot_clearance_mm = 0.2 of three-double 3.1";
        assert_eq!(escape(text), text.replace("]:", "\\]:"));
    }
}
