//! The title block, and the sign of the projection.

use super::draft::Draft;
use super::font::{LINE_PER_CAPITAL, fitted};
use super::geometry::{Extent, Point};
use super::sheet::{Layer, Paper, Shape, Text};

/// Width of the title block, mm (ISO 7200).
pub(super) const TITLE_WIDTH_MM: f64 = 180.0;
/// Height of a row of it, mm.
const ROW_MM: f64 = 9.5;
/// Height of the words that say what a cell holds, mm.
const LABEL_MM: f64 = 1.6;
/// What is smaller in one line goes on in the next, mm.
const LEAST_MM: f64 = 1.8;
/// Its height, mm.
pub(super) const TITLE_HEIGHT_MM: f64 = 3.0 * ROW_MM;

/// How views are arranged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// What is seen from above lies below, what is seen from the left lies to the right: usual in Europe and Asia.
    First,
    /// What is seen from above lies above, what is seen from the right lies to the right: usual in North America.
    Third,
}

/// What the title block says.
#[derive(Clone, Debug, PartialEq)]
pub struct TitleBlock {
    /// Name of the whole.
    pub name: String,
    /// Which variant of it.
    pub layout: String,
    /// What the sheet shows.
    pub title: String,
    /// Number of the part.
    pub part_number: String,
    /// What it is made of.
    pub material: String,
    /// Tolerance of what has none of its own.
    pub general_tolerance: String,
    /// Scale of the main views.
    pub scale: String,
    /// How views are arranged.
    pub projection: Projection,
    /// Date, if one was asked for.
    pub date: Option<String>,
    /// Number of this sheet, and of all.
    pub sheet: (usize, usize),
    /// Program that drew it.
    pub generator: String,
}

impl Draft {
    /// A sheet with its frame and a title block.
    #[must_use]
    pub fn new(paper: Paper, title: &TitleBlock) -> Self {
        let mut draft = Self::bare(paper);
        draft.title_block(title, paper);
        draft.begin_content();
        draft
    }

    fn title_block(&mut self, title: &TitleBlock, paper: Paper) {
        let block = self.sheet().title_block;
        let sheet = format!("{} / {}", title.sheet.0, title.sheet.1);
        let mut last = vec![
            (24.0, "", String::new()),
            (24.0, "Scale", title.scale.clone()),
            (24.0, "Units", "mm".to_owned()),
            (18.0, "Size", paper.name().to_owned()),
            (24.0, "Sheet", sheet),
        ];
        match &title.date {
            Some(date) => {
                last.push((28.0, "Date", date.clone()));
                last.push((38.0, "Drawn by", title.generator.clone()));
            }
            None => last.push((66.0, "Drawn by", title.generator.clone())),
        }
        let rows = [
            vec![
                (66.0, "Switch", title.name.clone()),
                (46.0, "Layout", title.layout.clone()),
                (68.0, "Part number", title.part_number.clone()),
            ],
            vec![
                (66.0, "Title", title.title.clone()),
                (46.0, "Material", title.material.clone()),
                (68.0, "General tolerance", title.general_tolerance.clone()),
            ],
            last,
        ];
        for (i, row) in rows.into_iter().enumerate() {
            let top = block.high.y - ROW_MM * i as f64;
            let mut left = block.low.x;
            for (width, label, value) in row {
                let cell = Extent::between(Point::new(left, top), Point::new(left + width, top - ROW_MM));
                self.cell(cell, label, &value);
                left += width;
            }
        }
        self.rectangle(Layer::Frame, block, 0);
        let middle = Point::new(block.low.x + 12.0, block.low.y + ROW_MM / 2.0);
        self.projection_symbol(title.projection, middle);
    }

