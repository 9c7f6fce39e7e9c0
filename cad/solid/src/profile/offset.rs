//! Offsetting a contour into its material: chamfers.

use std::f64::consts::PI;

use pinswitch_diagnostic::{Diagnostic, codes};

use super::arc::Arc;
use super::contour::{Contour, Edge};
use super::point::{Point2, Vector2};

/// Neighbouring edges whose directions differ by less than this, in radians, are tangent.
const SMOOTH_RAD: f64 = 1e-7;

/// An offset that removes an edge of the contour.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("an offset of {distance_mm:.3} mm removes the edge at ({x:.3}, {y:.3}) mm")]
pub struct OffsetError {
    /// Offset, mm.
    pub distance_mm: f64,
    /// Start of the edge, mm.
    pub x: f64,
    /// Start of the edge, mm.
    pub y: f64,
}

impl From<OffsetError> for Diagnostic {
    fn from(error: OffsetError) -> Self {
        Self::new(codes::SHAPE_CANNOT_BE_BUILT, error.to_string())
            .with_help("lower the offset, or lengthen the edge")
    }
}

/// An offset edge, not yet trimmed to its new corners.
#[derive(Clone, Copy, Debug)]
enum OffsetEdge {
    Line { through: Point2, along: Vector2 },
    Circle { centre: Point2, radius_mm: f64 },
}

impl Contour {
    /// Returns the contour offset to its left, into the material, by `distance_mm`; a negative
    /// distance is out of the material. It has the same edges in the same order, so that a wall can
    /// join the two.
    ///
    /// # Errors
    /// [`OffsetError`] if an edge vanishes or neighbours no longer meet.
    pub fn offset(&self, distance_mm: f64) -> Result<Self, OffsetError> {
        let n = self.edges().len();
        let fault = |i: usize| OffsetError { distance_mm, x: self.corners()[i].x, y: self.corners()[i].y };
        let moved: Vec<_> =
            (0..n).map(|i| self.offset_edge(i, distance_mm).ok_or(fault(i))).collect::<Result<_, _>>()?;
        let corners: Vec<_> = (0..n)
            .map(|i| {
                let before = (i + n - 1) % n;
                self.offset_corner(before, i, &moved, distance_mm).ok_or(fault(i))
            })
            .collect::<Result<_, _>>()?;
        let edges: Vec<_> = (0..n)
            .map(|i| self.trimmed(i, corners[i], corners[(i + 1) % n]).ok_or(fault(i)))
            .collect::<Result<_, _>>()?;
        Ok(Self::from_parts(corners, edges))
    }

    fn tangents(&self, i: usize) -> (Vector2, Vector2) {
        match &self.edges()[i] {
            Edge::Line => {
                let (from, to) = self.ends(i);
                let along = (to - from).normalize();
                (along, along)
            }
            Edge::Arc(arc) => (arc.tangent_at(0.0), arc.tangent_at(1.0)),
        }
    }

    fn offset_edge(&self, i: usize, distance_mm: f64) -> Option<OffsetEdge> {
        match &self.edges()[i] {
            Edge::Line => {
                let along = self.tangents(i).0;
                Some(OffsetEdge::Line { through: self.corners()[i] + left(along) * distance_mm, along })
            }
            Edge::Arc(arc) => {
                let radius_mm = arc.radius_mm - distance_mm * arc.sweep_rad.signum();
                (radius_mm > 0.0).then_some(OffsetEdge::Circle { centre: arc.centre, radius_mm })
            }
        }
    }

    fn offset_corner(
        &self,
        before: usize,
        after: usize,
        moved: &[OffsetEdge],
        distance_mm: f64,
    ) -> Option<Point2> {
        let corner = self.corners()[after];
        let (into, out) = (self.tangents(before).1, self.tangents(after).0);
        if (into.perp(&out)).abs() < SMOOTH_RAD && into.dot(&out) > 0.0 {
            return Some(corner + left(into) * distance_mm);
        }
        intersections(moved[before], moved[after])
            .into_iter()
            .flatten()
            .min_by(|a, b| (a - corner).norm().total_cmp(&(b - corner).norm()))
    }

