//! Exact plane profiles of straight lines and circular arcs: the only description of every part.
//!
//! A [`Contour`] is closed, with material to its left: outlines run counter-clockwise, holes
//! clockwise.

mod arc;
mod contour;
mod flatten;
mod hull;
mod offset;
mod pen;
mod point;
mod tolerance;

pub use arc::Arc;
pub use contour::{Contour, Edge};
pub use flatten::{FLAT_MM, chords_for, deviation_mm};
pub use hull::{Disc, HullArc, hull, hull_arcs};
pub use offset::OffsetError;
pub use pen::Pen;
pub use point::{Point2, Vector2, polar};
pub use tolerance::{ChordTolerance, ToleranceError};
