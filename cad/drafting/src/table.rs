//! Tables, such as a parts list or a hole table.

use super::annotation::TEXT_MM;
use super::draft::Draft;
use super::geometry::{Extent, Point};
use super::sheet::{Annotation, Layer};

/// A table with a heading.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// What it lists.
    pub key: String,
    /// Heading and width in mm of each column.
    pub columns: Vec<(String, f64)>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
    /// Whether the heading is at the top. Parts lists grow upward from theirs (ISO 7573).
    pub reads_down: bool,
}

impl Table {
    /// Height of a row, mm.
    pub const ROW_MM: f64 = 5.5;

    /// Height on paper, mm.
    #[must_use]
    pub fn height_mm(&self) -> f64 {
        Self::ROW_MM * (self.rows.len() + 1) as f64
    }

    /// Width and height on paper, mm.
    #[must_use]
    pub fn size_mm(&self) -> [f64; 2] {
        [self.columns.iter().map(|c| c.1).sum(), self.height_mm()]
    }

    /// Draws it with its lower right corner at `corner`; returns its extent. The first row is next to the heading.
    pub fn draw(&self, draft: &mut Draft, corner: Point) -> Extent {
        let width: f64 = self.columns.iter().map(|c| c.1).sum();
        let headings: Vec<String> = self.columns.iter().map(|c| c.0.clone()).collect();
        let lines = draft.group();
        for (i, row) in std::iter::once(&headings).chain(&self.rows).enumerate() {
            let step = if self.reads_down { self.rows.len() - i } else { i };
            let low = corner.y + Self::ROW_MM * step as f64;
            let mut left = corner.x - width;
            for ((_, width_mm), content) in self.columns.iter().zip(row) {
                let cell =
                    Extent::between(Point::new(left, low), Point::new(left + width_mm, low + Self::ROW_MM));
                draft.rectangle(Layer::Thin, cell, lines);
                let at = Point::new(left + 1.0, low + (Self::ROW_MM - TEXT_MM) / 2.0);
                draft.put_text(content, TEXT_MM, at, [width_mm - 2.0, TEXT_MM + 1.0]);
                left += width_mm;
            }
            let group = draft.group();
            draft.annotate(Annotation { group, key: self.key.clone(), text: row.join("\t") });
        }
        Extent::between(corner, corner + Point::new(-width, self.height_mm()))
    }
}
