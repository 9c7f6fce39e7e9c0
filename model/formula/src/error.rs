//! Errors in formulas, with the bytes that are wrong.

use std::fmt;
use std::ops::Range;

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes, excerpt};

use crate::nearest::nearest;

/// Most characters of a name in an error.
const LONGEST_NAME: usize = 40;

/// What is wrong in a formula, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormulaError {
    code: Code,
    span: Range<usize>,
    problem: String,
    help: Option<String>,
}

impl FormulaError {
    /// An error at these bytes of the formula.
    pub fn new(code: Code, span: Range<usize>, problem: impl Into<String>) -> Self {
        Self { code, span, problem: problem.into(), help: None }
    }

    /// The same error with a remedy.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Returns the kind of fault.
    pub fn code(&self) -> Code {
        self.code
    }

    /// Returns the bytes of the formula that are wrong; empty at the end of the formula.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Returns what is wrong.
    pub fn problem(&self) -> &str {
        &self.problem
    }

    /// Returns the remedy.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Returns the diagnostic for a formula that is given by itself, with `text` and a caret.
    pub fn to_diagnostic(&self, text: &str) -> Diagnostic {
        let location = Location { file: None, ..Location::in_text("", text, self.span()) };
        self.to_diagnostic_at(location)
    }

    /// Returns the diagnostic for a formula that is the value of a TOML string; `string` are the
    /// bytes of the string in `text`, with its quotes.
    pub fn to_diagnostic_in_toml(&self, file: &str, text: &str, string: Range<usize>) -> Diagnostic {
        self.to_diagnostic_at(Location::in_text(file, text, span_in_toml(text, string, &self.span)))
    }

    fn to_diagnostic_at(&self, location: Location) -> Diagnostic {
        Diagnostic::from(self).with_location(location)
    }
}

impl From<&FormulaError> for Diagnostic {
    /// Returns the problem and the remedy, without a location.
    fn from(error: &FormulaError) -> Self {
        diagnostic(error.code, &error.problem, error.help.as_deref())
    }
}

impl fmt::Display for FormulaError {
    /// Writes `problem; help`, without the location.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.problem)?;
        self.help.as_ref().map_or(Ok(()), |help| write!(f, "; {help}"))
    }
}

impl std::error::Error for FormulaError {}

/// Why a name has no meaning in a formula.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameError {
    pub(crate) code: Code,
    pub(crate) problem: String,
    pub(crate) help: Option<String>,
}

impl NameError {
    /// An error about a name.
    pub fn new(code: Code, problem: impl Into<String>) -> Self {
        Self { code, problem: problem.into(), help: None }
    }

    /// The same error with a remedy.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// The same error of another kind.
    #[must_use]
    pub fn with_code(self, code: Code) -> Self {
        Self { code, ..self }
    }

    /// A name that does not exist, with the nearest of the `known` ones, or all of them; `kind` is
    /// what is named, such as `variable`.
    pub fn unknown<'a>(kind: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        let problem = format!("unknown {kind} '{}'", excerpt(name, LONGEST_NAME));
        let help = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean {near}?"),
            None => format!("use one of {}", known.join(", ")),
        };
        Self { code: codes::UNKNOWN_NAME, problem, help: Some(help) }
    }

    pub(crate) fn at(self, span: Range<usize>) -> FormulaError {
        FormulaError { code: self.code, span, problem: self.problem, help: self.help }
    }
}

impl fmt::Display for NameError {
    /// Writes `problem; help`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.problem)?;
        self.help.as_ref().map_or(Ok(()), |help| write!(f, "; {help}"))
    }
}

impl std::error::Error for NameError {}

impl From<NameError> for Diagnostic {
    fn from(error: NameError) -> Self {
        diagnostic(error.code, &error.problem, error.help.as_deref())
    }
}

fn diagnostic(code: Code, problem: &str, help: Option<&str>) -> Diagnostic {
    let diagnostic = Diagnostic::new(code, problem);
    match help {
        Some(help) => diagnostic.with_help(help),
        None => diagnostic,
    }
}

/// Bytes of `text` at which the bytes `span` of a TOML string's value are; the whole string if it
/// has escapes.
fn span_in_toml(text: &str, string: Range<usize>, span: &Range<usize>) -> Range<usize> {
    let raw = text.get(string.clone()).unwrap_or_default();
    if raw.starts_with('"') && raw.contains('\\') {
        return string;
    }
    let quotes = if raw.starts_with("\"\"\"") || raw.starts_with("'''") { 3 } else { 1 };
    let inner = raw.get(quotes..).unwrap_or_default();
    // A line feed directly after three quotes is not part of the value.
    let line_feed = match quotes {
        3 if inner.starts_with("\r\n") => 2,
        3 if inner.starts_with('\n') => 1,
        _ => 0,
    };
    let start = string.start + quotes + line_feed;
    let at = |offset: usize| (start + offset).min(string.end);
    at(span.start)..at(span.end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn carets_point_into_toml_strings() {
        for (text, marked) in [
            ("f = \"a * bb\"", "bb"),
            ("f = 'a * bb'", "bb"),
            ("f = '''\na * bb'''", "bb"),
            ("f = \"\"\"\r\na * bb\"\"\"", "bb"),
            ("f = \"\"\"a * bb\"\"\"", "bb"),
            ("f = \"a * bb \\u00b5\"", "\"a * bb \\u00b5\""),
        ] {
            let string = 4..text.len();
            let span = span_in_toml(text, string.clone(), &(4..6));
            assert_eq!(&text[span], marked, "{text}");
            let error = FormulaError::new(codes::UNKNOWN_NAME, 4..6, "unknown");
            let location = error.to_diagnostic_in_toml("a.toml", text, string).location().cloned();
            assert!(
                location.is_some_and(|l| l.file.as_deref() == Some("a.toml") && l.snippet.is_some()),
                "{text}"
            );
        }
    }
}
