//! The boundary to the terminal.
//!
//! Names and cells of files are foreign text, and a terminal obeys the control characters in it. Every text for a
//! person leaves the program through this module, which makes them visible. Data (CSV, JSON, TOML, pictures) keeps its
//! bytes, except on a terminal.

use std::borrow::Cow;
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use log::{Level, LevelFilter};
use pinswitch_diagnostic::{Diagnostic, codes, neutral, neutral_line};
use schemars::JsonSchema;
use serde::Serialize;

use super::Failure;

/// Whether something was printed on standard output. A program that reads JSON there reads one document.
static IS_STDOUT_USED: AtomicBool = AtomicBool::new(false);

/// Prints text for a person on standard output.
///
/// # Errors
/// [`Failure::failed`] if it cannot be written.
pub(super) fn print_text(text: &str) -> Result<(), Failure> {
    write_stdout(neutral(text).as_bytes())
}

/// Prints data on standard output.
///
/// # Errors
/// [`Failure::failed`] if it cannot be written.
pub(super) fn print_data(bytes: &[u8]) -> Result<(), Failure> {
    write_stdout(&data(bytes, std::io::stdout().is_terminal()))
}

/// Prints `value` on standard output as indented JSON.
///
/// # Errors
/// [`Failure::failed`] if it cannot be written.
pub(super) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    print_data(&to_json(value)?)
}

/// Returns `value` as indented JSON with a line feed at the end.
///
/// # Errors
/// [`Failure::failed`] if the value has no JSON form.
pub(super) fn to_json(value: &impl Serialize) -> Result<Vec<u8>, Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Failure::failed(Diagnostic::from_error(codes::INTERNAL_ERROR, e)))?;
    Ok(escaped_json(&(text + "\n")).into_bytes())
}

/// Escapes the characters that a terminal may act on, and that JSON allows in its strings.
pub(super) fn escaped_json(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        let mut one = [0; 4];
        // A line feed is between values here: within strings it is escaped already.
        if c == '\n' || neutral(c.encode_utf8(&mut one)) == *c.encode_utf8(&mut [0; 4]) {
            escaped.push(c);
        } else {
            let mut units = [0; 2];
            c.encode_utf16(&mut units).iter().for_each(|unit| escaped.push_str(&format!("\\u{unit:04x}")));
        }
    }
    escaped
}

/// Prints a failure as text on standard error, and as JSON on standard output if `as_json`. A command that has
/// printed its report already does not print a second document.
pub(super) fn report_failure(failure: &Failure, as_json: bool) {
    if as_json {
        print_failure_json(failure);
    }
    print_line(&failure.render());
}

/// What a command prints with `--json` in place of its result when it fails.
#[derive(Serialize, JsonSchema)]
pub(super) struct FailureReport<'a> {
    /// Why it stopped.
    error: &'a Failure,
}

/// Prints a failure as JSON on standard output, unless the command has printed its report there.
pub(super) fn print_failure_json(failure: &Failure) {
    if !IS_STDOUT_USED.load(Ordering::Relaxed) {
        // The text and the exit code report the failure even if this cannot be written.
        let _ = print_json(&FailureReport { error: failure });
    }
}

/// Prints a warning on standard error, unless `--quiet` is given.
pub(super) fn warn(warning: impl Into<Diagnostic>) {
    if log::max_level() >= LevelFilter::Warn {
        print_line(&warning.into().render("warning"));
    }
}

/// Prints text for a person on standard error, with a line feed.
///
/// `eprintln!` would panic if standard error is closed or full; the exit code reports a failure all the same.
pub(super) fn print_line(text: &str) {
    let _ = writeln!(std::io::stderr(), "{}", neutral(text));
}

/// Prints text for a person on standard error, in colours on a terminal that has them. `styled` is the same text with the
/// escape sequences of the colours.
pub(super) fn print_styled(plain: &str, styled: &str) {
    let is_set = |variable| std::env::var_os(variable).is_some_and(|value| !value.is_empty());
    let is_dumb = std::env::var_os("TERM").is_some_and(|terminal| terminal == "dumb");
    let is_styled = std::io::stderr().is_terminal() && !is_set("NO_COLOR") && !is_dumb;
    let _ = std::io::stderr().write_all(if is_styled { styled } else { plain }.as_bytes());
}

/// Starts the log on standard error.
pub(super) fn start_log(level: LevelFilter) {
    env_logger::Builder::new()
        .filter_level(level)
        .format(|line, record| {
            let (level, style) = (record.level(), line.default_level_style(record.level()));
            let text = record.args().to_string();
            match level {
                // The shape of a diagnostic.
                Level::Warn => writeln!(line, "{style}warning{style:#}: {}", neutral_line(&text)),
                _ => writeln!(line, "[{style}{level:<5}{style:#}] {}", neutral_line(&text)),
            }
        })
        .init();
}

/// Writes to standard output. A reader that stops early, as `head` does, is not an error.
fn write_stdout(bytes: &[u8]) -> Result<(), Failure> {
    IS_STDOUT_USED.store(true, Ordering::Relaxed);
    match std::io::stdout().lock().write_all(bytes) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::failed(
            Diagnostic::new(codes::CANNOT_WRITE, "cannot write to standard output").with_source(e),
        )),
        _ => Ok(()),
    }
}

/// Returns the bytes of data as they are written: unchanged, except that a terminal gets no control characters.
fn data(bytes: &[u8], is_terminal: bool) -> Cow<'_, [u8]> {
    if !is_terminal {
        return Cow::Borrowed(bytes);
    }
    Cow::Owned(neutral(&String::from_utf8_lossy(bytes)).into_owned().into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_terminal_gets_changed_data() {
        let bytes = b"a\t\x1b[2J\xff\n";
        assert_eq!(&*data(bytes, false), bytes);
        assert_eq!(&*data(bytes, true), "a \\u{1b}[2J\u{fffd}\n".as_bytes());
    }

    #[test]
    fn json_ends_with_a_line_feed() {
        assert_eq!(to_json(&[1]).unwrap(), b"[\n  1\n]\n");
    }
}
