//! Flattening within a chord tolerance: polygons that straddle the curve and keep its area.
//!
//! Vertices on the curve would make convex parts too small and grooves too shallow, always with the
//! same sign. Therefore the inner vertices of each arc are slightly outside of it, so that the
//! polygon encloses exactly the area of the arc; corners are exact. Both the overshoot of the
//! vertices and the sag of the chords are within the tolerance.

use std::f64::consts::FRAC_PI_2;

use super::arc::Arc;
use super::contour::{Contour, Edge};
use super::point::Point2;
use super::tolerance::ChordTolerance;

/// Sagitta in mm up to which an arc becomes its chord: finer vertices would be equal in single
/// precision.
pub const FLAT_MM: f64 = 2e-4;

/// Radius of the inner vertices with which `chords` chords enclose the area of the arc's sector.
///
/// With `h = sweep/(2 chords)` and the ends on the curve, the triangles to the centre add up to
/// `(n-2)/2 q² sin 2h + q r sin 2h = r² n h`, a quadratic in the radius `q`.
fn straddling_radius_mm(arc: &Arc, chords: usize) -> f64 {
    let (r, n) = (arc.radius_mm, chords as f64);
    let half = arc.sweep_rad.abs() / (2.0 * n);
    let s = libm::sin(2.0 * half);
    let (a, b, c) = ((n - 2.0) * s, r * s, -2.0 * r * r * half * n);
    if chords == 2 { -c / (2.0 * b) } else { (-b + (b * b - a * c).sqrt()) / a }
}

/// Returns the largest distance in millimetres between `arc` and its flattening into `chords`
/// chords.
pub fn deviation_mm(arc: &Arc, chords: usize) -> f64 {
    if chords < 2 {
        return arc.sagitta_mm();
    }
    let q = straddling_radius_mm(arc, chords);
    let step = arc.sweep_rad.abs() / chords as f64;
    // Distance from the centre to a chord between radii p and q; the foot of the perpendicular may
    // be outside of it.
    let nearest = |p: f64| {
        let length = (p * p + q * q - 2.0 * p * q * libm::cos(step)).sqrt();
        let foot_inside = (p - q).abs() * (p + q) <= length * length;
        if foot_inside { p * q * libm::sin(step) / length } else { p.min(q) }
    };
    let lowest = if chords > 2 { nearest(arc.radius_mm).min(nearest(q)) } else { nearest(arc.radius_mm) };
    (q - arc.radius_mm).abs().max((arc.radius_mm - lowest).abs())
}

/// Returns the least number of chords that keep `arc` within `tolerance`.
pub fn chords_for(arc: &Arc, tolerance: ChordTolerance) -> usize {
    if arc.sagitta_mm() <= FLAT_MM.min(tolerance.mm()) {
        return 1;
    }
    // Long arcs overshoot by r h²/3, which gives the number but for a step or two.
    let half = (3.0 * tolerance.mm() / arc.radius_mm).sqrt().min(1.0);
    let mut chords = ((arc.sweep_rad.abs() / (2.0 * half)) as usize).max(2);
    while 2.0 * chords as f64 * FRAC_PI_2 <= arc.sweep_rad.abs() || deviation_mm(arc, chords) > tolerance.mm()
    {
        chords += 1;
    }
    chords
}

impl Contour {
    /// Returns the number of chords per edge that keep every edge within `tolerance`; one for a
    /// line.
    pub fn chords(&self, tolerance: ChordTolerance) -> Vec<usize> {
        self.edges()
            .iter()
            .map(|edge| match edge {
                Edge::Line => 1,
                Edge::Arc(arc) => chords_for(arc, tolerance),
            })
            .collect()
    }

