//! A closed contour of lines and arcs, with its exact area, perimeter and bounds.

use std::f64::consts::{FRAC_PI_2, PI};

use super::arc::Arc;
use super::point::{Point2, Vector2};

/// The curve between two corners of a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge {
    /// A straight line.
    Line,
    /// A circular arc.
    Arc(Arc),
}

/// A closed contour with material to its left. Edge `i` joins corner `i` to corner `i + 1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    corners: Vec<Point2>,
    edges: Vec<Edge>,
}

impl Contour {
    /// A contour with as many corners as edges; every arc starts and ends in its corners.
    pub(super) fn from_parts(corners: Vec<Point2>, edges: Vec<Edge>) -> Self {
        debug_assert_eq!(corners.len(), edges.len());
        Self { corners, edges }
    }

    /// A polygon through `corners`.
    pub fn polygon(corners: Vec<Point2>) -> Self {
        let edges = vec![Edge::Line; corners.len()];
        Self { corners, edges }
    }

    /// A counter-clockwise circle, as two half circles.
    pub fn circle(centre: Point2, radius_mm: f64) -> Self {
        let half = |start_rad| Edge::Arc(Arc { centre, radius_mm, start_rad, sweep_rad: PI });
        let reach = Vector2::new(radius_mm, 0.0);
        Self { corners: vec![centre + reach, centre - reach], edges: vec![half(0.0), half(PI)] }
    }

    /// Corners in order.
    pub fn corners(&self) -> &[Point2] {
        &self.corners
    }

    /// Edges in order; edge `i` starts in corner `i`.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// First and last point of edge `i`.
    pub fn ends(&self, i: usize) -> (Point2, Point2) {
        (self.corners[i], self.corners[(i + 1) % self.corners.len()])
    }

