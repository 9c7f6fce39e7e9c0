//! The diagnostic, and how a person reads it.

use std::error::Error;
use std::fmt;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use crate::{Code, Location, excerpt, neutral_line};

/// Most characters of a problem, of a line of help and of each cause: more would not be read.
const LONGEST: usize = 520;
/// Most lines of a help, such as the options that answer a question.
const MAX_HELP_LINES: usize = 24;
/// Most characters of the one-line form.
const LONGEST_LINE: usize = 590;
/// Most causes that are shown.
const MAX_CAUSES: usize = 5;

/// A field and the value that it takes, as TOML.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Change {
    /// Field, such as `shell.width_mm`.
    pub field: String,
    /// Value as TOML.
    pub value: String,
}

/// What is wrong, where, and what to do about it, with the [`Code`] of its kind.
///
/// Its [`Display`](fmt::Display) is one line, `location: problem; help`, for logs and tables; [`Diagnostic::render`] is
/// what a person reads, and its serialisation what a program does.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(
    with = "WrittenDiagnostic<'static>",
    description = "What is wrong, where, and what to do about it."
)]
pub struct Diagnostic {
    code: Code,
    location: Option<Box<Location>>,
    problem: String,
    help: Option<String>,
    changes: Vec<Change>,
    alternatives: Vec<Vec<Change>>,
    source: Option<Arc<dyn Error + Send + Sync>>,
}

impl Diagnostic {
    /// A problem, in lower case and without a full stop, with the bound that was broken.
    pub fn new(code: Code, problem: impl Into<String>) -> Self {
        let problem = problem.into();
        Self {
            code,
            location: None,
            problem,
            help: None,
            changes: Vec::new(),
            alternatives: Vec::new(),
            source: None,
        }
    }

    /// The message of an error of another library, which stays its source. A diagnostic is returned unchanged, with its
    /// own code.
    pub fn from_error(code: Code, error: impl Error + Send + Sync + 'static) -> Self {
        let error: Box<dyn Error + Send + Sync> = Box::new(error);
        let error = match error.downcast::<Self>() {
            Ok(diagnostic) => return *diagnostic,
            Err(error) => error,
        };
        let source: Arc<dyn Error + Send + Sync> = Arc::from(error);
        // The error itself is the problem; what caused it follows.
        Self { source: Some(Arc::clone(&source)), ..Self::new(code, source.to_string()) }
    }

    /// The same diagnostic at this location.
    #[must_use]
    pub fn with_location(mut self, location: Location) -> Self {
        self.location = Some(Box::new(location));
        self
    }

    /// The same diagnostic at this location, unless it has a file.
    #[must_use]
    pub fn or_in_file(mut self, file: &str) -> Self {
        let location = self.location.take().map_or_else(Location::default, |location| *location);
        self.location = Some(Box::new(location.in_file(file)));
        self
    }

    /// The same diagnostic at this location; a field and a value of its own stay. Unchanged if it has a file.
    #[must_use]
    pub fn or_at(mut self, location: &Location) -> Self {
        let own = self.location.take().map_or_else(Location::default, |own| *own);
        let location = if own.file.is_some() { own } else { own.placed_at(location) };
        self.location = Some(Box::new(location));
        self
    }

