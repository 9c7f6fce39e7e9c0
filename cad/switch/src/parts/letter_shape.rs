//! Shapes of engraved letters: the union of their strokes.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use i_overlay::mesh::float::stroke::offset::StrokeOffset;
use i_overlay::mesh::float::style::{LineCap, LineJoin, StrokeStyle};

use super::stroke_font::{HEIGHT, WIDTH, strokes};

/// Width of a letter over its height.
pub(super) const ASPECT: f64 = 0.58;
/// Angle between the points of a round stroke end, radians.
const ROUND_RAD: f64 = 0.5;
/// Points of the outline of a letter that are closer are merged, mm.
const MERGE_MM: f64 = 0.02;
/// Most letters that are known at a time, of about 1 kB each.
const MOST_KNOWN: usize = 1024;

/// Shapes of a letter, each its outline, then its islands, in mm about the centre of the letter.
pub(super) type LetterShapes = Vec<Vec<Vec<[f64; 2]>>>;

/// A letter with the bits of its height and of its stroke.
type Key = (char, u64, u64);

/// Letters that were made before. A batch engraves the same ones into every variant.
static KNOWN: LazyLock<Mutex<HashMap<Key, Arc<LetterShapes>>>> = LazyLock::new(Mutex::default);

/// Returns the union of the strokes of a letter; empty for a space and for a letter that is not in the font.
pub(super) fn letter_shapes(letter: char, height_mm: f64, stroke_mm: f64) -> Arc<LetterShapes> {
    let key = (letter, height_mm.to_bits(), stroke_mm.to_bits());
    // An entry is complete when it is inserted, so that a poisoned lock is safe.
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let before = known().get(&key).cloned();
    before.unwrap_or_else(|| {
        let made = Arc::new(union_of_strokes(letter, height_mm, stroke_mm));
        let mut known = known();
        if known.len() >= MOST_KNOWN {
            known.clear();
        }
        known.insert(key, made.clone());
        made
    })
}

/// The union of the strokes of a letter, in mm about its centre. A shape is its outline, then its islands.
fn union_of_strokes(letter: char, height_mm: f64, stroke_mm: f64) -> LetterShapes {
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
    let shapes: LetterShapes = paths.stroke(style, false);
    shapes.into_iter().map(|shape| shape.into_iter().map(|c| without_near_duplicates(&c)).collect()).collect()
}

/// Merges points that are close to their neighbour.
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
    use pinswitch_solid::profile::{Contour, Point2};

    #[test]
    fn letters_have_no_nested_islands() {
        for letter in (' '..='~').filter(|l| strokes(*l).is_some()) {
            let shapes = letter_shapes(letter, 3.0, 0.5);
            let area = |points: &Vec<[f64; 2]>| {
                Contour::polygon(points.iter().map(|[x, y]| Point2::new(*x, *y)).collect()).area_mm2().abs()
            };
            for shape in shapes.iter() {
                assert!(shape.iter().skip(1).all(|island| area(island) < area(&shape[0])), "{letter}");
            }
            // Only the colon and the equals sign have two shapes.
            assert!(shapes.len() <= 1 || ":=".contains(letter), "{letter}: {}", shapes.len());
        }
    }

    #[test]
    fn known_letters_are_those_that_are_made() {
        for size in [2.0, 2.5] {
            for _ in 0..2 {
                assert_eq!(*letter_shapes('R', size, 0.5), union_of_strokes('R', size, 0.5));
            }
        }
    }
}
