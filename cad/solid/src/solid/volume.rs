//! Volume in closed form, by integration of the area of the section over the height.

use super::definition::{Solid, Wall};
use crate::profile::{ChordTolerance, FLAT_MM};

impl Solid {
    /// Returns the volume in mm³.
    ///
    /// The section at a height is bounded by the walls that cross it, outlines counter-clockwise
    /// and holes clockwise. So the volume is the sum over all walls of their signed area times
    /// height. The area of a section of a slanted wall is quadratic in height, for which Simpson's
    /// rule is exact.
    pub fn volume_mm3(&self) -> f64 {
        self.walls
            .iter()
            .map(|wall| {
                let (lower, upper) = (&self.rings[wall.lower.0], &self.rings[wall.upper.0]);
                let (a, b) = (lower.contour.area_mm2(), upper.contour.area_mm2());
                let middle =
                    if self.is_upright(wall) { a } else { lower.contour.midway_area_mm2(&upper.contour) };
                (upper.z_mm - lower.z_mm) * (a + 4.0 * middle + b) / 6.0
            })
            .sum()
    }

    /// Returns a bound on the difference between the volume of the mesh and [`Self::volume_mm3`],
    /// in mm³.
    ///
    /// Flattened arcs keep their area, except those that become their chord ([`FLAT_MM`]). Slanted
    /// walls are within the tolerance for their arcs, and again for the surface between them.
    pub fn volume_bound_mm3(&self, tolerance: ChordTolerance) -> f64 {
        let off = |wall: &Wall| {
            if self.is_upright(wall) { FLAT_MM.min(tolerance.mm()) } else { 2.0 * tolerance.mm() }
        };
        let bound: f64 = self.walls.iter().map(|wall| off(wall) * self.wall_mm2(wall)).sum();
        // Single precision of files: seven digits of a coordinate, over the whole surface.
        bound + 1e-5 * self.surface_mm2()
    }

    /// Returns the area of the surface in mm²; of slanted walls, the mean perimeter times the slant
    /// height.
    pub fn surface_mm2(&self) -> f64 {
        self.walls.iter().map(|wall| self.wall_mm2(wall)).sum::<f64>() + self.caps_mm2()
    }

    fn is_upright(&self, wall: &Wall) -> bool {
        self.rings[wall.lower.0].contour == self.rings[wall.upper.0].contour
    }