    /// Edge `i` between its new corners; `None` if its direction is reversed.
    fn trimmed(&self, i: usize, from: Point2, to: Point2) -> Option<Edge> {
        match &self.edges()[i] {
            Edge::Line => ((to - from).dot(&self.tangents(i).0) > 0.0).then_some(Edge::Line),
            Edge::Arc(old) => {
                let arc = Arc::between(old.centre, from, to, old.sweep_rad > 0.0);
                ((arc.sweep_rad - old.sweep_rad).abs() < PI).then_some(Edge::Arc(arc))
            }
        }
    }
}

fn left(along: Vector2) -> Vector2 {
    Vector2::new(-along.y, along.x)
}

/// The points in which two offset edges intersect, none to two.
fn intersections(a: OffsetEdge, b: OffsetEdge) -> [Option<Point2>; 2] {
    match (a, b) {
        (OffsetEdge::Line { through: p, along: d }, OffsetEdge::Line { through: q, along: e }) => {
            let cross = d.perp(&e);
            [(cross.abs() > SMOOTH_RAD).then(|| p + d * ((q - p).perp(&e) / cross)), None]
        }
        (OffsetEdge::Line { through, along }, OffsetEdge::Circle { centre, radius_mm })
        | (OffsetEdge::Circle { centre, radius_mm }, OffsetEdge::Line { through, along }) => {
            let foot = through + along * (centre - through).dot(&along);
            on_chord(foot, along, radius_mm.powi(2) - (foot - centre).norm_squared())
        }
        (OffsetEdge::Circle { centre: p, radius_mm: r }, OffsetEdge::Circle { centre: q, radius_mm: s }) => {
            let apart = (q - p).norm();
            if apart == 0.0 {
                return [None, None];
            }
            let towards = (q - p) / apart;
            let reach = (apart * apart + r * r - s * s) / (2.0 * apart);
            on_chord(p + towards * reach, left(towards), r * r - reach * reach)
        }
    }
}

/// The two points at distance `sqrt(half_chord²)` from `middle` along a unit direction.
fn on_chord(middle: Point2, along: Vector2, half_chord_squared: f64) -> [Option<Point2>; 2] {
    if half_chord_squared < 0.0 {
        return [None, None];
    }
    let half = half_chord_squared.sqrt();
    [Some(middle + along * half), Some(middle - along * half)]
}

#[cfg(test)]
mod tests {
    use super::super::pen::Pen;
    use super::*;

    fn square() -> Contour {
        Contour::polygon(vec![
            Point2::new(0.0, 0.0),
            Point2::new(4.0, 0.0),
            Point2::new(4.0, 4.0),
            Point2::new(0.0, 4.0),
        ])
    }

    /// A block with a half-round groove in its top: the groove widens as the outline shrinks.
    fn grooved() -> Contour {
        Pen::at(Point2::new(0.0, 0.0))
            .line_to(Point2::new(6.0, 0.0))
            .line_to(Point2::new(6.0, 3.0))
            .line_to(Point2::new(4.0, 3.0))
            .arc_to(Point2::new(3.0, 3.0), Point2::new(2.0, 3.0), false)
            .line_to(Point2::new(0.0, 3.0))
            .close()
    }

    #[test]
    fn outlines_shrink_and_holes_grow() {
        assert!((square().offset(0.5).unwrap().area_mm2() - 9.0).abs() < 1e-12);
        assert!((square().reversed().offset(0.5).unwrap().area_mm2() + 25.0).abs() < 1e-12);
        let hole = Contour::circle(Point2::origin(), 1.0).reversed();
        assert!((hole.offset(0.5).unwrap().area_mm2() + PI * 2.25).abs() < 1e-12);
    }

    #[test]
    fn offsets_have_a_constant_distance() {
        let shrunk = grooved().offset(0.3).unwrap();
        assert!(shrunk.area_mm2() < grooved().area_mm2());
        for i in 0..shrunk.edges().len() {
            let (from, to) = shrunk.ends(i);
            let middle = match &shrunk.edges()[i] {
                Edge::Line => nalgebra::center(&from, &to),
                Edge::Arc(arc) => arc.point_at(0.5, arc.radius_mm),
            };
            assert!((grooved().distance_mm(middle) - 0.3).abs() < 1e-12);
        }
    }

    #[test]
    fn offsets_that_remove_edges_are_refused() {
        assert!(square().offset(2.1).is_err());
        assert!(grooved().offset(1.5).is_err());
        assert!(Contour::circle(Point2::origin(), 1.0).offset(1.0).is_err());
    }
}
