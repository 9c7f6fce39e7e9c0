//! The manual as PDF, on pages of A4.

use std::collections::BTreeMap;

use super::Pictures;
use crate::formats::guide::document::{Block, Document, Step, Table};
use crate::formats::guide::figure::{Align, Figure, Ink, Shape, TEXT_MM};
use crate::formats::guide::inline::{Run, runs};
use crate::formats::guide::step_picture;
use pinswitch_drafting::{Page, PageItem, PngPixels, Rgb, Typeface, pages_pdf};

/// Width and height of a page, mm.
const PAGE_MM: [f64; 2] = [210.0, 297.0];
/// Margins at the sides, above and below, mm.
const SIDE_MM: f64 = 18.0;
const TOP_MM: f64 = 18.0;
const BOTTOM_MM: f64 = 20.0;
/// Width of the text, mm.
const WIDTH_MM: f64 = PAGE_MM[0] - 2.0 * SIDE_MM;
/// Sizes of type, mm: title, headings of sections and of their parts, text, footer.
const TITLE_MM: f64 = 8.0;
const SECTION_MM: f64 = 5.6;
const PART_MM: f64 = 4.2;
const TEXT_SIZE_MM: f64 = 3.5;
const FOOTER_MM: f64 = 2.9;
/// Distance of baselines over the size of the type.
const LEADING: f64 = 1.35;
/// Distance of blocks, mm.
const GAP_MM: f64 = 3.0;
/// Width of the picture of a step, and distance to its text, mm.
const STEP_PICTURE_MM: f64 = 104.0;
const GUTTER_MM: f64 = 6.0;
/// Width of a picture without a step, mm.
const PICTURE_MM: f64 = 140.0;
/// Least height below the heading of a section, mm.
const BELOW_HEADING_MM: f64 = 82.0;
/// Indentation of lists, mm.
const INDENT_MM: f64 = 4.0;
/// Gap between columns of a table, mm.
const CELL_GAP_MM: f64 = 4.0;
const RULE_MM: f64 = 0.15;

const INK: Rgb = [0.11, 0.13, 0.15];
const SOFT: Rgb = [0.4, 0.43, 0.47];
const RULE: Rgb = [0.75, 0.77, 0.79];
const BAND: Rgb = [0.81, 0.89, 0.96];
const CURVE: Rgb = [0.1, 0.37, 0.7];
const WARM: Rgb = [0.72, 0.26, 0.06];

pub(super) fn pdf(document: &Document, pictures: &Pictures) -> Vec<u8> {
    let mut writer = Writer::new(pictures);
    writer.title(&document.title);
    for block in &document.blocks {
        writer.block(block);
    }
    writer.finish(&document.title)
}

/// A piece of a line in one typeface.
#[derive(Clone, Debug)]
struct Piece {
    typeface: Typeface,
    text: String,
    /// Distance from the start of the line, mm.
    at_mm: f64,
}

/// Text set in lines.
#[derive(Clone, Debug)]
struct Setting {
    size_mm: f64,
    lines: Vec<Vec<Piece>>,
}

impl Setting {
    /// Breaks a text of the document into lines of at most `width_mm`. A longer word is broken anywhere.
    fn new(text: &str, size_mm: f64, width_mm: f64, base: Typeface) -> Self {
        let mut lines: Vec<Vec<Piece>> = vec![Vec::new()];
        let (mut at, mut space_mm) = (0.0, 0.0);
        for run in runs(text) {
            let typeface = match &run {
                Run::Plain(_) => base,
                Run::Strong(_) => Typeface::Bold,
                Run::Code(_) => Typeface::Typewriter,
            };
            for (number, word) in run.text().split(' ').enumerate() {
                if number > 0 {
                    space_mm = typeface.width_mm(" ", size_mm);
                }
                for part in broken(word, typeface, size_mm, width_mm) {
                    let width = typeface.width_mm(&part, size_mm);
                    if at + space_mm + width > width_mm && at > 0.0 {
                        lines.push(Vec::new());
                        (at, space_mm) = (0.0, 0.0);
                    }
                    let start = if at > 0.0 { at + space_mm } else { 0.0 };
                    at = start + width;
                    space_mm = 0.0;
                    if let Some(line) = lines.last_mut() {
                        line.push(Piece { typeface, text: part, at_mm: start });
                    }
                }
            }
        }
        Self { size_mm, lines }
    }

    fn height_mm(&self) -> f64 {
        self.lines.len() as f64 * self.size_mm * LEADING
    }
}

