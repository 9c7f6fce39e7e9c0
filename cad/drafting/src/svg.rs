//! SVG: all sheets, one below another.

use std::fmt::Write as _;

use super::font::CAPITAL_PER_EM;
use super::geometry::Point;
use super::sheet::{Entity, Layer, Shape, Sheet, Text};
use crate::escape::escape;

/// Distance of sheets, mm.
const GAP_MM: f64 = 8.0;

/// Writes all sheets, one below another, in millimetres. In a browser, `drawing.svg#NAME` shows the sheet of that name.
#[must_use]
pub fn drawing_svg(sheets: &[Sheet], title: &str) -> String {
    let width = sheets.iter().map(|s| s.paper.size_mm().0).fold(0.0, f64::max);
    let tops: Vec<f64> = sheets
        .iter()
        .scan(0.0, |top, sheet| {
            let at = *top;
            *top += sheet.paper.size_mm().1 + GAP_MM;
            Some(at)
        })
        .collect();
    let height = sheets.iter().map(|s| s.paper.size_mm().1 + GAP_MM).sum::<f64>() - GAP_MM;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">\n\
         <title>{}</title>\n<style>{}</style>\n",
        escape(title),
        styles()
    );
    for (sheet, top) in sheets.iter().zip(&tops) {
        let (w, h) = sheet.paper.size_mm();
        let _ = writeln!(
            text,
            "<view id=\"{}\" preserveAspectRatio=\"xMinYMin meet\" viewBox=\"0 {top} {w} {h}\"/>",
            escape(&sheet.name)
        );
    }
    for (sheet, top) in sheets.iter().zip(&tops) {
        let (w, h) = sheet.paper.size_mm();
        let _ = write!(
            text,
            "<svg y=\"{top}\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\"><title>{}</title>\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n",
            escape(&sheet.name)
        );
        for layer in Layer::ALL {
            text += &layer_group(sheet, layer, h);
        }
        text += "</svg>\n";
    }
    text + "</svg>\n"
}

fn styles() -> String {
    let mut text = "path,circle{fill:none;stroke:#000;stroke-linecap:round}text{font-family:Helvetica,Arial,\"Liberation Sans\",\"Nimbus Sans\",sans-serif}.a{fill:#000;stroke:none}".to_owned();
    for layer in Layer::ALL {
        let dashes: Vec<String> = layer.dashes_mm().iter().map(ToString::to_string).collect();
        let dashed = if dashes.is_empty() {
            String::new()
        } else {
            format!(";stroke-dasharray:{};stroke-linecap:butt", dashes.join(" "))
        };
        let name = layer.name();
        let _ = write!(text, ".{name} path,.{name} circle{{stroke-width:{}{dashed}}}", layer.width_mm());
    }
    text
}

fn layer_group(sheet: &Sheet, layer: Layer, height: f64) -> String {
    let mut body = String::new();
    for Entity { shape, .. } in sheet.entities.iter().filter(|e| e.layer == layer) {
        let _ = match shape {
            Shape::Line { from, to } => {
                write!(
                    body,
                    "<path d=\"M{} {}L{} {}\"/>",
                    n(from.x),
                    n(height - from.y),
                    n(to.x),
                    n(height - to.y)
                )
            }
            Shape::Circle { centre, radius_mm } => {
                write!(
                    body,
                    "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
                    n(centre.x),
                    n(height - centre.y),
                    n(*radius_mm)
                )
            }
            Shape::Arc { centre, radius_mm, start_rad, sweep_rad } => {
                let at = |a: f64| *centre + Point::towards(a) * *radius_mm;
                let (from, to) = (at(*start_rad), at(start_rad + sweep_rad));
                let large = u8::from(sweep_rad.abs() > std::f64::consts::PI);
                // The y axis of SVG points down: counter-clockwise on paper is flag 0.
                let flag = u8::from(*sweep_rad < 0.0);
                write!(
                    body,
                    "<path d=\"M{} {}A{r} {r} 0 {large} {flag} {} {}\"/>",
                    n(from.x),
                    n(height - from.y),
                    n(to.x),
                    n(height - to.y),
                    r = n(*radius_mm)
                )
            }
            Shape::Arrow { tip, direction } => {
                let [a, b, c] =
                    Shape::arrow_corners(*tip, *direction).map(|p| format!("{} {}", n(p.x), n(height - p.y)));
                write!(body, "<path class=\"a\" d=\"M{a}L{b}L{c}Z\"/>")
            }
            Shape::Text(text) => write!(body, "{}", text_element(text, height)),
        };
        body.push('\n');
    }
    if body.is_empty() { body } else { format!("<g class=\"{}\">\n{body}</g>\n", layer.name()) }
}

fn text_element(text: &Text, height: f64) -> String {
    let (x, y) = (n(text.at.x), n(height - text.at.y));
    let rotation = if text.upright { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
    // A fixed length, so that a font with other widths fits.
    format!(
        "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" textLength=\"{}\" lengthAdjust=\"spacingAndGlyphs\"{rotation}>{}</text>",
        n(text.height_mm / CAPITAL_PER_EM),
        n(text.width_mm()),
        escape(&text.content)
    )
}

/// Formats a length with micrometres.
fn n(mm: f64) -> String {
    let text = format!("{mm:.3}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([n(1.0), n(-0.0001), n(2.50049), n(100.0)], ["1", "0", "2.5", "100"]);
    }
}
