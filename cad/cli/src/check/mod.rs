//! `pinswitch check FILE…`.

mod format;
mod verdict;

use std::path::PathBuf;

use clap::Args;
use rayon::prelude::*;

use super::{Failure, print_json, print_text};
use pinswitch_diagnostic::{Diagnostic, Location};
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

fn tolerance(text: &str) -> Result<f64, Diagnostic> {
    let (finest, coarsest) = TOLERANCES_MM;
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|mm| (finest..=coarsest).contains(mm))
        .ok_or_else(|| Diagnostic::new(format!("not a length from {finest} to {coarsest} mm")))
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if !(arguments.min_wall >= 0.0 && arguments.min_wall.is_finite()) {
        return Err(Failure::bad_input(
            Diagnostic::new("is not a wall thickness")
                .with_location(Location::field("--min-wall", arguments.min_wall.to_string()))
                .with_help("give 0 or more mm"),
        ));
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
            Err(error) => unreadable.push(error.or_in_file(&file.display().to_string())),
        }
    }
    if arguments.json {
        // Without a verdict, the failure is the only JSON document.
        if !verdicts.is_empty() {
            print_json(&verdicts)?;
        }
    } else {
        print_text(&verdicts.iter().map(Verdict::describe).collect::<String>())?;
    }
    let invalid = verdicts.iter().filter(|v| !v.valid).count();
    if let Some(failure) = Failure::bad_inputs(unreadable) {
        return Err(failure);
    }
    if invalid > 0 {
        return Err(Failure::failed(format!("{invalid} of {} files are not valid", verdicts.len())));
    }
    Ok(())
}
