//! PDF: a page for each sheet, in Helvetica, which every reader has.

use pdf_writer::types::LineCapStyle;
use pdf_writer::{Content, Finish as _, Name, Pdf, Rect, Ref, Str, TextStr};

use super::font::CAPITAL_PER_EM;
use super::geometry::Point;
use super::sheet::{Layer, Shape, Sheet, Text};

/// Points in a millimetre.
const POINT_PER_MM: f64 = 72.0 / 25.4;
const FONT: Name<'static> = Name(b"F");

/// Writes all sheets as a PDF with a title. The file contains no date, and is the same on every machine.
#[must_use]
pub fn drawing_pdf(sheets: &[Sheet], title: &str) -> Vec<u8> {
    let number = |i: usize| Ref::new(i32::try_from(i).unwrap_or(i32::MAX));
    let (catalog, tree, font, info) = (number(1), number(2), number(3), number(4));
    let page = |i: usize| number(5 + 2 * i);
    let content = |i: usize| number(6 + 2 * i);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(tree);
    pdf.document_info(info).title(TextStr(title)).producer(TextStr("pinswitch"));
    let count = i32::try_from(sheets.len()).unwrap_or(i32::MAX);
    pdf.pages(tree).kids((0..sheets.len()).map(page)).count(count);
    pdf.type1_font(font).base_font(Name(b"Helvetica")).encoding_predefined(Name(b"WinAnsiEncoding"));
    for (i, sheet) in sheets.iter().enumerate() {
        let (width, height) = sheet.paper.size_mm();
        let mut p = pdf.page(page(i));
        p.media_box(Rect::new(0.0, 0.0, points(width), points(height))).parent(tree).contents(content(i));
        p.resources().fonts().pair(FONT, font);
        p.finish();
        pdf.stream(content(i), &page_content(sheet));
    }
    pdf.finish()
}

#[allow(clippy::cast_possible_truncation)]
pub(super) fn points(mm: f64) -> f32 {
    // Thousandths of a point.
    ((mm * POINT_PER_MM * 1000.0).round() / 1000.0) as f32
}

fn page_content(sheet: &Sheet) -> Vec<u8> {
    let mut content = Content::new();
    for layer in Layer::ALL {
        content.set_line_width(points(layer.width_mm()));
        let dashes = layer.dashes_mm();
        content.set_dash_pattern(dashes.iter().map(|d| points(*d)), 0.0);
        content.set_line_cap(if dashes.is_empty() { LineCapStyle::RoundCap } else { LineCapStyle::ButtCap });
        for entity in sheet.entities.iter().filter(|e| e.layer == layer) {
            draw(&mut content, &entity.shape);
        }
    }
    content.finish().to_vec()
}

fn draw(content: &mut Content, shape: &Shape) {
    match shape {
        Shape::Line { from, to } => {
            content.move_to(points(from.x), points(from.y)).line_to(points(to.x), points(to.y)).stroke();
        }
        Shape::Arc { centre, radius_mm, start_rad, sweep_rad } => {
            arc(content, *centre, *radius_mm, *start_rad, *sweep_rad);
        }
        Shape::Circle { centre, radius_mm } => {
            arc(content, *centre, *radius_mm, 0.0, std::f64::consts::TAU);
        }
        Shape::Arrow { tip, direction } => {
            let [a, b, c] = Shape::arrow_corners(*tip, *direction);
            content.move_to(points(a.x), points(a.y));
            content.line_to(points(b.x), points(b.y)).line_to(points(c.x), points(c.y));
            content.close_path().fill_nonzero();
        }
        Shape::Text(text) => write(content, text),
    }
}

/// Draws an arc as cubic curves of at most 90 degrees, within 0.03 % of the radius.
fn arc(content: &mut Content, centre: Point, radius_mm: f64, start_rad: f64, sweep_rad: f64) {
    let number = (sweep_rad.abs() / std::f64::consts::FRAC_PI_2).ceil().max(1.0);
    let step = sweep_rad / number;
    let handle = 4.0 / 3.0 * libm::tan(step / 4.0) * radius_mm;
    let at = |angle: f64| centre + Point::towards(angle) * radius_mm;
    let from = at(start_rad);
    content.move_to(points(from.x), points(from.y));
    for i in 0..number as u32 {
        let (a, b) = (start_rad + step * f64::from(i), start_rad + step * f64::from(i + 1));
        let first = at(a) + Point::towards(a).left() * handle;
        let second = at(b) - Point::towards(b).left() * handle;
        let to = at(b);
        content.cubic_to(
            points(first.x),
            points(first.y),
            points(second.x),
            points(second.y),
            points(to.x),
            points(to.y),
        );
    }
    content.stroke();
}

/// Encodes a text. `WinAnsiEncoding` has the letters of western Europe; others become question marks.
pub(super) fn encoded(text: &str) -> Vec<u8> {
    text.chars()
        .map(|c| match u32::from(c) {
            code @ (0x20..=0x7e | 0xa0..=0xff) => u8::try_from(code).unwrap_or(b'?'),
            _ => b'?',
        })
        .collect()
}

fn write(content: &mut Content, text: &Text) {
    let bytes = encoded(&text.content);
    let (x, y) = (points(text.at.x), points(text.at.y));
    let matrix = if text.upright { [0.0, 1.0, -1.0, 0.0, x, y] } else { [1.0, 0.0, 0.0, 1.0, x, y] };
    content.begin_text();
    content.set_font(FONT, points(text.height_mm / CAPITAL_PER_EM));
    content.set_text_matrix(matrix).show(Str(&bytes));
    content.end_text();
}
