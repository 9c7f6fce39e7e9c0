//! How a command ends when it cannot do what was asked.

use std::fmt::Display;
use std::process::ExitCode;

use pinswitch_friction::excerpt;

/// What stands between several errors of one command.
const BETWEEN: &str = "\nerror: ";
/// Most characters of one error.
const MAX_CHARACTERS: usize = 590;
/// Errors, each short enough to be read: a value of any length that the input holds may stand in one.
fn bounded(message: &str) -> String {
    message.split(BETWEEN).map(|one| excerpt(one, MAX_CHARACTERS)).collect::<Vec<_>>().join(BETWEEN)
}

/// Why a command stopped, and with which exit code.
#[derive(Debug)]
pub enum Failure {
    /// The work could not be done (exit code 1): a full disk, an invalid mesh.
    Failed(String),
    /// The input cannot be used (exit code 2): it names what to change.
    BadInput(String),
}

impl Failure {
    /// Exit code 1 with this message.
    pub fn failed(message: impl Display) -> Self {
        Self::Failed(bounded(&message.to_string()))
    }

    /// Exit code 2 with this message.
    pub fn bad_input(message: impl Display) -> Self {
        Self::BadInput(bounded(&message.to_string()))
    }

    /// What went wrong.
    pub(super) fn message(&self) -> &str {
        match self {
            Self::Failed(message) | Self::BadInput(message) => message,
        }
    }

    /// Prints the message on standard error and returns the exit code.
    pub(super) fn report(&self) -> ExitCode {
        let (message, code) = match self {
            Self::Failed(message) => (message, 1),
            Self::BadInput(message) => (message, 2),
        };
        eprintln!("error: {message}");
        ExitCode::from(code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_short_and_keeps_its_beginning_and_its_remedy() {
        let long = format!("my.toml:2: layout.pins = [{}]; give fewer", "5, ".repeat(100_000));
        let failure = Failure::bad_input(&long);
        let message = failure.message();
        assert!(message.chars().count() <= 590, "{message}");
        assert!(
            message.starts_with("my.toml:2: layout.pins") && message.ends_with("; give fewer"),
            "{message}"
        );
        // Several errors are bounded one by one.
        let two = Failure::bad_input(format!("a{BETWEEN}{long}"));
        assert_eq!(two.message(), format!("a{BETWEEN}{message}"));
        assert_eq!(Failure::failed("short").message(), "short");
    }
}
