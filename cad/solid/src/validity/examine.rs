//! The examination: all checks in their order.

use schemars::JsonSchema;
use serde::Serialize;

use super::budget::Allowance;
use super::bvh::Bvh;
use super::connectivity::Connectivity;
use super::fault::{Fault, Level};
use super::{components, connectivity, cracks, facets, self_intersection, wall_thickness};
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
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

/// A check that was not completed, because the mesh needs more work than a bound allows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Incomplete {
    /// Name of the check.
    pub check: &'static str,
    /// Level of the fault that it could have found.
    pub level: Level,
    /// The bound that was exceeded.
    pub bound: String,
}

/// The outcome of an examination.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Examination {
    /// Measures of the mesh.
    pub facts: MeshFacts,
    /// Faults of any level, in the order of the checks.
    pub faults: Vec<Fault>,
    /// Checks that were not completed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub incomplete: Vec<Incomplete>,
}

impl Examination {
    /// Whether the mesh is a valid solid: all checks for errors are complete, and found none.
    pub fn is_valid(&self) -> bool {
        self.is_without(Level::Error)
    }

    /// Whether the mesh is valid and has no warning, such as a facet without area.
    pub fn is_flawless(&self) -> bool {
        self.is_without(Level::Warning)
    }

    /// Whether there is nothing of this level or a higher one.
    fn is_without(&self, level: Level) -> bool {
        self.faults.iter().all(|fault| fault.level < level)
            && self.incomplete.iter().all(|check| check.level < level)
    }

