//! The command line of pinswitch: one file per subcommand.
//!
//! A command reads its options and files, calls the crates that `pinswitch` re-exports, and prints
//! its result or returns a [`Failure`]. Only `terminal` writes to the terminal, and only `write`
//! writes files.

#![warn(clippy::print_stdout, clippy::print_stderr)]

use std::any::TypeId;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};
use clap_verbosity_flag::{InfoLevel, Verbosity};

mod as_measured;
mod calibrated_curve;
mod data_package;
mod failure;
mod finger_text;
mod input;
mod law;
mod predict_rows;
mod provenance;
mod range;
mod report_schema;
mod second_kernel;
mod slicing;
mod source;
mod terminal;
mod tolerances_text;
mod usage;
mod user_effects;
pub mod write;

pub use failure::Failure;
use terminal::{print_data, print_json, print_text};

/// Seed of the simulated sessions behind the interval of an expected error. It is fixed, so that a
/// command prints the same result each time.
const SEED: u64 = 1;

/// Parametric CAD generator for a printable friction switch, with the predicted friction curve of its layout.
#[derive(Debug, Parser)]
#[command(name = "pinswitch", version, max_term_width = 100, propagate_version = true)]
#[command(after_help = "Commands by task:
  make parts        generate, init, schema, layouts, view, render
  make many         batch, merge
  predict           predict, physics, finger, tolerances, export
  design            design
  check meshes      check
  use measurements  import, segment, calibrate, experiment, effects, simulate, power
  read an error     explain
  set up a shell    completions, man

`pinswitch help COMMAND` explains a command, with examples.
`pinswitch explain CODE` explains the word in brackets at the end of an error or a warning.")]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    verbosity: Verbosity<InfoLevel>,
    /// Wait up to SECONDS for another run that writes into the same folder; without it, fail at once.
    #[arg(long, global = true, value_name = "SECONDS", default_value_t = 0, hide_default_value = true)]
    #[arg(value_parser = clap::value_parser!(u64).range(0..=write::MAX_WAIT_S))]
    wait: u64,
}

/// Declares the subcommands: the file of each, its place in the help, and its function.
macro_rules! commands {
    ($($Command:ident: $file:ident,)*) => {
        $(mod $file;)*

        #[derive(Debug, Subcommand)]
        enum Command {
            $($Command($file::Arguments),)*
        }

        impl Command {
            fn run(&self) -> Result<(), Failure> {
                match self {
                    $(Self::$Command(arguments) => $file::run(arguments),)*
                }
            }
        }
    };
}

commands! {
    Generate: generate,
    Batch: run_batch,
    Merge: merge,
    Predict: predict,
    Design: design,
    Finger: finger,
    Export: export,
    Physics: physics,
    Tolerances: tolerances,
    View: view,
    Check: check,
    Render: render,
    Layouts: layouts,
    Init: init,
    Schema: schema,
    Import: import,
    Segment: segment,
    Calibrate: calibrate,
    Experiment: experiment,
    Effects: effects,
    Simulate: simulate,
    Power: power,
    Completions: completions,
    Man: man,
    Explain: explain,
    Answer: answer,
    Supervise: supervise,
}

/// Runs the command that the arguments name. Exit codes: 0 done, 1 failed, 2 bad input.
pub fn run() -> ExitCode {
    let (cli, is_json) = match parse() {
        Ok(parsed) => parsed,
        Err(e) => return usage::report(e),
    };
    terminal::start_log(cli.verbosity.log_level_filter());
    write::wait_for_locks(cli.wait);
    match cli.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            terminal::report_failure(&failure, is_json);
            failure.exit_code()
        }
    }
}

/// Parses the arguments of the process; also returns whether the command was given `--json`.
fn parse() -> Result<(Cli, bool), clap::Error> {
    let matches = command().try_get_matches()?;
    let cli = Cli::from_arg_matches(&matches).map_err(|e| e.format(&mut Cli::command()))?;
    let is_json = matches.subcommand().is_some_and(|(_, command)| is_set(command, "json"));
    Ok((cli, is_json))
}

/// Returns the command line, in which every option that takes a number accepts a negative one: its own
/// check names the field and the bound.
fn command() -> clap::Command {
    Cli::command().mut_subcommands(|command| command.mut_args(with_negative_numbers))
}

/// Lets an option with a number accept `-1`; file names and texts do not begin with a minus sign.
fn with_negative_numbers(argument: clap::Arg) -> clap::Arg {
    let value = argument.get_value_parser().type_id();
    let is_text = [TypeId::of::<String>(), TypeId::of::<PathBuf>()].iter().any(|text| value == *text);
    let is_value = argument.get_action().takes_values() && !argument.is_positional();
    if is_value && !is_text { argument.allow_negative_numbers(true) } else { argument }
}

/// Whether a command has this flag and was given it.
fn is_set(command: &ArgMatches, flag: &str) -> bool {
    command.try_get_one::<bool>(flag).is_ok_and(|value| value.copied().unwrap_or(false))
}
