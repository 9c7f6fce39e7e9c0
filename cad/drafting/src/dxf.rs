//! DXF (R12), in millimetres of the part.
//!
//! Every view is a block at 1:1, so that measurements in it are those of the part. In model space the sheets are side by
//! side, each scaled so that its main views are 1:1; details are inserted at the scale in their title. The header
//! names the unit in `$INSUNITS`, which later versions define. No time stamp is written.

use std::fmt::Write as _;

use super::geometry::Point;
use super::sheet::{Layer, Shape, Sheet, Text};

/// Distance of sheets, mm of paper.
const GAP_MM: f64 = 20.0;

/// Writes all sheets as DXF.
#[must_use]
pub fn drawing_dxf(sheets: &[Sheet]) -> String {
    let mut text = String::from(
        "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n9\n$MEASUREMENT\n70\n1\n0\nENDSEC\n",
    );
    tables(&mut text);
    text += "0\nSECTION\n2\nBLOCKS\n";
    for sheet in sheets {
        for (i, view) in sheet.views.iter().enumerate() {
            let name = block_name(sheet, i);
            let _ = write!(text, "0\nBLOCK\n8\n0\n2\n{name}\n70\n0\n10\n0\n20\n0\n30\n0\n3\n{name}\n");
            for entity in sheet.entities.iter().filter(|e| e.view == Some(i)) {
                let true_size =
                    Transform { shift: view.origin * (-1.0 / view.scale), factor: 1.0 / view.scale };
                shape(&mut text, entity.layer, &entity.shape, true_size);
            }
            text += "0\nENDBLK\n8\n0\n";
        }
    }
    text += "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
    let mut left = 0.0;
    for sheet in sheets {
        let frame = Transform { shift: Point::new(left, 0.0), factor: 1.0 / sheet.scale };
        left += (sheet.paper.size_mm().0 + GAP_MM) / sheet.scale;
        for (i, view) in sheet.views.iter().enumerate() {
            let (at, factor) = (frame.at(view.origin), n(view.scale * frame.factor));
            let _ = write!(
                text,
                "0\nINSERT\n8\n0\n2\n{}\n10\n{}\n20\n{}\n30\n0\n41\n{factor}\n42\n{factor}\n43\n{factor}\n",
                block_name(sheet, i),
                n(at.x),
                n(at.y)
            );
        }
        for entity in sheet.entities.iter().filter(|e| e.view.is_none()) {
            shape(&mut text, entity.layer, &entity.shape, frame);
        }
    }
    text + "0\nENDSEC\n0\nEOF\n"
}

/// The position of a sheet or a view in the file.
#[derive(Clone, Copy)]
struct Transform {
    shift: Point,
    factor: f64,
}

impl Transform {
    fn at(self, p: Point) -> Point {
        p * self.factor + self.shift
    }
}

/// The name of the block of view `i`. R12 allows 31 letters, digits, `-`, `_` and `$`.
fn block_name(sheet: &Sheet, i: usize) -> String {
    let clean = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' };
    format!("{}_{}", sheet.name, sheet.views[i].name).chars().map(clean).collect()
}

fn tables(text: &mut String) {
    let dashed = Layer::ALL.iter().filter(|l| !l.dashes_mm().is_empty()).count();
    let _ = writeln!(text, "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLTYPE\n70\n{}", 1 + dashed);
    *text += "0\nLTYPE\n2\nCONTINUOUS\n70\n0\n3\nSolid\n72\n65\n73\n0\n40\n0\n";
    for layer in Layer::ALL {
        let dashes = layer.dashes_mm();
        if dashes.is_empty() {
            continue;
        }
        let length: f64 = dashes.iter().sum();
        let _ = write!(
            text,
            "0\nLTYPE\n2\n{}\n70\n0\n3\n{}\n72\n65\n73\n{}\n40\n{}\n",
            layer.name(),
            layer.name(),
            dashes.len(),
            n(length)
        );
        for (i, dash) in dashes.iter().enumerate() {
            let _ = writeln!(text, "49\n{}", n(if i % 2 == 0 { *dash } else { -dash }));
        }
    }
    let _ = write!(text, "0\nENDTAB\n0\nTABLE\n2\nLAYER\n70\n{}\n", 1 + Layer::ALL.len());
    *text += "0\nLAYER\n2\n0\n70\n0\n62\n7\n6\nCONTINUOUS\n";
    for layer in Layer::ALL {
        let dashed = if layer.dashes_mm().is_empty() { "CONTINUOUS" } else { layer.name() };
        // White or black for visible lines, colours for the others: plotters choose pens by colour.
        let colour = match layer {
            Layer::Visible | Layer::Frame | Layer::Text => 7,
            Layer::Hidden => 3,
            Layer::Centre => 1,
            Layer::Dimension => 5,
            Layer::Hatch => 8,
            Layer::Phantom | Layer::Thin => 4,
        };
        let _ = write!(text, "0\nLAYER\n2\n{}\n70\n0\n62\n{colour}\n6\n{dashed}\n", layer.name());
    }
    *text += "0\nENDTAB\n0\nTABLE\n2\nSTYLE\n70\n1\n0\nSTYLE\n2\nSTANDARD\n70\n0\n40\n0\n41\n1\n50\n0\n71\n0\n42\n2.5\n3\narial.ttf\n4\n\n0\nENDTAB\n0\nENDSEC\n";
}

