//! Indicators of geometrical tolerances (ISO 1101) and of datums (ISO 5459).

use super::annotation::TEXT_MM;
use super::draft::{Candidate, Draft};
use super::font::text_width_mm;
use super::geometry::{Extent, Point};
use super::sheet::{Layer, Shape, Text};

/// Height of an indicator and of the box of a datum, mm: twice the height of its text.
pub(super) const INDICATOR_MM: f64 = 5.0;
/// Space left and right of the text of a cell, mm.
const MARGIN_MM: f64 = 1.0;
/// Height of the triangle of a datum, and half of its base, mm.
const TRIANGLE_MM: (f64, f64) = (2.2, 1.3);
/// Lengths of the stem of a datum that are tried, mm.
const STEMS_MM: [f64; 8] = [4.0, 6.0, 8.0, 11.0, 14.0, 18.0, 23.0, 29.0];

/// Indicator of a position tolerance: width of the zone, and datums.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Indicator {
    /// Width of the zone in mm, such as `0.1`, or its diameter, such as `⌀0.2`.
    pub zone: String,
    /// Letters of the datums, in their order.
    pub datums: Vec<char>,
}

/// Returns the lines of a rectangle.
pub(super) fn rectangle(extent: Extent) -> impl Iterator<Item = (Layer, Shape)> {
    let (low, high) = (extent.low, extent.high);
    let corners = [low, Point::new(high.x, low.y), high, Point::new(low.x, high.y)];
    (0..4).map(move |i| (Layer::Dimension, Shape::Line { from: corners[i], to: corners[(i + 1) % 4] }))
}

fn text(at: Point, content: &str) -> (Layer, Shape) {
    (Layer::Text, Shape::Text(Text { at, height_mm: TEXT_MM, content: content.to_owned(), upright: false }))
}

impl Indicator {
    /// Creates the indicator of a position tolerance.
    pub fn position(zone: impl Into<String>, datums: &[char]) -> Self {
        Self { zone: zone.into(), datums: datums.to_vec() }
    }

    /// Returns the indicator in words, such as `position 0.1 A B`.
    #[must_use]
    pub fn words(&self) -> String {
        std::iter::once("position".to_owned()).chain(self.cells()).collect::<Vec<_>>().join(" ")
    }

    /// Texts of the cells after the symbol.
    fn cells(&self) -> impl Iterator<Item = String> {
        std::iter::once(self.zone.clone()).chain(self.datums.iter().map(char::to_string))
    }

    /// Width on paper, mm.
    pub(super) fn width_mm(&self) -> f64 {
        INDICATOR_MM + self.cells().map(|cell| cell_width_mm(&cell)).sum::<f64>()
    }

    /// Shapes of the indicator with its lower left corner at `low`.
    pub(super) fn shapes(&self, low: Point) -> Vec<(Layer, Shape)> {
        let mut left = low.x;
        let mut cell = |width: f64| {
            let extent =
                Extent::between(Point::new(left, low.y), Point::new(left + width, low.y + INDICATOR_MM));
            left += width;
            extent
        };
        let first = cell(INDICATOR_MM);
        let mut all: Vec<_> = rectangle(first).collect();
        all.extend(symbol(first.middle()));
        for content in self.cells() {
            let extent = cell(cell_width_mm(&content));
            all.extend(rectangle(extent));
            all.push(centred(extent, &content));
        }
        all
    }
}

/// The symbol of a position: a circle with a cross.
fn symbol(middle: Point) -> [(Layer, Shape); 3] {
    let line = |x: f64, y: f64| {
        let half = Point::new(x, y);
        (Layer::Dimension, Shape::Line { from: middle - half, to: middle + half })
    };
    let circle = (Layer::Dimension, Shape::Circle { centre: middle, radius_mm: 1.1 });
    [circle, line(1.9, 0.0), line(0.0, 1.9)]
}

fn cell_width_mm(content: &str) -> f64 {
    (text_width_mm(content, TEXT_MM) + 2.0 * MARGIN_MM).max(0.8 * INDICATOR_MM)
}

/// Returns a text in the middle of a box.
fn centred(extent: Extent, content: &str) -> (Layer, Shape) {
    let half = Point::new(text_width_mm(content, TEXT_MM) / 2.0, TEXT_MM / 2.0);
    text(extent.middle() - half, content)
}

/// Returns the shapes of a datum: an open triangle with its base at `foot`, a stem along `direction`, and a box around the
/// letter.
pub(super) fn datum(foot: Point, direction: Point, stem_mm: f64, letter: char) -> Vec<(Layer, Shape)> {
    let (high, half) = TRIANGLE_MM;
    let (side, apex) = (direction.left() * half, foot + direction * high);
    let (a, b) = (foot + side, foot - side);
    let mut all: Vec<_> = [(a, b), (b, apex), (apex, a), (apex, foot + direction * (high + stem_mm))]
        .map(|(from, to)| (Layer::Dimension, Shape::Line { from, to }))
        .to_vec();
    let end = foot + direction * (high + stem_mm);
    let middle = end + direction * (INDICATOR_MM / 2.0);
    let extent = Extent::between(middle, middle).grown(INDICATOR_MM / 2.0);
    all.extend(rectangle(extent));
    all.push(centred(extent, &letter.to_string()));
    all
}

/// Datum of a flat face, at one of its edges in a view.
#[derive(Clone, Debug)]
pub struct DatumMark {
    /// What it marks.
    pub key: String,
    /// Letter.
    pub letter: char,
    /// Possible feet of the triangle, with the outward normal of the face on paper.
    pub feet: Vec<(Point, Point)>,
}

impl DatumMark {
    /// Draws it; returns whether there was space.
    pub fn place(&self, draft: &mut Draft) -> bool {
        let candidates: Vec<Candidate> = self
            .feet
            .iter()
            .enumerate()
            .flat_map(|(i, (foot, outward))| {
                STEMS_MM.map(|stem| (stem + 0.1 * i as f64, datum(*foot, *outward, stem, self.letter)))
            })
            .collect();
        draft.place(&self.key, candidates)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Paper, collisions};

    #[test]
    fn indicators_have_a_cell_for_each_datum() {
        let indicator = Indicator::position("\u{d8}0.2", &['A', 'B']);
        let shapes = indicator.shapes(Point::new(0.0, 0.0));
        let texts: Vec<_> = shapes
            .iter()
            .filter_map(|(_, s)| if let Shape::Text(t) = s { Some(t.content.clone()) } else { None })
            .collect();
        assert_eq!(texts, ["\u{d8}0.2", "A", "B"]);
        let right = shapes.iter().flat_map(|(_, s)| s.pieces()).flatten().map(|p| p.x).fold(0.0, f64::max);
        assert!((right - indicator.width_mm()).abs() < 1e-9);
    }

    #[test]
    fn datums_find_free_space() {
        let mut draft = Draft::without_title(Paper::A4);
        let feet = [100.0, 130.0].map(|y| (Point::new(100.0, y), Point::new(1.0, 0.0))).to_vec();
        let mark = |letter| DatumMark { key: format!("datum {letter}"), letter, feet: feet.clone() };
        assert!(mark('A').place(&mut draft) && mark('B').place(&mut draft));
        assert!(!mark('C').place(&mut draft), "both feet are taken");
        assert!(collisions(draft.sheet()).is_empty());
    }
}
