//! Planes of facets in floating point, with bounds on the rounding error: a filter before exact
//! predicates.

use crate::mesh::{Point3, Vector3};

/// Bound on the relative rounding errors of a normal and of a dot product with it: some ten times
/// their sum.
const ROUNDING: f64 = 1e-14;

/// The plane of a facet.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    /// Normal, as long as twice the area of the facet.
    pub(super) normal: Vector3,
    /// Rounding error of the side of a point, over its distance from the facet's first corner.
    /// Infinite if the corners may be collinear.
    error: f64,
}

impl Plane {
    pub(super) fn of([a, b, c]: [Point3; 3]) -> Self {
        let (u, v) = (b - a, c - a);
        let normal = u.cross(&v);
        let error = ROUNDING * span(u) * span(v);
        Self { normal, error: if span(normal) > error { error } else { f64::INFINITY } }
    }

    /// Whether the corners are certainly not collinear.
    pub(super) fn is_certain(&self) -> bool {
        self.error < f64::INFINITY
    }

    /// Whether the points, at least one, are certainly on the same side. `origin` is the facet's
    /// first corner.
    pub(super) fn has_on_one_side(&self, origin: Point3, points: impl Iterator<Item = Point3>) -> bool {
        let (mut above, mut below, mut certain) = (false, false, true);
        for point in points {
            let from_origin = point - origin;
            let height = self.normal.dot(&from_origin);
            let error = self.error * span(from_origin);
            above |= height > error;
            below |= -height > error;
            // False for overflow, too.
            certain &= height.abs() > error;
        }
        (above ^ below) & certain
    }
}

/// Sum of the absolute coordinates, an upper bound of the length.
fn span(v: Vector3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}
