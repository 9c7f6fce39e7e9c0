//! The one oracle for meshes: is this a valid, printable solid, and if not what is wrong, where, and how much.
//!
//! Tests and `pinswitch check` ask the same [`examine`]. Nothing is repaired.

mod bodies;
mod edges;
mod facets;
mod fans;
mod intersections;
mod triangle_pair;
mod walls;

use serde::Serialize;

use crate::mesh::{Mesh, Point3};

/// What a mesh is held against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expectation {
    /// Number of bodies; `None` accepts any.
    pub bodies: Option<usize>,
    /// Volume in mm³ and how far the mesh may lie from it.
    pub volume_mm3: Option<(f64, f64)>,
    /// Least height of a triangle, mm: below it, single precision no longer tells its corners apart.
    pub min_height_mm: f64,
    /// Least and greatest length of the longest side, mm; beyond it the unit is probably wrong.
    pub longest_side_mm: (f64, f64),
    /// Least wall thickness in mm; zero does not look for thin walls.
    pub min_wall_mm: f64,
    /// Whether to look for facets that pass through each other: the slowest of the checks.
    pub intersections: bool,
}

impl Default for Expectation {
    fn default() -> Self {
        Self {
            bodies: None,
            volume_mm3: None,
            min_height_mm: 1e-5,
            longest_side_mm: (1.0, 1000.0),
            min_wall_mm: 0.0,
            intersections: true,
        }
    }
}

/// Something that makes a mesh invalid: how often, where first or worst (mm), and what it means.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// The check that failed.
    pub check: &'static str,
    /// How many edges, facets, vertices or bodies are concerned.
    pub count: usize,
    /// Where the first or worst lies, mm; absent where the fault has no place.
    pub at_mm: Option<[f64; 3]>,
    /// What is wrong, and how much.
    pub detail: String,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.check, self.detail)?;
        if let Some([x, y, z]) = self.at_mm {
            write!(f, " (at {x:.4} {y:.4} {z:.4} mm)")?;
        }
        Ok(())
    }
}

/// What a mesh measures.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Facts {
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Number of bodies that stand apart, voids not counted.
    pub bodies: usize,
    /// Number of closed voids inside bodies.
    pub voids: usize,
    /// Volume in mm³.
    pub volume_mm3: f64,
    /// Surface in mm².
    pub surface_mm2: f64,
    /// Lower corner of the bounding box, mm.
    pub low_mm: [f64; 3],
    /// Upper corner of the bounding box, mm.
    pub high_mm: [f64; 3],
    /// Height of the thinnest triangle, mm.
    pub min_height_mm: f64,
}

/// The outcome of an examination.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Examination {
    /// What the mesh measures.
    pub facts: Facts,
    /// What is wrong; empty for a valid mesh.
    pub faults: Vec<Fault>,
}

impl Examination {
    /// Whether nothing is wrong.
    pub fn is_valid(&self) -> bool {
        self.faults.is_empty()
    }
}

/// Relative difference up to which the three axis integrals of the volume count as equal.
const AXIS_AGREEMENT: f64 = 1e-6;

/// Examines `mesh` against `expected`.
pub fn examine(mesh: &Mesh, expected: &Expectation) -> Examination {
    let mut found = Examination::default();
    found.facts.triangles = mesh.triangles.len();
    found.facts.vertices = mesh.positions.len();
    if let Some(fault) = facets::not_finite(mesh).or_else(|| facets::none(mesh)) {
        found.faults.push(fault);
        return found;
    }
    measure(mesh, &mut found.facts);
    found.faults.extend(facets::wrong_unit(&found.facts, expected.longest_side_mm));
    let degenerate = facets::degenerate(mesh, expected.min_height_mm);
    let repeated = facets::repeated(mesh);
    let edge_faults = edges::unpaired(mesh);
    let closed = edge_faults.is_empty();
    found.faults.extend(degenerate.into_iter().chain(repeated).chain(edge_faults));
    found.faults.extend(fans::split_vertices(mesh));
    if closed {
        let split = bodies::split(mesh);
        found.facts.bodies = split.bodies;
        found.facts.voids = split.voids;
        found.faults.extend(split.fault);
        found.faults.extend(volume_faults(mesh, expected));
        found.faults.extend(bodies::unexpected(split.bodies, expected.bodies));
    }
    if expected.intersections {
        found.faults.extend(intersections::crossing_facets(mesh));
    }
    if expected.min_wall_mm > 0.0 {
        found.faults.extend(walls::thin(mesh, expected.min_wall_mm));
    }
    found
}

fn measure(mesh: &Mesh, facts: &mut Facts) {
    facts.volume_mm3 = mesh.volume_mm3();
    facts.surface_mm2 = mesh.surface_mm2();
    facts.min_height_mm = mesh.facets().map(facets::height_mm).fold(f64::INFINITY, f64::min);
    if let Some((low, high)) = mesh.bounds() {
        facts.low_mm = low.coords.into();
        facts.high_mm = high.coords.into();
    }
}

fn volume_faults(mesh: &Mesh, expected: &Expectation) -> Vec<Fault> {
    let axes = mesh.axis_volumes_mm3();
    let (least, most) = axes.iter().fold((f64::MAX, f64::MIN), |(l, m), v| (l.min(*v), m.max(*v)));
    let mut faults = Vec::new();
    if most - least > AXIS_AGREEMENT * most.abs().max(1e-9) {
        faults.push(Fault {
            check: "axis volumes",
            count: 1,
            at_mm: None,
            detail: format!("volume is {:.6} / {:.6} / {:.6} mm3 along x / y / z", axes[0], axes[1], axes[2]),
        });
    }
    if let Some((volume, bound)) = expected.volume_mm3 {
        let off = mesh.volume_mm3() - volume;
        if off.abs() > bound {
            faults.push(Fault {
                check: "volume",
                count: 1,
                at_mm: None,
                detail: format!("off the exact {volume:.6} mm3 by {off:+.6} mm3, allowed are {bound:.6} mm3"),
            });
        }
    }
    faults
}

fn place(point: Point3) -> Option<[f64; 3]> {
    Some(point.coords.into())
}

#[cfg(test)]
mod tests;
