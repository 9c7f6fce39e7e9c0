//! How a command ends when it cannot do what was asked.

use std::fmt::Display;
use std::process::ExitCode;

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
        Self::Failed(message.to_string())
    }

    /// Exit code 2 with this message.
    pub fn bad_input(message: impl Display) -> Self {
        Self::BadInput(message.to_string())
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
