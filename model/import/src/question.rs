//! Decisions that only a person can take.

use pinswitch_diagnostic::Diagnostic;
use serde::Serialize;

/// A decision that the file leaves open: two or more readings, and the option that decides for each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Question {
    /// What is uncertain.
    pub problem: String,
    /// Each reading, and the value of `--set` that decides for it.
    pub readings: Vec<(String, String)>,
}

impl Question {
    /// Returns the question as an error, whose help lists the options.
    pub fn to_diagnostic(&self) -> Diagnostic {
        let readings: Vec<String> =
            self.readings.iter().map(|(reading, option)| format!("--set '{option}' ({reading})")).collect();
        Diagnostic::new(self.problem.clone()).with_help(format!("decide with {}", readings.join(", or ")))
    }
}