    fn add_bound(&mut self, check: &'static str, level: Level, bound: Option<String>) {
        self.incomplete.extend(bound.map(|bound| Incomplete { check, level, bound }));
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
    examine_within(mesh, expected, &mut Allowance::default())
}

/// Examines `mesh` as [`examine`] does, and subtracts the work of its searches from an allowance
/// that several meshes share.
pub fn examine_within(mesh: &Mesh, expected: &Expectation, allowance: &mut Allowance) -> Examination {
    let mut examination = Examination::default();
    examination.facts.triangles = mesh.triangles.len();
    examination.facts.vertices = mesh.positions.len();
    if let Some(fault) = facets::not_finite(mesh).or_else(|| facets::empty(mesh)) {
        examination.faults.push(fault);
        return examination;
    }
    let collapsed = without_collapsed(mesh);
    let mesh = collapsed.as_ref().unwrap_or(mesh);
    let connectivity = connectivity::check(mesh);
    let joined = if connectivity.has_open_edges() { cracks::joined(mesh) } else { None };
    if let Some(cracks::Joined { mesh: closed, width_mm }) = joined {
        // A crack is one finding: everything else is examined as if it were closed.
        let count = connectivity.open_edges();
        let connectivity = connectivity::check(&closed);
        examine_connected(&closed, expected, connectivity, &mut examination, allowance);
        let detail = format!(
            "{count} edges have only one facet; the surface closes when corners within {width_mm:.1e} mm are joined"
        );
        examination.faults.insert(0, Fault::new("crack", Level::Error, count, detail));
    } else {
        examine_connected(mesh, expected, connectivity, &mut examination, allowance);
    }
    if let Some(before) = collapsed.map(|after| examination.facts.triangles - after.triangles.len()) {
        let detail = format!("{before} facets have two corners at the same place");
        examination.faults.insert(0, Fault::new("degenerate facet", Level::Warning, before, detail));
    }
    examination
}

/// The mesh without facets that have a vertex twice: they bound nothing. `None` if it has none, or
/// only such facets.
fn without_collapsed(mesh: &Mesh) -> Option<Mesh> {
    let is_whole = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    let whole = mesh.triangles.iter().filter(|t| is_whole(t)).count();
    (whole > 0 && whole < mesh.triangles.len()).then(|| {
        let triangles = mesh.triangles.iter().copied().filter(is_whole).collect();
        Mesh::new(mesh.positions.clone(), triangles)
    })
}

/// Examines a mesh of known connectivity.
fn examine_connected(
    mesh: &Mesh,
    expected: &Expectation,
    connectivity: Connectivity,
    examination: &mut Examination,
    allowance: &mut Allowance,
) {
    let facts = &mut examination.facts;
    if let Some((low, high)) = mesh.bounds() {
        facts.low_mm = low.coords.into();
        facts.high_mm = high.coords.into();
    }
    // The unit is questioned before any search for walls: if it is larger, all of them are thin.
    let size = facets::implausible_size(facts.low_mm, facts.high_mm, expected.longest_side_mm);
    let longest_mm = (0..3).map(|i| facts.high_mm[i] - facts.low_mm[i]).fold(0.0, f64::max);
    let expected = &scaled(expected, longest_mm);
    let is_searched = expected.min_wall_mm > 0.0 && longest_mm >= expected.longest_side_mm.0;
    let fine = is_searched.then(|| facets::implausible_resolution(mesh, longest_mm)).flatten();
    let walls = is_searched && fine.is_none();
    examination.faults.extend(size.or(fine));
    let mut in_space = Examination::default();
    parallel::both(
        mesh.triangles.len(),
        || examine_surface(mesh, expected, connectivity, examination),
        || examine_space(mesh, expected, walls, &mut in_space, allowance),
    );
    examination.faults.append(&mut in_space.faults);
    examination.incomplete.append(&mut in_space.incomplete);
}

/// The expectation of a mesh whose longest side is smaller than expected, as that of a file in metres: its facets are as
/// much smaller.
fn scaled(expected: &Expectation, longest_mm: f64) -> Expectation {
    let share = longest_mm / expected.longest_side_mm.0;
    let share = if share > 0.0 { share.min(1.0) } else { 1.0 };
    Expectation { min_height_mm: expected.min_height_mm * share, ..*expected }
}

/// Checks of single facets, and of facets that share vertices.
fn examine_surface(
    mesh: &Mesh,
    expected: &Expectation,
    connectivity: Connectivity,
    examination: &mut Examination,
) {
    let heights = facets::heights(mesh, expected.min_height_mm);
    let axes_mm3 = mesh.axis_volumes_mm3();
    let facts = &mut examination.facts;
    facts.volume_mm3 = mean(axes_mm3);
    facts.surface_mm2 = mesh.surface_mm2();
    facts.min_height_mm = heights.least_mm;
    let closed = connectivity.edges.is_empty();
    let faults = &mut examination.faults;
    faults.extend(facets::degenerate(mesh, &heights, expected.min_height_mm));
    faults.extend(connectivity.repeated.into_iter().chain(connectivity.edges).chain(connectivity.vertices));
    if closed {
        let bodies = components::bodies(mesh, facts.volume_mm3);
        facts.bodies = bodies.bodies;
        facts.voids = bodies.voids;
        faults.extend(bodies.fault);
        faults.extend(volume_faults(axes_mm3, expected));
        if bodies.bound.is_none() {
            faults.extend(components::wrong_count(examination.facts.bodies, expected.bodies));
        }
        examination.add_bound("inside out", Level::Error, bodies.bound);
    }
}

/// Checks of facets that need not share a vertex.
fn examine_space(
    mesh: &Mesh,
    expected: &Expectation,
    walls: bool,
    examination: &mut Examination,
    allowance: &mut Allowance,
) {
    // Without any area there is nothing to intersect.
    let has_area = mesh.facets().any(|corners| facets::height_mm(corners) >= expected.min_height_mm);
    if !(expected.intersections || walls) || !has_area {
        return;
    }
    let bvh = Bvh::new(mesh);
    let before = allowance.0.of_mesh(mesh.triangles.len());
    let mut left = before;
    if expected.intersections {
        let search = self_intersection::search(mesh, &bvh, expected.min_height_mm, left);
        left = search.left;
        let bound = search.bound.filter(|_| search.fault.is_none());
        examination.faults.extend(search.fault);
        examination.add_bound("self-intersection", Level::Error, bound);
    }
    if walls {
        let search = wall_thickness::search(mesh, &bvh, expected.min_wall_mm, left);
        left = search.left;
        let bound = search.bound.filter(|_| search.fault.is_none());
        examination.faults.extend(search.fault);
        examination.add_bound("thin wall", Level::Warning, bound);
    }
    allowance.0.spend(before, left);
}

fn volume_faults(axes: [f64; 3], expected: &Expectation) -> Vec<Fault> {
    let (least, most) = axes.iter().fold((f64::MAX, f64::MIN), |(l, m), v| (l.min(*v), m.max(*v)));
    let mut faults = Vec::new();
    if most - least > AXIS_AGREEMENT * most.abs().max(1e-9) {
        let detail =
            format!("the volume is {:.6} / {:.6} / {:.6} mm3 along x / y / z", axes[0], axes[1], axes[2]);
        faults.push(Fault::new("axis volumes", Level::Error, 1, detail));
    }
    if let Some((volume, bound)) = expected.volume_mm3 {
        let off = mean(axes) - volume;
        if off.abs() > bound {
            let detail = format!(
                "the volume deviates by {off:+.6} mm3 from the exact {volume:.6} mm3, at most {bound:.6} mm3 allowed"
            );
            faults.push(Fault::new("volume", Level::Error, 1, detail));
        }
    }
    faults
}
