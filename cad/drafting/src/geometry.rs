//! Points and rectangles on paper.

use std::ops::{Add, Mul, Sub};

/// A point or a displacement on paper, mm; y up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// To the right, mm.
    pub x: f64,
    /// Up, mm.
    pub y: f64,
}

impl Point {
    /// A point.
    #[must_use]
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// The unit vector at this angle, radians counter-clockwise from +x.
    #[must_use]
    pub fn towards(angle_rad: f64) -> Self {
        Self::new(libm::cos(angle_rad), libm::sin(angle_rad))
    }

    /// The length of a displacement, mm.
    #[must_use]
    pub fn length(self) -> f64 {
        libm::hypot(self.x, self.y)
    }

    /// The same direction with length 1; zero stays zero.
    #[must_use]
    pub fn unit(self) -> Self {
        let length = self.length();
        if length > 0.0 { self * (1.0 / length) } else { self }
    }

    /// Rotated by 90 degrees counter-clockwise.
    #[must_use]
    pub fn left(self) -> Self {
        Self::new(-self.y, self.x)
    }

    /// The angle of a displacement, radians counter-clockwise from +x.
    #[must_use]
    pub fn angle_rad(self) -> f64 {
        libm::atan2(self.y, self.x)
    }
}

impl Add for Point {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl Sub for Point {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl Mul<f64> for Point {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::new(self.x * factor, self.y * factor)
    }
}

/// A rectangle with sides parallel to those of the paper, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Lower left corner.
    pub low: Point,
    /// Upper right corner.
    pub high: Point,
}

impl Extent {
    /// The rectangle between two corners, in any order.
    #[must_use]
    pub fn between(a: Point, b: Point) -> Self {
        Self { low: Point::new(a.x.min(b.x), a.y.min(b.y)), high: Point::new(a.x.max(b.x), a.y.max(b.y)) }
    }

    /// The smallest rectangle around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            low: Point::new(self.low.x.min(other.low.x), self.low.y.min(other.low.y)),
            high: Point::new(self.high.x.max(other.high.x), self.high.y.max(other.high.y)),
        }
    }

    /// Enlarged by `by` on all sides.
    #[must_use]
    pub fn grown(self, by: f64) -> Self {
        Self { low: self.low - Point::new(by, by), high: self.high + Point::new(by, by) }
    }

    /// Width, mm.
    #[must_use]
    pub fn width(self) -> f64 {
        self.high.x - self.low.x
    }

    /// Height, mm.
    #[must_use]
    pub fn height(self) -> f64 {
        self.high.y - self.low.y
    }

    /// Its centre.
    #[must_use]
    pub fn middle(self) -> Point {
        (self.low + self.high) * 0.5
    }

    /// Returns whether both share more than an edge.
    #[must_use]
    pub fn overlaps(self, other: Self) -> bool {
        self.low.x < other.high.x
            && other.low.x < self.high.x
            && self.low.y < other.high.y
            && other.low.y < self.high.y
    }

    /// Returns whether `other` is inside.
    #[must_use]
    pub fn contains(self, other: Self) -> bool {
        self.low.x <= other.low.x
            && self.low.y <= other.low.y
            && self.high.x >= other.high.x
            && self.high.y >= other.high.y
    }

    /// Returns whether the line from `a` to `b` passes through the inside.
    #[must_use]
    pub fn is_crossed_by(self, a: Point, b: Point) -> bool {
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for (start, step, low, high) in
            [(a.x, b.x - a.x, self.low.x, self.high.x), (a.y, b.y - a.y, self.low.y, self.high.y)]
        {
            if step.abs() < 1e-12 {
                if start <= low || start >= high {
                    return false;
                }
                continue;
            }
            let (first, last) = ((low - start) / step, (high - start) / step);
            from = from.max(first.min(last));
            to = to.min(first.max(last));
        }
        from < to
    }
}

/// Returns whether two lines cross. Ends that touch do not.
pub(super) fn lines_cross([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let side = |p: Point, q: Point, r: Point| (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    let apart = |x: f64, y: f64| (x > 1e-9 && y < -1e-9) || (x < -1e-9 && y > 1e-9);
    apart(side(a, b, c), side(a, b, d)) && apart(side(c, d, a), side(c, d, b))
}

/// Returns whether two lines coincide over more than 1 mm.
pub(super) fn lines_overlap([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let along = (b - a).unit();
    let off = |p: Point| ((p - a).x * along.y - (p - a).y * along.x).abs();
    let far = |p: Point| (p - a).x * along.x + (p - a).y * along.y;
    let shared = (b - a).length().min(far(c).max(far(d))) - far(c).min(far(d)).max(0.0);
    off(c) < COINCIDENT_MM && off(d) < COINCIDENT_MM && shared > 1.0
}

/// Lines closer than this look like one, mm.
const COINCIDENT_MM: f64 = 0.8;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallel_lines_overlap_and_others_cross() {
        let at = |x: f64, y: f64| Point::new(x, y);
        let line = [at(0.0, 0.0), at(10.0, 0.0)];
        assert!(lines_overlap(line, [at(20.0, 0.1), at(5.0, 0.0)]));
        assert!(!lines_overlap(line, [at(20.0, 0.0), at(9.5, 0.0)]));
        assert!(
            !lines_overlap(line, [at(5.0, -3.0), at(5.0, 3.0)])
                && !lines_overlap(line, [at(0.0, 2.0), at(10.0, 2.0)])
        );
        assert!(
            lines_cross(line, [at(5.0, -3.0), at(5.0, 3.0)])
                && !lines_cross(line, [at(5.0, 0.0), at(5.0, 3.0)])
        );
    }

    #[test]
    fn lines_cross_the_inside_of_rectangles() {
        let square = Extent::between(Point::new(0.0, 0.0), Point::new(2.0, 2.0));
        let crossed =
            |a: [f64; 2], b: [f64; 2]| square.is_crossed_by(Point::new(a[0], a[1]), Point::new(b[0], b[1]));
        assert!(crossed([-1.0, 1.0], [3.0, 1.0]) && crossed([0.5, 0.5], [1.0, 1.0]));
        assert!(crossed([-1.0, -0.5], [3.0, 2.5]));
        // Along an edge, past a corner, and short of it.
        assert!(!crossed([-1.0, 2.0], [3.0, 2.0]) && !crossed([-1.0, 1.5], [1.0, 3.5]));
        assert!(!crossed([-2.0, 1.0], [-0.1, 1.0]));
    }
}
