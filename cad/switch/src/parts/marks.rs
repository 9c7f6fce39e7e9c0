//! Marks on the outer faces of the supports: side, layout, and the direction of groove 1 and of the load
//! (cad/doc/dimensions.md, "Label").

use super::label::{EDGE_MM, Engraving, SAME_MM, Zone, engrave_below, largest_mm, sizes_mm};
use super::omission::LeftOut;
use crate::design::Design;
use pinswitch_solid::solid::Solid;

/// The layout of the marks of a support.
struct Marks {
    /// Texts of the rows.
    rows: Vec<String>,
    /// Height of all letters, mm.
    size_mm: f64,
    /// Texts with their zones.
    placed: Vec<(String, Zone)>,
}

/// Engraves the marks of a support into its face on the bed.
pub(super) fn engrave_marks(solid: &mut Solid, design: &Design, is_right: bool) -> Engraving {
    if !design.configuration().label.engrave {
        return Engraving::none(Vec::new());
    }
    let marks = marks(design, is_right);
    let left_out = missing(design, is_right, marks.as_ref());
    let Some(Marks { rows, size_mm, placed }) = marks else { return Engraving::none(left_out) };
    let cut = |(text, zone): &(String, Zone)| engrave_below(solid, design, text, zone, size_mm);
    Engraving { rings: placed.iter().flat_map(cut).collect(), left_out, lines: rows }
}

/// Returns the marks that do not fit on a support.
pub(super) fn left_out(design: &Design, is_right: bool) -> Vec<LeftOut> {
    let is_wanted = design.configuration().label.engrave;
    if is_wanted { missing(design, is_right, marks(design, is_right).as_ref()) } else { Vec::new() }
}

fn missing(design: &Design, is_right: bool, marks: Option<&Marks>) -> Vec<LeftOut> {
    let has = |is_it: &dyn Fn(&String) -> bool| marks.is_some_and(|m| m.rows.iter().any(is_it));
    let label = design.label();
    [
        (LeftOut::Side, has(&|row| row.contains(side(is_right)))),
        (LeftOut::Arrow, has(&|row| has_arrow(row))),
        (LeftOut::Label, has(&|row| row.contains(&label))),
    ]
    .into_iter()
    .filter_map(|(what, is_there)| (!is_there).then_some(what))
    .collect()
}

/// Returns whether an engraved line has the arrow to groove 1.
fn has_arrow(line: &str) -> bool {
    line.contains("1<") || line.contains(">1")
}

const fn side(is_right: bool) -> &'static str {
    if is_right { "R" } else { "L" }
}

/// Returns the most complete set of rows that fits: with the label if possible, and else with the arrow.
fn marks(design: &Design, is_right: bool) -> Option<Marks> {
    let c = design.configuration();
    // A floor that prints must stay over the letters.
    if c.support.plate_mm - c.label.depth_mm < c.print.least_wall_mm {
        return None;
    }
    let (side, label) = (side(is_right), design.label());
    let sets = row_sets(side, &label, is_right);
    let labelled = sets.iter().filter(|rows| rows.iter().any(|row| row.contains(&label)));
    labelled
        .chain(&sets)
        .find_map(|rows| below_each_other(design, rows))
        .or_else(|| split_rows(side, is_right).iter().find_map(|read| on_both_sides_of_holes(design, read)))
        .or_else(|| below_each_other(design, &[side.to_owned()]))
}

/// A word with the arrow to groove 1, on the side of the load: from outside, this is left on the right support and right on the
/// left one.
fn towards_load(word: &str, is_right: bool) -> String {
    if is_right { format!("1<{word}") } else { format!("{word}>1") }
}

/// Sets of rows, from the outside inward, the most complete set first.
fn row_sets(side: &str, label: &str, is_right: bool) -> Vec<Vec<String>> {
    let mark = |word: &str| towards_load(word, is_right);
    let (load, force) = (mark("LOAD"), mark("F"));
    let with_side = |mark: &str| if is_right { format!("{mark} {side}") } else { format!("{side} {mark}") };
    vec![
        vec![format!("{side} {label}"), load.clone()],
        vec![format!("{side} {label}"), force.clone()],
        vec![with_side(&load), label.to_owned()],
        vec![label.to_owned(), with_side(&force)],
        vec![label.to_owned(), mark(side)],
        vec![mark(side), label.to_owned()],
        vec![with_side(&force)],
        vec![mark(side)],
        vec![side.to_owned(), mark("")],
        vec![mark(""), side.to_owned()],
    ]
}

