//! Reads STEP through truck: each solid's boundary representation, triangulated, in its place in the assembly.

mod entities;
mod placement;
mod readable;

use std::panic::{AssertUnwindSafe, catch_unwind};

use truck_meshalgo::prelude::{
    Faces, MeshedShape, OptimizingFilter, PolygonMesh, RobustMeshableShape, StandardAttributes,
};

use crate::mesh::{Mesh, Point3};
use crate::profile::ChordTolerance;
use crate::validity::{Expectation, Fault, examine};
use entities::Entities;
use placement::{Isometry, Placements};
use readable::{table_of, unreadable};

/// A solid of a STEP file.
#[derive(Clone, Debug)]
pub struct ReadSolid {
    /// Its name, or that of its product, or the number of its shell.
    pub name: String,
    /// Its boundary, triangulated, in its own frame; millimetres.
    pub mesh: Mesh,
    /// Where it stands: once for each time that it is used.
    pub placements: Vec<Isometry>,
    /// Faces that could not be triangulated.
    pub untriangulated: usize,
}

/// What a STEP file holds.
#[derive(Clone, Debug, Default)]
pub struct StepFile {
    /// Its solids, in the order of their numbers.
    pub solids: Vec<ReadSolid>,
    /// Where it contradicts itself.
    pub faults: Vec<Fault>,
}

/// Why a file is no STEP that could be judged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StepReadError {
    /// It breaks the exchange structure (ISO 10303-21).
    #[error("it is no whole STEP file: {0}; export it again")]
    Malformed(String),
    /// No boundary representation in it.
    #[error("it holds no solid with faces; export solids as AP203, AP214 or AP242 boundary representations")]
    NoSolid,
    /// It describes something else than shapes.
    #[error("its schema is {0}, not one of shapes; export it as AP203, AP214 or AP242")]
    Schema(String),
    /// Its lengths cannot be told.
    #[error("{0}; export it in millimetres")]
    Unit(String),
    /// It uses surfaces or curves that are not read.
    #[error(
        "{faces} of {of} faces of #{shell} are of kinds that are not read here, so that it cannot be judged; export planes, cylinders, cones, spheres, tori or B-splines"
    )]
    Unread {
        /// The shell.
        shell: u64,
        /// Faces that are lost.
        faces: usize,
        /// All of its faces.
        of: usize,
    },
    /// Truck gave up.
    #[error("its surfaces cannot be followed; export it again, or by another program")]
    Truck,
}

