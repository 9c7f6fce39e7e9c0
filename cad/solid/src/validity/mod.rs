//! The examination of meshes: is this a valid, printable solid, and if not what is wrong, where, and how much.
//!
//! Tests and `pinswitch check` ask the same [`examine`]. Nothing is repaired.

mod bodies;
mod edges;
mod facet_tree;
mod facets;
mod fans;
mod intersections;
mod overlap;
mod plane;
mod stars;
mod tally;
mod triangle_pair;
mod walls;

use serde::Serialize;

pub use overlap::shared_place;

use crate::mesh::{Mesh, Point3, mean};
use crate::parallel;
use facet_tree::FacetTree;

/// What a mesh is compared with.
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
pub struct MeshFacts {
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
    pub facts: MeshFacts,
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

/// Examines `mesh` against `expected`. Nothing is repaired.
///
/// ```
/// use pinswitch_solid::mesh::{Mesh, Point3};
/// use pinswitch_solid::validity::{Expectation, examine};
///
/// let corners = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]];
/// let positions = corners.map(|[x, y, z]| Point3::new(x, y, z)).to_vec();
/// let tetrahedron = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let whole = examine(&Mesh::new(positions.clone(), tetrahedron.clone()), &Expectation::default());
/// assert!(whole.is_valid() && whole.facts.volume_mm3 == 121.5);
///
/// let open = examine(&Mesh::new(positions, tetrahedron[..3].to_vec()), &Expectation::default());
/// assert_eq!((open.faults[0].check, open.faults[0].count), ("open edge", 3));
/// ```
pub fn examine(mesh: &Mesh, expected: &Expectation) -> Examination {
    let mut found = Examination::default();
    found.facts.triangles = mesh.triangles.len();
    found.facts.vertices = mesh.positions.len();
    if let Some(fault) = facets::not_finite(mesh).or_else(|| facets::empty(mesh)) {
        found.faults.push(fault);
        return found;
    }
    let (on_surface, in_space) = parallel::both(
        mesh.triangles.len(),
        || examine_surface(mesh, expected, &mut found.facts),
        || examine_space(mesh, expected),
    );
    found.faults.extend(on_surface.into_iter().chain(in_space));
    found
}

/// What the facets show by themselves and by the vertices that they share.
fn examine_surface(mesh: &Mesh, expected: &Expectation, facts: &mut MeshFacts) -> Vec<Fault> {
    let heights = facets::heights(mesh, expected.min_height_mm);
    let axes_mm3 = mesh.axis_volumes_mm3();
    facts.volume_mm3 = mean(axes_mm3);
    facts.surface_mm2 = mesh.surface_mm2();
    facts.min_height_mm = heights.min_thickness_mm;
    if let Some((low, high)) = mesh.bounds() {
        facts.low_mm = low.coords.into();
        facts.high_mm = high.coords.into();
    }
    let stars = stars::examine(mesh);
    let closed = stars.edges.is_empty();
    let mut faults = Vec::new();
    faults.extend(facets::implausible_size(facts, expected.longest_side_mm));
    faults.extend(facets::degenerate(mesh, &heights, expected.min_height_mm));
    faults.extend(stars.repeated.into_iter().chain(stars.edges).chain(stars.vertices));
    if closed {
        let split = bodies::split(mesh, facts.volume_mm3);
        facts.bodies = split.bodies;
        facts.voids = split.voids;
        faults.extend(split.fault);
        faults.extend(volume_faults(axes_mm3, expected));
        faults.extend(bodies::wrong_count(split.bodies, expected.bodies));
    }
    faults
}

/// What facets do to others that need not share a vertex with them.
fn examine_space(mesh: &Mesh, expected: &Expectation) -> Vec<Fault> {
    let walls = expected.min_wall_mm > 0.0;
    if !(expected.intersections || walls) {
        return Vec::new();
    }
    let tree = FacetTree::new(mesh);
    let crossing = expected.intersections.then(|| intersections::self_intersections(mesh, &tree)).flatten();
    let thin = walls.then(|| walls::thin_walls(mesh, &tree, expected.min_wall_mm)).flatten();
    crossing.into_iter().chain(thin).collect()
}

fn volume_faults(axes: [f64; 3], expected: &Expectation) -> Vec<Fault> {
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
        let off = mean(axes) - volume;
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
mod brute_force;
#[cfg(test)]
mod tests;
