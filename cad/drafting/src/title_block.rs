//! The title block (ISO 7200) with the symbol of the projection (ISO 5456-2).

use super::draft::{Draft, TITLE_BLOCK_MM};
use super::font::{LINE_PER_CAPITAL, fit_text};
use super::geometry::{Extent, Point};
use super::sheet::{Layer, Paper, Shape, Text};

/// Label of the cell with the symbol of surface texture.
const TEXTURE: &str = "Surface texture";
/// Height of a row, mm.
const ROW_MM: f64 = TITLE_BLOCK_MM[1] / 4.0;
/// Height of the label of a cell, mm.
const LABEL_MM: f64 = 1.6;
/// Height of the value of a cell, mm.
const VALUE_MM: f64 = 2.5;
/// Width and height of the symbol of surface texture, mm.
const TEXTURE_MM: [f64; 2] = [4.4, 3.4];
/// Least height of a text on one line, before it is broken into several, mm.
const LEAST_MM: f64 = 1.8;

/// The arrangement of views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// First angle, usual in Europe and Asia: the view from above is below, the view from the left is on the right.
    #[default]
    First,
    /// Third angle, usual in North America: the view from above is above, the view from the right is on the right.
    Third,
}

/// The content of a title block: the fields of ISO 7200, with material, tolerances and scale. An empty text leaves its
/// cell for handwriting.
#[derive(Clone, Debug, PartialEq)]
pub struct TitleBlock {
    /// Label and name of the product, such as `Switch` and `three-double`.
    pub product: (String, String),
    /// Label and name of the variant of the product.
    pub variant: (String, String),
    /// Title of the sheet.
    pub title: String,
    /// Type of the document, such as `Part drawing`.
    pub document_type: String,
    /// Status of the document, such as `Released`.
    pub status: String,
    /// Legal owner.
    pub owner: String,
    /// Person who approved the document.
    pub approved_by: String,
    /// Index of the revision.
    pub revision: String,
    /// Code of the language (ISO 639).
    pub language: String,
    /// Identification number: that of the part.
    pub part_number: String,
    /// Material.
    pub material: String,
    /// Tolerance of dimensions without one.
    pub general_tolerance: String,
    /// Surface texture (ISO 21920-1) of surfaces without one; empty without a requirement.
    pub surface_texture: String,
    /// Scale of the main views.
    pub scale: String,
    /// Arrangement of the views.
    pub projection: Projection,
    /// Date of issue.
    pub date: Option<String>,
    /// Number of the sheet, and of all sheets.
    pub sheet: (usize, usize),
    /// Author, or the program that drew the sheet.
    pub generator: String,
}

impl Default for TitleBlock {
    /// The title block of a single sheet in first-angle projection, without texts.
    fn default() -> Self {
        Self {
            product: ("Product".to_owned(), String::new()),
            variant: ("Variant".to_owned(), String::new()),
            title: String::new(),
            document_type: "Part drawing".to_owned(),
            status: String::new(),
            owner: String::new(),
            approved_by: String::new(),
            revision: String::new(),
            language: "en".to_owned(),
            part_number: String::new(),
            material: String::new(),
            general_tolerance: String::new(),
            surface_texture: String::new(),
            scale: String::new(),
            projection: Projection::First,
            date: None,
            sheet: (1, 1),
            generator: String::new(),
        }
    }
}

impl Draft {
    /// A sheet with its frame and its title block.
    #[must_use]
    pub fn new(paper: Paper, title: &TitleBlock) -> Self {
        let mut draft = Self::without_title(paper);
        draft.put_title_block(title, paper);
        draft.begin_content();
        draft
    }

    fn put_title_block(&mut self, title: &TitleBlock, paper: Paper) {
        let block = self.sheet().title_block;
        let sheet = format!("{} / {}", title.sheet.0, title.sheet.1);
        let rows = [
            vec![
                (66.0, title.product.0.as_str(), title.product.1.clone()),
                (46.0, title.variant.0.as_str(), title.variant.1.clone()),
                (68.0, "Identification number", title.part_number.clone()),
            ],
            vec![
                (66.0, "Title", title.title.clone()),
                (46.0, "Material", title.material.clone()),
                (36.0, "Document type", title.document_type.clone()),
                (32.0, "Status", title.status.clone()),
            ],
            vec![
                (66.0, "General tolerances", title.general_tolerance.clone()),
                (46.0, TEXTURE, title.surface_texture.clone()),
                (36.0, "Created by", title.generator.clone()),
                (32.0, "Approved by", title.approved_by.clone()),
            ],
            vec![
                (24.0, "", String::new()),
                (16.0, "Scale", title.scale.clone()),
                (13.0, "Units", "mm".to_owned()),
                (13.0, "Size", paper.name().to_owned()),
                (33.0, "Legal owner", title.owner.clone()),
                (13.0, "Rev.", title.revision.clone()),
                (28.0, "Date of issue", title.date.clone().unwrap_or_default()),
                (20.0, "Language", title.language.clone()),
                (20.0, "Sheet", sheet),
            ],
        ];
        for (i, row) in rows.into_iter().enumerate() {
            let top = block.high.y - ROW_MM * i as f64;
            let mut left = block.low.x;
            for (width, label, value) in row {
                let cell = Extent::between(Point::new(left, top), Point::new(left + width, top - ROW_MM));
                self.put_cell(cell, label, &value);
                left += width;
            }
        }
        self.rectangle(Layer::Frame, block, 0);
        let middle = Point::new(block.low.x + 12.0, block.low.y + ROW_MM / 2.0);
        self.put_projection_symbol(title.projection, middle);
    }

