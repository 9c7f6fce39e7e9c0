//! A warning with its code.

use std::borrow::Cow;
use std::fmt;

use pinswitch_diagnostic::{Code, Diagnostic};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Serialize, Serializer};

/// What a design or a part is warned about, with the parameter to change. In files it is its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    code: Code,
    text: String,
}

impl Warning {
    /// A warning of this kind.
    pub fn new(code: Code, text: impl Into<String>) -> Self {
        Self { code, text: text.into() }
    }

    /// Returns the kind of the warning.
    pub fn code(&self) -> Code {
        self.code
    }

    /// Returns the warning on one line.
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl fmt::Display for Warning {
    /// Writes the text.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl From<&Warning> for Diagnostic {
    fn from(warning: &Warning) -> Self {
        Self::new(warning.code, warning.text.as_str())
    }
}

impl Serialize for Warning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text)
    }
}

impl JsonSchema for Warning {
    fn schema_name() -> Cow<'static, str> {
        "Warning".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        String::json_schema(generator)
    }
}
