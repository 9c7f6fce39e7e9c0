//! Planes of facets in plain floating point: fast, and aware of when they cannot tell.

use crate::mesh::{Point3, Vector3};

/// A bound on the relative rounding errors of a normal and of a product with it, some ten times what they add up to.
const DOUBT: f64 = 1e-14;

/// The plane of a facet.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    /// As long as twice the area of the facet.
    pub(super) normal: Vector3,
    /// Times the distance of a point from the facet's first corner: below it, the side of the point is unknown.
    /// Infinite if the corners may lie on one line.
    error: f64,
}

impl Plane {
    pub(super) fn of([a, b, c]: [Point3; 3]) -> Self {
        let (u, v) = (b - a, c - a);
        let normal = u.cross(&v);
        let error = DOUBT * span(u) * span(v);
        Self { normal, error: if span(normal) > error { error } else { f64::INFINITY } }
    }

    /// Whether the corners certainly lie on no line.
    pub(super) fn is_certain(&self) -> bool {
        self.error < f64::INFINITY
    }

    /// Whether the points, at least one, certainly lie on the same side. `origin` is the facet's first corner.
    pub(super) fn has_beside(&self, origin: Point3, points: impl Iterator<Item = Point3>) -> bool {
        let (mut above, mut below, mut certain) = (false, false, true);
        for point in points {
            let from_origin = point - origin;
            let height = self.normal.dot(&from_origin);
            let error = self.error * span(from_origin);
            above |= height > error;
            below |= -height > error;
            // False as well for what overflows.
            certain &= height.abs() > error;
        }
        (above ^ below) & certain
    }
}

/// Sum of the absolute coordinates: never less than the length.
fn span(v: Vector3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}
