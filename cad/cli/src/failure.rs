//! How a command ends when it cannot do what was asked.

use std::fmt::Display;
use std::io::Write;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use pinswitch_diagnostic::excerpt;

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
        say(format_args!("error: {message}"));
        ExitCode::from(code)
    }
}

/// Writes a line on standard error. Where nobody listens or the disk is full there is no one to tell, and the exit code says
/// enough: `eprintln!` would panic.
pub(super) fn say(line: impl Display) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Files that a command cannot do without, and the kind of each that `init` writes.
const KINDS: [(&str, &str); 3] = [("<PLAN>", "plan"), ("<RUN>", "run"), ("<SWEEP>", "sweep")];

/// The error with where a file comes from that was not given.
fn with_kind_of_file(mut error: clap::Error) -> clap::Error {
    let Some(ContextValue::Strings(missing)) = error.get(ContextKind::InvalidArg) else { return error };
    let kind = KINDS.iter().find(|(name, _)| missing.iter().any(|argument| argument == name));
    if let Some((_, kind)) = kind.filter(|_| error.kind() == ErrorKind::MissingRequiredArgument) {
        let tip = format!("`pinswitch init {kind} --out {kind}.toml` writes one to start from");
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

/// Prints what is wrong with the arguments, or the help that they ask for, and returns the exit code.
pub(super) fn report_usage(error: clap::Error) -> ExitCode {
    let error = with_kind_of_file(error);
    let text = error.render().to_string();
    if error.use_stderr() && text.chars().count() > MAX_CHARACTERS {
        // An argument of any length may stand in it.
        say(bounded_lines(text.trim_end()));
    } else {
        // Nobody may listen any more, as after `head`.
        let _ = error.print();
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}

/// A text of several lines, none of which is long, and all of which are short enough to be read.
fn bounded_lines(text: &str) -> String {
    let lines: Vec<_> = text.lines().map(|line| excerpt(line, MAX_CHARACTERS / 2)).collect();
    excerpt(&lines.join("\n"), MAX_CHARACTERS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_with_an_argument_is_short_however_long_it_is() {
        let text =
            format!("error: invalid value '{}' for '--law'\n\nFor more, try '--help'.", "x".repeat(100_000));
        let short = bounded_lines(&text);
        assert!(short.chars().count() <= 590, "{short}");
        assert!(short.starts_with("error: invalid value") && short.ends_with("try '--help'."), "{short}");
    }

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
