//! Engraved labels: letters as pockets along an arc or a line.

use pinswitch_friction::sort_by_number;

use super::letter_shape::{ASPECT, letter_shapes};
use super::omission::LeftOut;
use super::stroke_font::HEIGHT;
use crate::design::Design;
use pinswitch_solid::profile::{Contour, Point2, Vector2, polar};
use pinswitch_solid::solid::{RingId, Solid};

/// Least height of letters that are legible in a print, mm.
const MIN_HEIGHT_MM: f64 = 1.5;
/// Step between heights of letters that are tried, mm.
const STEP_MM: f64 = 0.1;
/// Wall between a letter and the edge of its zone, mm.
pub(super) const EDGE_MM: f64 = 0.5;
/// Distance of the frame of a letter from it, as a share of the wall between letters: frames leave half of the wall.
const FRAME_SHARE: f64 = 0.25;
/// Heights that differ by less are equal, mm.
pub(super) const SAME_MM: f64 = 1e-9;

/// A flat area for a label.
#[derive(Clone, Copy, Debug)]
pub(super) enum Zone {
    /// Between two radii and two angles about the axis.
    Arc { inner_mm: f64, outer_mm: f64, from_rad: f64, to_rad: f64 },
    /// A rectangle.
    Flat { middle: Point2, length_mm: f64, height_mm: f64 },
}

/// The result of an engraving.
pub(super) struct Engraving {
    /// Rings at the top, which are holes in the cap.
    pub(super) rings: Vec<RingId>,
    /// Features that do not fit.
    pub(super) left_out: Vec<LeftOut>,
    /// Engraved lines.
    pub(super) lines: Vec<String>,
}

impl Engraving {
    /// Nothing engraved.
    pub(super) const fn none(left_out: Vec<LeftOut>) -> Self {
        Self { rings: Vec::new(), left_out, lines: Vec::new() }
    }
}

/// The layout of a text: the height of its letters in mm, and its pieces with their zones.
struct TextLayout {
    size_mm: f64,
    pieces: Vec<(String, Zone)>,
}

impl Zone {
    pub(super) fn flat(middle: Point2, length_mm: f64, height_mm: f64) -> Self {
        Self::Flat { middle, length_mm, height_mm }
    }

    /// Returns the zones of a band between two radii, from left to right, without the dowels, and the fasteners with a radius of
    /// `fastener_mm`.
    pub(super) fn between_holes(
        design: &Design,
        fastener_mm: f64,
        inner_mm: f64,
        outer_mm: f64,
    ) -> Vec<Self> {
        let (middle, half) = (design.fastener_radius_mm(), design.half_span_rad());
        // Greatest width of a hole within the band: at a tangent from the axis, or at the edge of the band.
        let taken = |angles: Vec<f64>, reach_mm: f64| {
            let at =
                (middle.powi(2) - reach_mm.powi(2)).max(0.0).sqrt().clamp(inner_mm, outer_mm.max(inner_mm));
            let cosine = (at.powi(2) + middle.powi(2) - reach_mm.powi(2)) / (2.0 * at * middle);
            let half = libm::acos(cosine.clamp(-1.0, 1.0));
            angles.into_iter().filter(move |_| cosine < 1.0).map(move |a| (a - half, a + half))
        };
        let dowel = design.dowel_hole_radius_mm().unwrap_or(0.0);
        let mut holes: Vec<(f64, f64)> = taken(design.fastener_angles_rad(), fastener_mm)
            .chain(taken(design.dowel_angles_rad(), dowel))
            .collect();
        sort_by_number(&mut holes, |(from_rad, _)| *from_rad);
        let from = std::iter::once(-half).chain(holes.iter().map(|h| h.1));
        let to = holes.iter().map(|h| h.0).chain([half]);
        from.zip(to)
            .filter(|(from_rad, to_rad)| to_rad > from_rad)
            .map(|(from_rad, to_rad)| Self::Arc { inner_mm, outer_mm, from_rad, to_rad })
            .collect()
    }

    /// Returns the widest zone; the first of equal ones, within rounding.
    pub(super) fn widest(zones: &[Self]) -> Option<Self> {
        let wide = |zone: &Self| match *zone {
            Self::Flat { length_mm, .. } => length_mm,
            Self::Arc { from_rad, to_rad, .. } => to_rad - from_rad,
        };
        zones.iter().copied().reduce(|best, zone| if wide(&zone) > wide(&best) + 1e-9 { zone } else { best })
    }

