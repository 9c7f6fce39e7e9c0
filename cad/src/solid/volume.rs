//! Volume in closed form: the sections' areas, integrated over the height.

use super::Solid;
use crate::profile::Contour;

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
                let middle = if lower.contour == upper.contour {
                    a
                } else {
                    middle_area_mm2(&lower.contour, &upper.contour)
                };
                (upper.z_mm - lower.z_mm) * (a + 4.0 * middle + b) / 6.0
            })
            .sum()
    }

    /// Area of the surface in mm², from the exact profile; slanted walls with their mean perimeter and slant.
    pub fn surface_mm2(&self) -> f64 {
        let walls: f64 = self
            .walls
            .iter()
            .map(|wall| {
                let (lower, upper) = (&self.rings[wall.lower.0], &self.rings[wall.upper.0]);
                let (p, q) = (lower.contour.perimeter_mm(), upper.contour.perimeter_mm());
                let inward = (lower.contour.corners()[0] - upper.contour.corners()[0]).norm();
                let slant = if lower.contour == upper.contour { 0.0 } else { inward };
                (p + q) / 2.0 * (upper.z_mm - lower.z_mm).hypot(slant)
            })
            .sum();
        walls + self.caps_mm2()
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
