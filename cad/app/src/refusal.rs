//! Why a design is refused, in the form in which the page shows it: at the control of the field,
//! with a button that applies a remedy.

use pinswitch_diagnostic::{Change, Diagnostic, Location};
use serde::Serialize;

/// The JSON of `trouble` in an answer.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Refusal {
    /// Field as `table.key`; another word if the problem is not in a field, such as `syntax`; empty
    /// without one.
    field: String,
    /// Value of the field, as written.
    value: Option<String>,
    problem: String,
    /// What to do; may be empty.
    help: String,
    /// Values that solve the problem when the page sets all of them; empty if only a person can
    /// solve it.
    changes: Vec<Assignment>,
    /// Other values that solve it as well, the nearest first.
    alternatives: Vec<Vec<Assignment>>,
}

/// One value to set.
#[derive(Debug, PartialEq, Serialize)]
struct Assignment {
    path: String,
    value: serde_json::Value,
}

impl From<Diagnostic> for Refusal {
    /// Keeps the field; a file and a line become part of the problem.
    fn from(diagnostic: Diagnostic) -> Self {
        let location = diagnostic.location().cloned().unwrap_or_default();
        let place = Location { field: None, value: None, ..location.clone() }.to_string();
        let problem = diagnostic.problem();
        let assignments = |changes: &[Change]| {
            let assignment = |change: &Change| {
                // Numbers, lists, quoted words and booleans are the same in TOML and in JSON.
                let value = serde_json::from_str(&change.value).ok()?;
                Some(Assignment { path: change.field.clone(), value })
            };
            changes.iter().filter_map(assignment).collect()
        };
        Self {
            problem: if place.is_empty() { problem.to_owned() } else { format!("{place}: {problem}") },
            field: location.field.unwrap_or_default(),
            value: location.value,
            help: diagnostic.help().unwrap_or_default().to_owned(),
            changes: assignments(diagnostic.changes()),
            alternatives: diagnostic.alternatives().iter().map(|changes| assignments(changes)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_diagnostic::codes;
    use serde_json::json;

    #[test]
    fn changes_become_json_values() {
        let change = |field: &str, value: &str| Change { field: field.to_owned(), value: value.to_owned() };
        let diagnostic = Diagnostic::new(codes::GROOVES_OVERLAP, "grooves overlap")
            .with_location(Location::field("segment.grooves", "40"))
            .with_help("lower it to 20")
            .with_changes(vec![change("segment.grooves", "20"), change("layout.pins", "[5, 8]")])
            .with_alternatives(vec![vec![change("shell.outer_radius_mm", "31.5")]]);
        assert_eq!(
            serde_json::to_value(Refusal::from(diagnostic)).unwrap(),
            json!({
                "field": "segment.grooves", "value": "40", "problem": "grooves overlap", "help": "lower it to 20",
                "changes": [{"path": "segment.grooves", "value": 20}, {"path": "layout.pins", "value": [5, 8]}],
                "alternatives": [[{"path": "shell.outer_radius_mm", "value": 31.5}]],
            })
        );
    }

    #[test]
    fn a_file_is_part_of_the_problem() {
        let diagnostic =
            Diagnostic::new(codes::DAMAGED_FILE, "is empty").with_location(Location::line("x.toml", 3));
        let refusal = Refusal::from(diagnostic);
        assert_eq!((refusal.field.as_str(), refusal.problem.as_str()), ("", "x.toml:3: is empty"));
    }
}
