//! `pinswitch check FILE…`.

mod format;
mod judgement;
mod verdict;

use std::path::PathBuf;

use clap::Args;
use pinswitch_diagnostic::{Diagnostic, Location};
use rayon::prelude::*;

use super::{Failure, print_json, print_text};
use judgement::{Judgement, Purpose, Status};
use pinswitch_solid::validity::{Expectation, Level};
use verdict::Verdict;

/// Check whether STL and 3MF files from any program are valid printable solids.
///
/// Finds holes, edges with more than two facets, flipped, repeated and degenerate facets, vertices
/// that join separate surfaces, bodies that face inward or are inside another, facets that
/// intersect, contrary normals, thin walls and wrong units. Of a 3MF it also finds violations of
/// the core specification, object by object, and items that overlap on the plate. Every fault has a
/// place and a size; nothing is repaired.
///
/// A finding is an error (not a solid, or it breaks the specification), a warning (it can be
/// printed, with a risk), or a note. Exit code 0: all files are valid; 1: a file is not valid; 2: a
/// file cannot be read or judged, whatever the others are.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch check out/three-double/*.stl out/three-double/assembly.3mf
  pinswitch check plate.stl --bodies 3 --min-wall 0.8 --json
  pinswitch check --strict --for print downloads/*.stl")]
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
    /// Count warnings as errors.
    #[arg(long)]
    strict: bool,
    /// Judge the files only for this purpose; without it, for both.
    #[arg(long = "for", value_name = "PURPOSE")]
    purpose: Option<Purpose>,
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
    let level = if arguments.strict { Level::Warning } else { Level::Error };
    let judgement = Judgement { purpose: arguments.purpose, level };
    let verdict = |file: &PathBuf| Verdict::of_file(file, &expected, judgement);
    let outcomes: Vec<_> = arguments.files.par_iter().map(verdict).collect();
    let mut verdicts = Vec::new();
    let mut unjudged = Vec::new();
    for (file, outcome) in arguments.files.iter().zip(outcomes) {
        let name = file.display().to_string();
        match outcome {
            Ok(verdict) => {
                if verdict.status == Status::Unjudged {
                    unjudged.push(bounded(&verdict).or_in_file(&name));
                }
                verdicts.push(verdict);
            }
            Err(diagnostic) => unjudged.push(diagnostic.or_in_file(&name)),
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
    if let Some(failure) = Failure::bad_inputs(unjudged) {
        return Err(failure);
    }
    match verdicts.iter().filter(|v| v.status == Status::Invalid).count() {
        0 => Ok(()),
        invalid => Err(Failure::failed(Diagnostic::new(format!(
            "{invalid} of {} files are not valid",
            verdicts.len()
        )))),
    }
}

/// The diagnostic of a file whose checks exceed a bound.
fn bounded(verdict: &Verdict) -> Diagnostic {
    Diagnostic::new(format!("cannot be judged: {}", verdict.bounds().join("; ")))
        .with_help("export it with a coarser mesh, or in several files")
}
