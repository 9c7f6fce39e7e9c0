//! Locations in files, options and tables.

use std::fmt;
use std::ops::Range;

use schemars::JsonSchema;
use serde::Serialize;
use unicode_width::UnicodeWidthStr;

use crate::{excerpt, neutral, neutral_line};

/// Most characters of a field's value in a location.
const LONGEST_VALUE: usize = 120;
/// Most characters of a file's or field's name in a location.
const LONGEST_NAME: usize = 160;
/// Widest line that is shown with a caret, in columns of a terminal; a wider one would wrap.
const WIDEST_SNIPPET: usize = 160;
/// Columns of the window of a wider line, of which all may be marked: the message is to stay short.
const WINDOW: usize = 100;
/// Columns before the wrong part in a window.
const COLUMNS_BEFORE: usize = 40;

/// Where a problem is: a file or an option, a line and a column in it, and the field that is wrong.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
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

/// One line of a file, or a window of a long one, with the part that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Snippet {
    /// The line without its end; `…` replaces what a window leaves out.
    pub text: String,
    /// The wrong part, in characters from the start of the text.
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
        Self {
            column: Some(column + 1),
            snippet: (!line.trim().is_empty()).then(|| Snippet::of_line(line, column..column + width)),
            ..Self::line(file, text[..start].matches('\n').count() + 1)
        }
    }

    /// A cell of a CSV file: the one with the index `cell`, from 0, of the record that starts at the byte `record` of `text`.
    /// The whole first line of the record, without a column, if it lacks this cell.
    pub fn in_csv(file: impl Into<String>, text: &str, record: usize, cell: Option<usize>) -> Self {
        let start = boundary(text, record);
        // The csv crate counts line breaks before a record to it.
        let start = start + text[start..].find(|c| c != '\n' && c != '\r').unwrap_or(0);
        if let Some(span) = cell.and_then(|cell| csv_cell(&text[start..], cell)) {
            return Self::in_text(file, text, start + span.start..start + span.end);
        }
        let end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        Self { column: None, ..Self::in_text(file, text, start..end) }
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
        let before = shown_width(&text.chars().take(marked.start).collect::<String>());
        let under =
            shown_width(&text.chars().skip(marked.start).take(marked.len()).collect::<String>()).max(1);
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

impl Snippet {
    /// A line with its wrong part in characters; of a wide line, a window around the start of that part.
    fn of_line(line: &str, marked: Range<usize>) -> Self {
        if shown_width(line) <= WIDEST_SNIPPET {
            return Self { text: line.to_owned(), marked };
        }
        let widths: Vec<usize> = line.chars().map(|c| shown_width(c.encode_utf8(&mut [0; 4]))).collect();
        // Two columns are for the ellipses.
        let mut free = WINDOW - 2;
        let first = marked.start.min(widths.len());
        let (mut start, mut end) = (first, first);
        let mut free_before = COLUMNS_BEFORE;
        while start > 0 && widths[start - 1] <= free_before {
            start -= 1;
            free_before -= widths[start];
        }
        free -= COLUMNS_BEFORE - free_before;
        while end < widths.len() && widths[end] <= free {
            free -= widths[end];
            end += 1;
        }
        // At the end of the line, its part before takes the rest.
        while start > 0 && widths[start - 1] <= free {
            start -= 1;
            free -= widths[start];
        }
        let before = if start > 0 { "…" } else { "" };
        let after = if end < widths.len() { "…" } else { "" };
        let window: String = line.chars().skip(start).take(end - start).collect();
        let shift = before.chars().count();
        let marked = first - start + shift..(marked.end.min(end).max(first + 1) - start) + shift;
        Self { text: format!("{before}{window}{after}"), marked }
    }
}

/// Columns that a text takes on a terminal, where an escape has its own length: two for a wide character, none for a
/// combining one.
fn shown_width(text: &str) -> usize {
    neutral(text).width()
}

/// Span of a cell of the first record of a CSV text, with its quotes and without the blanks around it.
fn csv_cell(text: &str, index: usize) -> Option<Range<usize>> {
    let (mut is_quoted, mut cell, mut start) = (false, 0, 0);
    for (at, c) in text.char_indices().chain([(text.len(), '\n')]) {
        match c {
            '"' => is_quoted = !is_quoted,
            ',' | '\n' if !is_quoted || at == text.len() => {
                if cell == index {
                    let content = &text[start..at];
                    // An empty cell is marked at its separator.
                    let blanks = content.len() - content.trim_start().len();
                    return Some(start + blanks..start + blanks.max(content.trim_end().len()));
                }
                if c == '\n' {
                    return None;
                }
                (cell, start) = (cell + 1, at + 1);
            }
            _ => {}
        }
    }
    None
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
            let cell = Location::in_csv("f", &text, start, Some(length));
            prop_assert!(cell.line.is_some_and(|line| line >= 1));
            let _ = cell.shown_snippet();
        }
    }

    #[test]
    fn a_location_is_counted_in_characters() {
        let location = Location::in_text("a.toml", "x = 1\r\nµ = \"é\"\r\n", 12..16);
        assert_eq!((location.line, location.column), (Some(2), Some(5)));
        assert_eq!(location.snippet.map(|s| (s.text, s.marked)), Some(("µ = \"é\"".to_owned(), 4..7)));
    }

    /// The two lines under a problem: the line and its carets.
    fn shown(location: &Location) -> (String, String) {
        let text = location.shown_snippet();
        let mut lines = text.lines().skip(1).map(|line| line.split_once("| ").unwrap().1.to_owned());
        (lines.next().unwrap(), lines.next().unwrap())
    }

    #[test]
    fn carets_are_as_wide_as_characters() {
        let text = "名 = \"摩擦\" # e\u{301}";
        let start = text.find('"').unwrap();
        let location = Location::in_text("a.toml", text, start..start + 8);
        assert_eq!(shown(&location).1, "     ^^^^^^");
        let combined = "e\u{301} = 1";
        let location = Location::in_text("a.toml", combined, combined.len() - 1..combined.len());
        assert_eq!(shown(&location).1, "    ^");
    }

    #[test]
    fn long_lines_show_a_window() {
        let text = format!("x = [{}wrong, {}]", "1, ".repeat(100), "2, ".repeat(100));
        let start = text.find("wrong").unwrap();
        let (line, carets) = shown(&Location::in_text("a.toml", &text, start..start + 5));
        assert!(line.starts_with('…') && line.ends_with('…') && line.chars().count() == WINDOW, "{line}");
        assert_eq!(line.chars().skip(carets.find('^').unwrap()).take(5).collect::<String>(), "wrong");
        assert_eq!(carets.matches('^').count(), 5);
        let end = text.len() - 1;
        let (line, carets) = shown(&Location::in_text("a.toml", &text, end..end + 1));
        assert!(line.starts_with('…') && line.ends_with("2, ]"), "{line}");
        assert_eq!(carets.chars().count(), line.chars().count());
        let all = Location::in_text("a.toml", &text, 0..text.len());
        assert_eq!(shown(&all).1, "^".repeat(WINDOW - 2));
    }

    #[test]
    fn cells_of_csv_are_located() {
        let text = "a,b,c\n1, \"x,y\" ,\n\n\"two\nlines\",5,6\n";
        let cell = |record: usize, cell: usize| {
            let location = Location::in_csv("t.csv", text, record, Some(cell));
            (location.line, location.column, location.snippet.map(|s| s.marked.len()))
        };
        assert_eq!(cell(6, 0), (Some(2), Some(1), Some(1)));
        assert_eq!(cell(6, 1), (Some(2), Some(4), Some(5)));
        assert_eq!(cell(6, 2), (Some(2), Some(11), Some(1)));
        assert_eq!(cell(6, 3), (Some(2), None, Some(10)));
        // A line break before a record, and one within a cell.
        assert_eq!(cell(17, 0), (Some(4), Some(1), Some(4)));
        assert_eq!(cell(17, 1), (Some(5), Some(8), Some(1)));
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
