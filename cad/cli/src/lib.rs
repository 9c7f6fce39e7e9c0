//! The command line of pinswitch: one file per subcommand, with input and output at its edges. The work is done by the
//! crates that `pinswitch` re-exports.

use std::io::Write;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use clap_verbosity_flag::{InfoLevel, Verbosity};

mod calibrated_curve;
mod failure;
mod finger_text;
mod input;
mod law;
mod own_effects;
mod predict_rows;
mod range;
mod second_kernel;
mod slicing;
mod source;
pub mod write;

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

/// Declares the subcommands: the file of each, its place in the help, and how it is run.
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
    Physics: physics,
    View: view,
    Check: check,
    Render: render,
    Layouts: layouts,
    Init: init,
    Segment: segment,
    Calibrate: calibrate,
    Experiment: experiment,
    Effects: effects,
    Simulate: simulate,
    Power: power,
    Completions: completions,
    Answer: answer,
}

/// Runs the command that the arguments name. Exit codes: 0 done, 1 failed, 2 bad input.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(e) => return failure::report_usage(e),
    };
    env_logger::Builder::new()
        .filter_level(cli.verbosity.log_level_filter())
        .format_timestamp(None)
        .format_target(false)
        .init();
    match cli.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Prints on standard output. A reader that stops early, as `head` does, is no failure.
fn print(bytes: &[u8]) -> Result<(), Failure> {
    match std::io::stdout().lock().write_all(bytes) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::failed(format!("standard output: {e}")))
        }
        _ => Ok(()),
    }
}

/// Prints `value` as indented JSON.
fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let mut bytes = serde_json::to_vec_pretty(value).map_err(Failure::failed)?;
    bytes.push(b'\n');
    print(&bytes)
}
