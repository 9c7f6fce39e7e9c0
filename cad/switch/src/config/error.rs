//! Why a configuration cannot be used.

use std::fmt;

use pinswitch_diagnostic::excerpt;

/// Most characters of an error behind its place.
const LONGEST: usize = 520;

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// File, or the option that gave the value.
    pub file: String,
    /// Line, from 1.
    pub line: Option<usize>,
}

impl Place {
    /// The place of byte `offset` in `text`.
    pub fn new(file: &str, text: &str, offset: usize) -> Self {
        let line = text.bytes().take(offset).filter(|b| *b == b'\n').count() + 1;
        Self { file: file.to_owned(), line: Some(line) }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}", self.file),
            None => f.write_str(&self.file),
        }
    }
}

/// An error in one field: its value, what is wrong, and the remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigError {
    /// The field, such as `shell.width_mm`.
    pub field: String,
    /// Its value, as written.
    pub value: Option<String>,
    /// What is wrong with it, with the bound.
    pub problem: String,
    /// What to change.
    pub remedy: String,
    /// Fields and values, as TOML, that mend it when all of them are set: the first way that `remedy` tells. Empty where only
    /// words can say it.
    pub changes: Vec<(String, String)>,
    /// Where it stands.
    pub place: Option<Place>,
}

impl ConfigError {
    /// A value that its field does not accept.
    pub fn new(field: impl Into<String>, value: impl Into<String>, remedy: String) -> Self {
        Self {
            field: field.into(),
            value: Some(value.into()),
            problem: "is not accepted".to_owned(),
            remedy,
            changes: Vec::new(),
            place: None,
        }
    }

    /// Text that is no TOML.
    pub fn syntax(place: Place, message: &str) -> Self {
        Self {
            field: "syntax".to_owned(),
            value: None,
            problem: message.trim().replace('\n', ", "),
            remedy: "mend the line; templates/reference.toml shows the form".to_owned(),
            changes: Vec::new(),
            place: Some(place),
        }
    }

    /// The same error with its place.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        self.place.get_or_insert(place);
        self
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        let value = self.value.as_ref().map(|value| format!(" = {}", excerpt(value, 120)));
        let value = value.unwrap_or_default();
        let text = format!("{}{value} {}; {}", excerpt(&self.field, 100), self.problem, self.remedy);
        // A value of any length may stand in it; the place is that of a file.
        f.write_str(&excerpt(&text, LONGEST))
    }
}

impl std::error::Error for ConfigError {}
