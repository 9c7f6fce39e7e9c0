//! Views of solids: front views, side views with hidden lines, cut faces, the mark of a section, and isometric views.
//!
//! A front view looks along the axis of a solid, onto its upper face. Side views look across the axis; their coordinates
//! are `u` across the paper, `z` along the axis, and `w` toward the observer.

mod axonometric;
mod body;
mod elevation;
mod face;
mod plan;
mod section_mark;
mod stack;
mod strokes;

pub use axonometric::{Shifted, isometric};
pub use body::{Body, Side};
pub use elevation::{Elevation, elevation};
pub use face::Face;
pub(crate) use plan::within;
pub use plan::{Place, Trace, draw_plan, plan};
pub use section_mark::{Letter, draw_section_mark};
pub use stack::{Placed, stacked_plan};
pub use strokes::{Stroke, draw_strokes, joined, legible};

/// Distance between hatching lines, mm on paper.
pub const HATCH_MM: f64 = 1.8;
/// Least distance between parallel lines of a side view, mm on paper.
pub const CROWDED_MM: f64 = 0.8;