/// Lays out all rows below each other, each between two holes, in letters as large as possible.
fn below_each_other(design: &Design, rows: &[String]) -> Option<Marks> {
    sizes_mm(design).find_map(|size_mm| {
        let layout = |(i, row): (usize, &String)| {
            let zone = Zone::widest(&between_holes(design, i, size_mm)?)?;
            fits(design, row, &zone, size_mm).then(|| (row.clone(), zone))
        };
        let placed: Option<Vec<_>> = rows.iter().enumerate().map(layout).collect();
        Some(Marks { rows: rows.to_vec(), size_mm, placed: placed? })
    })
}

/// Ways to split side and arrow at holes, in reading order: the arrow with its `1`, and letter by letter. A label that needs
/// such a split does not occur on the supports of some 300 designs.
fn split_rows(side: &str, is_right: bool) -> [Vec<String>; 2] {
    let arrow = towards_load("", is_right);
    let letters: Vec<String> = arrow.chars().map(String::from).collect();
    [vec![arrow], letters].map(|mut read| {
        read.insert(if is_right { read.len() } else { 0 }, side.to_owned());
        read
    })
}

/// Lays out the pieces of one row with holes between them, in letters as large as possible.
fn on_both_sides_of_holes(design: &Design, read: &[String]) -> Option<Marks> {
    sizes_mm(design).find_map(|size_mm| {
        // From outside a support is viewed from below: the zone on the right is read first.
        let mut zones = between_holes(design, 0, size_mm)?.into_iter().rev();
        let place = |text: &String| {
            zones.find(|zone| fits(design, text, zone, size_mm)).map(|zone| (text.clone(), zone))
        };
        let placed: Option<Vec<_>> = read.iter().map(place).collect();
        Some(Marks { rows: vec![read.concat()], size_mm, placed: placed? })
    })
}

/// Returns the zones between holes of a row, counted from outside. Rows share the wall between them. `None` for a row beyond
/// the plate.
fn between_holes(design: &Design, row: usize, size_mm: f64) -> Option<Vec<Zone>> {
    let pitch = size_mm + design.configuration().label.stroke_mm + EDGE_MM;
    let top = design.slot().inner_edge_mm() - row as f64 * pitch;
    let bottom = top - pitch - EDGE_MM;
    (bottom > design.inner_radius_mm())
        .then(|| Zone::between_holes(design, design.fastener_along_mm(), bottom, top))
}

fn fits(design: &Design, text: &str, zone: &Zone, size_mm: f64) -> bool {
    largest_mm(design, text, zone).is_some_and(|largest| largest >= size_mm - SAME_MM)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Configuration, assign};

    fn rows(assignments: &[&str], is_right: bool) -> Vec<String> {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        marks(&Design::new(c).unwrap(), is_right).map(|m| m.rows).unwrap_or_default()
    }

    #[test]
    fn supports_have_side_layout_and_arrow() {
        let pins = &["layout.pins=[5, 8, 11]"][..];
        assert_eq!(rows(pins, false), ["3x3/5", "L>1"]);
        assert_eq!(rows(pins, true), ["3x3/5", "1<R"]);
        let wide = &["layout.pins=[5, 8, 11]", "shell.outer_radius_mm=40", "shell.wall_mm=14"][..];
        assert_eq!(rows(wide, false), ["L 3x3/5", "LOAD>1"]);
    }

    #[test]
    fn small_supports_omit_the_layout_first() {
        let small = ["shell.wall_mm=3.5", "fasteners.hole_diameter_mm=1.8", "shell.width_mm=7.5"];
        assert_eq!(rows(&small, false), ["L F>1"]);
        // Two letters fit at most between wide recesses.
        let crowded = [
            "fasteners.hole_diameter_mm=1.8",
            "fasteners.count=5",
            "shell.width_mm=7.5",
            "shell.wall_mm=9",
            "shell.outer_radius_mm=24",
        ];
        for is_right in [false, true] {
            let rows = rows(&crowded, is_right);
            assert!(rows.iter().any(|row| has_arrow(row)), "{rows:?}");
        }
    }
}