    fn wall_mm2(&self, wall: &Wall) -> f64 {
        let (lower, upper) = (&self.rings[wall.lower.0], &self.rings[wall.upper.0]);
        let (p, q) = (lower.contour.perimeter_mm(), upper.contour.perimeter_mm());
        let inward = (lower.contour.corners()[0] - upper.contour.corners()[0]).norm();
        (p + q) / 2.0 * libm::hypot(upper.z_mm - lower.z_mm, inward)
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

#[cfg(test)]
mod tests {
    use super::super::definition::Facing;
    use super::*;
    use crate::profile::{Contour, Edge, Pen, Point2, polar};
    use proptest::prelude::*;

    /// A sector with ends parallel to radial planes, at `shift_mm` outside of them.
    fn sector([inner_mm, outer_mm]: [f64; 2], half_rad: f64, shift_mm: f64) -> Contour {
        let corner =
            |radius: f64, side: f64| polar(radius, side * (half_rad + libm::asin(shift_mm / radius)));
        Pen::at(corner(inner_mm, 1.0))
            .line_to(corner(outer_mm, 1.0))
            .arc_to(Point2::origin(), corner(outer_mm, -1.0), true)
            .line_to(corner(inner_mm, -1.0))
            .arc_to(Point2::origin(), corner(inner_mm, 1.0), false)
            .close()
    }

    fn frustum(lower: Contour, upper: Contour, height_mm: f64) -> Solid {
        let mut solid = Solid::new();
        let (lower, upper) = (solid.ring(lower, 0.0), solid.ring(upper, height_mm));
        solid.wall(lower, upper);
        solid.cap(Facing::Down, lower, &[]);
        solid.cap(Facing::Up, upper, &[]);
        solid
    }

    /// Points on the curve at equal shares of every edge.
    fn points(contour: &Contour, per_edge: u32) -> Vec<Point2> {
        let on = |i: usize, share: f64| match &contour.edges()[i] {
            Edge::Line => contour.ends(i).0 + (contour.ends(i).1 - contour.ends(i).0) * share,
            Edge::Arc(arc) => arc.point_at(share, arc.radius_mm),
        };
        let shares = |i| (0..per_edge).map(move |k| on(i, f64::from(k) / f64::from(per_edge)));
        (0..contour.edges().len()).flat_map(shares).collect()
    }

    /// Volume between two contours from thin slices of the ruled surface, without formulas of arcs.
    fn summed_mm3(lower: &Contour, upper: &Contour, height_mm: f64) -> f64 {
        const SLICES: u32 = 40;
        let (below, above) = (points(lower, 2000), points(upper, 2000));
        let area = |share: f64| {
            let here: Vec<_> = below.iter().zip(&above).map(|(p, q)| p + (q - p) * share).collect();
            let next = here.iter().cycle().skip(1);
            here.iter().zip(next).map(|(a, b)| a.coords.perp(&b.coords)).sum::<f64>() / 2.0
        };
        let middles = (0..SLICES).map(|k| area((f64::from(k) + 0.5) / f64::from(SLICES)));
        middles.sum::<f64>() * height_mm / f64::from(SLICES)
    }

    fn mesh_mm3(solid: &Solid, tolerance_mm: f64) -> f64 {
        solid.mesh(ChordTolerance::new(tolerance_mm).unwrap()).unwrap().volume_mm3()
    }

    /// A cavity with 5 degrees of draft on three sides, 13.6 mm deep. An arc through the corners
    /// midway is not the curve midway; the slices show the difference.
    #[test]
    fn twisted_walls_have_their_exact_volume() {
        let drafted_mm = 13.6 * libm::tan(5f64.to_radians());
        let half = 89.45f64.to_radians() / 2.0;
        let lower = sector([20.0, 22.0], half, 0.0);
        let upper = sector([20.0 - drafted_mm, 22.0], half, drafted_mm);
        let exact = frustum(lower.clone(), upper.clone(), 13.6).volume_mm3();
        assert!((exact / summed_mm3(&lower, &upper, 13.6) - 1.0).abs() < 1e-5, "{exact}");
        let of_arcs =
            13.6 / 6.0 * (lower.area_mm2() + 4.0 * lower.midway(&upper).area_mm2() + upper.area_mm2());
        assert!((of_arcs - exact).abs() > 0.1, "{of_arcs} for {exact}");
    }

    /// A square that turns with height: its section is a square, smaller by the cosine.
    #[test]
    fn a_twisted_prism_has_its_exact_volume() {
        let turn = 0.6f64;
        let square = |by: f64| {
            Contour::polygon(
                (0..4).map(|k| polar(2.0, by - f64::from(k) * std::f64::consts::FRAC_PI_2)).collect(),
            )
        };
        let solid = frustum(square(0.0), square(turn), 3.0);
        let exact = 3.0 * 8.0 / 6.0 * (2.0 + 4.0 * libm::cos(turn / 2.0).powi(2));
        assert!((solid.volume_mm3() / exact.abs() - 1.0).abs() < 1e-12, "{}", solid.volume_mm3());
        assert!((mesh_mm3(&solid, 1e-4) - exact).abs() <= 1e-4 * solid.surface_mm2());
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn closed_form_slices_and_mesh_agree(
            inner in 8.0..100.0f64, thick in 1.0..8.0f64, half in 0.2..2.6f64, height in 1.0..30.0f64,
            inward in 0.0..2.0f64, outward in 0.0..2.0f64, ends in 0.0..2.0f64, at in 0.0..1.0f64,
        ) {
            let lower = sector([inner, inner + thick], half, at);
            let upper = sector([inner - inward, inner + thick + outward], half, at + ends);
            let solid = frustum(lower.clone(), upper.clone(), height);
            let exact = solid.volume_mm3();
            let summed = summed_mm3(&lower, &upper, height);
            prop_assert!((exact / summed - 1.0).abs() < 3e-4, "{exact} for {summed}");
            for tolerance_mm in [0.1, 0.01, 1e-3] {
                let tolerance = ChordTolerance::new(tolerance_mm).unwrap();
                let (off, bound) = ((mesh_mm3(&solid, tolerance_mm) - exact).abs(), solid.volume_bound_mm3(tolerance));
                prop_assert!(off <= bound, "{off} at {tolerance_mm}, bound {bound}");
            }
        }
    }
}
