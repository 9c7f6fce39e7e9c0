//! Construction of a contour edge by edge.

use super::arc::Arc;
use super::contour::{Contour, Edge};
use super::point::Point2;

/// Draws a [`Contour`]; neighbouring edges share their corner by construction.
///
/// ```
/// use pinswitch_solid::profile::{Pen, Point2};
///
/// // A half disc of radius 3: an arc about the origin, closed with a straight line.
/// let half = Pen::at(Point2::new(3.0, 0.0)).arc_to(Point2::origin(), Point2::new(-3.0, 0.0), true).close();
/// assert!((half.area_mm2() - 4.5 * std::f64::consts::PI).abs() < 1e-12);
/// assert_eq!(half.edges().len(), 2);
/// ```
#[derive(Clone, Debug)]
pub struct Pen {
    corners: Vec<Point2>,
    edges: Vec<Edge>,
}

impl Pen {
    /// Starts a contour at `point`.
    pub fn at(point: Point2) -> Self {
        Self { corners: vec![point], edges: Vec::new() }
    }

    fn here(&self) -> Point2 {
        // There is always a corner: the constructor adds one and none is removed.
        self.corners.last().copied().unwrap_or_else(Point2::origin)
    }

    /// Appends a straight line to `point`.
    #[must_use]
    pub fn line_to(mut self, point: Point2) -> Self {
        self.edges.push(Edge::Line);
        self.corners.push(point);
        self
    }

    /// Appends an arc about `centre` to `point`, counter-clockwise or clockwise.
    #[must_use]
    pub fn arc_to(mut self, centre: Point2, point: Point2, counter_clockwise: bool) -> Self {
        self.edges.push(Edge::Arc(Arc::between(centre, self.here(), point, counter_clockwise)));
        self.corners.push(point);
        self
    }

    /// Closes the contour, with a straight line unless the pen is at its start.
    pub fn close(mut self) -> Contour {
        if (self.here() - self.corners[0]).norm() > 1e-9 {
            self.edges.push(Edge::Line);
        } else {
            self.corners.pop();
        }
        Contour::from_parts(self.corners, self.edges)
    }
}
