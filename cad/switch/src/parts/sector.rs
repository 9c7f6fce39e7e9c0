//! Sectors of an annulus, smooth or grooved: the outlines of shell, layer, mould and plates.

use pinswitch_solid::profile::{Contour, Pen, Point2, Vector2, polar};

/// A sector of an annulus about the axis, with its middle at angle zero. Its ends are parallel to the radial planes at plus
/// and minus `half_span_rad`, `end_shift_mm` outside of them, so that end walls have a constant thickness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sector {
    /// Inner radius, mm.
    pub inner_mm: f64,
    /// Outer radius, mm.
    pub outer_mm: f64,
    /// Half of the angle between the radial planes.
    pub half_span_rad: f64,
    /// Distance of the ends from the radial planes, mm.
    pub end_shift_mm: f64,
}

/// Stops at both ends of the face of a sector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stops {
    /// Gap between the end of the sector and the stop, mm.
    pub gap_mm: f64,
    /// Thickness along the arc, mm.
    pub thickness_mm: f64,
    /// Height above the face, mm.
    pub height_mm: f64,
    /// Radius of the outer corner, mm.
    pub fillet_mm: f64,
}

/// The two ends of a sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// At the positive angle, toward +x.
    Positive,
    /// At the negative angle, toward -x.
    Negative,
}

impl Sector {
    /// The sector enlarged on all four sides.
    #[must_use]
    pub fn grown(self, inward_mm: f64, outward_mm: f64, at_ends_mm: f64) -> Self {
        Self {
            inner_mm: self.inner_mm - inward_mm,
            outer_mm: self.outer_mm + outward_mm,
            end_shift_mm: self.end_shift_mm + at_ends_mm,
            ..self
        }
    }

    /// The sector scaled about the axis.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            inner_mm: self.inner_mm * factor,
            outer_mm: self.outer_mm * factor,
            end_shift_mm: self.end_shift_mm * factor,
            ..self
        }
    }

    /// The point of an end face at `radius_mm`.
    pub(super) fn corner(&self, radius_mm: f64, end: End) -> Point2 {
        let angle = self.half_span_rad + libm::asin((self.end_shift_mm / radius_mm).clamp(-1.0, 1.0));
        polar(radius_mm, if end == End::Positive { angle } else { -angle })
    }

    /// The smooth outline, counter-clockwise.
    pub fn outline(&self) -> Contour {
        self.grooved(&[], 0.0)
    }

    /// The outline with half-round grooves in its outer face, centred on the outer radius (cad/doc/dimensions.md).
    pub fn grooved(&self, angles_rad: &[f64], groove_radius_mm: f64) -> Contour {
        let pen = Pen::at(self.corner(self.inner_mm, End::Positive))
            .line_to(self.corner(self.outer_mm, End::Positive));
        grooved_face(
            pen,
            self.outer_mm,
            angles_rad,
            groove_radius_mm,
            self.corner(self.outer_mm, End::Negative),
            true,
        )
        .line_to(self.corner(self.inner_mm, End::Negative))
        .arc_to(Point2::origin(), self.corner(self.inner_mm, End::Positive), false)
        .close()
    }

    /// The grooved outline with a stop at each end: a wall beyond the end of the layer, higher than the face.
    pub(super) fn stopped(&self, angles_rad: &[f64], groove_radius_mm: f64, stops: &Stops) -> Contour {
        let face = Self { end_shift_mm: self.end_shift_mm + stops.gap_mm, ..*self };
        let top = Self {
            outer_mm: self.outer_mm + stops.height_mm,
            end_shift_mm: face.end_shift_mm + stops.thickness_mm,
            ..*self
        };
        let axis = Point2::origin();
        let rounded = |end: End| (stops.fillet_mm > 0.0).then(|| top.fillet(stops.fillet_mm, end));
        let foot_of_gap = |end: End| face.corner(self.outer_mm, end);
        let mut pen = Pen::at(top.corner(self.inner_mm, End::Positive));
        pen = match rounded(End::Positive) {
            Some(f) => pen.line_to(f.on_end).arc_to(f.centre, f.on_arc, true),
            None => pen.line_to(top.corner(top.outer_mm, End::Positive)),
        };
        pen = pen
            .arc_to(axis, face.corner(top.outer_mm, End::Positive), true)
            .line_to(foot_of_gap(End::Positive));
        let last = foot_of_gap(End::Negative);
        pen = grooved_face(pen, self.outer_mm, angles_rad, groove_radius_mm, last, true)
            .line_to(face.corner(top.outer_mm, End::Negative));
        pen = match rounded(End::Negative) {
            Some(f) => pen.arc_to(axis, f.on_arc, true).arc_to(f.centre, f.on_end, true),
            None => pen.arc_to(axis, top.corner(top.outer_mm, End::Negative), true),
        };
        pen.line_to(top.corner(self.inner_mm, End::Negative))
            .arc_to(axis, top.corner(self.inner_mm, End::Positive), false)
            .close()
    }

    /// The grooved outline whose ends are `reach_mm` longer from radius `from_mm` outward, over the stops below.
    pub(super) fn eared(
        &self,
        angles_rad: &[f64],
        groove_radius_mm: f64,
        from_mm: f64,
        reach_mm: f64,
    ) -> Contour {
        let ear = Self { end_shift_mm: self.end_shift_mm + reach_mm, ..*self };
        let axis = Point2::origin();
        let pen = Pen::at(self.corner(self.inner_mm, End::Positive))
            .line_to(self.corner(from_mm, End::Positive))
            .arc_to(axis, ear.corner(from_mm, End::Positive), false)
            .line_to(ear.corner(self.outer_mm, End::Positive));
        let last = ear.corner(self.outer_mm, End::Negative);
        grooved_face(pen, self.outer_mm, angles_rad, groove_radius_mm, last, true)
            .line_to(ear.corner(from_mm, End::Negative))
            .arc_to(axis, self.corner(from_mm, End::Negative), false)
            .line_to(self.corner(self.inner_mm, End::Negative))
            .arc_to(axis, self.corner(self.inner_mm, End::Positive), false)
            .close()
    }

    /// The outline with its two outer corners rounded.
    pub fn rounded(&self, corner_radius_mm: f64) -> Contour {
        if corner_radius_mm <= 0.0 {
            return self.outline();
        }
        let fillets = [End::Positive, End::Negative].map(|end| self.fillet(corner_radius_mm, end));
        let [right, left] = fillets;
        Pen::at(self.corner(self.inner_mm, End::Positive))
            .line_to(right.on_end)
            .arc_to(right.centre, right.on_arc, true)
            .arc_to(Point2::origin(), left.on_arc, true)
            .arc_to(left.centre, left.on_end, true)
            .line_to(self.corner(self.inner_mm, End::Negative))
            .arc_to(Point2::origin(), self.corner(self.inner_mm, End::Positive), false)
            .close()
    }

    fn fillet(&self, radius_mm: f64, end: End) -> Fillet {
        let side = if end == End::Positive { 1.0 } else { -1.0 };
        let radial = polar(1.0, side * self.half_span_rad).coords;
        let outward = Vector2::new(radial.y, -radial.x) * side;
        let across = self.end_shift_mm - radius_mm;
        let along = ((self.outer_mm - radius_mm).powi(2) - across.powi(2)).max(0.0).sqrt();
        let centre = Point2::from(radial * along + outward * across);
        Fillet {
            centre,
            on_end: Point2::from(radial * along + outward * self.end_shift_mm),
            on_arc: centre + centre.coords.normalize() * radius_mm,
        }
    }
}

