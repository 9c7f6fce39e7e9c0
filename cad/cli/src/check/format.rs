//! Formats that can be checked: how each is recognised, read and examined.

use std::io::{BufRead, Read, Seek};

use pinswitch_diagnostic::Diagnostic;
use pinswitch_solid::files::{read_stl, read_three_mf};
use pinswitch_solid::validity::{Examination, Expectation, Fault, examine, shared_place};

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

/// Faults of a file as a whole, and the verdict on each of its parts.
type Parts = (Vec<Fault>, Vec<PartVerdict>);

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
        } else if text.starts_with(b"ISO-10303-21") {
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
    Diagnostic::new("check does not support STEP").with_help(
        "check it in the CAD program that made it, or with FreeCAD or another program based on Open CASCADE; \
         the STEP files that pinswitch writes are tested with independent readers (tests/programs/judges.rs)",
    )
}

/// The diagnostic of a file that cannot be read.
pub(super) fn unreadable(error: std::io::Error) -> Diagnostic {
    Diagnostic::new(format!("cannot read the file: {error}"))
        .with_help("give a file that exists and can be read")
}

/// Examines an STL; returns the examination and remarks that are not faults.
///
/// # Errors
/// A diagnostic if the file is not an STL.
pub(super) fn stl(
    reader: &mut (impl BufRead + Seek),
    expected: &Expectation,
) -> Result<(Examination, Vec<String>), Diagnostic> {
    let stl = read_stl(reader)?;
    let mut examination = examine(&stl.mesh, expected);
    if stl.contrary_normals > 0 {
        examination.faults.push(Fault {
            check: "contrary normals",
            count: stl.contrary_normals,
            at_mm: None,
            detail: format!("{} stored normals contradict the order of the corners", stl.contrary_normals),
        });
    }
    let trailing = (stl.trailing_bytes > 0)
        .then(|| format!("{} bytes follow the last triangle; readers ignore them", stl.trailing_bytes));
    Ok((examination, trailing.into_iter().collect()))
}

/// Examines each solid object of a 3MF, and whether the items on the plate overlap.
///
/// # Errors
/// A diagnostic if the file is not a 3MF.
pub(super) fn three_mf(mut reader: impl Read, expected: &Expectation) -> Result<Parts, Diagnostic> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(unreadable)?;
    let package = read_three_mf(&bytes)?;
    drop(bytes);
    let each = Expectation { bodies: None, ..*expected };
    let parts: Vec<PartVerdict> = package
        .meshes
        .iter()
        .filter(|object| object.is_solid)
        .map(|object| PartVerdict::new(object.name.clone(), examine(&object.mesh, &each)))
        .collect();
    let mut faults = package.faults;
    if parts.iter().all(|part| part.valid) {
        for (i, solid) in package.built.iter().enumerate() {
            // Solids of one item form one object, which may be composed of any.
            for other in package.built[..i].iter().filter(|other| other.item != solid.item) {
                if let Some(at) = shared_place(&solid.mesh, &other.mesh, CONTACT_DEPTH_MM) {
                    let detail = format!("{} and {} overlap on the plate", other.name, solid.name);
                    faults.push(Fault { check: "overlap", count: 1, at_mm: Some(at), detail });
                }
            }
        }
    }
    if parts.is_empty() && faults.is_empty() {
        faults.push(Fault {
            check: "empty",
            count: 0,
            at_mm: None,
            detail: "no object is a solid with a mesh".to_owned(),
        });
    }
    Ok((faults, parts))
}
