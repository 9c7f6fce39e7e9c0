//! `pinswitch check FILE…`.

mod format;
mod verdict;

use std::path::PathBuf;

use clap::Args;
use pinswitch_diagnostic::{Diagnostic, Location};
use rayon::prelude::*;

use super::{Failure, print, print_json};
use pinswitch_solid::validity::Expectation;
use verdict::Verdict;

/// Check whether STL and 3MF files from any program are valid printable solids.
///
/// Finds holes, edges with more than two facets, flipped, repeated and degenerate facets, vertices
/// that join separate surfaces, bodies that face inward or are inside another, facets that
/// intersect, contrary normals, thin walls and wrong units. Of a 3MF it also finds violations of
/// the core specification, object by object, and items that overlap on the plate. Every fault has a
/// place and a size; nothing is repaired. Exit code 0: all files are valid; 1: a file is not valid;
/// 2: a file cannot be examined.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch check out/three-double/*.stl out/three-double/assembly.3mf
  pinswitch check plate.stl --bodies 3 --min-wall 0.8 --json")]
pub(super) struct Arguments {
    /// STL files, binary or ASCII, and 3MF files.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Require exactly this many bodies in each file.
    #[arg(long, value_name = "N")]
    bodies: Option<usize>,
    /// Report walls thinner than this, in mm; 0 accepts any.
    #[arg(long, value_name = "MM", default_value_t = 0.4)]
    min_wall: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if !(arguments.min_wall >= 0.0 && arguments.min_wall.is_finite()) {
        return Err(Failure::bad_input(
            Diagnostic::new("not a wall thickness")
                .with_location(Location::field("--min-wall", arguments.min_wall.to_string()))
                .with_help("give 0 or more mm"),
        ));
    }
    let expected =
        Expectation { bodies: arguments.bodies, min_wall_mm: arguments.min_wall, ..Expectation::default() };
    let outcomes: Vec<_> = arguments.files.par_iter().map(|file| Verdict::of_file(file, &expected)).collect();
    let mut verdicts = Vec::new();
    let mut unexamined = Vec::new();
    for (file, outcome) in arguments.files.iter().zip(outcomes) {
        match outcome {
            Ok(verdict) => verdicts.push(verdict),
            Err(diagnostic) => unexamined.push(diagnostic.or_in_file(&file.display().to_string())),
        }
    }
    if arguments.json {
        print_json(&verdicts)?;
    } else {
        print(verdicts.iter().map(Verdict::describe).collect::<String>().as_bytes())?;
    }
    if !unexamined.is_empty() {
        return Err(bad_inputs(&unexamined));
    }
    match verdicts.iter().filter(|v| !v.valid).count() {
        0 => Ok(()),
        invalid => Err(Failure::failed(Diagnostic::new(format!(
            "{invalid} of {} files are not valid",
            verdicts.len()
        )))),
    }
}

/// The failure that reports several diagnostics.
fn bad_inputs(diagnostics: &[Diagnostic]) -> Failure {
    let lines: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
    Failure::bad_input(lines.join("\nerror: "))
}
