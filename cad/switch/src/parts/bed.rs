//! Whether the printed parts fit on the print bed, by their exact outlines.

use super::{Part, Role};
use crate::config::ConfigError;
use crate::design::Design;
use pinswitch_solid::files::{BED_EDGE_MM, needed_bed_mm};

/// Whether each of `parts` fits on the bed by itself.
///
/// # Errors
/// [`ConfigError`] names the part that needs the largest bed, its size, the bed, and what to change.
pub fn fit_on_bed(parts: &[Part], design: &Design) -> Result<(), ConfigError> {
    let bed_mm = design.configuration().print.bed_mm;
    let needs = |part: &Part| part.solid.bounds().map(|bounds| (needed_bed_mm(&bounds), bounds));
    let largest = parts
        .iter()
        .filter_map(|part| needs(part).map(|(needed_mm, bounds)| (part, needed_mm, bounds)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    match largest {
        Some((part, needed_mm, (low, high))) if needed_mm > bed_mm => Err(ConfigError {
            field: "print.bed_mm".to_owned(),
            value: Some(bed_mm.to_string()),
            problem: format!(
                "is too small for {}: it is {:.1} x {:.1} mm, and {BED_EDGE_MM} mm stay free along each edge",
                part.name,
                high.x - low.x,
                high.y - low.y
            ),
            remedy: format!("raise it to {}, or {}", (needed_mm * 10.0).ceil() / 10.0, smaller(part)),
            changes: vec![("print.bed_mm".to_owned(), ((needed_mm * 10.0).ceil() / 10.0).to_string())],
            place: None,
        }),
        _ => Ok(()),
    }
}

/// What makes a part smaller, or leaves it out.
fn smaller(part: &Part) -> &'static str {
    match (part.role, part.name.as_str()) {
        (_, "coupon") => "leave the coupon out: parts.coupon = false",
        (_, "guide-pulley") => {
            "leave the pulley out: parts.guide_pulley = false, and mount.kind other than rig"
        }
        (Role::Mould, "mould-tray") => "lower mould.layers, mould.wall_mm or shell.outer_radius_mm",
        (Role::Mould, _) => "lower mould.wall_mm or shell.outer_radius_mm",
        (Role::Mount, _) => "lower mount.bore_distance_mm, mount.pulley_distance_mm or mount.rim_mm",
        _ => "lower shell.outer_radius_mm or segment.span_deg",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Configuration, assign};
    use crate::parts::printed;

    fn said(assignments: &[&str]) -> Result<(), String> {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        let design = Design::new(c).unwrap();
        fit_on_bed(&printed(&design).unwrap(), &design).map_err(|e| e.to_string())
    }

    #[test]
    fn the_largest_part_is_named_with_a_bed_that_takes_it() {
        let refusal = said(&["print.bed_mm=55"]).unwrap_err();
        assert!(refusal.starts_with("print.bed_mm = 55 is too small for coupon: it is 54.5 x "), "{refusal}");
        let (_, wanted) = refusal.split_once("raise it to ").unwrap();
        let (wanted, _) = wanted.split_once(',').unwrap();
        assert_eq!(said(&[&format!("print.bed_mm={wanted}")]), Ok(()));
        let less = wanted.parse::<f64>().unwrap() - 0.2;
        assert!(said(&[&format!("print.bed_mm={less}")]).is_err());
        // The other way out that it names.
        assert_eq!(said(&["print.bed_mm=55", "parts.coupon=false"]), Ok(()));
    }
}
