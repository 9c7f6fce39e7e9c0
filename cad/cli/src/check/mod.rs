//! `pinswitch check FILE…`.

mod format;
mod verdict;

use std::path::PathBuf;

use clap::Args;
use rayon::prelude::*;

use super::{Failure, print, print_json};
use pinswitch_solid::validity::Expectation;
use verdict::Verdict;

/// Check whether STL, 3MF and STEP files, ours or not, are valid printable solids: what is wrong, where, and how much.
///
/// Looks for holes, edges with more than two facets, flipped, repeated and degenerate facets, vertices that only touch,
/// inward and nested bodies, facets that pass through each other, contrary normals, thin walls and wrong units; of a 3MF
/// for what breaks the core specification as well, of each object, and for items of its plate that share space; of a STEP for references to nothing, for faces that
/// do not meet, and for solids of an assembly that share space, its curved faces followed within --tolerance. Nothing is
/// repaired. Exit code 0: all valid; 1: something is not valid; 2: a file cannot be judged.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch check out/three-double/*.stl out/three-double/assembly.3mf
  pinswitch check plate.stl --bodies 3 --min-wall 0.8 --json")]
pub(super) struct Arguments {
    /// STL files, binary or ASCII, 3MF and STEP files.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Expect exactly this many bodies in each file.
    #[arg(long, value_name = "N")]
    bodies: Option<usize>,
    /// Walls thinner than this are a fault, in mm; 0 accepts all.
    #[arg(long, value_name = "MM", default_value_t = 0.4)]
    min_wall: f64,
    /// Chord tolerance for the curved faces of STEP, in mm.
    #[arg(long, value_name = "MM", default_value_t = 0.01, value_parser = tolerance)]
    tolerance: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Finest and coarsest chord tolerance, mm.
const TOLERANCES_MM: (f64, f64) = (0.001, 1.0);

fn tolerance(text: &str) -> Result<f64, String> {
    let (finest, coarsest) = TOLERANCES_MM;
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|mm| (finest..=coarsest).contains(mm))
        .ok_or_else(|| format!("give {finest} to {coarsest} mm"))
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if !(arguments.min_wall >= 0.0 && arguments.min_wall.is_finite()) {
        return Err(Failure::bad_input(format!(
            "--min-wall = {} is not a wall thickness; give 0 or more mm",
            arguments.min_wall
        )));
    }
    let mut verdicts = Vec::new();
    let mut unreadable = Vec::new();
    let expected =
        Expectation { bodies: arguments.bodies, min_wall_mm: arguments.min_wall, ..Expectation::default() };
    let found: Vec<_> =
        arguments.files.par_iter().map(|file| verdict::of(file, &expected, arguments.tolerance)).collect();
    for (file, found) in arguments.files.iter().zip(found) {
        match found {
            Ok(verdict) => verdicts.push(verdict),
            Err(error) => unreadable.push(format!("{}: {error}", file.display())),
        }
    }
    if arguments.json {
        print_json(&verdicts)?;
    } else {
        print(verdicts.iter().map(Verdict::describe).collect::<String>().as_bytes())?;
    }
    let invalid = verdicts.iter().filter(|v| !v.valid).count();
    if !unreadable.is_empty() {
        return Err(Failure::bad_input(unreadable.join("\nerror: ")));
    }
    if invalid > 0 {
        return Err(Failure::failed(format!("{invalid} of {} files are not valid", verdicts.len())));
    }
    Ok(())
}