    /// Returns the same curve in the opposite direction: an outline becomes a hole.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let n = self.corners.len();
        let corners = (0..n).map(|i| self.corners[(n - i) % n]).collect();
        let turn = |edge: &Edge| match edge {
            Edge::Line => Edge::Line,
            Edge::Arc(a) => {
                Edge::Arc(Arc { start_rad: a.start_rad + a.sweep_rad, sweep_rad: -a.sweep_rad, ..*a })
            }
        };
        Self { corners, edges: self.edges.iter().rev().map(turn).collect() }
    }

    /// Returns the contour translated by `by`.
    #[must_use]
    pub fn translated(&self, by: Vector2) -> Self {
        let edges = self.edges.iter().map(|edge| match edge {
            Edge::Line => Edge::Line,
            Edge::Arc(a) => Edge::Arc(Arc { centre: a.centre + by, ..*a }),
        });
        Self { corners: self.corners.iter().map(|p| p + by).collect(), edges: edges.collect() }
    }

    /// Returns the contour rotated about the origin by `angle_rad`, counter-clockwise.
    #[must_use]
    pub fn rotated(&self, angle_rad: f64) -> Self {
        let (c, s) = (libm::cos(angle_rad), libm::sin(angle_rad));
        let turn = |p: Point2| Point2::new(c * p.x - s * p.y, s * p.x + c * p.y);
        let edges = self.edges.iter().map(|edge| match edge {
            Edge::Line => Edge::Line,
            Edge::Arc(a) => {
                Edge::Arc(Arc { centre: turn(a.centre), start_rad: a.start_rad + angle_rad, ..*a })
            }
        });
        Self { corners: self.corners.iter().map(|p| turn(*p)).collect(), edges: edges.collect() }
    }

    /// Returns the contour scaled about the origin by a positive `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let edges = self.edges.iter().map(|edge| match edge {
            Edge::Line => Edge::Line,
            Edge::Arc(a) => {
                Edge::Arc(Arc { centre: a.centre * factor, radius_mm: a.radius_mm * factor, ..*a })
            }
        });
        Self { corners: self.corners.iter().map(|p| p * factor).collect(), edges: edges.collect() }
    }

    /// Returns the contour mirrored in the y axis, directed so that material stays to its left.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let flip = |p: Point2| Point2::new(-p.x, p.y);
        let edges = self.edges.iter().map(|edge| match edge {
            Edge::Line => Edge::Line,
            Edge::Arc(a) => Edge::Arc(Arc {
                centre: flip(a.centre),
                start_rad: PI - a.start_rad,
                sweep_rad: -a.sweep_rad,
                ..*a
            }),
        });
        Self { corners: self.corners.iter().map(|p| flip(*p)).collect(), edges: edges.collect() }.reversed()
    }

    /// Returns the contour halfway to `other`, which has the same edges in the same order: corners
    /// are midway, and arcs are about the midway centre. This is exact for lines, and for arcs over
    /// the same angles. Over different angles the exact curve is not an arc;
    /// [`Self::midway_area_mm2`] is exact for it, too.
    #[must_use]
    pub fn midway(&self, other: &Self) -> Self {
        let corners: Vec<_> =
            self.corners.iter().zip(&other.corners).map(|(a, b)| nalgebra::center(a, b)).collect();
        let n = corners.len();
        let edges = self.edges.iter().zip(&other.edges).enumerate().map(|(i, pair)| match pair {
            (Edge::Arc(a), Edge::Arc(b)) => {
                let centre = nalgebra::center(&a.centre, &b.centre);
                Edge::Arc(Arc::between(centre, corners[i], corners[(i + 1) % n], a.sweep_rad > 0.0))
            }
            _ => Edge::Line,
        });
        let edges = edges.collect();
        Self { corners, edges }
    }

    /// Signed area in mm² by Green's theorem: positive for outlines, negative for holes.
    pub fn area_mm2(&self) -> f64 {
        (0..self.edges.len()).map(|i| self.twice_swept_mm2(i)).sum::<f64>() / 2.0
    }

    /// Signed area in mm² halfway up the ruled wall to `other`, which has the same edges in the
    /// same order.
    ///
    /// The wall joins both curves at equal shares of every edge, so that the curve halfway is `m =
    /// (a + b)/2`. For two arcs over different angles it is not an arc, but `∫ m × dm` has a closed
    /// form.
    pub fn midway_area_mm2(&self, other: &Self) -> f64 {
        let halfway = self.midway(other);
        let twice = (0..self.edges.len()).map(|i| match (&self.edges[i], &other.edges[i]) {
            (Edge::Arc(a), Edge::Arc(b)) if a.is_twisted_to(b) => {
                (a.swept_with(a) + a.swept_with(b) + b.swept_with(a) + b.swept_with(b)) / 4.0
            }
            _ => halfway.twice_swept_mm2(i),
        });
        twice.sum::<f64>() / 2.0
    }

    /// Twice the area that the ray from the origin sweeps along edge `i`.
    fn twice_swept_mm2(&self, i: usize) -> f64 {
        let (from, to) = self.ends(i);
        let chord = from.x * to.y - to.x * from.y;
        match &self.edges[i] {
            Edge::Line => chord,
            Edge::Arc(a) => chord + a.radius_mm.powi(2) * (a.sweep_rad - libm::sin(a.sweep_rad)),
        }
    }

    /// Largest angle, in radians, between edge `i` of this contour and of `other` at equal shares
    /// of both.
    pub(crate) fn turn_to_rad(&self, other: &Self, i: usize) -> f64 {
        match (&self.edges[i], &other.edges[i]) {
            (Edge::Arc(a), Edge::Arc(b)) => {
                a.turns_to_rad(b).into_iter().fold(0.0, |most, t| most.max(t.abs()))
            }
            _ => {
                let ((from, to), (from_other, to_other)) = (self.ends(i), other.ends(i));
                (to - from).angle(&(to_other - from_other))
            }
        }
    }

    /// Length of the contour in mm.
    pub fn perimeter_mm(&self) -> f64 {
        (0..self.edges.len()).map(|i| self.edge_mm(i)).sum()
    }

    /// Length of edge `i` in mm.
    pub(crate) fn edge_mm(&self, i: usize) -> f64 {
        match &self.edges[i] {
            Edge::Line => (self.ends(i).1 - self.ends(i).0).norm(),
            Edge::Arc(a) => a.length_mm(),
        }
    }

    /// Lower left and upper right corner of the exact bounding box.
    pub fn bounds(&self) -> (Point2, Point2) {
        let empty = Point2::new(f64::INFINITY, f64::INFINITY);
        (0..self.edges.len()).map(|i| self.edge_bounds(i)).fold((empty, -empty), |(low, high), (a, b)| {
            (Point2::new(low.x.min(a.x), low.y.min(a.y)), Point2::new(high.x.max(b.x), high.y.max(b.y)))
        })
    }

    /// Lower left and upper right corner of the exact bounding box of edge `i`.
    pub(crate) fn edge_bounds(&self, i: usize) -> (Point2, Point2) {
        let (from, to) = self.ends(i);
        let mut low = Point2::new(from.x.min(to.x), from.y.min(to.y));
        let mut high = Point2::new(from.x.max(to.x), from.y.max(to.y));
        if let Edge::Arc(a) = &self.edges[i] {
            for quadrant in 0..4 {
                let angle = f64::from(quadrant) * FRAC_PI_2;
                if a.covers(angle) {
                    let p = a.centre + Vector2::new(libm::cos(angle), libm::sin(angle)) * a.radius_mm;
                    low = Point2::new(low.x.min(p.x), low.y.min(p.y));
                    high = Point2::new(high.x.max(p.x), high.y.max(p.y));
                }
            }
        }
        (low, high)
    }

    /// Distance in millimetres from `point` to the exact curve.
    pub fn distance_mm(&self, point: Point2) -> f64 {
        let to_edge = |i: usize| {
            let (from, to) = self.ends(i);
            let to_ends = (point - from).norm().min((point - to).norm());
            match &self.edges[i] {
                Edge::Line => {
                    let along = to - from;
                    let t = (point - from).dot(&along) / along.norm_squared();
                    if (0.0..=1.0).contains(&t) { (from + along * t - point).norm() } else { to_ends }
                }
                Edge::Arc(a) => {
                    let radial = point - a.centre;
                    let to_circle = (radial.norm() - a.radius_mm).abs();
                    if a.covers(libm::atan2(radial.y, radial.x)) { to_circle } else { to_ends }
                }
            }
        };
        (0..self.edges.len()).map(to_edge).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::super::pen::Pen;
    use super::*;

    fn half_disc() -> Contour {
        Pen::at(Point2::new(1.0, 0.0)).arc_to(Point2::origin(), Point2::new(-1.0, 0.0), true).close()
    }

    #[test]
    fn areas_and_perimeters_are_exact() {
        let circle = Contour::circle(Point2::new(3.0, -2.0), 2.0);
        assert!((circle.area_mm2() - 4.0 * PI).abs() < 1e-12);
        assert!((circle.perimeter_mm() - 4.0 * PI).abs() < 1e-12);
        assert!((circle.reversed().area_mm2() + 4.0 * PI).abs() < 1e-12);
        assert!((half_disc().area_mm2() - FRAC_PI_2).abs() < 1e-12);
        assert!((half_disc().mirrored().area_mm2() - FRAC_PI_2).abs() < 1e-12);
        assert!((half_disc().scaled(2.0).area_mm2() - 4.0 * FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn bounds_include_the_bulge_of_arcs() {
        let (low, high) = half_disc().bounds();
        assert!((low - Point2::new(-1.0, 0.0)).norm() < 1e-12);
        assert!((high - Point2::new(1.0, 1.0)).norm() < 1e-12);
    }

    #[test]
    fn distances_are_to_the_arc_itself() {
        assert!((half_disc().distance_mm(Point2::new(0.0, 0.5)) - 0.5).abs() < 1e-12);
        assert!((half_disc().distance_mm(Point2::new(0.0, -3.0)) - 3.0).abs() < 1e-12);
    }
}
