//! Errors of configurations: [`Diagnostic`]s that name a field.

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};

/// The error of a configuration: a [`Diagnostic`] whose location names the field and its value.
pub type ConfigError = Diagnostic;

/// Returns the error of a text that is not valid TOML, with the parser's `message`.
pub fn syntax_error(location: Location, message: &str) -> Diagnostic {
    Diagnostic::new(codes::INVALID_TOML, format!("invalid TOML: {}", message.trim().replace('\n', ", ")))
        .with_location(location)
        .with_help("fix this line; templates/reference.toml shows the format")
}

/// A field without a value or a file.
pub(crate) fn field_location(field: impl Into<String>) -> Location {
    Location { field: Some(field.into()), ..Location::default() }
}

/// Why a parameter does not accept a value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{problem}; {help}")]
pub struct ValueError {
    code: Code,
    problem: String,
    help: String,
}

impl ValueError {
    pub(crate) fn new(code: Code, problem: impl Into<String>, help: impl Into<String>) -> Self {
        Self { code, problem: problem.into(), help: help.into() }
    }

    /// Kind of fault.
    pub fn code(&self) -> Code {
        self.code
    }

    /// What is wrong with the value, such as `outside 2 to 100`.
    pub fn problem(&self) -> &str {
        &self.problem
    }

    /// The values that are accepted, as an instruction.
    pub fn help(&self) -> &str {
        &self.help
    }

    /// The diagnostic of this error in `field`, whose `value` was refused.
    #[must_use]
    pub fn in_field(self, field: impl Into<String>, value: impl Into<String>) -> Diagnostic {
        Diagnostic::from(self).with_location(Location::field(field, value))
    }
}

impl From<ValueError> for Diagnostic {
    fn from(error: ValueError) -> Self {
        Self::new(error.code, error.problem).with_help(error.help)
    }
}
