//! A circular arc.

use std::f64::consts::TAU;

use super::{Point2, Vector2};

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
    /// The arc about `centre` from `from` to `to`, counter-clockwise or clockwise, short of a full turn.
    pub fn between(centre: Point2, from: Point2, to: Point2, counter_clockwise: bool) -> Self {
        let angle = |p: Point2| (p.y - centre.y).atan2(p.x - centre.x);
        let start_rad = angle(from);
        let forward = (angle(to) - start_rad).rem_euclid(TAU);
        let sweep_rad = if counter_clockwise { forward } else { forward - TAU };
        Self { centre, radius_mm: (from - centre).norm(), start_rad, sweep_rad }
    }

    /// The point at `fraction` of the sweep, on a circle of `radius_mm` about the same centre.
    pub fn point_at(&self, fraction: f64, radius_mm: f64) -> Point2 {
        let angle = self.start_rad + self.sweep_rad * fraction;
        self.centre + Vector2::new(angle.cos(), angle.sin()) * radius_mm
    }

    /// Unit tangent at `fraction` of the sweep.
    pub fn tangent_at(&self, fraction: f64) -> Vector2 {
        let angle = self.start_rad + self.sweep_rad * fraction;
        Vector2::new(-angle.sin(), angle.cos()) * self.sweep_rad.signum()
    }

    /// Length in millimetres.
    pub fn length_mm(&self) -> f64 {
        self.radius_mm * self.sweep_rad.abs()
    }

    /// Distance in millimetres between the arc and its single chord.
    pub fn sagitta_mm(&self) -> f64 {
        self.radius_mm * (1.0 - (self.sweep_rad / 2.0).cos())
    }

    /// Whether the arc passes the angle `angle_rad`.
    pub fn covers(&self, angle_rad: f64) -> bool {
        let forward = (angle_rad - self.start_rad) * self.sweep_rad.signum();
        forward.rem_euclid(TAU) <= self.sweep_rad.abs()
    }
}
