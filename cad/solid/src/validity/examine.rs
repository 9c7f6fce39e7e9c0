//! The examination: all checks in their order.

use serde::Serialize;

use super::bvh::Bvh;
use super::fault::Fault;
use super::{components, connectivity, facets, self_intersection, wall_thickness};
use crate::mesh::{Mesh, mean};
use crate::parallel;

/// Relative difference up to which the three axis integrals of the volume are equal.
const AXIS_AGREEMENT: f64 = 1e-6;

/// What a mesh is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expectation {
    /// Number of bodies; `None` accepts any.
    pub bodies: Option<usize>,
    /// Volume in mm³, and the largest deviation from it.
    pub volume_mm3: Option<(f64, f64)>,
    /// Least height of a triangle, mm: below it, its corners may be equal in single precision.
    pub min_height_mm: f64,
    /// Least and greatest length of the longest side, mm; outside of it, the unit is probably
    /// wrong.
    pub longest_side_mm: (f64, f64),
    /// Least wall thickness in mm; zero skips the check.
    pub min_wall_mm: f64,
    /// Whether to search for facets that intersect: the slowest of the checks.
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

/// Measures of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MeshFacts {
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Number of bodies: connected surfaces that bound material from outside.
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

impl MeshFacts {
    /// Returns the facts of two meshes together.
    #[must_use]
    pub fn joined(&self, other: &Self) -> Self {
        Self {
            triangles: self.triangles + other.triangles,
            vertices: self.vertices + other.vertices,
            bodies: self.bodies + other.bodies,
            voids: self.voids + other.voids,
            volume_mm3: self.volume_mm3 + other.volume_mm3,
            surface_mm2: self.surface_mm2 + other.surface_mm2,
            low_mm: std::array::from_fn(|i| self.low_mm[i].min(other.low_mm[i])),
            high_mm: std::array::from_fn(|i| self.high_mm[i].max(other.high_mm[i])),
            min_height_mm: self.min_height_mm.min(other.min_height_mm),
        }
    }
}

/// The outcome of an examination.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Examination {
    /// Measures of the mesh.
    pub facts: MeshFacts,
    /// Reasons why the mesh is invalid; empty for a valid mesh.
    pub faults: Vec<Fault>,
}

impl Examination {
    /// Whether the mesh has no fault.
    pub fn is_valid(&self) -> bool {
        self.faults.is_empty()
    }
}

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
    let mut examination = Examination::default();
    examination.facts.triangles = mesh.triangles.len();
    examination.facts.vertices = mesh.positions.len();
    if let Some(fault) = facets::not_finite(mesh).or_else(|| facets::empty(mesh)) {
        examination.faults.push(fault);
        return examination;
    }
    let (on_surface, in_space) = parallel::both(
        mesh.triangles.len(),
        || examine_surface(mesh, expected, &mut examination.facts),
        || examine_space(mesh, expected),
    );
    examination.faults.extend(on_surface.into_iter().chain(in_space));
    examination
}

/// Checks of single facets, and of facets that share vertices.
fn examine_surface(mesh: &Mesh, expected: &Expectation, facts: &mut MeshFacts) -> Vec<Fault> {
    let heights = facets::heights(mesh, expected.min_height_mm);
    let axes_mm3 = mesh.axis_volumes_mm3();
    facts.volume_mm3 = mean(axes_mm3);
    facts.surface_mm2 = mesh.surface_mm2();
    facts.min_height_mm = heights.least_mm;
    if let Some((low, high)) = mesh.bounds() {
        facts.low_mm = low.coords.into();
        facts.high_mm = high.coords.into();
    }
    let connectivity = connectivity::check(mesh);
    let closed = connectivity.edges.is_empty();
    let mut faults = Vec::new();
    faults.extend(facets::implausible_size(facts.low_mm, facts.high_mm, expected.longest_side_mm));
    faults.extend(facets::degenerate(mesh, &heights, expected.min_height_mm));
    faults.extend(connectivity.repeated.into_iter().chain(connectivity.edges).chain(connectivity.vertices));
    if closed {
        let bodies = components::bodies(mesh, facts.volume_mm3);
        facts.bodies = bodies.bodies;
        facts.voids = bodies.voids;
        faults.extend(bodies.fault);
        faults.extend(volume_faults(axes_mm3, expected));
        faults.extend(components::wrong_count(facts.bodies, expected.bodies));
    }
    faults
}

/// Checks of facets that need not share a vertex.
fn examine_space(mesh: &Mesh, expected: &Expectation) -> Vec<Fault> {
    let walls = expected.min_wall_mm > 0.0;
    if !(expected.intersections || walls) {
        return Vec::new();
    }
    let bvh = Bvh::new(mesh);
    let crossing = expected.intersections.then(|| self_intersection::fault(mesh, &bvh)).flatten();
    let thin = walls.then(|| wall_thickness::fault(mesh, &bvh, expected.min_wall_mm)).flatten();
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
            detail: format!(
                "the volume is {:.6} / {:.6} / {:.6} mm3 along x / y / z",
                axes[0], axes[1], axes[2]
            ),
        });
    }
    if let Some((volume, bound)) = expected.volume_mm3 {
        let off = mean(axes) - volume;
        if off.abs() > bound {
            faults.push(Fault {
                check: "volume",
                count: 1,
                at_mm: None,
                detail: format!(
                    "the volume deviates by {off:+.6} mm3 from the exact {volume:.6} mm3, at most {bound:.6} mm3 allowed"
                ),
            });
        }
    }
    faults
}
