//! Makes a whole set in memory: nothing is written before everything is known to be right.

use pinswitch_model::{Contact, FrictionCurve, Law, other_laws, predict};
use rayon::prelude::*;

use super::{FileEntry, Manifest, PlotError, bill_of_materials, friction_csv, friction_svg, manifest};
use crate::config::ConfigError;
use crate::design::Design;
use crate::mesh::stl_bytes;
use crate::parts::{self, Part};
use crate::solid::CapError;
use crate::validity::{Expectation, Facts, Fault, examine};

/// A file to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputFile {
    /// Its name in the folder.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// A set of parts with its curve, ready to be written; the manifest is the last file.
#[derive(Clone, Debug)]
pub struct Set {
    /// What the set holds.
    pub manifest: Manifest,
    /// The files, the manifest last.
    pub files: Vec<OutputFile>,
}

/// Why a set cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SetError {
    /// The configuration asks for something that cannot be built.
    #[error(transparent)]
    Configuration(#[from] ConfigError),
    /// Contours of a part cross: a bound is missing, and this is a fault of the program.
    #[error("{part}: {source}; please report the configuration")]
    Cap {
        /// The part.
        part: String,
        /// Where.
        source: CapError,
    },
    /// A mesh is not valid: a fault of the program. Nothing is written.
    #[error("{part}: invalid mesh: {fault}; please report the configuration")]
    Invalid {
        /// The part.
        part: String,
        /// What is wrong.
        fault: Fault,
    },
    /// The plot cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A file cannot be put together.
    #[error("cannot put a file together: {0}")]
    Encoding(String),
}

/// The predicted curve of `design`.
pub fn curve_of(design: &Design, contact: &Contact) -> FrictionCurve {
    predict(contact, &loads_of(design))
}

/// Loads at which the other laws are compared with a curve: enough for a line in a plot.
const COMPARISON_POINTS: usize = 26;

/// The other laws' curves beside one of `law`, over the same range of loads.
pub fn curves_beside(design: &Design, law: Law) -> Vec<FrictionCurve> {
    other_laws(law, design.contact(), &spaced_loads(design, COMPARISON_POINTS))
}

/// The loads of the curve of `design`, in newtons.
pub fn loads_of(design: &Design) -> Vec<f64> {
    spaced_loads(design, design.configuration().friction.points)
}

fn spaced_loads(design: &Design, points: usize) -> Vec<f64> {
    let f = &design.configuration().friction;
    let step = (f.load_max_n - f.load_min_n) / (points - 1) as f64;
    (0..points).map(|i| f.load_min_n + step * i as f64).collect()
}

/// Makes every file of `design`.
///
/// # Errors
/// [`SetError`]; a mesh that the oracle refuses is never handed out.
pub fn make_set(design: &Design) -> Result<Set, SetError> {
    make_set_with(design, &curve_of(design, design.contact()))
}

/// Makes every file of `design` with this curve attached, such as one of a calibrated model.
///
/// # Errors
/// [`SetError`]; a mesh that the oracle refuses is never handed out.
pub fn make_set_with(design: &Design, curve: &FrictionCurve) -> Result<Set, SetError> {
    let mut files = Vec::new();
    let mut parts = Vec::new();
    let printed = parts::printed(design)?;
    let meshes: Vec<_> = printed.par_iter().map(|part| mesh_file(part, design)).collect();
    for (part, mesh) in printed.into_iter().zip(meshes) {
        let (bytes, facts) = mesh?;
        files.push(OutputFile { name: format!("{}.stl", part.name), bytes });
        parts.push((part, facts));
    }
    let contact = design.contact();
    files.push(OutputFile { name: "friction.csv".to_owned(), bytes: friction_csv(curve).into_bytes() });
    let others = curves_beside(design, curve.law);
    let svg = friction_svg(&design.configuration().switch.name, contact, curve, &others)?;
    files.push(OutputFile { name: "friction.svg".to_owned(), bytes: svg.into_bytes() });
    let (layer_mm3, overfill_mm3) = parts::cavity_mm3(design);
    let bill = bill_of_materials(design, layer_mm3, overfill_mm3);
    let entries = files.iter().map(FileEntry::of).collect();
    let manifest = manifest(design, &parts, bill, curve, &others, entries);
    files.push(OutputFile { name: "manifest.json".to_owned(), bytes: manifest.bytes()? });
    Ok(Set { manifest, files })
}

impl Manifest {
    /// The manifest as indented JSON.
    ///
    /// # Errors
    /// [`SetError::Encoding`] for a value that JSON cannot hold, which no valid design has.
    pub fn bytes(&self) -> Result<Vec<u8>, SetError> {
        let mut bytes = serde_json::to_vec_pretty(self).map_err(|e| SetError::Encoding(e.to_string()))?;
        bytes.push(b'\n');
        Ok(bytes)
    }
}

/// The part as binary STL, examined before it is handed out. The search for self-intersections, which vertical walls
/// over checked caps cannot have, is left to `pinswitch check` and the tests.
///
/// # Errors
/// [`SetError`]; a mesh that the oracle refuses is never handed out.
pub fn mesh_file(part: &Part, design: &Design) -> Result<(Vec<u8>, Facts), SetError> {
    let mesh = part.print_mesh(design).map_err(|source| SetError::Cap { part: part.name.clone(), source })?;
    let expected = Expectation { intersections: false, ..part.expectation(design) };
    let found = examine(&mesh, &expected);
    if let Some(fault) = found.faults.into_iter().next() {
        return Err(SetError::Invalid { part: part.name.clone(), fault });
    }
    let bytes = stl_bytes(&mesh).map_err(|e| SetError::Encoding(e.to_string()))?;
    Ok((bytes, found.facts))
}