    /// The same diagnostic with what to do about it.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into()).filter(|help| !help.is_empty());
        self
    }

    /// The same diagnostic with values that solve the problem when all of them are set.
    #[must_use]
    pub fn with_changes(mut self, changes: Vec<Change>) -> Self {
        self.changes = changes;
        self
    }

    /// The same diagnostic with other changes that solve the problem as well: its help describes them, and its
    /// serialisation does not contain them.
    #[must_use]
    pub fn with_alternatives(mut self, alternatives: Vec<Vec<Change>>) -> Self {
        self.alternatives = alternatives;
        self
    }

    /// The same diagnostic with the error that caused it.
    #[must_use]
    pub fn with_source(mut self, source: impl Error + Send + Sync + 'static) -> Self {
        self.source = Some(Arc::new(source));
        self
    }

    /// Kind of fault.
    pub fn code(&self) -> Code {
        self.code
    }

    /// Where the problem is.
    pub fn location(&self) -> Option<&Location> {
        self.location.as_deref()
    }

    /// What is wrong, with the bound that was broken.
    pub fn problem(&self) -> &str {
        &self.problem
    }

    /// What to do about it.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Values that solve the problem when all of them are set; empty where only words can describe the way out.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Other changes that solve the problem as well, the nearest first.
    pub fn alternatives(&self) -> &[Vec<Change>] {
        &self.alternatives
    }

    /// `LABEL: location: problem [code]`, the line of the file with a caret, and `  help: ...`, without control characters
    /// and of bounded length. The label is `error` or `warning`.
    pub fn render(&self, label: &str) -> String {
        let mut text = format!("{label}: {} [{}]", self.headline(), self.code);
        if let Some(location) = &self.location {
            text.push_str(&location.shown_snippet());
        }
        for cause in self.causes() {
            text.push_str("\n  cause: ");
            text.push_str(&shown_line(&cause));
        }
        if let Some(help) = &self.help {
            text.push_str("\n  help: ");
            text.push_str(&shown(help).replace('\n', "\n        "));
        }
        text
    }

    /// `location: problem`.
    fn headline(&self) -> String {
        let problem = shown_line(&self.problem);
        match self.location.as_ref().map(ToString::to_string).filter(|place| !place.is_empty()) {
            Some(place) => format!("{place}: {problem}"),
            None => problem,
        }
    }

    /// Messages of the sources, outermost first, without those that only repeat the one before.
    fn causes(&self) -> Vec<String> {
        let mut messages: Vec<String> = Vec::new();
        let mut next: Option<&(dyn Error + 'static)> = self.source.as_ref().map(|e| e.as_ref() as _);
        while let Some(error) = next.filter(|_| messages.len() < MAX_CAUSES) {
            let message = error.to_string();
            let before = messages.last().unwrap_or(&self.problem);
            if !before.contains(&message) {
                messages.push(message);
            }
            next = error.source();
        }
        messages
    }
}

/// A text of bounded length without control characters, on one line.
fn shown_line(text: &str) -> String {
    neutral_line(&excerpt(text, LONGEST)).into_owned()
}

/// A text of bounded length without control characters, which may have several lines.
fn shown(text: &str) -> String {
    let mut lines: Vec<String> = text.lines().take(MAX_HELP_LINES).map(shown_line).collect();
    let more = text.lines().count() - lines.len();
    if more > 0 {
        lines.push(format!("({more} lines more)"));
    }
    lines.join("\n")
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let headline = self.headline();
        let line = match &self.help {
            Some(help) => format!("{headline}; {}", shown_line(&help.replace('\n', ", "))),
            None => headline,
        };
        f.write_str(&excerpt(&line, LONGEST_LINE))
    }
}

impl Error for Diagnostic {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.source.as_ref().map(|source| source.as_ref() as _)
    }
}

impl PartialEq for Diagnostic {
    /// Sources are compared by their messages.
    fn eq(&self, other: &Self) -> bool {
        (self.code, &self.location, &self.problem, &self.help, &self.changes)
            == (other.code, &other.location, &other.problem, &other.help, &other.changes)
            && self.causes() == other.causes()
    }
}

impl Serialize for Diagnostic {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        WrittenDiagnostic {
            code: self.code.name(),
            location: self.location(),
            problem: &self.problem,
            help: self.help(),
            changes: &self.changes,
            causes: self.causes(),
        }
        .serialize(serializer)
    }
}

