//! Points and displacements in the plane.

/// A point in the plane, in millimetres.
pub type Point2 = nalgebra::Point2<f64>;
/// A displacement in the plane, in millimetres.
pub type Vector2 = nalgebra::Vector2<f64>;

/// Returns the point at `radius_mm` and `angle_rad` about the axis. Angles run from +y toward +x
/// (cad/doc/dimensions.md, "Frame and names").
pub fn polar(radius_mm: f64, angle_rad: f64) -> Point2 {
    Point2::new(radius_mm * libm::sin(angle_rad), radius_mm * libm::cos(angle_rad))
}
