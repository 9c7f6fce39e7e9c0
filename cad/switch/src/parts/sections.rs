//! Exact sections of bodies in their places, for tests of overlaps.

use super::Pose;
use pinswitch_solid::profile::{ChordTolerance, Contour, Point2, Vector2};
use pinswitch_solid::solid::Solid;

/// A section of a body.
pub(crate) struct Section {
    /// Its contours.
    pub exact: Vec<Contour>,
    /// Polygons within a tolerance, which decide whether a point is inside.
    pub polygons: Vec<Vec<Point2>>,
}

impl Section {
    /// Cuts a body in a pose at a height.
    pub(crate) fn new(solid: &Solid, pose: Pose, z_mm: f64, tolerance_mm: f64) -> Self {
        let own = if pose.flipped { pose.z_mm - z_mm } else { z_mm - pose.z_mm };
        let turn = |c: Contour| if pose.flipped { c.mirrored() } else { c };
        let exact: Vec<Contour> = solid.section(own).into_iter().map(turn).collect();
        let tolerance = ChordTolerance::new(tolerance_mm).unwrap();
        let polygons = exact.iter().map(|c| c.flattened(&c.chords(tolerance))).collect();
        Self { exact, polygons }
    }

    /// Returns the section at another place.
    pub(crate) fn translated(&self, by: Vector2) -> Self {
        Self {
            exact: self.exact.iter().map(|c| c.translated(by)).collect(),
            polygons: self.polygons.iter().map(|p| p.iter().map(|p| p + by).collect()).collect(),
        }
    }

    pub(crate) fn contains(&self, p: Point2) -> bool {
        let crossings = self.polygons.iter().flat_map(|polygon| {
            let next = polygon.iter().cycle().skip(1);
            polygon.iter().zip(next).filter(|(a, b)| {
                (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x
            })
        });
        crossings.count() % 2 == 1
    }

    /// Distance of a point from the contours, mm.
    pub(crate) fn distance_mm(&self, p: Point2) -> f64 {
        self.exact.iter().map(|c| c.distance_mm(p)).fold(f64::INFINITY, f64::min)
    }

    /// Depth of the outline of `other` inside of this section, mm, and its deepest point.
    pub(crate) fn depth_mm(&self, other: &Self) -> (f64, Point2) {
        let points = other.polygons.iter().flatten();
        let inside = points.filter(|p| self.contains(**p)).map(|p| (self.distance_mm(*p), *p));
        inside.fold((0.0, Point2::origin()), |best, next| if next.0 > best.0 { next } else { best })
    }
}
