//! A dimensioned sheet: plan and front view of every part to scale, for a workshop.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::parts::Part;
use crate::prediction::Prediction;
use pinswitch_solid::profile::{Contour, Edge, Point2};
use pinswitch_solid::solid::Facing;

pub(super) const FORMAT: Format =
    Format { name: "drawing", about: "drawing.svg: dimensioned sheet", inclusion: Inclusion::Default, make };

fn make(built: &Built, _: &Prediction, manifest: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let title = format!("{}, made by pinswitch {}", manifest.name, env!("CARGO_PKG_VERSION"));
    let parts: Vec<&Part> = built.printed().iter().map(|p| p.part()).collect();
    Ok(vec![OutputFile::new("drawing.svg", drawing_svg(&title, &parts))])
}

/// Millimetres on paper for a millimetre of the part.
const SCALE: f64 = 2.0;
/// Paper around a view for its dimensions, mm.
const MARGIN_MM: f64 = 16.0;
/// Width of the sheet, mm: A2 on its side.
const SHEET_MM: f64 = 594.0;
/// Least width of a cell, so that its texts fit, mm.
const MIN_CELL_MM: f64 = 92.0;

/// A part's place on the sheet.
struct Cell {
    x: f64,
    y: f64,
    width: f64,
    height: f64,
}

/// The sheet of `parts` as SVG in millimetres, titled `title`.
fn drawing_svg(title: &str, parts: &[&Part]) -> String {
    let mut body = String::new();
    let (mut x, mut y, mut row) = (8.0, 22.0, 0.0f64);
    for part in parts {
        let Some((low, high)) = part.solid.bounds() else { continue };
        let size = high - low;
        let width = (size.x * SCALE + 2.0 * MARGIN_MM).max(MIN_CELL_MM);
        let height = (size.y + size.z) * SCALE + 3.0 * MARGIN_MM + 26.0;
        if x + width > SHEET_MM - 8.0 && x > 8.0 {
            (x, y, row) = (8.0, y + row + 6.0, 0.0);
        }
        body += &cell(part, &Cell { x, y, width, height });
        x += width + 6.0;
        row = row.max(height);
    }
    let sheet_height = y + row + 8.0;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{SHEET_MM}mm\" height=\"{sheet_height:.1}mm\" \
         viewBox=\"0 0 {SHEET_MM} {sheet_height:.1}\" font-family=\"sans-serif\" font-size=\"3.2\" fill=\"none\" \
         stroke=\"#000\" stroke-width=\"0.35\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\" stroke=\"none\"/>\n\
         <g fill=\"#000\" stroke=\"none\"><text x=\"8\" y=\"10\" font-size=\"6\">{}</text>\
         <text x=\"8\" y=\"16\">scale {SCALE}:1, dimensions in mm, first-angle: plan above, front below; the pulley's axis is the cross</text></g>\n\
         {body}</svg>\n",
        escaped(title)
    )
}

