//! Engraved labels: letters as pockets, laid along an arc or a line, where they do not matter.

use i_overlay::mesh::float::stroke::offset::StrokeOffset;
use i_overlay::mesh::float::style::{LineCap, LineJoin, StrokeStyle};

use pinswitch_friction::sort_by_number;

use super::left_out::LeftOut;
use super::stroke_font::{HEIGHT, WIDTH, strokes};
use crate::design::Design;
use pinswitch_solid::profile::{Contour, Point2, Vector2, polar};
use pinswitch_solid::solid::{RingId, Solid};

/// Angle between the points of a round stroke end, radians.
const ROUND_RAD: f64 = 0.5;
/// Letters smaller than this are not legible in a print, mm.
const MIN_HEIGHT_MM: f64 = 1.5;
/// Steps in which smaller letters are tried, mm.
const STEP_MM: f64 = 0.1;
/// Wall between a letter and the edge of its zone, mm.
pub(super) const EDGE_MM: f64 = 0.5;
/// Width of a letter over its height.
const ASPECT: f64 = 0.58;
/// Heights closer than this are one, mm.
pub(super) const SAME_MM: f64 = 1e-9;
/// Points of a letter's outline that are closer than this are one point, mm.
const MERGE_MM: f64 = 0.02;

/// A flat place on a part where a label may go.
#[derive(Clone, Copy, Debug)]
pub(super) enum Zone {
    /// Between two radii and two angles about the axis.
    Arc { inner_mm: f64, outer_mm: f64, from_rad: f64, to_rad: f64 },
    /// A rectangle about a middle.
    Flat { middle: Point2, length_mm: f64, height_mm: f64 },
}

/// The result of an engraving: the rings at the top, which are holes in the cap there.
pub(super) struct Engraving {
    pub(super) rings: Vec<RingId>,
    /// What found no room.
    pub(super) left_out: Vec<LeftOut>,
    /// What was engraved, line by line.
    pub(super) lines: Vec<String>,
}

impl Engraving {
    /// Nothing, and what of it found no room.
    pub(super) const fn none(left_out: Vec<LeftOut>) -> Self {
        Self { rings: Vec::new(), left_out, lines: Vec::new() }
    }
}

/// A text as it can be laid out: the height of its letters in mm, and its pieces with their zones.
struct Laid {
    size_mm: f64,
    pieces: Vec<(String, Zone)>,
}

impl Zone {
    pub(super) fn flat(middle: Point2, length_mm: f64, height_mm: f64) -> Self {
        Self::Flat { middle, length_mm, height_mm }
    }

