//! Errors of the arguments, which clap finds before a command runs.

use std::error::Error;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use pinswitch_batch::ShardError;
use pinswitch_diagnostic::{Diagnostic, Location, codes, excerpt, neutral};

use super::Failure;
use super::terminal::{print_failure_json, print_line, print_styled, report_failure};

/// Most characters of an error of the arguments, which quotes arguments of any length.
const MAX_CHARACTERS: usize = 590;
/// Beginning of an error that clap has rendered.
const ERROR: &str = "error: ";
/// Arguments that are files, and the kind of file that `init` writes for each.
const STARTERS: [(&str, &str); 3] = [("<PLAN>", "plan"), ("<RUN>", "run"), ("<SWEEP>", "sweep")];

/// Prints what is wrong with the arguments, or the requested help, and returns the exit code.
pub(super) fn report(error: clap::Error) -> ExitCode {
    if let Some(diagnostic) = of_value(&error) {
        let as_json = std::env::args_os().any(|argument| argument == "--json");
        report_failure(&Failure::bad_input(diagnostic), as_json);
        return ExitCode::from(2);
    }
    let error = with_starter(error);
    let text = error.render().to_string();
    if error.use_stderr() && std::env::args_os().any(|argument| argument == "--json") {
        print_failure_json(&Failure::bad_input(diagnostic(&text)));
    }
    if error.use_stderr() && (text.chars().count() > MAX_CHARACTERS || quotes_controls(&error)) {
        print_line(&with_code(&bounded(text.trim_end())));
    } else if text.starts_with(ERROR) {
        print_styled(&with_code(&text), &with_code(&error.render().ansi().to_string()));
    } else {
        // The requested help. The reader may have stopped, as `head` does.
        let _ = error.print();
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}

/// Returns the error of a value that our own parser refused, at its option; `None` for other errors.
fn of_value(error: &clap::Error) -> Option<Diagnostic> {
    let source = error.source()?;
    let refused = source.downcast_ref::<Diagnostic>().cloned();
    let refused = refused.or_else(|| source.downcast_ref::<ShardError>().map(|e| Diagnostic::from(*e)))?;
    let word = |kind| error.get(kind).map(ToString::to_string).unwrap_or_default();
    let option = word(ContextKind::InvalidArg);
    // `--shard <K/N>` without the name of its value.
    let option = option.split(' ').next().unwrap_or_default();
    Some(refused.with_location(Location::field(option, word(ContextKind::InvalidValue))))
}

/// Returns an error that clap has rendered: the first paragraph is the problem, the others are the help.
fn diagnostic(text: &str) -> Diagnostic {
    let (problem, help) = text.split_once("\n\n").unwrap_or((text, ""));
    let problem = Diagnostic::new(codes::USAGE, problem.trim_start_matches(ERROR).trim());
    if help.trim().is_empty() { problem } else { problem.with_help(help.trim()) }
}

/// Adds the code to the first paragraph, the problem.
fn with_code(text: &str) -> String {
    let (problem, rest) = text.split_at(text.find("\n\n").unwrap_or(text.trim_end().len()));
    format!("{problem} [{}]{rest}", codes::USAGE)
}

/// Whether the error quotes an argument with control characters.
fn quotes_controls(error: &clap::Error) -> bool {
    error.context().any(|(_, value)| {
        let text = value.to_string();
        neutral(&text) != text
    })
}

/// Adds how to start the file that is missing.
fn with_starter(mut error: clap::Error) -> clap::Error {
    let Some(ContextValue::Strings(missing)) = error.get(ContextKind::InvalidArg) else { return error };
    let starter = STARTERS.iter().find(|(name, _)| missing.iter().any(|argument| argument == name));
    if let Some((_, kind)) = starter.filter(|_| error.kind() == ErrorKind::MissingRequiredArgument) {
        let tip = format!("`pinswitch init {kind} --out {kind}.toml` writes one to start from");
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

/// Shortens each line and then the whole text.
fn bounded(text: &str) -> String {
    let lines: Vec<_> = text.lines().map(|line| excerpt(line, MAX_CHARACTERS / 2)).collect();
    excerpt(&lines.join("\n"), MAX_CHARACTERS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_controls_are_found() {
        let error = |argument: &str| {
            let command = clap::Command::new("p").arg(clap::arg!([kind]).value_parser(["a", "b"]));
            command.try_get_matches_from(["p", argument]).unwrap_err()
        };
        assert!(quotes_controls(&error("\u{1b}[2J")) && quotes_controls(&error("--\u{9b}2J")));
        assert!(!quotes_controls(&error("c")) && !quotes_controls(&error("--c")));
    }

    #[test]
    fn help_of_a_refused_value_is_separate() {
        let arg = clap::arg!(--shard <NUMBERS>).value_parser(clap::value_parser!(pinswitch_batch::Shard));
        let error =
            clap::Command::new("p").arg(arg).try_get_matches_from(["p", "--shard", "9/2"]).unwrap_err();
        let diagnostic = of_value(&error).unwrap();
        assert_eq!(
            diagnostic.render("error"),
            "error: --shard = 9/2: invalid shard: expected K/N with 1 <= K <= N [invalid-shard]\n  help: write a shard such as 2/8"
        );
        let number = clap::arg!(--points <NUMBER>).value_parser(clap::value_parser!(u8));
        let error =
            clap::Command::new("p").arg(number).try_get_matches_from(["p", "--points", "x"]).unwrap_err();
        assert_eq!(of_value(&error), None);
    }

    #[test]
    fn problem_has_the_code() {
        let text = "error: missing:\n  <PLAN>\n\nUsage: p <PLAN>\n";
        assert_eq!(with_code(text), "error: missing:\n  <PLAN> [usage]\n\nUsage: p <PLAN>\n");
        assert_eq!(with_code("error: missing\n"), "error: missing [usage]\n");
    }

    #[test]
    fn long_arguments_make_short_errors() {
        let text =
            format!("error: invalid value '{}' for '--law'\n\nFor more, try '--help'.", "x".repeat(100_000));
        let short = bounded(&text);
        assert!(short.chars().count() <= MAX_CHARACTERS, "{short}");
        assert!(short.starts_with("error: invalid value") && short.ends_with("try '--help'."), "{short}");
    }
}
