//! Collisions on a finished sheet.

use super::geometry::{Extent, lines_cross};
use super::index::{Index, Piece};
use super::sheet::{Layer, Shape, Sheet};

/// Least distance of a text from other texts and lines, mm.
const LEAST_GAP_MM: f64 = 0.2;

/// Two entities that overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Collision {
    /// The text or line.
    pub what: String,
    /// The other text or line, the frame, or the title block.
    pub with: String,
    /// Position on paper.
    pub at: Extent,
}

/// Returns every collision on a sheet: of texts with each other, of a text with a line that is not of its own annotation, of
/// an arrow head with a line of another annotation, and of anything with the frame or the title block.
#[must_use]
pub fn collisions(sheet: &Sheet) -> Vec<Collision> {
    let mut all = Vec::new();
    let mut pieces = Index::new();
    for entity in &sheet.entities {
        // Lines of views may meet arrow heads, and so may centre lines and frames.
        let is_annotation = entity.view.is_none() && entity.layer == Layer::Dimension;
        for ends in entity.shape.pieces() {
            let extent = Extent::between(ends[0], ends[1]);
            pieces.insert(extent, Piece { ends, group: entity.group, is_annotation });
        }
        if entity.group >= sheet.first_group {
            out_of_bounds(sheet, &entity.shape, &mut all);
        }
    }
    for entity in &sheet.entities {
        let Shape::Arrow { tip, direction } = entity.shape else { continue };
        for [a, b] in Shape::arrow_sides(tip, direction) {
            let extent = Extent::between(a, b);
            let is_met =
                |p: &Piece| p.is_annotation && p.group != entity.group && lines_cross(p.ends, [a, b]);
            if pieces.any(extent, is_met) {
                all.push(Collision {
                    what: "an arrow head".to_owned(),
                    with: "a line of another annotation".to_owned(),
                    at: extent,
                });
                break;
            }
        }
    }
    let texts: Vec<_> = sheet
        .entities
        .iter()
        .filter_map(|e| match &e.shape {
            Shape::Text(text) => Some((text, text.extent().grown(LEAST_GAP_MM / 2.0), e.group)),
            _ => None,
        })
        .collect();
    for (i, (text, extent, group)) in texts.iter().enumerate() {
        for (other, around, _) in &texts[i + 1..] {
            // Lines of one note may touch, but not overlap.
            if extent.grown(-LEAST_GAP_MM / 2.0).overlaps(around.grown(-LEAST_GAP_MM / 2.0)) {
                all.push(Collision { what: text.content.clone(), with: other.content.clone(), at: *extent });
            }
        }
        let crossed =
            pieces.any(*extent, |p| p.group != *group && extent.is_crossed_by(p.ends[0], p.ends[1]));
        if crossed {
            all.push(Collision { what: text.content.clone(), with: "a line".to_owned(), at: *extent });
        }
    }
    all
}

/// Adds the collisions of a shape with the frame and the title block.
fn out_of_bounds(sheet: &Sheet, shape: &Shape, all: &mut Vec<Collision>) {
    let frame = sheet.paper.frame();
    let what = |word: &str| match shape {
        Shape::Text(text) => text.content.clone(),
        _ => word.to_owned(),
    };
    let mut test = |extent: Extent, enters: bool| {
        let with = match (frame.contains(extent), enters) {
            (false, _) => "the frame",
            (true, true) => "the title block",
            (true, false) => return,
        };
        all.push(Collision { what: what("a line"), with: with.to_owned(), at: extent });
    };
    match shape {
        Shape::Text(text) => test(text.extent(), text.extent().overlaps(sheet.title_block)),
        _ => {
            for [a, b] in shape.pieces() {
                test(Extent::between(a, b), sheet.title_block.is_crossed_by(a, b));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Draft, Layer, Paper, Point, Text};
    use super::*;

    fn text(x: f64, y: f64, content: &str) -> Shape {
        Shape::Text(Text {
            at: Point::new(x, y),
            height_mm: 2.5,
            content: content.to_owned(),
            upright: false,
        })
    }

    fn line(a: [f64; 2], b: [f64; 2]) -> Shape {
        Shape::Line { from: Point::new(a[0], a[1]), to: Point::new(b[0], b[1]) }
    }

    fn collisions_of(shapes: &[(usize, Shape)]) -> Vec<String> {
        let mut draft = Draft::without_title(Paper::A4);
        let first = draft.group();
        for (group, shape) in shapes {
            while draft.group() <= first + group {}
            draft.put(Layer::Text, shape.clone(), None, first + group);
        }
        collisions(draft.sheet()).into_iter().map(|c| format!("{} on {}", c.what, c.with)).collect()
    }

    #[test]
    fn every_kind_of_collision_is_reported() {
        let at = text(100.0, 150.0, "R20");
        assert!(collisions_of(&[(0, at.clone()), (1, text(120.0, 150.0, "R22"))]).is_empty());
        assert_eq!(collisions_of(&[(0, at.clone()), (1, text(103.0, 151.0, "R22"))]), ["R20 on R22"]);
        let through = line([90.0, 151.0], [130.0, 151.0]);
        assert_eq!(collisions_of(&[(0, at.clone()), (1, through.clone())]), ["R20 on a line"]);
        // A text may touch the lines of its own annotation.
        assert!(collisions_of(&[(0, at.clone()), (0, through)]).is_empty());
        assert_eq!(collisions_of(&[(0, text(5.0, 150.0, "R20"))]), ["R20 on the frame"]);
        // On the frame it also touches the line of the frame.
        assert_eq!(collisions_of(&[(0, text(18.0, 150.0, "R20"))]), ["R20 on the frame", "R20 on a line"]);
        assert_eq!(collisions_of(&[(0, text(250.0, 20.0, "R20"))]), ["R20 on the title block"]);
        assert_eq!(collisions_of(&[(0, line([250.0, 100.0], [250.0, 5.0]))]), ["a line on the frame"]);
        assert_eq!(collisions_of(&[(0, line([250.0, 100.0], [250.0, 20.0]))]), ["a line on the title block"]);
        let arc =
            Shape::Arc { centre: Point::new(101.0, 141.0), radius_mm: 10.0, start_rad: 1.0, sweep_rad: 1.0 };
        assert_eq!(collisions_of(&[(0, at), (1, arc)]), ["R20 on a line"]);
    }
}