fn cell(part: &Part, cell: &Cell) -> String {
    let Some((low, high)) = part.solid.bounds() else { return String::new() };
    let size = high - low;
    let left = cell.x + (cell.width - size.x * SCALE) / 2.0;
    let top = cell.y + MARGIN_MM;
    // The plan's y axis points up, the paper's down.
    let plan = |p: Point2| (left + (p.x - low.x) * SCALE, top + (high.y - p.y) * SCALE);
    let front_top = top + size.y * SCALE + MARGIN_MM;
    let mut text = format!(
        "<g><title>{}</title>\n<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" stroke=\"#aaa\" stroke-width=\"0.2\"/>\n",
        escaped(&part.name),
        cell.x,
        cell.y,
        cell.width,
        cell.height
    );
    // What a cap that faces up borders can be seen from above.
    let from_above: Vec<usize> =
        part.solid.caps().filter(|(facing, _)| *facing == Facing::Up).flat_map(|(_, rings)| rings).collect();
    let mut seen: Vec<&Contour> = Vec::new();
    for (contour, _) in part.solid.rings() {
        if seen.contains(&contour) {
            continue;
        }
        seen.push(contour);
        let visible =
            part.solid.rings().enumerate().any(|(n, (c, _))| c == contour && from_above.contains(&n));
        let dash = if visible { "" } else { " stroke-dasharray=\"1.2 0.8\" stroke-width=\"0.2\"" };
        let _ = writeln!(text, "<path d=\"{}\"{dash}/>", path(contour, plan));
    }
    let axis = plan(Point2::origin());
    // Where it would fall into the front view it is left out.
    let beside_plan = axis.0 > cell.x && axis.0 < cell.x + cell.width;
    if beside_plan && axis.1 > cell.y && axis.1 < front_top - 3.0 {
        let _ = writeln!(
            text,
            "<path d=\"M{:.2} {:.2}h4m-2 -2v4\" stroke=\"#06c\" stroke-width=\"0.2\"/>",
            axis.0 - 2.0,
            axis.1
        );
    }
    text += &front(part, left, front_top);
    let (right, plan_bottom, bottom) =
        (left + size.x * SCALE, top + size.y * SCALE, front_top + size.z * SCALE);
    text += &dimension((left, plan_bottom), (right, plan_bottom), 7.0, size.x);
    text += &dimension((right, top), (right, plan_bottom), 7.0, size.y);
    text += &dimension((right, front_top), (right, bottom), 7.0, size.z);
    let mut line = bottom + 10.0;
    let mut say = |words: &str, size: f64| {
        let _ = writeln!(
            text,
            "<text x=\"{:.2}\" y=\"{line:.2}\" font-size=\"{size}\" fill=\"#000\" stroke=\"none\">{}</text>",
            cell.x + 4.0,
            escaped(words)
        );
        line += size * 1.45;
    };
    say(&part.name, 4.5);
    say(&format!("{:.1} mm3; heights {}", part.solid.volume_mm3(), heights(part)), 2.8);
    for words in features(part) {
        say(&words, 2.8);
    }
    text.push_str("</g>\n");
    text
}

/// The front view: the extent of every wall over its height; walls of holes are dashed.
fn front(part: &Part, left: f64, top: f64) -> String {
    let Some((low, high)) = part.solid.bounds() else { return String::new() };
    let rings: Vec<(&Contour, f64)> = part.solid.rings().collect();
    let at = |x: f64, z: f64| format!("{:.3} {:.3}", left + (x - low.x) * SCALE, top + (high.z - z) * SCALE);
    part.solid.walls().fold(String::new(), |mut text, (lower, upper)| {
        let ((a, low_z), (b, high_z)) = (rings[lower], rings[upper]);
        let ((from, to), (above_from, above_to)) = (a.bounds(), b.bounds());
        let hole = a.area_mm2() < 0.0;
        let dash = if hole { " stroke-dasharray=\"1.2 0.8\" stroke-width=\"0.2\"" } else { "" };
        let _ = writeln!(
            text,
            "<path d=\"M{}L{}L{}L{}Z\"{dash}/>",
            at(from.x, low_z),
            at(to.x, low_z),
            at(above_to.x, high_z),
            at(above_from.x, high_z)
        );
        text
    })
}

fn path(contour: &Contour, plan: impl Fn(Point2) -> (f64, f64)) -> String {
    let start = plan(contour.corners()[0]);
    let mut d = format!("M{:.3} {:.3}", start.0, start.1);
    for (i, edge) in contour.edges().iter().enumerate() {
        let to = plan(contour.ends(i).1);
        let _ = match edge {
            Edge::Line => write!(d, "L{:.3} {:.3}", to.0, to.1),
            Edge::Arc(arc) => {
                let r = arc.radius_mm * SCALE;
                let large = u8::from(arc.sweep_rad.abs() > std::f64::consts::PI);
                // The paper's y axis points down: counter-clockwise in the plan is flag 0.
                let sweep = u8::from(arc.sweep_rad < 0.0);
                write!(d, "A{r:.3} {r:.3} 0 {large} {sweep} {:.3} {:.3}", to.0, to.1)
            }
        };
    }
    d + "Z"
}

