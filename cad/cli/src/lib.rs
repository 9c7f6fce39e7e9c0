//! pinswitch turns a layout of pins into printable parts of a friction switch, with the friction curve they will have,
//! and keeps that curve honest with measured data.
//!
//! This crate is the command line: one file per subcommand, input and output at its edges. What it does is done by the
//! crates below, which it shows under short names. All but [`batch`] and [`slicer`] read no file, clock or environment: text and numbers
//! go in, and values, text and bytes come out.
//!
//! | crate | what it knows |
//! | --- | --- |
//! | [`friction`] | what the tendon lies on, the laws that predict its friction, the paper's numbers, the search for layouts |
//! | [`calibration`] | tables of measured plateaus, logs, the effects that the paper's model may lack, fits, verdicts |
//! | [`simulation`] | a rig whose truth is known: tables and logs with chosen effects, the power of a plan |
//! | [`solid`] | exact solids of lines and arcs, their meshes, what makes a mesh valid, STL, 3MF, STEP and DXF |
//! | [`switch`] | a switch: its configuration, its rules, its parts, built once, and every document made from them |
//! | [`batch`] | sweeps of many switches, made in parallel and taken up where they stopped |
//! | [`slicer`] | what an installed slicer says of printing them |
//! | [`plot`] | figures of curves, layouts and calibrations, as SVG and HTML |
//!
//! A configuration becomes a design, the design parts, and the parts files. Everything that a configuration does not say
//! has a default with a reason:
//!
//! ```
//! use pinswitch::friction::{Transition, Trust};
//! use pinswitch::solid::validity::{Expectation, examine};
//! use pinswitch::switch::{built::Built, config, design::Design, formats, prediction::Prediction, set::Set};
//!
//! // Four pins, 11.9 degrees apart, in a shell whose wall is a little thicker than usual.
//! let text = "[layout]\npins = [5, 7, 9, 11]\n[shell]\nwall_mm = 6.5\n[friction]\npoints = 21\n";
//! let (configuration, _) = config::read(text, "four.toml")?;
//! let design = Design::new(configuration)?; // or one error: field, value, bound and remedy
//!
//! // Its curve says which law it comes from and how far to trust it.
//! let prediction = Prediction::of(&design);
//! let curve = &prediction.curve;
//! assert_eq!(curve.trust, Trust::Interpolated);
//! let transition = Transition::of(curve).ok_or("it never switches")?;
//! assert!(transition.low_n < transition.threshold_n && transition.threshold_n < transition.high_n);
//!
//! // Its parts are built and meshed once; a mesh that is not valid would be an error.
//! let built = Built::new(design)?;
//! let shell = &built.printed()[0];
//! let expected = Expectation { bodies: Some(1), ..Expectation::default() };
//! assert!(examine(&shell.print_mesh, &expected).is_valid());
//!
//! // Every format takes them from there. Writing the bytes is left to you.
//! let set = Set::new(&built, &prediction, &formats::named(&["stl", "step"])?)?;
//! assert!(set.files.iter().any(|file| file.name == "shell.step"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! More to start from is in `cad/examples`: a part of one's own, the curve of any layout, the check of an STL, a
//! calibration, an effect of one's own, a sweep in code. `CONTRIBUTING.md` is the map of the repository.

pub use pinswitch_batch as batch;
pub use pinswitch_calibration as calibration;
pub use pinswitch_friction as friction;
pub use pinswitch_plot as plot;
pub use pinswitch_simulation as simulation;
pub use pinswitch_slicer as slicer;
pub use pinswitch_solid as solid;
pub use pinswitch_switch as switch;

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
