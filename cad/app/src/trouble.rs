//! What is wrong with a design, as the page shows it: at the control of the field, with a button that mends it.

use pinswitch_switch::config::ConfigError;
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

impl From<ConfigError> for Trouble {
    fn from(error: ConfigError) -> Self {
        let changes = error.changes.into_iter().filter_map(|(path, value)| {
            // Numbers, lists, words in quotes and booleans are the same in TOML and in JSON.
            Some(Change { path, value: serde_json::from_str(&value).ok()? })
        });
        Self {
            field: error.field,
            value: error.value,
            problem: error.problem,
            remedy: error.remedy,
            changes: changes.collect(),
        }
    }
}