fn shape(text: &mut String, layer: Layer, shape: &Shape, frame: Transform) {
    let layer = layer.name();
    let _ = match shape {
        Shape::Line { from, to } => {
            let (a, b) = (frame.at(*from), frame.at(*to));
            write!(
                text,
                "0\nLINE\n8\n{layer}\n10\n{}\n20\n{}\n30\n0\n11\n{}\n21\n{}\n31\n0\n",
                n(a.x),
                n(a.y),
                n(b.x),
                n(b.y)
            )
        }
        Shape::Circle { centre, radius_mm } => {
            let c = frame.at(*centre);
            let radius = n(radius_mm * frame.factor);
            write!(text, "0\nCIRCLE\n8\n{layer}\n10\n{}\n20\n{}\n30\n0\n40\n{radius}\n", n(c.x), n(c.y))
        }
        Shape::Arc { centre, radius_mm, start_rad, sweep_rad } => {
            let c = frame.at(*centre);
            // An arc runs counter-clockwise from its first angle to its second.
            let (a, b) = (*start_rad, start_rad + sweep_rad);
            let (first, second) = if *sweep_rad > 0.0 { (a, b) } else { (b, a) };
            let degrees = |angle: f64| n(angle.to_degrees().rem_euclid(360.0));
            write!(
                text,
                "0\nARC\n8\n{layer}\n10\n{}\n20\n{}\n30\n0\n40\n{}\n50\n{}\n51\n{}\n",
                n(c.x),
                n(c.y),
                n(radius_mm * frame.factor),
                degrees(first),
                degrees(second)
            )
        }
        Shape::Arrow { tip, direction } => {
            let corners = Shape::arrow_corners(*tip, *direction).map(|p| frame.at(p));
            let mut solid = format!("0\nSOLID\n8\n{layer}\n");
            // A triangle repeats its last corner.
            for (i, p) in corners.iter().chain(corners.last()).enumerate() {
                let _ = write!(solid, "1{i}\n{}\n2{i}\n{}\n3{i}\n0\n", n(p.x), n(p.y));
            }
            write!(text, "{solid}")
        }
        Shape::Text(words) => write!(text, "{}", letters(words, layer, frame)),
    };
}

fn letters(text: &Text, layer: &str, frame: Transform) -> String {
    let at = frame.at(text.at);
    let content: String = text
        .content
        .chars()
        .map(|c| match c {
            '\u{d8}' => "%%c".to_owned(),
            '\u{b0}' => "%%d".to_owned(),
            '\u{b1}' => "%%p".to_owned(),
            '\u{d7}' => "x".to_owned(),
            '%' => "%%%".to_owned(),
            ' '..='~' => c.to_string(),
            // The code of newer versions: R12 has none for other letters.
            _ => format!("\\U+{:04X}", u32::from(c)),
        })
        .collect();
    let rotation = if text.upright { 90 } else { 0 };
    format!(
        "0\nTEXT\n8\n{layer}\n10\n{}\n20\n{}\n30\n0\n40\n{}\n1\n{content}\n50\n{rotation}\n",
        n(at.x),
        n(at.y),
        n(text.height_mm * frame.factor)
    )
}

/// Formats a number with at most nine decimals, without rounding errors of coordinates.
fn n(value: f64) -> String {
    let text = format!("{value:.9}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}
