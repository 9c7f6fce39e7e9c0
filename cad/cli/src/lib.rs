//! The command line: one file per subcommand, input and output at its edges.

use std::io::Write;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use clap_verbosity_flag::{InfoLevel, Verbosity};

mod batch;
mod calibrate;
mod check;
mod completions;
mod design;
mod failure;
mod finger;
mod generate;
mod init;
mod law;
mod layouts;
mod merge;
mod physics;
mod power;
mod predict;
mod predict_rows;
mod range;
mod render;
mod segment;
mod simulate;
mod source;
mod view;
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

#[derive(Debug, Subcommand)]
enum Command {
    Generate(generate::Arguments),
    Batch(batch::Arguments),
    Merge(merge::Arguments),
    Predict(predict::Arguments),
    Design(design::Arguments),
    Finger(finger::Arguments),
    Physics(physics::Arguments),
    View(view::Arguments),
    Check(check::Arguments),
    Render(render::Arguments),
    Layouts(layouts::Arguments),
    Init(init::Arguments),
    Segment(segment::Arguments),
    Calibrate(calibrate::Arguments),
    Simulate(simulate::Arguments),
    Power(power::Arguments),
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
        Command::Generate(arguments) => generate::run(&arguments),
        Command::Batch(arguments) => batch::run(&arguments),
        Command::Merge(arguments) => merge::run(&arguments),
        Command::Predict(arguments) => predict::run(&arguments),
        Command::Design(arguments) => design::run(&arguments),
        Command::Finger(arguments) => finger::run(&arguments),
        Command::Physics(arguments) => physics::run(&arguments),
        Command::View(arguments) => view::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Render(arguments) => render::run(&arguments),
        Command::Layouts(arguments) => layouts::run(&arguments),
        Command::Init(arguments) => init::run(&arguments),
        Command::Segment(arguments) => segment::run(&arguments),
        Command::Calibrate(arguments) => calibrate::run(&arguments),
        Command::Power(arguments) => power::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
    };
    match outcome {
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
