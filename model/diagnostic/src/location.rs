//! Locations in files, options and tables.

use std::fmt;
use std::ops::Range;

use serde::Serialize;

use crate::{excerpt, neutral, neutral_line};

/// Most characters of a field's value in a location.
const LONGEST_VALUE: usize = 120;
/// Most characters of a file's or field's name in a location.
const LONGEST_NAME: usize = 160;
/// Longest line that is shown with a caret; a longer one would wrap.
const LONGEST_SNIPPET: usize = 160;

/// Where a problem is: a file or an option, a line and a column in it, and the field that is wrong.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Location {
    /// File as given, or the option that gave the value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Line, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Column in characters, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<usize>,
    /// Field or column of a table, such as `shell.width_mm`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<String>,
    /// Value of the field, as written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<String>,
    /// The line itself, to show under the problem.
    #[serde(skip)]
    pub snippet: Option<Snippet>,
}

/// One line of a file with the part that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Snippet {
    /// The line without its end.
    pub text: String,
    /// The wrong part, in characters from the start of the line.
    pub marked: Range<usize>,
}

impl Location {
    /// A whole file, or an option of the command line.
    pub fn file(file: impl Into<String>) -> Self {
        Self { file: Some(file.into()), ..Self::default() }
    }

    /// A line of a file, counted from 1.
    pub fn line(file: impl Into<String>, line: usize) -> Self {
        Self { line: Some(line), ..Self::file(file) }
    }

    /// The bytes `span` of `text`, which is the content of `file`. A span outside of the text is moved to its end.
    pub fn in_text(file: impl Into<String>, text: &str, span: Range<usize>) -> Self {
        let start = boundary(text, span.start);
        let end = boundary(text, span.end.max(start));
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let line = text[line_start..line_end].trim_end_matches('\r');
        let column = text[line_start..start].chars().count();
        let width = text[start..end.min(line_end)].trim_end().chars().count().max(1);
        let snippet = Snippet { text: line.to_owned(), marked: column..column + width };
        let is_shown = !line.trim().is_empty() && line.chars().count() <= LONGEST_SNIPPET;
        Self {
            column: Some(column + 1),
            snippet: is_shown.then_some(snippet),
            ..Self::line(file, text[..start].matches('\n').count() + 1)
        }
    }

    /// A field with its value, without a file.
    pub fn field(field: impl Into<String>, value: impl Into<String>) -> Self {
        Self::default().with_field(field, value)
    }

    /// The same location with the field that is wrong, and its value.
    #[must_use]
    pub fn with_field(mut self, field: impl Into<String>, value: impl Into<String>) -> Self {
        self.field = Some(field.into());
        self.value = Some(value.into());
        self
    }

    /// The same location with a file, unless it has one.
    #[must_use]
    pub fn in_file(mut self, file: impl Into<String>) -> Self {
        self.file.get_or_insert_with(|| file.into());
        self
    }

    /// `place` with the field and the value of this location, where it has a field.
    pub(crate) fn placed_at(self, place: &Self) -> Self {
        let place = place.clone();
        if self.field.is_some() { Self { field: self.field, value: self.value, ..place } } else { place }
    }

    /// The line with a caret under the wrong part, indented by two; empty where there is no line.
    pub(crate) fn shown_snippet(&self) -> String {
        let (Some(line), Some(Snippet { text, marked })) = (self.line, &self.snippet) else {
            return String::new();
        };
        let number = line.to_string();
        // A tab takes one character here as in the line above, and an escape its own length.
        let width = |part: &mut dyn Iterator<Item = char>| neutral(&part.collect::<String>()).chars().count();
        let before = width(&mut text.chars().take(marked.start));
        let under = width(&mut text.chars().skip(marked.start).take(marked.len())).max(1);
        let margin = " ".repeat(number.len());
        format!("\n  {number} | {}\n  {margin} | {}{}", neutral(text), " ".repeat(before), "^".repeat(under))
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        if let Some(file) = &self.file {
            f.write_str(&neutral_line(&excerpt(file, LONGEST_NAME)))?;
            for number in [self.line, self.column].into_iter().flatten() {
                write!(f, ":{number}")?;
            }
            separator = ": ";
        }
        if let Some(field) = &self.field {
            write!(f, "{separator}{}", neutral_line(&excerpt(field, LONGEST_NAME)))?;
            if let Some(value) = &self.value {
                write!(f, " = {}", neutral_line(&excerpt(value, LONGEST_VALUE)))?;
            }
        }
        Ok(())
    }
}

/// The nearest character boundary of `text` at or before `at`.
fn boundary(text: &str, at: usize) -> usize {
    let at = at.min(text.len());
    (0..=at).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_span_of_any_text_is_located(text in any::<String>(), start in 0usize..200, length in 0usize..200) {
            let location = Location::in_text("f", &text, start..start + length);
            prop_assert!(location.line.is_some_and(|line| line >= 1));
            let _ = location.shown_snippet();
        }
    }

    #[test]
    fn a_location_is_counted_in_characters() {
        let location = Location::in_text("a.toml", "x = 1\r\nµ = \"é\"\r\n", 12..16);
        assert_eq!((location.line, location.column), (Some(2), Some(5)));
        assert_eq!(location.snippet.map(|s| (s.text, s.marked)), Some(("µ = \"é\"".to_owned(), 4..7)));
    }

    #[test]
    fn a_location_names_what_is_known() {
        assert_eq!(Location::file("a.csv").to_string(), "a.csv");
        assert_eq!(
            Location::line("a.csv", 3).with_field("load_N", "abc").to_string(),
            "a.csv:3: load_N = abc"
        );
        assert_eq!(Location::field("shell.width_mm", "1").in_file("b").to_string(), "b: shell.width_mm = 1");
    }
}
