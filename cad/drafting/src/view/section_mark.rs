//! The mark of a cutting plane.

use std::f64::consts::PI;

use crate::{Draft, Layer, Point, Shape, Text};

/// Height of the letter of a section, mm.
const LETTER_MM: f64 = 3.5;

/// Position of the letter at the mark of a section. Extension lines pass on the other side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Letter {
    /// On the other side of the plane than the arrow.
    BehindLine,
    /// At the tip of the arrow.
    BeforeArrow,
}

/// Draws the cutting plane A-A at `x`, from `low` to `high`: a chain line through the view, thick at its ends, with arrows
/// along the line of sight, to the right for a positive `sense` and else to the left.
pub fn draw_section_mark(draft: &mut Draft, x: f64, [low, high]: [f64; 2], sense: f64, letter: Letter) {
    let group = draft.group();
    let line = |from: f64, to: f64| Shape::Line { from: Point::new(x, from), to: Point::new(x, to) };
    draft.put(Layer::Centre, line(low, high), None, group);
    for (from, to) in [(low, low - 5.0), (high, high + 5.0)] {
        draft.put(Layer::Frame, line(from, to), None, group);
        let foot = Point::new(x, f64::midpoint(from, to));
        let direction = Point::towards(if sense > 0.0 { 0.0 } else { PI });
        let tip = foot + direction * 6.0;
        draft.put(Layer::Dimension, Shape::Line { from: foot, to: tip }, None, group);
        draft.put(Layer::Dimension, Shape::Arrow { tip, direction }, None, group);
        let is_left = (sense > 0.0) == (letter == Letter::BehindLine);
        let from = if letter == Letter::BehindLine { foot } else { tip };
        let at = from + Point::new(if is_left { -4.0 } else { 1.6 }, -LETTER_MM / 2.0);
        let letter = Text { at, height_mm: LETTER_MM, content: "A".to_owned(), upright: false };
        draft.put(Layer::Text, Shape::Text(letter), None, group);
    }
}
