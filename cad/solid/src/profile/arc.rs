//! A circular arc.

use std::f64::consts::{PI, TAU};

use super::point::{Point2, Vector2};

/// Angles that differ by at most this, in radians, are equal: the rest is rounding.
const SAME_ANGLE_RAD: f64 = 1e-9;

/// A circular arc; angles in radians, counter-clockwise from +x, as in mathematics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Centre of the circle.
    pub centre: Point2,
    /// Radius in millimetres.
    pub radius_mm: f64,
    /// Angle of the first point.
    pub start_rad: f64,
    /// Signed angle to the last point; positive is counter-clockwise.
    pub sweep_rad: f64,
}

impl Arc {
    /// The arc about `centre` from `from` to `to`, counter-clockwise or clockwise, short of a full
    /// turn.
    pub fn between(centre: Point2, from: Point2, to: Point2, counter_clockwise: bool) -> Self {
        let angle = |p: Point2| libm::atan2(p.y - centre.y, p.x - centre.x);
        let start_rad = angle(from);
        let forward = (angle(to) - start_rad).rem_euclid(TAU);
        let sweep_rad = if counter_clockwise { forward } else { forward - TAU };
        Self { centre, radius_mm: (from - centre).norm(), start_rad, sweep_rad }
    }

    /// Returns the point at `fraction` of the sweep, on a circle of `radius_mm` about the same
    /// centre.
    pub fn point_at(&self, fraction: f64, radius_mm: f64) -> Point2 {
        let angle = self.start_rad + self.sweep_rad * fraction;
        self.centre + Vector2::new(libm::cos(angle), libm::sin(angle)) * radius_mm
    }

    /// Unit tangent at `fraction` of the sweep.
    pub fn tangent_at(&self, fraction: f64) -> Vector2 {
        let angle = self.start_rad + self.sweep_rad * fraction;
        Vector2::new(-libm::sin(angle), libm::cos(angle)) * self.sweep_rad.signum()
    }

    /// Length in millimetres.
    pub fn length_mm(&self) -> f64 {
        self.radius_mm * self.sweep_rad.abs()
    }

    /// Distance in millimetres between the arc and its single chord.
    pub fn sagitta_mm(&self) -> f64 {
        self.radius_mm * (1.0 - libm::cos(self.sweep_rad / 2.0))
    }

    /// Whether the arc passes the angle `angle_rad`.
    pub fn covers(&self, angle_rad: f64) -> bool {
        let forward = (angle_rad - self.start_rad) * self.sweep_rad.signum();
        forward.rem_euclid(TAU) <= self.sweep_rad.abs()
    }

    /// Angles from this arc's direction to that of `other` at their first and last points; the
    /// first is within half a turn.
    pub(super) fn turns_to_rad(&self, other: &Self) -> [f64; 2] {
        let first = (other.start_rad - self.start_rad + PI).rem_euclid(TAU) - PI;
        [first, first + (other.sweep_rad - self.sweep_rad)]
    }

    /// Whether the arcs cover different angles, so that the ruled wall to `other` is neither a
    /// cylinder nor a cone.
    pub(super) fn is_twisted_to(&self, other: &Self) -> bool {
        self.turns_to_rad(other).iter().any(|turn| turn.abs() > SAME_ANGLE_RAD)
    }

    /// The integral of `a × db` over both arcs at equal shares of their angles, in mm²: `a` is this
    /// arc, `b` the other.
    ///
    /// About the centre, the integrand is the cosine of the angle between the two directions, which
    /// changes linearly.
    pub(super) fn swept_with(&self, other: &Self) -> f64 {
        let [first, last] = self.turns_to_rad(other);
        let (middle, half) = (f64::midpoint(first, last), (last - first) / 2.0);
        let sinc = if half.abs() < SAME_ANGLE_RAD { 1.0 } else { libm::sin(half) / half };
        let moved = other.point_at(1.0, other.radius_mm) - other.point_at(0.0, other.radius_mm);
        self.centre.coords.perp(&moved)
            + self.radius_mm * other.radius_mm * other.sweep_rad * libm::cos(middle) * sinc
    }
}
