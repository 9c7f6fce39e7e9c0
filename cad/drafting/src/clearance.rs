//! What collides on a finished sheet: the judge of every layout.

use super::geometry::Extent;
use super::index::{Index, Piece};
use super::sheet::{Shape, Sheet};

/// What a text must keep from other texts and lines, mm.
const LEAST_GAP_MM: f64 = 0.2;

/// Two things that lie on each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Collision {
    /// The text or line.
    pub what: String,
    /// What it lies on.
    pub with: String,
    /// Where, mm on paper.
    pub at: Extent,
}

/// Every collision of `sheet`: a text with a text, a text with a line that is not its own leader or dimension line, and
/// anything with the frame or the title block.
#[must_use]
pub fn collisions(sheet: &Sheet) -> Vec<Collision> {
    let mut found = Vec::new();
    let mut pieces = Index::new();
    for entity in &sheet.entities {
        for ends in entity.shape.pieces() {
            let extent = Extent::between(ends[0], ends[1]);
            pieces.insert(extent, Piece { ends, group: entity.group, is_annotation: false });
        }
        if entity.group >= sheet.first_group {
            out_of_bounds(sheet, &entity.shape, &mut found);
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
            // Lines of one note stand on each other's heels, but not in each other.
            if extent.grown(-LEAST_GAP_MM / 2.0).meets(around.grown(-LEAST_GAP_MM / 2.0)) {
                found.push(Collision {
                    what: text.content.clone(),
                    with: other.content.clone(),
                    at: *extent,
                });
            }
        }
        let crossed =
            pieces.any(*extent, |p| p.group != *group && extent.is_crossed_by(p.ends[0], p.ends[1]));
        if crossed {
            found.push(Collision { what: text.content.clone(), with: "a line".to_owned(), at: *extent });
        }
    }
    found
}

/// Whether a shape leaves the frame or enters the title block.
fn out_of_bounds(sheet: &Sheet, shape: &Shape, found: &mut Vec<Collision>) {
    let frame = sheet.paper.frame();
    let what = |word: &str| match shape {
        Shape::Text(text) => text.content.clone(),
        _ => word.to_owned(),
    };
    let mut judge = |extent: Extent, enters: bool| {
        let with = match (frame.holds(extent), enters) {
            (false, _) => "the frame",
            (true, true) => "the title block",
            (true, false) => return,
        };
        found.push(Collision { what: what("a line"), with: with.to_owned(), at: extent });
    };
    match shape {
        Shape::Text(text) => judge(text.extent(), text.extent().meets(sheet.title_block)),
        _ => {
            for [a, b] in shape.pieces() {
                judge(Extent::between(a, b), sheet.title_block.is_crossed_by(a, b));
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

    fn found(shapes: &[(usize, Shape)]) -> Vec<String> {
        let mut draft = Draft::bare(Paper::A4);
        let first = draft.group();
        for (group, shape) in shapes {
            while draft.group() <= first + group {}
            draft.put(Layer::Text, shape.clone(), None, first + group);
        }
        collisions(draft.sheet()).into_iter().map(|c| format!("{} on {}", c.what, c.with)).collect()
    }

    #[test]
    fn every_kind_of_collision_is_seen_and_nothing_else() {
        let at = text(100.0, 150.0, "R20");
        assert!(found(&[(0, at.clone()), (1, text(120.0, 150.0, "R22"))]).is_empty());
        assert_eq!(found(&[(0, at.clone()), (1, text(103.0, 151.0, "R22"))]), ["R20 on R22"]);
        let through = line([90.0, 151.0], [130.0, 151.0]);
        assert_eq!(found(&[(0, at.clone()), (1, through.clone())]), ["R20 on a line"]);
        // Its own dimension line may touch it.
        assert!(found(&[(0, at.clone()), (0, through)]).is_empty());
        assert_eq!(found(&[(0, text(5.0, 150.0, "R20"))]), ["R20 on the frame"]);
        // On the frame itself it also touches its line.
        assert_eq!(found(&[(0, text(18.0, 150.0, "R20"))]), ["R20 on the frame", "R20 on a line"]);
        assert_eq!(found(&[(0, text(250.0, 20.0, "R20"))]), ["R20 on the title block"]);
        assert_eq!(found(&[(0, line([250.0, 100.0], [250.0, 5.0]))]), ["a line on the frame"]);
        assert_eq!(found(&[(0, line([250.0, 100.0], [250.0, 20.0]))]), ["a line on the title block"]);
        let arc =
            Shape::Arc { centre: Point::new(101.0, 141.0), radius_mm: 10.0, start_rad: 1.0, sweep_rad: 1.0 };
        assert_eq!(found(&[(0, at), (1, arc)]), ["R20 on a line"]);
    }
}
