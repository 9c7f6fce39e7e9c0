//! `pinswitch check FILE…`.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use clap::Args;
use rayon::prelude::*;
use serde::Serialize;

use super::{Failure, print, print_json};
use pinswitch_solid::files::read_stl;
use pinswitch_solid::validity::{Examination, Expectation, Fault, examine};

/// Check whether STL files, ours or not, are valid printable meshes: what is wrong, where, and how much.
///
/// Looks for holes, edges with more than two facets, flipped, repeated and degenerate facets, vertices that only touch,
/// inward and nested bodies, facets that pass through each other, contrary normals, thin walls and wrong units. Nothing
/// is repaired. Exit code 0: all valid; 1: a mesh is not valid; 2: a file is no STL.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch check out/three-double/*.stl
  pinswitch check plate.stl --bodies 3 --min-wall 0.8 --json")]
pub(super) struct Arguments {
    /// STL files, binary or ASCII.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Expect exactly this many bodies in each file.
    #[arg(long, value_name = "N")]
    bodies: Option<usize>,
    /// Walls thinner than this are a fault, in mm; 0 accepts all.
    #[arg(long, value_name = "MM", default_value_t = 0.4)]
    min_wall: f64,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Longest file that is examined: its mesh takes four times that.
const MAX_STL: u64 = 2 << 30;

/// What is known of one file.
#[derive(Debug, Serialize)]
struct Verdict {
    file: String,
    valid: bool,
    #[serde(flatten)]
    examination: Examination,
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
    let found: Vec<_> = arguments.files.par_iter().map(|file| verdict(file, arguments)).collect();
    for (file, found) in arguments.files.iter().zip(found) {
        match found {
            Ok(verdict) => verdicts.push(verdict),
            Err(error) => unreadable.push(format!("{}: {error}", file.display())),
        }
    }
    if arguments.json {
        print_json(&verdicts)?;
    } else {
        print(verdicts.iter().map(describe).collect::<String>().as_bytes())?;
    }
    let invalid = verdicts.iter().filter(|v| !v.valid).count();
    if !unreadable.is_empty() {
        return Err(Failure::bad_input(unreadable.join("\nerror: ")));
    }
    if invalid > 0 {
        return Err(Failure::failed(format!("{invalid} of {} files are not valid meshes", verdicts.len())));
    }
    Ok(())
}

fn verdict(file: &Path, arguments: &Arguments) -> Result<Verdict, String> {
    if file.is_dir() {
        return Err("it is a folder; give the STL files in it".to_owned());
    }
    let opened =
        File::open(file).map_err(|e| format!("cannot read: {e}; give a file that exists and can be read"))?;
    let length =
        opened.metadata().map_err(|e| format!("cannot read: {e}; give a file that can be read"))?.len();
    if length > MAX_STL {
        return Err(format!(
            "holds {length} bytes, more than {MAX_STL}, forty million triangles; export it coarser"
        ));
    }
    let stl = read_stl(&mut BufReader::new(opened)).map_err(|e| e.to_string())?;
    let expected =
        Expectation { bodies: arguments.bodies, min_wall_mm: arguments.min_wall, ..Expectation::default() };
    let mut examination = examine(&stl.mesh, &expected);
    if stl.contrary_normals > 0 {
        examination.faults.push(Fault {
            check: "contrary normals",
            count: stl.contrary_normals,
            at_mm: None,
            detail: format!("{} stored normals contradict the order of the corners", stl.contrary_normals),
        });
    }
    Ok(Verdict { file: file.display().to_string(), valid: examination.is_valid(), examination })
}

fn describe(verdict: &Verdict) -> String {
    let facts = &verdict.examination.facts;
    let size: Vec<_> = (0..3).map(|i| format!("{:.2}", facts.high_mm[i] - facts.low_mm[i])).collect();
    let mut text = format!(
        "{}: {}; {} triangles, {:.3} mm3, {} mm\n",
        verdict.file,
        if verdict.valid { "valid" } else { "NOT VALID" },
        facts.triangles,
        facts.volume_mm3,
        size.join(" x ")
    );
    for fault in &verdict.examination.faults {
        text += &format!("  {fault}\n");
    }
    text
}
