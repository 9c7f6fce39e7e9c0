//! Exact plane profiles of straight lines and circular arcs: the single source of every part.
//!
//! A [`Contour`] is closed, and material lies to its left: outlines run counter-clockwise, holes clockwise.

mod arc;
mod contour;
mod flatten;
mod hull;
mod offset;
mod pen;
mod tolerance;

pub use arc::Arc;
pub use contour::{Contour, Edge};
pub use flatten::{FLAT_MM, chords_for, deviation_mm};
pub use hull::{Disc, HullArc, hull, hull_arcs};
pub use offset::OffsetError;
pub use pen::Pen;
pub use tolerance::{ChordTolerance, ToleranceError};

/// A point in the plane, in millimetres.
pub type Point2 = nalgebra::Point2<f64>;
/// A displacement in the plane, in millimetres.
pub type Vector2 = nalgebra::Vector2<f64>;

/// The point at `radius_mm` and `angle_rad` about the axis: angles run from +y toward +x
/// (cad/doc/dimensions.md, "Frame and names").
pub fn polar(radius_mm: f64, angle_rad: f64) -> Point2 {
    Point2::new(radius_mm * libm::sin(angle_rad), radius_mm * libm::cos(angle_rad))
}