    /// The mirror image in the y axis.
    fn mirrored(&self) -> Self {
        match *self {
            Self::Flat { middle, length_mm, height_mm } => {
                Self::Flat { middle: Point2::new(-middle.x, middle.y), length_mm, height_mm }
            }
            Self::Arc { inner_mm, outer_mm, from_rad, to_rad } => {
                Self::Arc { inner_mm, outer_mm, from_rad: -to_rad, to_rad: -from_rad }
            }
        }
    }

    /// Length at the feet of letters of `letter_mm`, and height of the zone, mm.
    fn size_mm(&self, letter_mm: f64) -> (f64, f64) {
        match *self {
            Self::Flat { length_mm, height_mm, .. } => (length_mm, height_mm),
            // Letters fan out: their feet are closest.
            Self::Arc { inner_mm, outer_mm, from_rad, to_rad } => {
                let foot =
                    f64::midpoint(inner_mm, outer_mm) - (letter_mm / 2.0).min((outer_mm - inner_mm) / 2.0);
                ((to_rad - from_rad) * foot, outer_mm - inner_mm)
            }
        }
    }

    /// Radius of the feet of the letters, mm, where they are closest.
    fn foot_mm(&self, letter_mm: f64) -> f64 {
        match *self {
            Self::Flat { .. } => f64::INFINITY,
            Self::Arc { inner_mm, outer_mm, .. } => {
                f64::midpoint(inner_mm, outer_mm) - (letter_mm / 2.0).min((outer_mm - inner_mm) / 2.0)
            }
        }
    }

    /// Maps a point of a letter, from its centre, to the part. The foot of the letter is `along_mm` along the line from its
    /// middle.
    fn place(&self, along_mm: f64, letter_mm: f64, [x, y]: [f64; 2]) -> Point2 {
        match *self {
            Self::Flat { middle, .. } => middle + Vector2::new(along_mm + x, y),
            Self::Arc { inner_mm, outer_mm, from_rad, to_rad } => {
                let radius = f64::midpoint(inner_mm, outer_mm);
                let angle = f64::midpoint(from_rad, to_rad) + along_mm / self.foot_mm(letter_mm);
                let up = polar(1.0, angle).coords;
                let right = Vector2::new(up.y, -up.x);
                Point2::from(up * (radius + y) + right * x)
            }
        }
    }
}

/// Engraves the label of the design into the face at `top_mm`, in the first choice of zones into which it fits.
pub(super) fn engrave(solid: &mut Solid, design: &Design, choices: &[Vec<Zone>], top_mm: f64) -> Engraving {
    if !design.configuration().label.engrave {
        return Engraving::none(Vec::new());
    }
    let text = design.label();
    let Some(TextLayout { size_mm, pieces }) = layout(design, &text, choices, top_mm) else {
        return Engraving::none(vec![LeftOut::Label]);
    };
    let cut = |(piece, zone): &(String, Zone)| pockets(solid, design, piece, zone, size_mm, top_mm);
    Engraving { rings: pieces.iter().flat_map(cut).collect(), left_out: Vec::new(), lines: vec![text] }
}

/// Returns whether [`engrave`] leaves the label out.
pub(super) fn is_left_out(design: &Design, choices: &[Vec<Zone>], top_mm: f64) -> bool {
    design.configuration().label.engrave && layout(design, &design.label(), choices, top_mm).is_none()
}

/// Lays out a text in the widest zone of the first choice into which it fits, or else in several zones.
fn layout(design: &Design, text: &str, choices: &[Vec<Zone>], top_mm: f64) -> Option<TextLayout> {
    let c = design.configuration();
    // The floor under the letters must be printable.
    if top_mm - c.label.depth_mm < c.print.least_wall_mm {
        return None;
    }
    choices.iter().find_map(|zones| {
        let whole = Zone::widest(zones).and_then(|zone| {
            let size_mm = largest_mm(design, text, &zone)?;
            Some(TextLayout { size_mm, pieces: vec![(text.to_owned(), zone)] })
        });
        let parted = |size_mm| Some(TextLayout { size_mm, pieces: broken(design, text, zones, size_mm)? });
        whole.or_else(|| sizes_mm(design).find_map(parted))
    })
}