/// Breaks a word that is wider than a line; no part of an empty word.
fn broken(word: &str, typeface: Typeface, size_mm: f64, width_mm: f64) -> Vec<String> {
    let mut parts: Vec<String> = Vec::new();
    let mut part = String::new();
    for letter in word.chars() {
        part.push(letter);
        if typeface.width_mm(&part, size_mm) > width_mm && part.chars().count() > 1 {
            part.pop();
            parts.push(std::mem::replace(&mut part, letter.to_string()));
        }
    }
    if !part.is_empty() {
        parts.push(part);
    }
    parts
}

/// Pages in progress. Heights are from the upper edge of the page.
struct Writer {
    pages: Vec<Page>,
    /// Height of the next block, mm.
    top_mm: f64,
    pixels: Vec<PngPixels>,
    index: BTreeMap<String, usize>,
}

impl Writer {
    fn new(pictures: &Pictures) -> Self {
        let read: Vec<(&String, PngPixels)> =
            pictures.iter().filter_map(|(name, png)| Some((name, PngPixels::new(png)?))).collect();
        let index = read.iter().enumerate().map(|(i, (name, _))| ((*name).clone(), i)).collect();
        let pixels = read.into_iter().map(|(_, pixels)| pixels).collect();
        Self { pages: vec![Page::default()], top_mm: TOP_MM, pixels, index }
    }

    fn add(&mut self, item: PageItem) {
        if let Some(page) = self.pages.last_mut() {
            page.items.push(item);
        }
    }

    /// Begins a page unless a block of this height fits. Returns whether it did.
    fn reserve(&mut self, height_mm: f64) -> bool {
        let is_full = self.top_mm + height_mm > PAGE_MM[1] - BOTTOM_MM && self.top_mm > TOP_MM;
        if is_full {
            self.pages.push(Page::default());
            self.top_mm = TOP_MM;
        }
        is_full
    }

    /// Writes lines at a height; returns the height below them.
    fn lines(&mut self, setting: &Setting, left_mm: f64, top_mm: f64, colour: Rgb) -> f64 {
        let mut baseline = top_mm + setting.size_mm;
        for line in &setting.lines {
            for piece in line {
                self.add(PageItem::Text {
                    at: [left_mm + piece.at_mm, PAGE_MM[1] - baseline],
                    typeface: piece.typeface,
                    size_mm: setting.size_mm,
                    colour,
                    text: piece.text.clone(),
                });
            }
            baseline += setting.size_mm * LEADING;
        }
        top_mm + setting.height_mm()
    }

    fn title(&mut self, title: &str) {
        let setting =
            Setting::new(&crate::formats::markdown::escape(title), TITLE_MM, WIDTH_MM, Typeface::Bold);
        self.top_mm = self.lines(&setting, SIDE_MM, self.top_mm, INK) + GAP_MM;
    }

    fn block(&mut self, block: &Block) {
        match block {
            Block::Heading { number: Some(number), text } => {
                self.heading(&format!("{number}. {text}"), SECTION_MM, BELOW_HEADING_MM);
            }
            Block::Heading { number: None, text } => self.heading(text, PART_MM, BELOW_HEADING_MM / 2.0),
            Block::Paragraph(text) => self.paragraph(text, 0.0),
            Block::List(points) => {
                for point in points {
                    self.point(point);
                }
                self.top_mm += GAP_MM / 2.0;
            }
            Block::Table(table) => self.table(table),
            Block::Picture { file, .. } => {
                if let Some(picture) = self.index.get(file).copied() {
                    let height = PICTURE_MM * self.pixels[picture].aspect();
                    self.reserve(height);
                    self.picture(picture, [SIDE_MM, self.top_mm], PICTURE_MM);
                    self.top_mm += height + GAP_MM;
                }
            }
            Block::Figure { figure, .. } => self.figure(figure),
            Block::Step(step) => self.step(step),
        }
    }

    fn heading(&mut self, text: &str, size_mm: f64, below_mm: f64) {
        self.reserve(below_mm);
        if self.top_mm > TOP_MM {
            self.top_mm += GAP_MM;
        }
        let setting = Setting::new(text, size_mm, WIDTH_MM, Typeface::Bold);
        self.top_mm = self.lines(&setting, SIDE_MM, self.top_mm, INK) + GAP_MM / 2.0;
    }

    fn paragraph(&mut self, text: &str, indent_mm: f64) {
        let setting = Setting::new(text, TEXT_SIZE_MM, WIDTH_MM - indent_mm, Typeface::Regular);
        self.reserve(setting.height_mm());
        self.top_mm = self.lines(&setting, SIDE_MM + indent_mm, self.top_mm, INK) + GAP_MM;
    }