    /// The stretches of a band between two radii into which no fastener that takes `fastener_mm`, and no dowel reaches; from
    /// left to right.
    pub(super) fn between_holes(
        design: &Design,
        fastener_mm: f64,
        inner_mm: f64,
        outer_mm: f64,
    ) -> Vec<Self> {
        let (middle, half) = (design.fastener_radius_mm(), design.half_span_rad());
        // The widest that a round hole is within the band: where a line from the axis touches it, or at the band's edge.
        let taken = |angles: Vec<f64>, reach_mm: f64| {
            let at =
                (middle.powi(2) - reach_mm.powi(2)).max(0.0).sqrt().clamp(inner_mm, outer_mm.max(inner_mm));
            let cosine = (at.powi(2) + middle.powi(2) - reach_mm.powi(2)) / (2.0 * at * middle);
            let beside = libm::acos(cosine.clamp(-1.0, 1.0));
            angles.into_iter().filter(move |_| cosine < 1.0).map(move |a| (a - beside, a + beside))
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

    /// The widest of several zones; of equals the first, whatever the rounding.
    pub(super) fn widest(zones: &[Self]) -> Option<Self> {
        let wide = |zone: &Self| match *zone {
            Self::Flat { length_mm, .. } => length_mm,
            Self::Arc { from_rad, to_rad, .. } => to_rad - from_rad,
        };
        zones.iter().copied().reduce(|best, zone| if wide(&zone) > wide(&best) + 1e-9 { zone } else { best })
    }

    /// The zone mirrored in the y axis.
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

    /// Length along the feet of letters of `letter_mm`, and height across them, in mm.
    fn size_mm(&self, letter_mm: f64) -> (f64, f64) {
        match *self {
            Self::Flat { length_mm, height_mm, .. } => (length_mm, height_mm),
            // Letters lean apart: their inner edges are the closest.
            Self::Arc { inner_mm, outer_mm, from_rad, to_rad } => {
                let foot =
                    f64::midpoint(inner_mm, outer_mm) - (letter_mm / 2.0).min((outer_mm - inner_mm) / 2.0);
                ((to_rad - from_rad) * foot, outer_mm - inner_mm)
            }
        }
    }

    /// Radius of the letters' feet, mm: letters lean apart, so that there they are closest.
    fn foot_mm(&self, letter_mm: f64) -> f64 {
        match *self {
            Self::Flat { .. } => f64::INFINITY,
            Self::Arc { inner_mm, outer_mm, .. } => {
                f64::midpoint(inner_mm, outer_mm) - (letter_mm / 2.0).min((outer_mm - inner_mm) / 2.0)
            }
        }
    }

    /// Brings a point of a letter (`x` and `y` from its middle) onto the part; the letter's foot lies `along_mm` along
    /// the line from its middle.
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

/// Engraves the design's label into the face at `top_mm`, into the first of several choices of zones that holds it.
pub(super) fn engrave(solid: &mut Solid, design: &Design, choices: &[Vec<Zone>], top_mm: f64) -> Engraving {
    if !design.configuration().label.engrave {
        return Engraving::none(Vec::new());
    }
    let text = design.label();
    let Some(Laid { size_mm, pieces }) = laid(design, &text, choices, top_mm) else {
        return Engraving::none(vec![LeftOut::Label]);
    };
    let cut = |(piece, zone): &(String, Zone)| pockets(solid, design, piece, zone, size_mm, top_mm);
    Engraving { rings: pieces.iter().flat_map(cut).collect(), left_out: Vec::new(), lines: vec![text] }
}

/// Whether [`engrave`] leaves the label out.
pub(super) fn is_left_out(design: &Design, choices: &[Vec<Zone>], top_mm: f64) -> bool {
    design.configuration().label.engrave && laid(design, &design.label(), choices, top_mm).is_none()
}

/// `text` in the widest zone of the first choice that holds it, or else broken from one zone to the next.
fn laid(design: &Design, text: &str, choices: &[Vec<Zone>], top_mm: f64) -> Option<Laid> {
    let c = design.configuration();
    // A floor that prints must stay under the letters.
    if top_mm - c.label.depth_mm < c.print.least_wall_mm {
        return None;
    }
    choices.iter().find_map(|zones| {
        let whole = Zone::widest(zones).and_then(|zone| {
            let size_mm = largest_mm(design, text, &zone)?;
            Some(Laid { size_mm, pieces: vec![(text.to_owned(), zone)] })
        });
        let parted = |size_mm| Some(Laid { size_mm, pieces: broken(design, text, zones, size_mm)? });
        whole.or_else(|| sizes_mm(design).find_map(parted))
    })
}

/// `text` broken between letters so that each piece fits its zone in letters of `size_mm`: it runs on behind a hole. The
/// pieces in their order, as full as the zones allow.
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

/// Sizes of letters that are tried, the configured one first, the least that is legible last.
pub(super) fn sizes_mm(design: &Design) -> impl Iterator<Item = f64> + use<> {
    let (height, least) = (design.configuration().label.height_mm, least_height_mm(design));
    let steps = ((height - least) / STEP_MM + SAME_MM).floor();
    std::iter::successors(Some(0.0), move |step: &f64| (*step < steps).then_some(step + 1.0))
        .map(move |step| height - step * STEP_MM)
        .filter(move |size| *size >= least - SAME_MM)
        .chain((height >= least - SAME_MM).then_some(least))
}

/// Engraves `text` into one zone as large as configured, or smaller; the rings of nothing where it does not fit.
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
    laid(design, text, &[vec![*zone]], top_mm)
        .map(|l| pockets(solid, design, text, zone, l.size_mm, top_mm))
        .unwrap_or_default()
}

/// The letters of `text` as pockets in the face at `top_mm`; their rings are holes in the cap there.
fn pockets(
    solid: &mut Solid,
    design: &Design,
    text: &str,
    zone: &Zone,
    size_mm: f64,
    top_mm: f64,
) -> Vec<RingId> {
    let floor_mm = top_mm - design.configuration().label.depth_mm;
    shapes(design, text, zone, size_mm)
        .into_iter()
        .map(|(outline, islands)| solid.pocket(&outline, &islands, floor_mm, top_mm))
        .collect()
}

/// Engraves `text` in letters of `size_mm` into the face on the bed, to be read from below; its rings are holes in the
/// cap there.
pub(super) fn engrave_below(
    solid: &mut Solid,
    design: &Design,
    text: &str,
    zone: &Zone,
    size_mm: f64,
) -> Vec<RingId> {
    let ceiling = design.configuration().label.depth_mm;
    shapes(design, text, &zone.mirrored(), size_mm)
        .into_iter()
        .map(|(outline, islands)| {
            let islands: Vec<_> = islands.iter().map(Contour::mirrored).collect();
            solid.recess(&outline.mirrored(), &islands, 0.0, ceiling)
        })
        .collect()
}

/// Least height of letters whose strokes leave walls between them, mm.
pub(super) fn least_height_mm(design: &Design) -> f64 {
    let c = design.configuration();
    ((c.label.stroke_mm + c.print.least_wall_mm) * HEIGHT / 2.0).max(MIN_HEIGHT_MM)
}

/// The largest letters, up to the configured height, in which `text` fits the zone; `None` if it does not.
pub(super) fn largest_mm(design: &Design, text: &str, zone: &Zone) -> Option<f64> {
    let c = design.configuration();
    let stroke = c.label.stroke_mm;
    let (length, height) = zone.size_mm(c.label.height_mm + stroke);
    let letters = text.chars().count() as f64;
    // Strokes of a letter are two grid units apart, letters four and a gap: both must leave a wall between strokes.
    let gap = stroke + c.print.least_wall_mm;
    let by_length = ((length - 2.0 * EDGE_MM + gap - stroke) / letters - gap) / ASPECT;
    let size = c.label.height_mm.min(height - 2.0 * EDGE_MM - stroke).min(by_length);
    (size >= least_height_mm(design) - SAME_MM).then_some(size)
}

/// The letters of `text` in a zone: outlines, clockwise, each with its islands, counter-clockwise.
fn shapes(design: &Design, text: &str, zone: &Zone, size_mm: f64) -> Vec<(Contour, Vec<Contour>)> {
    let c = design.configuration();
    let stroke = c.label.stroke_mm;
    let letters = text.chars().count() as f64;
    let advance = size_mm * ASPECT + stroke + c.print.least_wall_mm;
    let mut all = Vec::new();
    for (i, letter) in text.chars().enumerate() {
        let middle = (i as f64 - (letters - 1.0) / 2.0) * advance;
        for shape in letter_shapes(letter, size_mm, stroke) {
            let mut contours = shape.iter().map(|points| {
                Contour::polygon(points.iter().map(|p| zone.place(middle, size_mm + stroke, *p)).collect())
            });
            let Some(outline) = contours.next().map(|c| oriented(c, Orientation::Clockwise)) else {
                continue;
            };
            all.push((outline, contours.map(|c| oriented(c, Orientation::CounterClockwise)).collect()));
        }
    }
    all
}

/// The outlines of a letter's strokes, united: each shape is its outline, then its islands, in mm about the letter's
/// middle.
fn letter_shapes(letter: char, height_mm: f64, stroke_mm: f64) -> Vec<Vec<Vec<[f64; 2]>>> {
    let (along, up) = (height_mm * ASPECT / WIDTH, height_mm / HEIGHT);
    let paths: Vec<Vec<[f64; 2]>> = strokes(letter)
        .unwrap_or_default()
        .iter()
        .map(|run| run.iter().map(|[x, y]| [(x - WIDTH / 2.0) * along, (y - HEIGHT / 2.0) * up]).collect())
        .collect();
    let style = StrokeStyle::new(stroke_mm)
        .line_join(LineJoin::Round(ROUND_RAD))
        .start_cap(LineCap::Round(ROUND_RAD))
        .end_cap(LineCap::Round(ROUND_RAD));
    let shapes: Vec<Vec<Vec<[f64; 2]>>> = paths.stroke(style, false);
    shapes.into_iter().map(|shape| shape.into_iter().map(|c| without_near_duplicates(&c)).collect()).collect()
}

/// Orientation of a contour.
#[derive(Clone, Copy, PartialEq)]
enum Orientation {
    Clockwise,
    CounterClockwise,
}

/// The contour in the given orientation: a pocket is a hole in the part, its islands are outlines.
fn oriented(contour: Contour, sense: Orientation) -> Contour {
    let is = if contour.area_mm2() > 0.0 { Orientation::CounterClockwise } else { Orientation::Clockwise };
    if is == sense { contour } else { contour.reversed() }
}

/// Drops points that nearly coincide with their neighbour.
fn without_near_duplicates(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let near = |a: [f64; 2], b: [f64; 2]| libm::hypot(a[0] - b[0], a[1] - b[1]) < MERGE_MM;
    let mut kept: Vec<[f64; 2]> = Vec::with_capacity(points.len());
    for p in points {
        if kept.last().is_none_or(|last| !near(*last, *p)) {
            kept.push(*p);
        }
    }
    while kept.len() > 3 && near(kept[0], kept[kept.len() - 1]) {
        kept.pop();
    }
    kept
}
#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Configuration;
    use pinswitch_solid::solid::Facing;
    use pinswitch_solid::validity::{Expectation, examine};

    #[test]
    fn no_letter_has_a_part_inside_its_island() {
        for letter in (' '..='~').filter(|l| strokes(*l).is_some()) {
            let shapes = letter_shapes(letter, 3.0, 0.5);
            let area = |points: &Vec<[f64; 2]>| {
                Contour::polygon(points.iter().map(|[x, y]| Point2::new(*x, *y)).collect()).area_mm2().abs()
            };
            for shape in &shapes {
                assert!(shape.iter().skip(1).all(|island| area(island) < area(&shape[0])), "{letter}");
            }
            // Only the colon and the equals sign have two parts; an island with a part in it would make two.
            assert!(shapes.len() <= 1 || ":=".contains(letter), "{letter}: {}", shapes.len());
        }
    }
    #[test]
    fn a_text_is_broken_between_letters_in_the_order_of_its_zones() {
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
    fn every_letter_leaves_walls_that_print() {
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
            let found = examine(&solid.mesh(design.tolerance()).unwrap(), &printable);
            assert!(found.is_valid(), "{letter}: {:?}", found.faults);
        }
    }
}