/// Reads a STEP file; curved faces are followed within `tolerance`.
///
/// # Errors
/// [`StepReadError`] if there is no solid that could be judged.
pub fn read_step(text: &str, tolerance: ChordTolerance) -> Result<StepFile, StepReadError> {
    let entities = Entities::parse(text)?;
    let unit_mm = entities.unit_mm()?;
    // Truck's own tolerance is absolute, whatever the unit.
    if tolerance.mm() / unit_mm < FINEST {
        let words = format!("its unit of length is {unit_mm} mm, too coarse to follow round faces in");
        return Err(StepReadError::Unit(words));
    }
    let dangling = entities.dangling();
    let mut found = StepFile::default();
    if let Some(first) = dangling.first() {
        found.faults.push(Fault {
            check: "reference",
            count: dangling.len(),
            at_mm: None,
            detail: format!("#{first} is referred to, and is not in the file"),
        });
    }
    // A library for well-formed files may give up on others; nothing of it outlives the attempt.
    let asked = catch_unwind(|| {
        let table = table_of(entities.section());
        let lost = unreadable(&table);
        (table, lost)
    });
    let (table, lost) = asked.map_err(|_| StepReadError::Truck)?;
    found.faults.extend(entities.impossible_radii());
    found.faults.extend(entities.open_shells());
    let mut shells: Vec<_> = table.shell.iter().collect();
    shells.sort_by_key(|(id, _)| **id);
    let placements = Placements::of(&entities, unit_mm);
    for (id, holder) in shells {
        let of = holder.cfs_faces.len();
        let faces = entities.faces_with(*id, &lost);
        if faces > 0 && dangling.is_empty() {
            return Err(StepReadError::Unread { shell: *id, faces, of });
        } else if faces > 0 {
            // What it refers to is not there: that was said.
            continue;
        }
        let meshed = catch_unwind(AssertUnwindSafe(|| {
            let shell = table.to_compressed_shell(holder).ok()?;
            let triangulated = |tolerance: f64| {
                let meshed = shell.robust_triangulation(tolerance);
                let untriangulated = meshed.faces.iter().filter(|face| face.surface.is_none()).count();
                (untriangulated, welded(&meshed.to_polygon(), unit_mm))
            };
            let (untriangulated, mesh) = unfolded(tolerance.mm() / unit_mm, triangulated);
            Some((shell.faces.len(), untriangulated, mesh))
        }));
        let (read, untriangulated, mesh) =
            meshed.map_err(|_| StepReadError::Truck)?.ok_or(StepReadError::Truck)?;
        if read < of && dangling.is_empty() {
            return Err(StepReadError::Unread { shell: *id, faces: of - read, of });
        }
        let solid = entities.solid_of(*id);
        let name = entities.name_of(*id).unwrap_or_else(|| format!("solid #{}", solid.unwrap_or(*id)));
        let placements = solid.map_or_else(|| vec![Isometry::identity()], |solid| placements.of_solid(solid));
        found.solids.push(ReadSolid { name, mesh, placements, untriangulated });
    }
    if found.solids.is_empty() && found.faults.is_empty() {
        return Err(StepReadError::NoSolid);
    }
    Ok(found)
}

/// Finest chord tolerance that truck follows, in the file's unit: a hundred times its own tolerance.
const FINEST: f64 = 1e-4;
/// Distance below which corners are one, in the file's unit: truck's own.
const WELD: f64 = 1e-6;

/// The name of the fault that folds are.
const FLIPPED: &str = "flipped facet";
/// Shares of the tolerance at which a shell is triangulated until no facet is folded over.
const FINER: [f64; 3] = [1.0, 0.4, 0.1];

/// The triangles of a shell at the first tolerance at which none is folded over its neighbour; at the asked one, if they are at
/// every. Truck divides a long and narrow twisted face finer across than its edges sag, so that facets beside them turn over: that
/// is no fault of the file, and goes away where the edges are followed more closely.
fn unfolded(tolerance: f64, triangulated: impl Fn(f64) -> (usize, Mesh)) -> (usize, Mesh) {
    let is_folded = |mesh: &Mesh| {
        let edges = Expectation { intersections: false, ..Expectation::default() };
        examine(mesh, &edges).faults.iter().any(|fault| fault.check == FLIPPED)
    };
    let mut asked = None;
    for share in FINER.into_iter().filter(|share| *share == 1.0 || share * tolerance >= FINEST) {
        let found = triangulated(share * tolerance);
        if !is_folded(&found.1) {
            return found;
        }
        asked.get_or_insert(found);
    }
    asked.unwrap_or_else(|| triangulated(tolerance))
}

/// The triangles by position alone, in millimetres.
fn welded(polygon: &PolygonMesh, unit_mm: f64) -> Mesh {
    // Positions only: truck's cleaning also merges uv and normals, which is quadratic here (cad/doc/meshes.md).
    let triangles: Vec<[usize; 3]> = polygon.faces().triangle_iter().map(|t| t.map(|v| v.pos)).collect();
    let attributes =
        StandardAttributes { positions: polygon.positions().clone(), ..StandardAttributes::default() };
    let mut clean = PolygonMesh::new(attributes, Faces::from_iter(triangles));
    clean.put_together_same_attrs(WELD).remove_degenerate_faces().remove_unused_attrs();
    let positions = clean.positions().iter().map(|p| Point3::new(p.x, p.y, p.z) * unit_mm).collect();
    let index = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    Mesh::new(positions, clean.faces().triangle_iter().map(|t| t.map(|v| index(v.pos))).collect())
}

#[cfg(test)]
mod tests;