    fn point(&mut self, text: &str) {
        let setting = Setting::new(text, TEXT_SIZE_MM, WIDTH_MM - INDENT_MM, Typeface::Regular);
        self.reserve(setting.height_mm());
        let y = PAGE_MM[1] - self.top_mm - 0.68 * TEXT_SIZE_MM;
        let dash = [[SIDE_MM, y], [SIDE_MM + 1.6, y]];
        self.add(PageItem::Line { points: dash.to_vec(), width_mm: 0.3, colour: SOFT });
        self.top_mm = self.lines(&setting, SIDE_MM + INDENT_MM, self.top_mm, INK) + GAP_MM / 4.0;
    }

    fn picture(&mut self, picture: usize, [left, top]: [f64; 2], width_mm: f64) {
        let height = width_mm * self.pixels[picture].aspect();
        let (low, right) = (PAGE_MM[1] - top - height, left + width_mm);
        self.add(PageItem::Picture { picture, at: [left, low], size_mm: [width_mm, height] });
        let corners =
            vec![[left, low], [right, low], [right, low + height], [left, low + height], [left, low]];
        self.add(PageItem::Line { points: corners, width_mm: RULE_MM, colour: RULE });
    }

    fn step(&mut self, step: &Step) {
        let name = step.picture.as_ref().map(|(number, _)| step_picture(*number));
        let picture = name.and_then(|name| self.index.get(&name).copied());
        let (left, width) = match picture {
            Some(_) => (SIDE_MM + STEP_PICTURE_MM + GUTTER_MM, WIDTH_MM - STEP_PICTURE_MM - GUTTER_MM),
            None => (SIDE_MM, WIDTH_MM),
        };
        let title = format!("{} {}", step.label(), step.title);
        let mut settings = vec![
            (Setting::new(&title, PART_MM, width, Typeface::Bold), INK),
            (Setting::new(&step.text.join(" "), TEXT_SIZE_MM, width, Typeface::Regular), INK),
        ];
        settings.extend(step.risks.iter().map(|risk| {
            (Setting::new(&Step::risk_text(risk), TEXT_SIZE_MM, width, Typeface::Regular), WARM)
        }));
        let of_text: f64 = settings.iter().map(|(s, _)| s.height_mm() + GAP_MM / 2.0).sum();
        let of_picture = picture.map_or(0.0, |p| STEP_PICTURE_MM * self.pixels[p].aspect());
        let height = of_text.max(of_picture);
        self.reserve(height + GAP_MM);
        let rule = [SIDE_MM, SIDE_MM + WIDTH_MM].map(|x| [x, PAGE_MM[1] - self.top_mm]);
        self.add(PageItem::Line { points: rule.to_vec(), width_mm: RULE_MM, colour: RULE });
        self.top_mm += GAP_MM;
        if let Some(picture) = picture {
            self.picture(picture, [SIDE_MM, self.top_mm], STEP_PICTURE_MM);
        }
        let mut top = self.top_mm;
        for (setting, colour) in &settings {
            top = self.lines(setting, left, top, *colour) + GAP_MM / 2.0;
        }
        self.top_mm += height + GAP_MM;
    }

    fn table(&mut self, table: &Table) {
        let widths = column_widths(table);
        let row = |cells: &[String], typeface: Typeface| -> Vec<Setting> {
            cells
                .iter()
                .zip(&widths)
                .map(|(cell, width)| Setting::new(cell, TEXT_SIZE_MM, *width, typeface))
                .collect()
        };
        let height_mm = |cells: &[Setting]| cells.iter().map(Setting::height_mm).fold(0.0, f64::max);
        let head = row(&table.head, Typeface::Bold);
        let rows: Vec<Vec<Setting>> = table.rows.iter().map(|cells| row(cells, Typeface::Regular)).collect();
        // The titles are above the rows of every page.
        let first_mm = rows.first().map_or(0.0, |cells| height_mm(cells) + GAP_MM);
        self.reserve(height_mm(&head) + first_mm);
        self.row(&head, &widths, height_mm(&head), SOFT);
        for cells in &rows {
            if self.reserve(height_mm(cells) + GAP_MM / 2.0) {
                self.row(&head, &widths, height_mm(&head), SOFT);
            }
            self.row(cells, &widths, height_mm(cells), INK);
        }
        self.top_mm += GAP_MM;
    }

