//! Volume in closed form: the sections' areas, integrated over the height.

use super::{Solid, Wall};
use crate::profile::{ChordTolerance, Contour, Edge, FLAT_MM};

impl Solid {
    /// Volume in mm³.
    ///
    /// The section at a height is bounded by the walls that cross it, outlines counter-clockwise and holes
    /// clockwise, so the volume is the sum over all walls of their signed area times height. The area of a slanted
    /// wall's section is quadratic in height, for which Simpson's rule is exact.
    pub fn volume_mm3(&self) -> f64 {
        self.walls
            .iter()
            .map(|wall| {
                let (lower, upper) = (&self.rings[wall.lower.0], &self.rings[wall.upper.0]);
                let (a, b) = (lower.contour.area_mm2(), upper.contour.area_mm2());
                let middle =
                    if self.is_upright(wall) { a } else { middle_area_mm2(&lower.contour, &upper.contour) };
                (upper.z_mm - lower.z_mm) * (a + 4.0 * middle + b) / 6.0
            })
            .sum()
    }

    /// How far the mesh's volume may lie from [`Self::volume_mm3`], in mm³: flattened arcs keep their area, but for
    /// those too flat to be cut ([`FLAT_MM`]); between slanted rings the mesh keeps the tolerance only.
    pub fn volume_bound_mm3(&self, tolerance: ChordTolerance) -> f64 {
        let off = |wall: &Wall| {
            if self.is_upright(wall) {
                FLAT_MM.min(tolerance.mm())
            } else {
                tolerance.mm() + self.twist_mm(wall)
            }
        };
        let bound: f64 = self.walls.iter().map(|wall| off(wall) * self.wall_mm2(wall)).sum();
        // Single precision of the written file: seven digits of a coordinate, over the whole surface.
        bound + 1e-5 * self.surface_mm2()
    }

    /// Area of the surface in mm², from the exact profile; slanted walls with their mean perimeter and slant.
    pub fn surface_mm2(&self) -> f64 {
        self.walls.iter().map(|wall| self.wall_mm2(wall)).sum::<f64>() + self.caps_mm2()
    }

    /// How far a ruled wall may lie inside the surface that its arcs sweep, mm: where a corner moves by `d` along an arc
    /// of radius `r`, the straight line between its two places sags by `d²/8r`.
    fn twist_mm(&self, wall: &Wall) -> f64 {
        let (lower, upper) = (&self.rings[wall.lower.0].contour, &self.rings[wall.upper.0].contour);
        let moved = lower.corners().iter().zip(upper.corners()).map(|(a, b)| (b - a).norm_squared());
        let sag = |(squared, edge): (f64, &Edge)| match edge {
            Edge::Line => 0.0,
            Edge::Arc(arc) => squared / (8.0 * arc.radius_mm),
        };
        moved.zip(lower.edges()).map(sag).fold(0.0, f64::max)
    }

    fn is_upright(&self, wall: &Wall) -> bool {
        self.rings[wall.lower.0].contour == self.rings[wall.upper.0].contour
    }

    fn wall_mm2(&self, wall: &Wall) -> f64 {
        let (lower, upper) = (&self.rings[wall.lower.0], &self.rings[wall.upper.0]);
        let (p, q) = (lower.contour.perimeter_mm(), upper.contour.perimeter_mm());
        let inward = (lower.contour.corners()[0] - upper.contour.corners()[0]).norm();
        (p + q) / 2.0 * (upper.z_mm - lower.z_mm).hypot(inward)
    }

    fn caps_mm2(&self) -> f64 {
        self.caps
            .iter()
            .map(|cap| {
                let area = |i: usize| self.rings[cap.rings[i].0].contour.area_mm2().abs();
                area(0) - (1..cap.rings.len()).map(area).sum::<f64>()
            })
            .sum()
    }
}

/// Area halfway up a ruled wall: every point of the section lies midway between the two contours.
fn middle_area_mm2(lower: &Contour, upper: &Contour) -> f64 {
    lower.midway(upper).area_mm2()
}
