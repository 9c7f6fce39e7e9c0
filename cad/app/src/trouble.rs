//! What is wrong with a design, as the page shows it: at the control of the field, with a button that mends it.

use pinswitch_switch::config::{self, Diagnostic};
use serde::Serialize;

/// An error of one field.
#[derive(Debug, Serialize)]
pub(crate) struct Trouble {
    /// The field, `table.key`; another word where it is none of a configuration.
    field: String,
    /// Its value, as written.
    value: Option<String>,
    problem: String,
    remedy: String,
    /// What the page can set to mend it: all of it together. Empty where only a person can.
    changes: Vec<Change>,
}

/// One value to set.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Change {
    path: String,
    value: serde_json::Value,
}

impl Trouble {
    /// Trouble with no field of its own.
    pub(crate) fn general(problem: impl std::fmt::Display) -> Self {
        let problem = problem.to_string();
        Self { field: String::new(), value: None, problem, remedy: String::new(), changes: Vec::new() }
    }
}

impl From<Diagnostic> for Trouble {
    fn from(error: Diagnostic) -> Self {
        let changes = error.changes().iter().filter_map(|config::Change { field, value }| {
            // Numbers, lists, words in quotes and booleans are the same in TOML and in JSON.
            Some(Change { path: field.clone(), value: serde_json::from_str(value).ok()? })
        });
        let location = error.location().cloned().unwrap_or_default();
        Self {
            field: location.field.unwrap_or_default(),
            value: location.value,
            problem: error.problem().to_owned(),
            remedy: error.help().unwrap_or_default().to_owned(),
            changes: changes.collect(),
        }
    }
}