    fn cell(&mut self, cell: Extent, label: &str, value: &str) {
        self.rectangle(Layer::Thin, cell, 0);
        if label.is_empty() {
            return;
        }
        let at = Point::new(cell.low.x + 1.2, cell.high.y - LABEL_MM - 1.1);
        self.lines_of_text(label, LABEL_MM, at, [cell.width() - 2.4, LABEL_MM]);
        let at = Point::new(cell.low.x + 1.2, cell.low.y + 1.7);
        self.lines_of_text(value, 3.0, at, [cell.width() - 2.4, ROW_MM - LABEL_MM - 3.3]);
    }

    /// Writes `content` whole into a room whose lower left corner is `low`, in as many lines as that takes.
    pub(super) fn lines_of_text(&mut self, content: &str, wanted_mm: f64, low: Point, room: [f64; 2]) {
        let (lines, height_mm) = fitted(content, wanted_mm, LEAST_MM, room);
        let pitch = LINE_PER_CAPITAL * height_mm;
        let group = self.group();
        for (i, content) in lines.into_iter().rev().enumerate() {
            let at = low + Point::new(0.0, pitch * i as f64);
            self.put(Layer::Text, Shape::Text(Text { at, height_mm, content, upright: false }), None, group);
        }
    }

    /// A cone cut short, from the side and from its narrow end (ISO 5456-2).
    fn projection_symbol(&mut self, projection: Projection, middle: Point) {
        let beside = match projection {
            Projection::First => 5.0,
            Projection::Third => -5.0,
        };
        let (cone, rings) = (middle - Point::new(beside, 0.0), middle + Point::new(beside, 0.0));
        let at = |x: f64, y: f64| cone + Point::new(x, y);
        let corners = [at(-3.5, -1.4), at(3.5, -2.8), at(3.5, 2.8), at(-3.5, 1.4)];
        for i in 0..4 {
            let (from, to) = (corners[i], corners[(i + 1) % 4]);
            self.put(Layer::Thin, Shape::Line { from, to }, None, 0);
        }
        for radius_mm in [1.4, 2.8] {
            self.put(Layer::Thin, Shape::Circle { centre: rings, radius_mm }, None, 0);
        }
        let cross = |half: Point, about: Point| Shape::Line { from: about - half, to: about + half };
        self.put(Layer::Centre, cross(Point::new(4.3, 0.0), cone), None, 0);
        self.put(Layer::Centre, cross(Point::new(3.6, 0.0), rings), None, 0);
        self.put(Layer::Centre, cross(Point::new(0.0, 3.6), rings), None, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::collisions;
    use super::*;

    /// The words of a sheet in the order in which they are read, cell by cell.
    fn texts(sheet: &super::super::Sheet) -> String {
        let all = sheet.entities.iter();
        let mut lines: Vec<(usize, f64, &str)> = all
            .filter_map(|e| match &e.shape {
                Shape::Text(t) => Some((e.group, -t.at.y, t.content.as_str())),
                _ => None,
            })
            .collect();
        lines.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        lines.iter().map(|l| l.2).collect()
    }

    #[test]
    fn a_title_block_holds_whatever_it_is_told() {
        for name in ["three-double".to_owned(), "W".repeat(80), "スイッチ".repeat(20)] {
            for date in [None, Some("2026-01-31 afternoon".to_owned())] {
                let title = TitleBlock {
                    name: name.clone(),
                    layout: name.clone(),
                    title: name.clone(),
                    part_number: format!("{name}/{name}"),
                    material: name.clone(),
                    general_tolerance: name.clone(),
                    scale: "1:2".to_owned(),
                    projection: Projection::First,
                    date,
                    sheet: (10, 12),
                    generator: "pinswitch 0.1.0".to_owned(),
                };
                for paper in [Paper::A4, Paper::A3] {
                    let draft = Draft::new(paper, &title);
                    assert_eq!(collisions(draft.sheet()), [], "{name}");
                    let block = draft.sheet().title_block;
                    assert!(paper.frame().holds(block));
                    // Nothing is cut: whoever reads a number may trust it.
                    let said: String = texts(draft.sheet());
                    assert!(said.contains(&title.part_number), "{said}");
                }
            }
        }
    }
}