/// What is wrong, where, and what to do about it. Keys without content are absent.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Diagnostic")]
struct WrittenDiagnostic<'a> {
    /// Kind of fault, which `pinswitch explain` describes.
    code: &'a str,
    /// Where the problem is.
    #[serde(skip_serializing_if = "Option::is_none")]
    location: Option<&'a Location>,
    /// What is wrong, with the bound that was broken.
    problem: &'a str,
    /// What to do about it.
    #[serde(skip_serializing_if = "Option::is_none")]
    help: Option<&'a str>,
    /// Values that solve the problem when all of them are set.
    #[serde(skip_serializing_if = "<[Change]>::is_empty")]
    changes: &'a [Change],
    /// Messages of the errors that caused it, outermost first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    causes: Vec<String>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codes::{CANNOT_WRITE, GROOVES_OVERLAP, OUT_OF_RANGE};

    #[test]
    fn a_diagnostic_is_two_parts() {
        let diagnostic = Diagnostic::new(GROOVES_OVERLAP, "grooves overlap")
            .with_location(Location::field("segment.grooves", "40"))
            .with_help("lower it to 20");
        assert_eq!(
            diagnostic.render("error"),
            "error: segment.grooves = 40: grooves overlap [grooves-overlap]\n  help: lower it to 20"
        );
        assert_eq!(diagnostic.to_string(), "segment.grooves = 40: grooves overlap; lower it to 20");
    }

    #[test]
    fn a_location_is_added_once() {
        let line = Location::in_text("a.toml", "[shell]\nwidth_mm = 1\n", 8..16).with_field("shell", "table");
        let diagnostic =
            Diagnostic::new(OUT_OF_RANGE, "too narrow").with_location(Location::field("shell.width_mm", "1"));
        let placed = diagnostic.or_at(&line);
        assert_eq!(placed.to_string(), "a.toml:2:1: shell.width_mm = 1: too narrow");
        assert_eq!(placed.clone().or_at(&Location::line("b.toml", 7)), placed);
        let without_field = Diagnostic::new(OUT_OF_RANGE, "too narrow").or_at(&line);
        assert_eq!(without_field.to_string(), "a.toml:2:1: shell = table: too narrow");
    }

    #[test]
    fn causes_follow_the_problem() {
        let cause = std::io::Error::other("disk full");
        let diagnostic = Diagnostic::new(CANNOT_WRITE, "cannot write shell.stl").with_source(cause);
        assert_eq!(
            diagnostic.render("error"),
            "error: cannot write shell.stl [cannot-write]\n  cause: disk full"
        );
        let same = Diagnostic::from_error(CANNOT_WRITE, std::io::Error::other("disk full"));
        assert_eq!(same.render("error"), "error: disk full [cannot-write]");
        let located =
            Diagnostic::new(OUT_OF_RANGE, "is wrong").with_location(Location::file("a")).with_help("drop it");
        assert_eq!(Diagnostic::from_error(CANNOT_WRITE, located.clone()), located);
    }

    #[test]
    fn foreign_text_is_short_and_neutral() {
        let problem = format!("\u{1b}[31m{}", "x".repeat(100_000));
        let diagnostic = Diagnostic::new(OUT_OF_RANGE, problem).with_location(Location::file("\u{7}.csv"));
        let text = diagnostic.render("error");
        assert!(text.chars().count() < 600 && !text.contains(char::is_control), "{text}");
    }

    #[test]
    fn a_cut_line_keeps_its_code() {
        let diagnostic = Diagnostic::new(OUT_OF_RANGE, "x ".repeat(100_000))
            .with_location(Location::field("y".repeat(100_000), "z".repeat(100_000)))
            .with_help("lower it");
        let text = diagnostic.render("warning");
        let first = text.lines().next().unwrap();
        assert!(first.ends_with(" [out-of-range]") && first.chars().count() < 1200, "{first}");
        assert!(!diagnostic.to_string().contains("out-of-range"));
    }

    #[test]
    fn json_names_every_part() {
        let change = Change { field: "segment.grooves".to_owned(), value: "20".to_owned() };
        let diagnostic = Diagnostic::new(GROOVES_OVERLAP, "grooves overlap")
            .with_location(Location::line("mine.toml", 2).with_field("segment.grooves", "40"))
            .with_help("lower it to 20")
            .with_changes(vec![change]);
        assert_eq!(
            serde_json::to_value(&diagnostic).unwrap(),
            serde_json::json!({
                "code": "grooves-overlap",
                "location": {"file": "mine.toml", "line": 2, "field": "segment.grooves", "value": "40"},
                "problem": "grooves overlap",
                "help": "lower it to 20",
                "changes": [{"field": "segment.grooves", "value": "20"}],
            })
        );
    }
}
