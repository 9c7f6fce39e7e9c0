//! Technical drawings on paper: sheets of lines, arcs and texts, dimensions that find free room, and three writers.
//!
//! It knows paper, not parts: what a part shows is decided by whoever draws it. All lengths are millimetres on paper, with
//! the origin in the sheet's lower left corner and y up; a [`View`] says how its lines follow from the millimetres of the
//! part. One list of [`Sheet`]s becomes `drawing.svg`, `drawing.pdf` and `drawing.dxf`.

#![warn(clippy::disallowed_methods)]

mod annotation;
mod clearance;
mod contour;
mod draft;
mod dxf;
mod escape;
mod font;
mod frame;
mod geometry;
mod index;
mod layout;
mod pdf;
mod sheet;
mod svg;
mod table;
pub mod view;

pub use annotation::{Angular, Callout, Label, Leader, Linear};
pub use clearance::{Collision, collisions};
pub use contour::{circle, hexagon, lettering, same};
pub use draft::Draft;
pub use dxf::drawing_dxf;
pub use escape::escape;
pub use font::{CAPITAL_PER_EM, fitted, text_width_mm};
pub use frame::{Projection, TitleBlock};
pub use geometry::{Extent, Point};
pub use layout::{ABOVE_ASSEMBLY_MM, ABOVE_MM, Layout, Sizes, assembly_formats, part_formats};
pub use pdf::drawing_pdf;
pub use sheet::{Annotation, Entity, Layer, Paper, Shape, Sheet, Text, View};
pub use svg::drawing_svg;
pub use table::Table;
