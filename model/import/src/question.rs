//! Decisions that only a person can take.

use pinswitch_diagnostic::{Code, Diagnostic};
use schemars::JsonSchema;
use serde::Serialize;

/// A decision that the file leaves open: two or more readings, and the option that decides for
/// each.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Question {
    /// Code of the kind of uncertainty.
    #[schemars(with = "String")]
    pub code: Code,
    /// What is uncertain.
    pub problem: String,
    /// Each reading of the file.
    pub answers: Vec<Answer>,
}

/// One reading of a file, and the options that decide for it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Answer {
    /// What the file then means.
    pub reading: String,
    /// Values of `--set`, such as `decimal=comma`.
    pub options: Vec<String>,
}

impl Question {
    /// Creates a question from its readings and the options of each, one a line.
    pub(crate) fn new(
        code: Code,
        problem: impl Into<String>,
        answers: impl IntoIterator<Item = (String, String)>,
    ) -> Self {
        let answers = answers.into_iter().map(|(reading, options)| Answer {
            reading,
            options: options.lines().map(str::to_owned).collect(),
        });
        Self { code, problem: problem.into(), answers: answers.collect() }
    }

    /// Returns the question as an error, whose help lists the options.
    pub fn to_diagnostic(&self) -> Diagnostic {
        let answers: Vec<String> = self
            .answers
            .iter()
            .map(|answer| {
                let options: Vec<String> = answer.options.iter().map(|o| format!("--set '{o}'")).collect();
                format!("{} ({})", options.join(" "), answer.reading)
            })
            .collect();
        Diagnostic::new(self.code, self.problem.clone())
            .with_help(format!("decide with {}", answers.join("\nor with ")))
    }
}
