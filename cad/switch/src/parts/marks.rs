//! Marks on the outer faces of the supports, which stay visible: which side it is, which layout, where groove 1 is and
//! where the load pulls (cad/doc/dimensions.md, "Label").

use super::label::{EDGE_MM, Engraving, SAME_MM, Zone, engrave_below, largest_mm, least_height_mm, left_out};
use crate::design::Design;
use pinswitch_solid::solid::Solid;

/// Steps in which smaller letters are tried, mm.
const STEP_MM: f64 = 0.1;

/// Engraves the marks of a support into its face on the bed.
pub(super) fn engrave_marks(solid: &mut Solid, design: &Design, is_right: bool) -> Engraving {
    let c = design.configuration();
    if !c.label.engrave {
        return Engraving::none(None);
    }
    let side = if is_right { "R" } else { "L" };
    let least_floor =
        c.print.least_wall_mm.max(c.support.plate_mm - c.support.plate_mm.max(c.label.depth_mm));
    if c.support.plate_mm - c.label.depth_mm < least_floor {
        return Engraving::none(Some(left_out(side)));
    }
    let wanted = row_sets(side, &design.label(), is_right);
    let found = wanted.iter().find_map(|rows| Some((rows, fitted(design, rows)?)));
    let Some((rows, (size, zones))) = found else {
        return Engraving::none(Some(left_out(side)));
    };
    let rings = rows
        .iter()
        .zip(&zones)
        .flat_map(|(row, zone)| engrave_below(solid, design, row, zone, size))
        .collect();
    let is_whole = rows.concat().contains(&design.label());
    let note = (!is_whole).then(|| left_out(&design.label()));
    Engraving { rings, note, lines: rows.clone() }
}

/// Rows from the outside inward, the fullest set first. Groove 1 is on the load's side, to which the arrow points: seen
/// from outside it lies to the left on the right support, and to the right on the left one.
fn row_sets(side: &str, label: &str, is_right: bool) -> Vec<Vec<String>> {
    let mark = |word: &str| if is_right { format!("1<{word}") } else { format!("{word}>1") };
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
        vec![side.to_owned()],
    ]
}

/// The largest letters in which all rows fit below each other, with the zone of each.
fn fitted(design: &Design, rows: &[String]) -> Option<(f64, Vec<Zone>)> {
    let c = design.configuration();
    let stroke = c.label.stroke_mm;
    let (inner, outer) = (design.inner_radius_mm(), design.slot().inner_edge_mm());
    let reach = design.fastener_along_mm();
    let least = least_height_mm(design);
    let steps = ((c.label.height_mm - least) / STEP_MM + SAME_MM).floor();
    // From the configured height down, the least included.
    let sizes = std::iter::successors(Some(0.0), |step: &f64| (*step < steps).then_some(step + 1.0))
        .map(|step| c.label.height_mm - step * STEP_MM)
        .filter(|size| *size >= least - SAME_MM)
        .chain((c.label.height_mm >= least - SAME_MM).then_some(least));
    for size in sizes {
        // Rows share the wall between them.
        let pitch = size + stroke + EDGE_MM;
        let zone = |i: usize| {
            let top = outer - i as f64 * pitch;
            (top - pitch - EDGE_MM > inner)
                .then(|| Zone::between_holes(design, reach, top - pitch - EDGE_MM, top))
        };
        let zones: Option<Vec<Zone>> = (0..rows.len()).map(zone).collect();
        let fits = |(row, zone): (&String, &Zone)| {
            largest_mm(design, row, zone).is_some_and(|s| s >= size - SAME_MM)
        };
        if let Some(zones) = zones.filter(|zones| rows.iter().zip(zones).all(fits)) {
            return Some((size, zones));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Configuration, assign};

    fn rows(assignments: &[&str], is_right: bool) -> Option<Vec<String>> {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        let design = Design::new(c).unwrap();
        let side = if is_right { "R" } else { "L" };
        row_sets(side, &design.label(), is_right).into_iter().find(|rows| fitted(&design, rows).is_some())
    }

    #[test]
    fn both_supports_say_side_layout_groove_and_load() {
        let pins = &["layout.pins=[5, 8, 11]"][..];
        assert_eq!(rows(pins, false).unwrap(), ["3x3/5", "L>1"]);
        assert_eq!(rows(pins, true).unwrap(), ["3x3/5", "1<R"]);
        let wide = &["layout.pins=[5, 8, 11]", "shell.outer_radius_mm=40", "shell.wall_mm=14"][..];
        assert_eq!(rows(wide, false).unwrap(), ["L 3x3/5", "LOAD>1"]);
    }

    #[test]
    fn small_supports_keep_the_side_and_the_load_before_the_layout() {
        let small =
            rows(&["shell.wall_mm=3.5", "fasteners.hole_diameter_mm=1.8", "shell.width_mm=7.5"], false);
        assert!(small.is_none_or(|rows| rows[0].starts_with('L')));
    }
}