/// Breaks a text between letters into pieces that fit the zones in letters of `size_mm`, each as long as possible. A text
/// continues on the other side of a hole.
pub(super) fn broken(
    design: &Design,
    text: &str,
    zones: &[Zone],
    size_mm: f64,
) -> Option<Vec<(String, Zone)>> {
    let mut rest: Vec<char> = text.chars().collect();
    let mut pieces = Vec::new();
    for zone in zones {
        let fits = |n: &usize| {
            let piece: String = rest[..*n].iter().collect();
            largest_mm(design, &piece, zone).is_some_and(|largest| largest >= size_mm - SAME_MM)
        };
        if let Some(n) = (1..=rest.len()).rev().find(fits) {
            pieces.push((rest.drain(..n).collect(), *zone));
        }
    }
    rest.is_empty().then_some(pieces)
}

/// Sizes of letters to try, from the configured one to the least legible one.
pub(super) fn sizes_mm(design: &Design) -> impl Iterator<Item = f64> + use<> {
    let (height, least) = (design.configuration().label.height_mm, least_height_mm(design));
    let steps = ((height - least) / STEP_MM + SAME_MM).floor();
    std::iter::successors(Some(0.0), move |step: &f64| (*step < steps).then_some(step + 1.0))
        .map(move |step| height - step * STEP_MM)
        .filter(move |size| *size >= least - SAME_MM)
        .chain((height >= least - SAME_MM).then_some(least))
}

/// Engraves a text into one zone, at most as large as configured; returns its rings, and none if it does not fit.
pub(super) fn engrave_text(
    solid: &mut Solid,
    design: &Design,
    text: &str,
    zone: &Zone,
    top_mm: f64,
) -> Vec<RingId> {
    if !design.configuration().label.engrave {
        return Vec::new();
    }
    layout(design, text, &[vec![*zone]], top_mm)
        .map(|l| pockets(solid, design, text, zone, l.size_mm, top_mm))
        .unwrap_or_default()
}

/// Adds letters as pockets in the face at `top_mm`; returns their rings, which are holes in the cap.
fn pockets(
    solid: &mut Solid,
    design: &Design,
    text: &str,
    zone: &Zone,
    size_mm: f64,
    top_mm: f64,
) -> Vec<RingId> {
    let floor_mm = top_mm - design.configuration().label.depth_mm;
    let cut = |Letter { shapes, frame }: Letter| {
        let pocket = |(outline, islands): &Shape| solid.pocket(outline, islands, floor_mm, top_mm);
        let rings: Vec<RingId> = shapes.iter().map(pocket).collect();
        solid.frame(frame, &rings);
        rings
    };
    letters(design, text, zone, size_mm).flat_map(cut).collect()
}

/// Engraves a text into the face on the bed, to read from below; returns its rings, which are holes in the cap.
pub(super) fn engrave_below(
    solid: &mut Solid,
    design: &Design,
    text: &str,
    zone: &Zone,
    size_mm: f64,
) -> Vec<RingId> {
    let ceiling = design.configuration().label.depth_mm;
    let cut = |Letter { shapes, frame }: Letter| {
        let recess = |(outline, islands): &Shape| {
            let islands: Vec<_> = islands.iter().map(Contour::mirrored).collect();
            solid.recess(&outline.mirrored(), &islands, 0.0, ceiling)
        };
        let rings: Vec<RingId> = shapes.iter().map(recess).collect();
        solid.frame(frame.mirrored(), &rings);
        rings
    };
    letters(design, text, &zone.mirrored(), size_mm).flat_map(cut).collect()
}

/// Least height of letters with printable walls between their strokes, mm.
pub(super) fn least_height_mm(design: &Design) -> f64 {
    let c = design.configuration();
    ((c.label.stroke_mm + c.print.least_wall_mm) * HEIGHT / 2.0).max(MIN_HEIGHT_MM)
}

/// Returns the largest height of letters, up to the configured one, at which a text fits the zone.
pub(super) fn largest_mm(design: &Design, text: &str, zone: &Zone) -> Option<f64> {
    let c = design.configuration();
    let stroke = c.label.stroke_mm;
    let (length, height) = zone.size_mm(c.label.height_mm + stroke);
    let letters = text.chars().count() as f64;
    // Strokes of a letter are two grid units apart, letters four and a gap. Both leave a wall between strokes.
    let gap = stroke + c.print.least_wall_mm;
    let by_length = ((length - 2.0 * EDGE_MM + gap - stroke) / letters - gap) / ASPECT;
    let size = c.label.height_mm.min(height - 2.0 * EDGE_MM - stroke).min(by_length);
    (size >= least_height_mm(design) - SAME_MM).then_some(size)
}

/// Outline of a pocket, clockwise, and its islands, counter-clockwise.
type Shape = (Contour, Vec<Contour>);

/// A letter in its place.
struct Letter {
    shapes: Vec<Shape>,
    /// A rectangle around it, apart from those of its neighbours.
    frame: Contour,
}

