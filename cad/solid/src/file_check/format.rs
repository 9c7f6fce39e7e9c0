//! Formats that can be checked: how each is recognised, read and examined.

use std::io::{BufRead, Read, Seek};

use pinswitch_diagnostic::{Diagnostic, codes};

use crate::files::{PlacedMesh, StlFile, read_stl, read_three_mf};
use crate::validity::{
    Allowance, Examination, Expectation, Fault, Incomplete, Level, examine, examine_within, shared_place,
};

use super::judgement::{Judgement, Status};
use super::verdict::PartVerdict;

/// Depth in mm below which two solids of a 3MF only touch: exporters round coordinates, and parts
/// may be adjacent.
const CONTACT_DEPTH_MM: f64 = 0.05;

/// A format that can be checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Stl,
    ThreeMf,
}

/// Most pairs of solids on the plate that are compared.
const MAX_PAIRS: usize = 200;
/// Most facets that samples of all pairs together are compared with, some 60 ns each.
const MAX_COMPARISONS: usize = 8_000_000;

impl Format {
    /// Detects the format from the first bytes of a file. Any other content is left to the reader
    /// of STL, which names it.
    ///
    /// # Errors
    /// A diagnostic for a STEP file.
    pub(super) fn detect(head: &[u8]) -> Result<Self, Diagnostic> {
        let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
        if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
            Ok(Self::ThreeMf)
        } else if text.starts_with(b"ISO-10303-21;") {
            Err(unsupported_step())
        } else {
            Ok(Self::Stl)
        }
    }

    /// Name of the format in the JSON output.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Stl => "stl",
            Self::ThreeMf => "3mf",
        }
    }

    /// Size in bytes of the largest file that is examined: a mesh takes several times that in
    /// memory.
    pub(super) fn max_bytes(self) -> u64 {
        match self {
            Self::Stl => 2 << 30,
            Self::ThreeMf => 512 << 20,
        }
    }
}

/// The diagnostic of a STEP file. An exact solid needs a CAD kernel to be judged, and this program
/// has none.
fn unsupported_step() -> Diagnostic {
    Diagnostic::new(codes::UNSUPPORTED_FORMAT, "check does not support STEP").with_help(
        "check it in the CAD program that made it, or with FreeCAD or another program based on Open CASCADE; \
         the STEP files that pinswitch writes are tested with independent readers (tests/programs/judges.rs)",
    )
}

/// The diagnostic of a file that cannot be read.
pub(super) fn unreadable(error: std::io::Error) -> Diagnostic {
    Diagnostic::new(codes::CANNOT_READ, "cannot read the file")
        .with_help("give a file that exists and can be read")
        .with_source(error)
}

/// Examines an STL.
///
/// # Errors
/// A diagnostic if the file is not an STL.
pub(super) fn stl(
    reader: &mut (impl BufRead + Seek),
    expected: &Expectation,
) -> Result<Examination, Diagnostic> {
    let stl = read_stl(reader)?;
    let mut examination = examine(&stl.mesh, expected);
    examination.faults.extend(format_faults(&stl));
    Ok(examination)
}

/// Faults of an STL that do not concern its mesh.
fn format_faults(stl: &StlFile) -> Vec<Fault> {
    let of_normals = [
        ("contrary normals", Level::Error, stl.contrary_normals, "contradict the order of the corners"),
        ("oblique normals", Level::Note, stl.oblique_normals, "are not perpendicular to their facets"),
        ("invalid normals", Level::Note, stl.invalid_normals, "are not finite"),
    ];
    let normals =
        of_normals.into_iter().filter(|(_, _, count, _)| *count > 0).map(|(check, level, count, problem)| {
            Fault::new(check, level, count, format!("{count} stored normals {problem}"))
        });
    let trailing = (stl.trailing_bytes > 0).then(|| {
        let detail = format!("{} bytes follow the last triangle; readers ignore them", stl.trailing_bytes);
        Fault::new("trailing bytes", Level::Note, 1, detail)
    });
    let deviations = stl.deviations.iter().map(|one| Fault::new("format", Level::Note, 1, (*one).to_owned()));
    normals.chain(trailing).chain(deviations).collect()
}

