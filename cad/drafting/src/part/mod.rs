//! Sheets of single parts: views, sections, details, and every dimension once.
//!
//! Features are recognised in the contours of the exact solid. [`Fits`] adds what a solid does not show: tolerances, and
//! what a hole is for.

mod angles;
mod bore;
mod callouts;
mod chains;
mod detail;
mod dimension;
mod drawing;
mod features;
mod fit;
mod hole_table;
mod notes;
mod sides;
mod text;

pub use drawing::PartDrawing;
pub use fit::{FaceDatum, Fit, Fits, RadialSize, RadiusFit, RoundFit};
pub use notes::Terms;
pub use text::number;