/// The letters of a text in a zone.
fn letters(design: &Design, text: &str, zone: &Zone, size_mm: f64) -> impl Iterator<Item = Letter> {
    let c = design.configuration();
    let (stroke_mm, wall_mm) = (c.label.stroke_mm, c.print.least_wall_mm);
    let count = text.chars().count() as f64;
    let advance = size_mm * ASPECT + stroke_mm + wall_mm;
    let around = wall_mm * FRAME_SHARE + 0.5 * stroke_mm;
    let half = [0.5 * size_mm * ASPECT + around, 0.5 * size_mm + around];
    text.chars().enumerate().map(move |(i, letter)| {
        let middle = (i as f64 - (count - 1.0) / 2.0) * advance;
        let placed = |points: &[[f64; 2]]| {
            Contour::polygon(points.iter().map(|p| zone.place(middle, size_mm + stroke_mm, *p)).collect())
        };
        let shape = |contours: &Vec<Vec<[f64; 2]>>| {
            let (outline, islands) = contours.split_first()?;
            let islands = islands.iter().map(|c| oriented(placed(c), Orientation::CounterClockwise));
            Some((oriented(placed(outline), Orientation::Clockwise), islands.collect()))
        };
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        Letter {
            shapes: letter_shapes(letter, size_mm, stroke_mm).iter().filter_map(shape).collect(),
            frame: placed(&corners.map(|[x, y]| [x * half[0], y * half[1]])),
        }
    })
}

/// Orientation of a contour.
#[derive(Clone, Copy, PartialEq)]
enum Orientation {
    Clockwise,
    CounterClockwise,
}

/// The contour in an orientation: a pocket is a hole in the part, its islands are outlines.
fn oriented(contour: Contour, sense: Orientation) -> Contour {
    let is = if contour.area_mm2() > 0.0 { Orientation::CounterClockwise } else { Orientation::Clockwise };
    if is == sense { contour } else { contour.reversed() }
}

#[cfg(test)]
mod tests {
    use super::super::stroke_font::strokes;
    use super::*;
    use crate::config::Configuration;
    use pinswitch_solid::solid::Facing;
    use pinswitch_solid::validity::{Expectation, examine};

    #[test]
    fn texts_break_between_letters() {
        let design = Design::new(Configuration::default()).unwrap();
        let c = design.configuration();
        let gap = c.label.stroke_mm + c.print.least_wall_mm;
        let long = |letters: f64| {
            letters * (c.label.height_mm * ASPECT + gap) - gap + c.label.stroke_mm + 2.0 * EDGE_MM + 0.01
        };
        let zones = [long(3.0), 1.0, long(2.0)].map(|wide| Zone::flat(Point2::origin(), wide, 8.0));
        let broken = |text: &str| {
            let pieces = broken(&design, text, &zones, c.label.height_mm)?;
            Some(pieces.into_iter().map(|(piece, _)| piece).collect::<Vec<_>>())
        };
        assert_eq!(broken("3x3/5").unwrap(), ["3x3", "/5"][..]);
        assert_eq!(broken("3x3").unwrap(), ["3x3"]);
        assert_eq!(broken("3x3/5 and more"), None);
        let sizes: Vec<f64> = sizes_mm(&design).collect();
        assert!(sizes.windows(2).all(|w| w[0] >= w[1]) && sizes[0] == design.configuration().label.height_mm);
    }

    #[test]
    fn letters_leave_printable_walls() {
        let design = Design::new(Configuration::default()).unwrap();
        let outline = Contour::polygon(
            [(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)].map(|(x, y)| Point2::new(x, y)).to_vec(),
        );
        for letter in ('!'..='~').filter(|l| strokes(*l).is_some()) {
            let mut solid = Solid::new();
            let (bottom, top) = solid.extrude(&outline, 0.0, 2.0);
            solid.cap(Facing::Down, bottom, &[]);
            let zone = Zone::flat(Point2::new(4.0, 4.0), 8.0, 8.0);
            let engraved = engrave_text(&mut solid, &design, &letter.to_string(), &zone, 2.0);
            assert!(!engraved.is_empty());
            solid.cap(Facing::Up, top, &engraved);
            let printable = Expectation { bodies: Some(1), min_wall_mm: 0.4, ..Expectation::default() };
            let report = examine(&solid.mesh(design.tolerance()).unwrap(), &printable);
            assert!(report.is_flawless(), "{letter}: {:?}", report.faults);
        }
    }
}