/// Examines each solid object of a 3MF, and whether the items on the plate overlap. Returns the
/// faults of the file as a whole, and the verdict on each part.
///
/// # Errors
/// A diagnostic if the file is not a 3MF, or cannot be judged.
pub(super) fn three_mf(
    mut reader: impl Read,
    expected: &Expectation,
    judgement: Judgement,
) -> Result<(Examination, Vec<PartVerdict>), Diagnostic> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(unreadable)?;
    let (length, package) = (bytes.len(), read_three_mf(&bytes)?);
    drop(bytes);
    let each = Expectation { bodies: None, ..*expected };
    let mut allowance = Allowance::of_bytes(length);
    let mut examine_part = |mesh| examine_within(mesh, &each, &mut allowance);
    let parts: Vec<PartVerdict> = package
        .meshes
        .iter()
        .filter(|object| object.is_solid)
        .map(|object| PartVerdict::new(object.name.clone(), examine_part(&object.mesh), judgement))
        .collect();
    let mut examination = Examination { faults: package.faults, ..Examination::default() };
    examination.incomplete.extend(package.bound.map(overlap_incomplete));
    // Another size of a valid solid is a valid solid; its walls may be thinner.
    let of_size = |bound| Incomplete { check: "thin wall", level: Level::Warning, bound };
    examination.incomplete.extend(package.size_bound.map(of_size));
    if parts.iter().all(|part| part.status == Status::Valid) {
        match overlaps(&package.built) {
            Ok(faults) => examination.faults.extend(faults),
            Err(incomplete) => examination.incomplete.push(incomplete),
        }
    }
    if parts.is_empty() && !examination.faults.iter().any(|fault| fault.level == Level::Error) {
        // Supports and surfaces alone conform, but should be next to what they support (4.1).
        let level = if package.meshes.is_empty() { Level::Error } else { Level::Warning };
        let detail = "no object is a solid with a mesh".to_owned();
        examination.faults.push(Fault::new("empty", level, 0, detail));
    }
    Ok((examination, parts))
}

/// The search for overlaps that a bound ended.
fn overlap_incomplete(bound: String) -> Incomplete {
    Incomplete { check: "overlap", level: Level::Error, bound }
}

/// Solids of different items that overlap on the plate; what is left open if there are too many to compare.
/// Solids of one item form one object, which may be composed of any.
fn overlaps(built: &[PlacedMesh]) -> Result<Vec<Fault>, Incomplete> {
    let boxes: Vec<_> = built.iter().map(|solid| solid.mesh.bounds()).collect();
    let meet = |i: usize, j: usize| match (boxes[i], boxes[j]) {
        (Some((low, high)), Some((other_low, other_high))) => {
            (0..3).all(|axis| low[axis] <= other_high[axis] && other_low[axis] <= high[axis])
        }
        _ => false,
    };
    let pairs = (0..built.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let close = pairs.filter(|(i, j)| built[*i].item != built[*j].item && meet(*i, *j));
    let close: Vec<_> = close.take(MAX_PAIRS + 1).collect();
    if close.len() > MAX_PAIRS {
        let bound = format!("more than {MAX_PAIRS} pairs of solids on the plate are close to each other");
        return Err(overlap_incomplete(bound));
    }
    let each = MAX_COMPARISONS / close.len().max(1);
    let overlap = |(i, j): (usize, usize)| {
        let at = shared_place(&built[i].mesh, &built[j].mesh, CONTACT_DEPTH_MM, each)?;
        let detail = format!("{} and {} overlap on the plate", built[j].name, built[i].name);
        Some(Fault::new("overlap", Level::Error, 1, detail).with_place(at).with_paragraph("3MF core 3.4.3.1"))
    };
    let mut all = close.into_iter().filter_map(overlap);
    let mut listed: Vec<Fault> = all.by_ref().take(MAX_OVERLAPS).collect();
    let others = all.count();
    if let Some(last) = listed.last_mut().filter(|_| others > 0) {
        last.detail.push_str(&format!("; {others} other pairs overlap"));
    }
    Ok(listed)
}

/// Most overlaps that are listed one by one.
const MAX_OVERLAPS: usize = 5;