/// A dimension line `offset` mm outside the edge from `a` to `b`: below a horizontal one, right of an upright one.
fn dimension(a: (f64, f64), b: (f64, f64), offset: f64, value_mm: f64) -> String {
    let upright = (a.0 - b.0).abs() < 1e-9;
    let shift = |p: (f64, f64), by: f64| if upright { (p.0 + by, p.1) } else { (p.0, p.1 + by) };
    let (from, to) = (shift(a, offset), shift(b, offset));
    let middle = ((from.0 + to.0) / 2.0, (from.1 + to.1) / 2.0);
    let (x, y) = if upright { (middle.0 + 1.0, middle.1 + 1.0) } else { (middle.0, middle.1 - 0.8) };
    let anchor = if upright { "start" } else { "middle" };
    // Slashes mark the ends, as on hand-drawn sheets.
    let tick = |p: (f64, f64)| format!("M{:.2} {:.2}l1.6 -1.6", p.0 - 0.8, p.1 + 0.8);
    let lead = |p: (f64, f64)| {
        let (from, to) = (shift(p, 1.0), shift(p, offset + 1.0));
        format!("M{:.2} {:.2}L{:.2} {:.2}", from.0, from.1, to.0, to.1)
    };
    format!(
        "<path d=\"M{:.2} {:.2}L{:.2} {:.2}{}{}{}{}\" stroke-width=\"0.18\"/>\
         <text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\" fill=\"#000\" stroke=\"none\">{value_mm:.2}</text>\n",
        from.0,
        from.1,
        to.0,
        to.1,
        tick(from),
        tick(to),
        lead(a),
        lead(b)
    )
}

fn heights(part: &Part) -> String {
    let all: Vec<String> = part.solid.heights_mm().iter().map(|z| format!("{z:.2}")).collect();
    all.join(" / ")
}

/// Radii about the axis, circles and small arcs, counted: what the views show but do not dimension.
fn features(part: &Part) -> Vec<String> {
    let (mut axis, mut circles, mut arcs) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
    let mut seen: Vec<&Contour> = Vec::new();
    for (contour, _) in part.solid.rings() {
        if seen.contains(&contour) {
            continue;
        }
        seen.push(contour);
        let whole = contour.edges().len() == 2 && contour.edges().iter().all(|e| matches!(e, Edge::Arc(_)));
        for edge in contour.edges() {
            let Edge::Arc(arc) = edge else { continue };
            let kind = if whole {
                &mut circles
            } else if arc.centre.coords.norm() < 1e-6 {
                &mut axis
            } else {
                &mut arcs
            };
            *kind.entry(format!("{:.3}", arc.radius_mm * if whole { 2.0 } else { 1.0 })).or_insert(0) += 1;
        }
    }
    let listed = |kind: &BTreeMap<String, i32>, mark: &str, half: i32| {
        let all: Vec<String> = kind.iter().map(|(v, n)| format!("{} x {mark}{v}", n / half)).collect();
        all.join(", ")
    };
    let mut lines = Vec::new();
    if !axis.is_empty() {
        let radii: Vec<String> = axis.keys().map(|r| format!("R{r}")).collect();
        lines.push(format!("about the axis: {}", radii.join(", ")));
    }
    if !circles.is_empty() {
        lines.push(format!("circles: {}", listed(&circles, "\u{2300}", 2)));
    }
    if !arcs.is_empty() && arcs.len() <= 6 {
        lines.push(format!("arcs: {}", listed(&arcs, "R", 1)));
    }
    lines
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
