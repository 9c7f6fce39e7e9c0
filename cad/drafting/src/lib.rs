//! Technical drawings of solids: views, sections and dimensions on sheets of paper, written as SVG, PDF and DXF.
//!
//! [`PartDrawing`] draws the sheet of a part from its exact
//! [`Solid`](pinswitch_solid::solid::Solid): a front view along its axis, a view from above, a
//! section, enlarged details, and every dimension once. It selects paper, scale and cutting plane.
//! [`Fits`] adds tolerances and purposes, which a solid does not contain.
//!
//! ```
//! use pinswitch_drafting::{Fit, Paper, PartDrawing, RoundFit, TitleBlock, collisions, drawing_svg};
//! use pinswitch_solid::profile::{Contour, Point2};
//! use pinswitch_solid::solid::Solid;
//!
//! // A plate of 60 x 40 x 5 mm with a hole. Material is on the left of every contour, so the hole runs clockwise.
//! let corners = [(0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (0.0, 40.0)];
//! let outline = Contour::polygon(corners.map(|(x, y)| Point2::new(x, y)).to_vec());
//! let centre = Point2::new(20.0, 15.0);
//! let hole = Contour::circle(centre, 4.5).reversed();
//! let plate = Solid::prism(&outline, &[hole], 0.0, 5.0, 0.0)?;
//!
//! let mut drawing = PartDrawing::new("plate", &plate);
//! let fit = Fit::new("H13", "for M8");
//! drawing.fits.holes.push(RoundFit { centre: Some(centre), half_mm: 4.5, fit });
//! drawing.notes.push("Deburred".to_owned());
//! let title = TitleBlock {
//!     product: ("Machine".to_owned(), "Press".to_owned()),
//!     title: "Base plate".to_owned(),
//!     material: "Steel".to_owned(),
//!     general_tolerance: "ISO 2768-1 m".to_owned(),
//!     ..TitleBlock::default()
//! };
//! let sheet = drawing.sheet(&title, Paper::A4).ok_or("the plate fits on no paper")?;
//!
//! // No dimension overlaps anything.
//! assert!(collisions(&sheet).is_empty());
//! let text = |key: &str| sheet.annotations.iter().find(|a| a.key == key).map(|a| a.text.as_str());
//! assert_eq!(text("hole 1"), Some("\u{d8}9 H13 through, for M8"));
//! assert_eq!(text("from the left side, 20"), Some("20"));
//! assert_eq!((text("length"), text("width"), text("overall height")), (Some("60"), Some("40"), Some("5")));
//!
//! let svg = drawing_svg(&[sheet], "Base plate");
//! assert!(svg.starts_with("<svg") && svg.contains("for M8"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Sheets
//!
//! A [`Draft`] is an unfinished sheet: lines, arcs and texts on [`Layer`]s, in groups. [`Linear`],
//! [`Angular`], [`Callout`] and [`Label`] are annotations. An annotation has many candidate
//! positions, and gets the one of least cost at which it overlaps nothing. [`collisions`] tests a
//! finished [`Sheet`].
//!
//! All lengths are millimetres on paper. The origin is the lower left corner of the sheet, and y
//! points up. A [`View`] has the scale of its lines. [`drawing_svg`], [`drawing_pdf`] and
//! [`drawing_dxf`] write a list of sheets to one file.
//!
//! # Views
//!
//! [`view`] contains the views, for other kinds of sheets, such as that of an assembly: front views
//! of one or several bodies, side views with hidden lines, cut faces with hatching, and the mark of
//! a section.
//!
//! # Pages
//!
//! [`pages_pdf`] writes pages of text, lines and pictures, for documents that belong to drawings.
//!
//! # Limits
//!
//! Solids consist of contours of lines and arcs at heights. These features get dimensions: radii and
//! angles about the axis (the origin), stepped, blind and hexagonal bores, round bosses, straight
//! and curved slots, half-round grooves and ribs, rounded corners, ring segments, ends of sectors,
//! patterns of pockets, corners of outlines, and heights. An outline of other curves gets views, but
//! no dimensions.

#![warn(clippy::disallowed_methods)]

mod annotation;
mod collision;
mod contour;
mod draft;
mod dxf;
mod escape;
mod font;
mod geometry;
mod index;
mod indicator;
mod layout;
mod pages;
mod part;
mod pdf;
mod sheet;
mod svg;
mod table;
mod title_block;
pub mod view;

pub use annotation::{Angular, Callout, Label, Leader, Linear};
pub use collision::{Collision, collisions};
pub use contour::{hexagon, lettering, same};
pub use draft::Draft;
pub use dxf::drawing_dxf;
pub use escape::escape;
pub use geometry::{Extent, Point};
pub use indicator::{DatumMark, Indicator};
pub use layout::{ABOVE_ASSEMBLY_MM, ABOVE_MM, Layout, Sizes, assembly_formats, part_formats};
pub use pages::{Page, PageItem, PngPixels, Rgb, Typeface, pages_pdf};
pub use part::{FaceDatum, Fit, Fits, PartDrawing, RadialSize, RadiusFit, RoundFit, Terms, number};
pub use pdf::drawing_pdf;
pub use sheet::{Annotation, Entity, Layer, Paper, Shape, Sheet, Text, View};
pub use svg::drawing_svg;
pub use table::Table;
pub use title_block::{Projection, TitleBlock};
