//! What lies on a sheet of paper.

use super::font::{CAPITAL_PER_EM, DESCENT_PER_EM};
use super::geometry::{Extent, Point};
use super::text_width_mm;

/// A size of paper, on its side.
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

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::A4 => "A4",
            Self::A3 => "A3",
        }
    }

    /// What is inside the frame: 20 mm from the left edge, where the sheet is filed, 10 mm from the others (ISO 5457).
    #[must_use]
    pub const fn frame(self) -> Extent {
        let (width, height) = self.size_mm();
        Extent { low: Point::new(20.0, 10.0), high: Point::new(width - 10.0, height - 10.0) }
    }
}

/// What a line is for: decides width and dashes (ISO 128).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Edges that are seen.
    Visible,
    /// Edges that are not.
    Hidden,
    /// Axes, planes of symmetry, pitch circles.
    Centre,
    /// Dimension lines, extension lines, leaders.
    Dimension,
    /// Cut faces.
    Hatch,
    /// What is near the part and does not belong to it.
    Phantom,
    /// Thin outlines: engraved letters, limits of details, tables.
    Thin,
    /// The plane of a section, and the frame.
    Frame,
    /// Letters.
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

    /// Its name in files.
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

    /// Width of its lines, mm.
    #[must_use]
    pub const fn width_mm(self) -> f64 {
        match self {
            Self::Visible | Self::Frame => 0.5,
            Self::Hatch => 0.18,
            _ => 0.25,
        }
    }

    /// Lengths of dashes and gaps in turn, mm; empty for a continuous line.
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
    /// Left end of the line that its letters stand on.
    pub at: Point,
    /// Height of its capitals, mm.
    pub height_mm: f64,
    /// What it says.
    pub content: String,
    /// Whether it runs upward, to be read from the right.
    pub upright: bool,
}

impl Text {
    /// Width on paper, along its line, mm.
    #[must_use]
    pub fn width_mm(&self) -> f64 {
        text_width_mm(&self.content, self.height_mm)
    }

    /// The box around its letters.
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

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A straight line.
    Line {
        /// Its first end.
        from: Point,
        /// Its last end.
        to: Point,
    },
    /// An arc, counter-clockwise where the sweep is positive.
    Arc {
        /// Centre of its circle.
        centre: Point,
        /// Radius, mm.
        radius_mm: f64,
        /// Angle of its first end from +x.
        start_rad: f64,
        /// Signed angle to its last end.
        sweep_rad: f64,
    },
    /// A whole circle.
    Circle {
        /// Its centre.
        centre: Point,
        /// Radius, mm.
        radius_mm: f64,
    },
    /// A filled arrow head.
    Arrow {
        /// Its point.
        tip: Point,
        /// Where it points: a unit vector.
        direction: Point,
    },
    /// A text.
    Text(Text),
}

/// Length of an arrow head, mm.
pub(super) const ARROW_MM: f64 = 2.5;
/// Half of its width, mm.
pub(super) const ARROW_HALF_MM: f64 = 0.42;

impl Shape {
    /// The curve as straight pieces that leave it by no more than some hundredths of a millimetre; none for texts.
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

    /// The three corners of an arrow head.
    pub(super) fn arrow_corners(tip: Point, direction: Point) -> [Point; 3] {
        let (foot, side) = (tip - direction * ARROW_MM, direction.left() * ARROW_HALF_MM);
        [tip, foot + side, foot - side]
    }
}

fn chords(centre: Point, radius_mm: f64, start_rad: f64, sweep_rad: f64) -> Vec<[Point; 2]> {
    // A chord of angle a leaves its arc by r a²/8.
    let step = (8.0 * 0.03 / radius_mm.max(1e-6)).sqrt().min(0.6);
    let number = ((sweep_rad.abs() / step).ceil().max(1.0)) as u32;
    let at = |i: u32| {
        centre + Point::towards(start_rad + sweep_rad * f64::from(i) / f64::from(number)) * radius_mm
    };
    (0..number).map(|i| [at(i), at(i + 1)]).collect()
}

/// Something drawn, with what it belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct Entity {
    /// Its line style.
    pub layer: Layer,
    /// What is drawn.
    pub shape: Shape,
    /// The view whose geometry it is; `None` for what is written about it.
    pub view: Option<usize>,
    /// The annotation that it is part of: a text may touch the lines of its own.
    pub group: usize,
}

/// One view of a part: where the part's origin lies on paper, and how much larger it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Its name in files, unique on its sheet, such as `FRONT`.
    pub name: String,
    /// Where the part's own origin lies on paper.
    pub origin: Point,
    /// Millimetres on paper for a millimetre of the part.
    pub scale: f64,
}

/// A dimension or a note: what it is of, and what it says.
#[derive(Clone, Debug, PartialEq)]
pub struct Annotation {
    /// Its entities.
    pub group: usize,
    /// What it dimensions, such as `groove pitch`.
    pub key: String,
    /// Its lines of text, joined by line feeds.
    pub text: String,
}

/// One sheet of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Name of what it shows: a part, or the assembly.
    pub name: String,
    /// Its size.
    pub paper: Paper,
    /// The scale of its main views.
    pub scale: f64,
    /// Its views.
    pub views: Vec<View>,
    /// All that is drawn.
    pub entities: Vec<Entity>,
    /// What is dimensioned and noted.
    pub annotations: Vec<Annotation>,
    /// Where nothing but the title block may lie.
    pub title_block: Extent,
    /// The first group of entities that do not belong to frame and title block.
    pub first_group: usize,
}

impl Sheet {
    /// A scale in the form of ISO 5455, such as `2:1`.
    #[must_use]
    pub fn scale_text(scale: f64) -> String {
        if scale >= 1.0 { format!("{scale}:1") } else { format!("1:{}", (1.0 / scale * 10.0).round() / 10.0) }
    }
}
