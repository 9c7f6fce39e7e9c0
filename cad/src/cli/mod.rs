//! The command line: one file per subcommand, input and output at its edges.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use clap_verbosity_flag::{InfoLevel, Verbosity};

mod completions;
mod failure;

pub use failure::Failure;

/// Parametric CAD generator for a printable friction switch, with the predicted friction curve of its layout.
#[derive(Debug, Parser)]
#[command(name = "pinswitch", version, max_term_width = 100, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    verbosity: Verbosity<InfoLevel>,
}

#[derive(Debug, Subcommand)]
enum Command {
    Completions(completions::Arguments),
}

/// Runs the command that the arguments name. Exit codes: 0 done, 1 failed, 2 bad input.
pub fn run() -> ExitCode {
    let cli = Cli::parse();
    env_logger::Builder::new()
        .filter_level(cli.verbosity.log_level_filter())
        .format_timestamp(None)
        .format_target(false)
        .init();
    let outcome = match cli.command {
        Command::Completions(arguments) => completions::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
