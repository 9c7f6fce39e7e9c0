//! Why a command stopped: its exit code and its diagnostics.

use std::error::Error;
use std::fmt;
use std::process::ExitCode;

use pinswitch_diagnostic::Diagnostic;
use schemars::JsonSchema;
use serde::Serialize;

/// Exit code of work that could not be done: a full disk, an invalid mesh.
const FAILED: u8 = 1;
/// Exit code of input that cannot be used.
const BAD_INPUT: u8 = 2;

/// Why a command stopped: an exit code and at least one diagnostic.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Failure {
    /// Exit code of the program: 1 failed, 2 bad input.
    exit_code: u8,
    /// Every problem, in the order in which it was met.
    diagnostics: Vec<Diagnostic>,
}

impl Failure {
    /// Creates a failure with exit code 1: the work could not be done.
    pub fn failed(diagnostic: impl Into<Diagnostic>) -> Self {
        Self { exit_code: FAILED, diagnostics: vec![diagnostic.into()] }
    }

    /// Creates a failure with exit code 2: the input cannot be used.
    pub fn bad_input(diagnostic: impl Into<Diagnostic>) -> Self {
        Self { exit_code: BAD_INPUT, diagnostics: vec![diagnostic.into()] }
    }

    /// Creates a failure with exit code 2 from several diagnostics; `None` if there are none.
    pub fn bad_inputs(diagnostics: impl IntoIterator<Item = Diagnostic>) -> Option<Self> {
        let diagnostics: Vec<_> = diagnostics.into_iter().collect();
        (!diagnostics.is_empty()).then_some(Self { exit_code: BAD_INPUT, diagnostics })
    }

    /// Exit code of the program: 1 failed, 2 bad input.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.exit_code)
    }

    /// Every problem, in the order in which it was met.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Returns the text for a person: each problem with its location, its causes and its help.
    pub(super) fn render(&self) -> String {
        self.diagnostics.iter().map(|one| one.render("error")).collect::<Vec<_>>().join("\n")
    }
}

impl fmt::Display for Failure {
    /// Writes one line per problem.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, diagnostic) in self.diagnostics.iter().enumerate() {
            write!(f, "{}{diagnostic}", if i == 0 { "" } else { "\n" })?;
        }
        Ok(())
    }
}

impl Error for Failure {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.diagnostics.first().and_then(Error::source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_diagnostic::codes::{CANNOT_WRITE, OUT_OF_RANGE};

    #[test]
    fn every_diagnostic_is_rendered() {
        let both =
            Failure::bad_inputs(["a is wrong", "b is wrong"].map(|text| Diagnostic::new(OUT_OF_RANGE, text)))
                .unwrap();
        assert_eq!(both.render(), "error: a is wrong [out-of-range]\nerror: b is wrong [out-of-range]");
        assert_eq!(both.to_string(), "a is wrong\nb is wrong");
        assert!(Failure::bad_inputs([]).is_none());
    }

    #[test]
    fn a_failure_is_json() {
        let failure = Failure::bad_input(Diagnostic::new(OUT_OF_RANGE, "a is wrong").with_help("drop it"));
        assert_eq!(
            serde_json::to_value(&failure).unwrap(),
            serde_json::json!({
                "exit_code": 2,
                "diagnostics": [{"code": "out-of-range", "problem": "a is wrong", "help": "drop it"}],
            })
        );
    }

    #[test]
    fn sources_are_kept() {
        let source = std::io::Error::other("disk full");
        let failure =
            Failure::failed(Diagnostic::new(CANNOT_WRITE, "cannot write a.stl").with_source(source));
        assert_eq!(failure.source().unwrap().to_string(), "disk full");
        assert_eq!(failure.render(), "error: cannot write a.stl [cannot-write]\n  cause: disk full");
        assert_eq!(failure.exit_code(), ExitCode::from(1));
    }
}
