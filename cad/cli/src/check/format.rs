//! Kinds of files that can be checked: how each is recognised, read and examined.

use std::io::{BufRead, Read, Seek};

use pinswitch_diagnostic::Diagnostic;
use pinswitch_solid::files::{read_stl, read_three_mf};
use pinswitch_solid::validity::{Examination, Expectation, Fault, examine, shared_place};

use super::verdict::PartVerdict;
use crate::failure::unconverted;

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Stl,
    ThreeMf,
    Step,
}

/// What the file as a whole is wrong about, and its parts.
type Parts = (Vec<Fault>, Vec<PartVerdict>);

impl Format {
    /// By how a file begins. What is none of the others may be an STL, or is refused as one.
    pub(super) fn of(head: &[u8]) -> Self {
        let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
        if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
            Self::ThreeMf
        } else if text.starts_with(b"ISO-10303-21") {
            Self::Step
        } else {
            Self::Stl
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Stl => "stl",
            Self::ThreeMf => "3mf",
            Self::Step => "step",
        }
    }

    /// Longest file that is examined, in bytes: a mesh takes several times that.
    pub(super) fn longest(self) -> u64 {
        match self {
            Self::Stl => 2 << 30,
            Self::ThreeMf => 512 << 20,
            Self::Step => 256 << 20,
        }
    }
}

/// Returns the diagnostic of a file that cannot be read.
pub(super) fn unreadable(error: std::io::Error) -> Diagnostic {
    Diagnostic::new("cannot read").with_help("give a file that exists and can be read").with_source(error)
}

/// Examines an STL.
pub(super) fn stl(
    reader: &mut (impl BufRead + Seek),
    expected: &Expectation,
) -> Result<(Examination, Vec<String>), Diagnostic> {
    let stl = read_stl(reader).map_err(unconverted)?;
    let mut examination = examine(&stl.mesh, expected);
    if stl.contrary_normals > 0 {
        examination.faults.push(Fault {
            check: "contrary normals",
            count: stl.contrary_normals,
            at_mm: None,
            detail: format!("{} stored normals contradict the order of the corners", stl.contrary_normals),
        });
    }
    let mut remarks = Vec::new();
    if stl.trailing_bytes > 0 {
        remarks
            .push(format!("{} bytes follow the last triangle; readers pass over them", stl.trailing_bytes));
    }
    Ok((examination, remarks))
}

/// Examines each solid object of a 3MF, and whether those that are built share space.
pub(super) fn three_mf(mut reader: impl Read, expected: &Expectation) -> Result<Parts, Diagnostic> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(unreadable)?;
    let package = read_three_mf(&bytes).map_err(unconverted)?;
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
        for (i, (item, name, mesh)) in package.built.iter().enumerate() {
            // Solids of one item are one object, which may be put together from any.
            for (_, other, beside) in package.built[..i].iter().filter(|(other, ..)| other != item) {
                if let Some(at) = shared_place(mesh, beside, SHARED_MM) {
                    let detail = format!("{other} and {name} share space on the plate");
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

/// Solids of a 3MF lie this deep inside one another before they share space, mm: exporters round, and parts may touch.
const SHARED_MM: f64 = 0.05;

/// Solids of a STEP lie this many chord tolerances inside one another before they share space.
#[cfg(feature = "truck")]
const SHARED_TOLERANCES: f64 = 5.0;

/// Examines each solid of a STEP, and whether those of an assembly share space.
#[cfg(feature = "truck")]
pub(super) fn step(
    mut reader: impl Read,
    expected: &Expectation,
    tolerance_mm: f64,
) -> Result<Parts, Diagnostic> {
    use pinswitch_solid::files::read_step;
    use pinswitch_solid::mesh::Mesh;
    use pinswitch_solid::profile::ChordTolerance;

    say_nothing_of_truck();
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(unreadable)?;
    let tolerance = ChordTolerance::new(tolerance_mm).map_err(unconverted)?;
    // By the standard it is ASCII; names may be in whatever the program spoke.
    let read = read_step(&String::from_utf8_lossy(&bytes), tolerance).map_err(unconverted)?;
    let each = Expectation { bodies: None, ..*expected };
    let mut parts = Vec::new();
    let mut placed: Vec<(&str, Mesh)> = Vec::new();
    for solid in &read.solids {
        let mut examination = examine(&solid.mesh, &each);
        if solid.untriangulated > 0 {
            examination.faults.push(Fault {
                check: "face",
                count: solid.untriangulated,
                at_mm: None,
                detail: format!(
                    "{} faces cannot be triangulated: their edges do not close on them",
                    solid.untriangulated
                ),
            });
        }
        parts.push(PartVerdict::new(solid.name.clone(), examination));
        for place in &solid.placements {
            let positions = solid.mesh.positions.iter().map(|p| place.transform_point(p)).collect();
            placed.push((&solid.name, Mesh::new(positions, solid.mesh.triangles.clone())));
        }
    }
    let mut faults = read.faults;
    // Only of closed solids can be told what lies inside.
    if parts.iter().all(|part| part.valid) {
        for (i, (name, mesh)) in placed.iter().enumerate() {
            for (other, beside) in &placed[..i] {
                if let Some(at) = shared_place(mesh, beside, SHARED_TOLERANCES * tolerance_mm) {
                    faults.push(Fault {
                        check: "overlap",
                        count: 1,
                        at_mm: Some(at),
                        detail: format!("{other} and {name} share space"),
                    });
                }
            }
        }
    }
    Ok((faults, parts))
}

/// Where truck gives up on a file, it panics; that is caught and told in one sentence. A panic of our own is still heard.
#[cfg(feature = "truck")]
fn say_nothing_of_truck() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            let file = info.location().map_or("", |place| place.file());
            if !["truck-", "ruststep", "spade", "cgmath"].iter().any(|name| file.contains(name)) {
                usual(info);
            }
        }));
    });
}

/// STEP is read through truck, which this build was made without.
#[cfg(not(feature = "truck"))]
pub(super) fn step(_: impl Read, _: &Expectation, _: f64) -> Result<Parts, Diagnostic> {
    Err(Diagnostic::new("this build reads no STEP files").with_help("build with --features brep"))
}
