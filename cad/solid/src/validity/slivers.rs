//! Facets without area, which close T-junctions and seams.
//!
//! Such a facet touches its neighbours along a line, and brings the corners of its neighbours into
//! contact with their edges. It is one finding (`degenerate facet`), not also an intersection of
//! each of these pairs. A thin facet that passes through another one far from its own corners is an
//! intersection: the facets of a thin wire are all thin.

use robust::{Coord, orient2d};

use super::facets::height_mm;
use super::triangle_intersection::{Corners, intersect};
use crate::mesh::{Mesh, Point3};

/// Distance by which the sides of a facet next to a sliver are moved inward before it is compared, in heights of the thickest
/// sliver: contact on the sliver disappears, a facet that passes through another remains.
const INWARD: f64 = 2.0;
/// Most of the radius of the inscribed circle by which the sides are moved.
const MOST_INWARD: f64 = 0.5;

/// The vertices of facets without area.
pub(super) struct Slivers {
    min_height_mm: f64,
    /// Whether each vertex belongs to such a facet; empty if there is none.
    vertices: Vec<bool>,
}

impl Slivers {
    pub(super) fn of(mesh: &Mesh, min_height_mm: f64) -> Self {
        let mut vertices = Vec::new();
        for t in mesh.triangles.iter().filter(|t| height_mm(mesh.corners(**t)) < min_height_mm) {
            vertices.resize(mesh.positions.len(), false);
            t.iter().for_each(|v| vertices[*v as usize] = true);
        }
        Self { min_height_mm, vertices }
    }

    /// Whether an intersection of two facets is one in its own right.
    pub(super) fn accept(&self, s: &Corners, t: &Corners) -> bool {
        if self.vertices.is_empty() {
            return true;
        }
        let is_flat = |corners: &Corners| height_mm(corners.map(|(_, p)| p)) < self.min_height_mm;
        let is_next = |corners: &Corners| corners.iter().any(|(v, _)| self.vertices[*v as usize]);
        // Without common corners: a shrunk facet has other ones.
        let is_away = || !(is_next(s) && is_next(t)) || intersect(&self.shrunk(s, 0), &self.shrunk(t, 3));
        if is_flat(s) || is_flat(t) {
            let is_shared = s.iter().any(|(v, _)| t.iter().any(|(w, _)| v == w));
            let is_seam = is_flat(s) && is_flat(t) && are_parallel(s, t);
            return !is_shared && !is_seam && !is_collinear(s) && !is_collinear(t) && is_away();
        }
        is_away()
    }

    /// The triangle with its sides moved inward, and with other indices.
    fn shrunk(&self, corners: &Corners, first: u32) -> Corners {
        let [a, b, c] = corners.map(|(_, p)| p.coords);
        let sides = [(c - b).norm(), (a - c).norm(), (b - a).norm()];
        let around = sides.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let incentre = (a * sides[0] + b * sides[1] + c * sides[2]) / around;
        let radius = (b - a).cross(&(c - a)).norm() / around;
        // Scaled about the centre of the inscribed circle, all sides move by the same distance.
        let share = (INWARD * self.min_height_mm / radius.max(f64::MIN_POSITIVE)).min(MOST_INWARD);
        let smaller = |p| Point3::from(incentre + (p - incentre) * (1.0 - share));
        [(first, smaller(a)), (first + 1, smaller(b)), (first + 2, smaller(c))]
    }
}

/// Whether the corners are on one line, exactly.
fn is_collinear(corners: &Corners) -> bool {
    (0..3).all(|axis| {
        let flat = |i: usize| {
            let p = corners[i].1;
            Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] }
        };
        orient2d(flat(0), flat(1), flat(2)) == 0.0
    })
}

/// Whether the longest edges of two facets have nearly the same direction, as along a seam.
fn are_parallel(s: &Corners, t: &Corners) -> bool {
    let longest = |corners: &Corners| {
        let [a, b, c] = corners.map(|(_, p)| p);
        let edges = [b - a, c - b, a - c];
        edges.into_iter().fold(edges[0], |x, y| if y.norm_squared() > x.norm_squared() { y } else { x })
    };
    let (u, v) = (longest(s), longest(t));
    u.cross(&v).norm() <= MAX_SEAM_SINE * u.norm() * v.norm()
}

/// Sine of the angle up to which two slivers may be of one seam.
const MAX_SEAM_SINE: f64 = 0.1;
