//! `pinswitch supervise`: runs a program that ends when its caller ends, however that happens.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_slicer::supervise;

use super::Failure;

/// Run a program until standard input ends; `--slice` starts this for the slicer.
#[derive(Args, Debug)]
#[command(hide = true)]
pub(super) struct Arguments {
    /// The program.
    program: PathBuf,
    /// Its arguments.
    #[arg(allow_hyphen_values = true, trailing_var_arg = true)]
    arguments: Vec<OsString>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match supervise(&arguments.program, &arguments.arguments) {
        // The caller reads this exit code as that of the program.
        Ok(code) => std::process::exit(code),
        Err(e) => Err(Failure::failed(
            Diagnostic::new(codes::CANNOT_START, "cannot run")
                .with_location(Location::file(arguments.program.display().to_string()))
                .with_source(e),
        )),
    }
}
