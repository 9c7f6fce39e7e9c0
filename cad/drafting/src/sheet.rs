//! Sheets: paper, line types, shapes, views and annotations.

use super::font::{CAPITAL_PER_EM, DESCENT_PER_EM, text_width_mm};
use super::geometry::{Extent, Point};

/// A size of paper, in landscape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paper {
    /// 297 x 210 mm.
    A4,
    /// 420 x 297 mm.
    A3,
}

impl Paper {
    /// Width and height, mm.
    #[must_use]
    pub const fn size_mm(self) -> (f64, f64) {
        match self {
            Self::A4 => (297.0, 210.0),
            Self::A3 => (420.0, 297.0),
        }
    }

    /// Name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::A4 => "A4",
            Self::A3 => "A3",
        }
    }

    /// The area inside the frame: 20 mm from the left edge, for filing, and 10 mm from the others (ISO 5457).
    #[must_use]
    pub const fn frame(self) -> Extent {
        let (width, height) = self.size_mm();
        Extent { low: Point::new(20.0, 10.0), high: Point::new(width - 10.0, height - 10.0) }
    }
}

/// The purpose of a line, with its width and dashes (ISO 128).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Visible edges.
    Visible,
    /// Hidden edges.
    Hidden,
    /// Axes, planes of symmetry, pitch circles.
    Centre,
    /// Dimension lines, extension lines, leaders.
    Dimension,
    /// Hatching of cut faces.
    Hatch,
    /// Adjacent parts.
    Phantom,
    /// Thin outlines: engraved letters, limits of details, tables.
    Thin,
    /// Cutting planes, and the frame.
    Frame,
    /// Text.
    Text,
}

impl Layer {
    /// Every layer.
    pub const ALL: [Self; 9] = [
        Self::Visible,
        Self::Hidden,
        Self::Centre,
        Self::Dimension,
        Self::Hatch,
        Self::Phantom,
        Self::Thin,
        Self::Frame,
        Self::Text,
    ];

    /// Name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Visible => "VISIBLE",
            Self::Hidden => "HIDDEN",
            Self::Centre => "CENTRE",
            Self::Dimension => "DIMENSION",
            Self::Hatch => "HATCH",
            Self::Phantom => "PHANTOM",
            Self::Thin => "THIN",
            Self::Frame => "FRAME",
            Self::Text => "TEXT",
        }
    }

    /// Width of lines, mm.
    #[must_use]
    pub const fn width_mm(self) -> f64 {
        match self {
            Self::Visible | Self::Frame => 0.5,
            Self::Hatch => 0.18,
            _ => 0.25,
        }
    }

    /// Alternating lengths of dashes and gaps, mm; empty for a continuous line.
    #[must_use]
    pub const fn dashes_mm(self) -> &'static [f64] {
        match self {
            Self::Hidden => &[2.0, 0.8],
            Self::Centre => &[5.0, 0.8, 0.4, 0.8],
            Self::Phantom => &[5.0, 0.8, 0.4, 0.8, 0.4, 0.8],
            _ => &[],
        }
    }
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Left end of the baseline.
    pub at: Point,
    /// Height of its capitals, mm.
    pub height_mm: f64,
    /// The text.
    pub content: String,
    /// Whether it runs upward, to read from the right.
    pub upright: bool,
}

impl Text {
    /// Length of the baseline, mm.
    #[must_use]
    pub fn width_mm(&self) -> f64 {
        text_width_mm(&self.content, self.height_mm)
    }

    /// The bounding box.
    #[must_use]
    pub fn extent(&self) -> Extent {
        let (width, descent) = (self.width_mm(), self.height_mm / CAPITAL_PER_EM * DESCENT_PER_EM);
        let (low, high) = if self.upright {
            (Point::new(-self.height_mm, 0.0), Point::new(descent, width))
        } else {
            (Point::new(0.0, -descent), Point::new(width, self.height_mm))
        };
        Extent { low: self.at + low, high: self.at + high }
    }
}

/// The shape of an entity.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A straight line.
    Line {
        /// First end.
        from: Point,
        /// Last end.
        to: Point,
    },
    /// An arc, counter-clockwise where the sweep is positive.
    Arc {
        /// Centre.
        centre: Point,
        /// Radius, mm.
        radius_mm: f64,
        /// Angle of the first end from +x.
        start_rad: f64,
        /// Signed angle to the last end.
        sweep_rad: f64,
    },
    /// A circle.
    Circle {
        /// Centre.
        centre: Point,
        /// Radius, mm.
        radius_mm: f64,
    },
    /// A filled arrow head.
    Arrow {
        /// Tip.
        tip: Point,
        /// Unit vector toward the tip.
        direction: Point,
    },
    /// A text.
    Text(Text),
}

