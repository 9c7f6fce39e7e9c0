//! `pinswitch check FILE…`.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use rayon::prelude::*;

use super::{Failure, print_json, print_text};
use pinswitch_solid::file_check::{Judgement, Purpose, Status, Verdict};
use pinswitch_solid::validity::{Expectation, Level};

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
    purpose: Option<PurposeName>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// What a file is judged for.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum PurposeName {
    /// Whether a slicer prints the part
    Print,
    /// Whether the file conforms to the specification of its format
    Spec,
}

impl From<PurposeName> for Purpose {
    fn from(name: PurposeName) -> Self {
        match name {
            PurposeName::Print => Self::Print,
            PurposeName::Spec => Self::Spec,
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if !(arguments.min_wall >= 0.0 && arguments.min_wall.is_finite()) {
        return Err(Failure::bad_input(
            Diagnostic::new(codes::OUT_OF_RANGE, "not a wall thickness")
                .with_location(Location::field("--min-wall", arguments.min_wall.to_string()))
                .with_help("give 0 or more mm"),
        ));
    }
    let expected =
        Expectation { bodies: arguments.bodies, min_wall_mm: arguments.min_wall, ..Expectation::default() };
    let level = if arguments.strict { Level::Warning } else { Level::Error };
    let judgement = Judgement { purpose: arguments.purpose.map(Purpose::from), level };
    let verdict = |file: &PathBuf| check_file(file, &expected, judgement);
    let outcomes: Vec<_> = arguments.files.par_iter().map(verdict).collect();
    let mut verdicts = Vec::new();
    let mut unjudged = Vec::new();
    let mut is_each_read = true;
    for (file, outcome) in arguments.files.iter().zip(outcomes) {
        let name = file.display().to_string();
        match outcome {
            Ok(verdict) => {
                if verdict.status == Status::Unjudged {
                    unjudged.push(bounded(&verdict).or_in_file(&name));
                }
                verdicts.push(verdict);
            }
            Err(diagnostic) => {
                is_each_read = false;
                unjudged.push(diagnostic.or_in_file(&name));
            }
        }
    }
    if arguments.json {
        // Without a verdict on each file, the failure is the only JSON document: a list of the others could be taken for all.
        if is_each_read {
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
        invalid => Err(Failure::failed(Diagnostic::new(
            codes::INVALID_MESH,
            format!("{invalid} of {} files are not valid", verdicts.len()),
        ))),
    }
}

/// Reads and examines a file.
///
/// # Errors
/// A diagnostic if the file cannot be examined.
fn check_file(file: &Path, expected: &Expectation, judgement: Judgement) -> Result<Verdict, Diagnostic> {
    let unreadable = |error: std::io::Error| {
        Diagnostic::new(codes::CANNOT_READ, "cannot read the file")
            .with_source(error)
            .with_help("give a file that exists and can be read")
    };
    // Opening a pipe or a device could wait for ever.
    let metadata = std::fs::metadata(file).map_err(unreadable)?;
    if metadata.is_dir() {
        return Err(
            Diagnostic::new(codes::NOT_A_FILE, "the path is a folder").with_help("give the files in it")
        );
    }
    if !metadata.is_file() {
        return Err(Diagnostic::new(codes::NOT_A_FILE, "the path is not a regular file")
            .with_help("give an STL or a 3MF"));
    }
    let mut reader = BufReader::new(File::open(file).map_err(unreadable)?);
    Verdict::read(&mut reader, metadata.len(), file.display().to_string(), expected, judgement)
}

/// The diagnostic of a file whose checks exceed a bound.
fn bounded(verdict: &Verdict) -> Diagnostic {
    Diagnostic::new(codes::MESH_NOT_JUDGED, format!("cannot be judged: {}", verdict.bounds().join("; ")))
        .with_help("a coarser mesh, several files or the export of another program may meet it: cad/doc/meshes.md lists the bounds")
}