struct Fillet {
    centre: Point2,
    on_end: Point2,
    on_arc: Point2,
}

/// Draws the face of a grooved sector up to `last`: from positive to negative angles if `counter_clockwise`, else in the
/// other direction. Grooves bulge toward the axis; drawn clockwise, they are the ribs that form them.
pub(super) fn grooved_face(
    mut pen: Pen,
    radius_mm: f64,
    angles_rad: &[f64],
    groove_radius_mm: f64,
    last: Point2,
    counter_clockwise: bool,
) -> Pen {
    let half = groove_half_angle_rad(groove_radius_mm, radius_mm);
    let mut angles = angles_rad.to_vec();
    let into = if counter_clockwise { half } else { -half };
    if counter_clockwise {
        angles.reverse();
    }
    for angle in angles {
        pen = pen.arc_to(Point2::origin(), polar(radius_mm, angle + into), counter_clockwise).arc_to(
            polar(radius_mm, angle),
            polar(radius_mm, angle - into),
            !counter_clockwise,
        );
    }
    pen.arc_to(Point2::origin(), last, counter_clockwise)
}

/// Half of the angle of a groove of radius g on its circle of radius R: `2 asin(g / 2R)`
/// (cad/doc/dimensions.md, "Sections").
pub(super) fn groove_half_angle_rad(groove_radius_mm: f64, radius_mm: f64) -> f64 {
    2.0 * libm::asin(groove_radius_mm / (2.0 * radius_mm))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Green's theorem over the lines and arcs of the reference shell, with 15 digits.
    #[test]
    fn the_reference_section_has_its_exact_area() {
        let half_span_rad = 89.45f64.to_radians() / 2.0;
        let pitch = 2.0 * half_span_rad / 15.0;
        let angles: Vec<_> = (0..15).map(|i| -half_span_rad + (f64::from(i) + 0.5) * pitch).collect();
        let sector = Sector { inner_mm: 19.0, outer_mm: 22.0, half_span_rad, end_shift_mm: 0.0 };
        let area = sector.grooved(&angles, 0.5).area_mm2();
        assert!((area / 90.151_539_710_680 - 1.0).abs() < 1e-12, "{area}");
    }

    #[test]
    fn rounding_removes_corners_only() {
        let sector = Sector { inner_mm: 14.0, outer_mm: 25.0, half_span_rad: 0.78, end_shift_mm: 0.3 };
        let (sharp, round) = (sector.outline().area_mm2(), sector.rounded(1.5).area_mm2());
        // A right corner loses (1 - pi/4) r²; these are nearly right.
        let lost = (sharp - round) / (2.0 * (1.0 - std::f64::consts::FRAC_PI_4) * 1.5f64.powi(2));
        assert!((0.9..1.1).contains(&lost), "{lost}");
    }
}