    /// Returns the number of pieces per edge with which the mean distance of a wall up to `other`,
    /// which has the same edges in the same order, from its ruled surface is within `tolerance`.
    /// This bounds the error of its volume.
    ///
    /// Where an edge turns by `d` from one contour to the other, a piece of the wall is not planar,
    /// but becomes two triangles. With lengths `p` and `q`, the distance between its diagonals is
    /// at most `p q sin d / (n sqrt(p² + q² + 2 p q cos d))`. The surface is midway between them
    /// and halves the tetrahedron of the four corners, so that its mean distance from the triangles
    /// is a sixth of that.
    pub(crate) fn wall_pieces(&self, other: &Self, tolerance: ChordTolerance) -> Vec<usize> {
        (0..self.edges().len())
            .map(|i| {
                let turn = self.turn_to_rad(other, i).min(FRAC_PI_2);
                let (p, q) = (self.edge_mm(i), other.edge_mm(i));
                let apart = p * q * libm::sin(turn) / (p * p + q * q + 2.0 * p * q * libm::cos(turn)).sqrt();
                ((apart / 6.0 / tolerance.mm()).ceil() as usize).max(1)
            })
            .collect()
    }

    /// Returns the closed polygon with `chords[i]` pieces on edge `i`; the first point is not
    /// repeated.
    pub fn flattened(&self, chords: &[usize]) -> Vec<Point2> {
        let mut points = Vec::with_capacity(chords.iter().sum());
        for (i, ((corner, edge), &n)) in self.corners().iter().zip(self.edges()).zip(chords).enumerate() {
            points.push(*corner);
            if n < 2 {
                continue;
            }
            match edge {
                Edge::Line => {
                    let along = self.ends(i).1 - corner;
                    points.extend((1..n).map(|k| corner + along * (k as f64 / n as f64)));
                }
                Edge::Arc(arc) => {
                    let q = straddling_radius_mm(arc, n);
                    points.extend((1..n).map(|k| arc.point_at(k as f64 / n as f64, q)));
                }
            }
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn polygon_area(points: &[Point2]) -> f64 {
        let next = points.iter().cycle().skip(1);
        points.iter().zip(next).map(|(a, b)| a.x * b.y - b.x * a.y).sum::<f64>() / 2.0
    }

    proptest! {
        /// The deviation of dense samples is within the tolerance, and close to the computed one.
        #[test]
        fn sampled_deviations_are_within_tolerance(
            radius in 0.1..150.0f64, sweep in 0.01..6.2f64, tolerance in 1e-4..0.1f64
        ) {
            let tolerance = ChordTolerance::new(tolerance).unwrap();
            let arc = Arc { centre: Point2::origin(), radius_mm: radius, start_rad: 0.3, sweep_rad: sweep };
            let n = chords_for(&arc, tolerance);
            let contour = Contour::from_parts(
                vec![arc.point_at(0.0, radius), arc.point_at(1.0, radius)],
                vec![Edge::Arc(arc), Edge::Line],
            );
            let points = contour.flattened(&[n, 1]);
            let mut worst = 0.0f64;
            for pair in points.windows(2) {
                for k in 0..=20 {
                    let p = pair[0] + (pair[1] - pair[0]) * (f64::from(k) / 20.0);
                    worst = worst.max((p.coords.norm() - radius).abs());
                }
            }
            prop_assert!(worst <= tolerance.mm() * (1.0 + 1e-9), "{worst} > {} with {n}", tolerance.mm());
            prop_assert!(worst >= 0.8 * deviation_mm(&arc, n), "{worst} < {}", deviation_mm(&arc, n));
        }

        #[test]
        fn circles_keep_their_area(radius in 0.15..120.0f64, tolerance in 1e-4..0.1f64) {
            let circle = Contour::circle(Point2::new(1.0, 2.0), radius);
            let points = circle.flattened(&circle.chords(ChordTolerance::new(tolerance).unwrap()));
            prop_assert!((polygon_area(&points) / circle.area_mm2() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn straddling_needs_fewer_chords() {
        let arc = Arc { centre: Point2::origin(), radius_mm: 22.0, start_rad: 0.0, sweep_rad: 1.5 };
        let tolerance = ChordTolerance::new(0.01).unwrap();
        let on_curve = (1.5 / (2.0 * libm::acos(1.0 - 0.01 / 22.0f64))).ceil() as usize;
        assert!(chords_for(&arc, tolerance) < on_curve);
    }
}