/// Length of an arrow head, mm.
pub(super) const ARROW_MM: f64 = 2.5;
/// Length of the tip of an arrow head that may touch other lines, mm.
const ARROW_TIP_MM: f64 = 0.5;
/// Half of its width, mm.
pub(super) const ARROW_HALF_MM: f64 = 0.42;

impl Shape {
    /// Straight pieces within 0.03 mm of the curve; none for a text.
    #[must_use]
    pub fn pieces(&self) -> Vec<[Point; 2]> {
        match *self {
            Self::Line { from, to } => vec![[from, to]],
            Self::Arc { centre, radius_mm, start_rad, sweep_rad } => {
                chords(centre, radius_mm, start_rad, sweep_rad)
            }
            Self::Circle { centre, radius_mm } => chords(centre, radius_mm, 0.0, std::f64::consts::TAU),
            Self::Arrow { tip, direction } => vec![[tip, tip - direction * ARROW_MM]],
            Self::Text(_) => Vec::new(),
        }
    }

    /// The sides of an arrow head, without its tip, which touches other lines.
    pub(super) fn arrow_sides(tip: Point, direction: Point) -> [[Point; 2]; 3] {
        let [_, left, right] = Self::arrow_corners(tip, direction);
        let front = tip - direction * ARROW_TIP_MM;
        [[front, left], [front, right], [left, right]]
    }

    /// The three corners of an arrow head.
    pub(super) fn arrow_corners(tip: Point, direction: Point) -> [Point; 3] {
        let (foot, side) = (tip - direction * ARROW_MM, direction.left() * ARROW_HALF_MM);
        [tip, foot + side, foot - side]
    }
}

fn chords(centre: Point, radius_mm: f64, start_rad: f64, sweep_rad: f64) -> Vec<[Point; 2]> {
    // The sagitta of a chord of angle a is r a²/8.
    let step = (8.0 * 0.03 / radius_mm.max(1e-6)).sqrt().min(0.6);
    let number = ((sweep_rad.abs() / step).ceil().max(1.0)) as u32;
    let at = |i: u32| {
        centre + Point::towards(start_rad + sweep_rad * f64::from(i) / f64::from(number)) * radius_mm
    };
    (0..number).map(|i| [at(i), at(i + 1)]).collect()
}

/// A shape with its line type, view and annotation.
#[derive(Clone, Debug, PartialEq)]
pub struct Entity {
    /// Line type.
    pub layer: Layer,
    /// Shape.
    pub shape: Shape,
    /// The number of the view to whose geometry it belongs; `None` for annotations.
    pub view: Option<usize>,
    /// The number of its group. A text may touch lines of its own group.
    pub group: usize,
}

/// A view of a part: the position of its origin on paper, and its scale.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Name in files, unique on the sheet, such as `FRONT`.
    pub name: String,
    /// Origin of the part, on paper.
    pub origin: Point,
    /// Millimetres on paper for a millimetre of the part.
    pub scale: f64,
}

/// The content of a dimension, callout, note or row of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Annotation {
    /// Number of the group of its entities.
    pub group: usize,
    /// What it describes, such as `groove pitch`.
    pub key: String,
    /// Lines of text, joined by line feeds; cells of a row, joined by tabs.
    pub text: String,
}

/// One sheet of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Name of the part, or of the assembly.
    pub name: String,
    /// Size.
    pub paper: Paper,
    /// Scale of the main views.
    pub scale: f64,
    /// Views.
    pub views: Vec<View>,
    /// Everything on the sheet.
    pub entities: Vec<Entity>,
    /// Content of dimensions, callouts, notes and tables.
    pub annotations: Vec<Annotation>,
    /// The area of the title block.
    pub title_block: Extent,
    /// Number of the first group after those of frame and title block.
    pub first_group: usize,
}

impl Sheet {
    /// Formats a scale as `2:1` (ISO 5455).
    #[must_use]
    pub fn scale_text(scale: f64) -> String {
        if scale >= 1.0 { format!("{scale}:1") } else { format!("1:{}", (1.0 / scale * 10.0).round() / 10.0) }
    }
}
