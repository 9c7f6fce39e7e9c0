//! Tables, such as a bill of materials: they stand on the title block.

use super::annotation::TEXT_MM;
use super::draft::Draft;
use super::font::fitted;
use super::geometry::{Extent, Point};
use super::sheet::{Annotation, Layer, Shape, Text};

/// Height of a row, mm.
const ROW_MM: f64 = 5.5;

/// A table with a heading.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// What it is.
    pub key: String,
    /// Heading and width in mm of each column.
    pub columns: Vec<(String, f64)>,
    /// Its rows, from the first.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Height on paper, mm.
    #[must_use]
    pub fn height_mm(&self) -> f64 {
        ROW_MM * (self.rows.len() + 1) as f64
    }

    /// Draws it with its lower right corner at `corner`, the heading below and the first row next to it, as lists of parts
    /// are written that grow upward (ISO 7573).
    pub fn draw(&self, draft: &mut Draft, corner: Point) -> Extent {
        let width: f64 = self.columns.iter().map(|c| c.1).sum();
        let headings: Vec<String> = self.columns.iter().map(|c| c.0.clone()).collect();
        let lines = draft.group();
        for (i, row) in std::iter::once(&headings).chain(&self.rows).enumerate() {
            let low = corner.y + ROW_MM * i as f64;
            let mut left = corner.x - width;
            let group = draft.group();
            for ((_, width_mm), content) in self.columns.iter().zip(row) {
                let cell = Extent::between(Point::new(left, low), Point::new(left + width_mm, low + ROW_MM));
                draft.rectangle(Layer::Thin, cell, lines);
                let (content, height_mm) = fitted(content, TEXT_MM, 1.6, width_mm - 2.0);
                let at = Point::new(left + 1.0, low + (ROW_MM - TEXT_MM) / 2.0);
                draft.put(
                    Layer::Text,
                    Shape::Text(Text { at, height_mm, content, upright: false }),
                    None,
                    group,
                );
                left += width_mm;
            }
            draft.annotate(Annotation { group, key: self.key.clone(), text: row.join("\t") });
        }
        Extent::between(corner, corner + Point::new(-width, self.height_mm()))
    }
}