    /// Writes a row of a table, with a line below it.
    fn row(&mut self, cells: &[Setting], widths: &[f64], height_mm: f64, colour: Rgb) {
        let mut left = SIDE_MM;
        for (cell, width) in cells.iter().zip(widths) {
            self.lines(cell, left, self.top_mm, colour);
            left += width + CELL_GAP_MM;
        }
        self.top_mm += height_mm + GAP_MM / 4.0;
        let rule = [SIDE_MM, SIDE_MM + WIDTH_MM].map(|x| [x, PAGE_MM[1] - self.top_mm]);
        self.add(PageItem::Line { points: rule.to_vec(), width_mm: RULE_MM, colour: RULE });
        self.top_mm += GAP_MM / 4.0;
    }

    fn figure(&mut self, figure: &Figure) {
        let scale = (WIDTH_MM / figure.size_mm[0]).min(1.0);
        let height = figure.size_mm[1] * scale;
        self.reserve(height);
        let top = self.top_mm;
        let place = |[x, y]: [f64; 2]| [SIDE_MM + x * scale, PAGE_MM[1] - top - y * scale];
        for shape in &figure.shapes {
            self.add(match shape {
                Shape::Line(ink, points) => PageItem::Line {
                    points: points.iter().copied().map(place).collect(),
                    width_mm: if *ink == Ink::Curve { 0.6 } else { 0.25 },
                    colour: colour(*ink),
                },
                Shape::Area(ink, points) => PageItem::Area {
                    points: points.iter().copied().map(place).collect(),
                    colour: colour(*ink),
                },
                Shape::Text(ink, align, at, text) => {
                    let typeface = if *ink == Ink::Threshold { Typeface::Bold } else { Typeface::Regular };
                    let size_mm = TEXT_MM * scale;
                    let width = typeface.width_mm(text, size_mm);
                    let [x, y] = place(*at);
                    let share = match align {
                        Align::Start => 0.0,
                        Align::Middle => 0.5,
                        Align::End => 1.0,
                    };
                    let at = [x - share * width, y];
                    PageItem::Text { at, typeface, size_mm, colour: colour(*ink), text: text.clone() }
                }
            });
        }
        self.top_mm += height + GAP_MM;
    }

    /// Writes the footers, and the file.
    fn finish(mut self, title: &str) -> Vec<u8> {
        let number = self.pages.len();
        for (i, page) in self.pages.iter_mut().enumerate() {
            let text = format!("{title}, page {} of {number}", i + 1);
            let at = [SIDE_MM, BOTTOM_MM - 9.0];
            page.items.push(PageItem::Text {
                at,
                typeface: Typeface::Regular,
                size_mm: FOOTER_MM,
                colour: SOFT,
                text,
            });
        }
        pages_pdf(&self.pages, &self.pixels, PAGE_MM, title)
    }
}

const fn colour(ink: Ink) -> Rgb {
    match ink {
        Ink::Axis => INK,
        Ink::Band => BAND,
        Ink::Curve => CURVE,
        Ink::Threshold => WARM,
    }
}

/// Widths of the columns: as wide as their longest cells, or narrower in proportion to the square root of these widths, so that
/// short cells stay on one line.
fn column_widths(table: &Table) -> Vec<f64> {
    let room = WIDTH_MM - CELL_GAP_MM * table.head.len().saturating_sub(1) as f64;
    let wanted: Vec<f64> = (0..table.head.len())
        .map(|i| {
            let cells = table.rows.iter().filter_map(|row| row.get(i));
            let of = |text: &str, typeface| {
                let setting = Setting::new(text, TEXT_SIZE_MM, f64::INFINITY, typeface);
                let last = setting.lines.last().and_then(|line| line.last().cloned());
                last.map_or(0.0, |p| p.at_mm + p.typeface.width_mm(&p.text, TEXT_SIZE_MM)) + 0.1
            };
            cells.map(|cell| of(cell, Typeface::Regular)).fold(of(&table.head[i], Typeface::Bold), f64::max)
        })
        .collect();
    let mut widths = wanted.clone();
    // Columns narrower than an equal share keep their width; the others share the rest.
    let mut open: Vec<usize> = (0..wanted.len()).collect();
    let mut rest = room;
    loop {
        let share = rest / open.len().max(1) as f64;
        let (narrow, wide): (Vec<usize>, Vec<usize>) = open.iter().partition(|i| wanted[**i] <= share);
        if narrow.is_empty() || wide.is_empty() {
            break;
        }
        rest -= narrow.iter().map(|i| wanted[*i]).sum::<f64>();
        open = wide;
    }
    if wanted.iter().sum::<f64>() > room {
        let roots: f64 = open.iter().map(|i| wanted[*i].sqrt()).sum();
        for i in open {
            widths[i] = (rest * wanted[i].sqrt() / roots).min(wanted[i].max(rest / wanted.len() as f64));
        }
    }
    widths
}