    fn put_cell(&mut self, cell: Extent, label: &str, value: &str) {
        self.rectangle(Layer::Thin, cell, 0);
        if label.is_empty() {
            return;
        }
        let at = Point::new(cell.low.x + 1.2, cell.high.y - LABEL_MM - 1.1);
        self.put_text(label, LABEL_MM, at, [cell.width() - 2.4, LABEL_MM]);
        if value.is_empty() {
            return;
        }
        let at = Point::new(cell.low.x + 1.2, cell.low.y + 1.2);
        let room = [cell.width() - 2.4, ROW_MM - LABEL_MM - 3.1];
        if label == TEXTURE {
            self.put_texture_symbol(at);
            let indent = TEXTURE_MM[0] + 1.0;
            self.put_text(value, VALUE_MM, at + Point::new(indent, 0.0), [room[0] - indent, room[1]]);
        } else {
            self.put_text(value, VALUE_MM, at, room);
        }
    }

    /// Draws the symbol of surface texture for any manufacturing process (ISO 21920-1) with its foot at `low`.
    fn put_texture_symbol(&mut self, low: Point) {
        let [width, height] = TEXTURE_MM;
        let at = |x: f64, y: f64| low + Point::new(x * width, y * height);
        let corners = [at(0.0, 0.5), at(0.27, 0.0), at(0.8, 1.0), at(1.0, 1.0)];
        for pair in corners.windows(2) {
            self.put(Layer::Thin, Shape::Line { from: pair[0], to: pair[1] }, None, 0);
        }
    }

    /// Draws a text into a box with its lower left corner at `low`, with capitals of at most `most_mm`, in as many lines as
    /// needed.
    pub(super) fn put_text(&mut self, content: &str, most_mm: f64, low: Point, size_mm: [f64; 2]) {
        let (lines, height_mm) = fit_text(content, most_mm, LEAST_MM, size_mm);
        let pitch = LINE_PER_CAPITAL * height_mm;
        let group = self.group();
        for (i, content) in lines.into_iter().rev().enumerate() {
            let at = low + Point::new(0.0, pitch * i as f64);
            self.put(Layer::Text, Shape::Text(Text { at, height_mm, content, upright: false }), None, group);
        }
    }

    /// Draws a truncated cone, from the side and from its narrow end.
    fn put_projection_symbol(&mut self, projection: Projection, middle: Point) {
        let shift = match projection {
            Projection::First => 5.0,
            Projection::Third => -5.0,
        };
        let (cone, rings) = (middle - Point::new(shift, 0.0), middle + Point::new(shift, 0.0));
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
    use super::super::{Sheet, collisions};
    use super::*;

    /// The texts of a sheet, cell by cell and line by line.
    fn texts(sheet: &Sheet) -> String {
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
    fn title_blocks_hold_texts_of_any_length() {
        for name in ["three-double".to_owned(), "W".repeat(80), "スイッチ".repeat(20)] {
            for date in [None, Some("2026-01-31 afternoon".to_owned())] {
                let title = TitleBlock {
                    product: ("Product".to_owned(), name.clone()),
                    variant: ("Variant".to_owned(), name.clone()),
                    title: name.clone(),
                    part_number: format!("{name}/{name}"),
                    material: name.clone(),
                    general_tolerance: name.clone(),
                    scale: "1:2".to_owned(),
                    projection: Projection::First,
                    date,
                    sheet: (10, 12),
                    generator: "pinswitch 0.1.0".to_owned(),
                    document_type: name.clone(),
                    status: name.clone(),
                    owner: name.clone(),
                    approved_by: name.clone(),
                    revision: name.clone(),
                    language: name.clone(),
                    surface_texture: name.clone(),
                };
                for paper in [Paper::A4, Paper::A3] {
                    let draft = Draft::new(paper, &title);
                    assert_eq!(collisions(draft.sheet()), [], "{name}");
                    let block = draft.sheet().title_block;
                    assert!(paper.frame().contains(block));
                    // Nothing is cut.
                    let text = texts(draft.sheet());
                    assert!(text.contains(&title.part_number), "{text}");
                }
            }
        }
    }
}
