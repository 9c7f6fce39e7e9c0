//! Whether the printed parts fit on the print bed, by their exact outlines.

use super::{Part, Role, printed};
use crate::config::{ConfigError, Configuration};
use crate::design::Design;
use crate::design::rules::Change::{self, Ease, Lower, Raise, Set};
use crate::design::rules::{Effort, ways_out};
use pinswitch_solid::files::{BED_EDGE_MM, Box3, needed_bed_mm};

/// Whether each of `parts` fits on the bed by itself.
///
/// # Errors
/// [`ConfigError`] names the part that needs the largest bed, its size, the bed, and what to change: each of the values it
/// names was tried, with all parts that are printed.
pub fn fit_on_bed(parts: &[Part], design: &Design) -> Result<(), ConfigError> {
    let c = design.configuration();
    let bed_mm = c.print.bed_mm;
    match largest(parts) {
        Some((part, needed_mm, (low, high))) if needed_mm > bed_mm => {
            // Other parts may be wanted here than are printed by default: a batch makes some.
            let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
            let fits = |changed: &Configuration| {
                let mut on_this_bed = changed.clone();
                on_this_bed.print.bed_mm = bed_mm;
                // A bed changes no part.
                (on_this_bed == *c && needed_mm <= changed.print.bed_mm)
                    || (on_this_bed != *c && all_fit(changed, &names))
            };
            let (remedy, changes) = ways_out("print.bed_mm", c, smaller(part), &fits, Effort::THOROUGH);
            Err(ConfigError {
                field: "print.bed_mm".to_owned(),
                value: Some(bed_mm.to_string()),
                problem: format!(
                    "is too small for {}: it is {:.1} x {:.1} mm, and {BED_EDGE_MM} mm stay free along each edge",
                    part.name,
                    high.x - low.x,
                    high.y - low.y
                ),
                remedy: if remedy.is_empty() { "make the switch smaller".to_owned() } else { remedy },
                changes,
                place: None,
            })
        }
        _ => Ok(()),
    }
}

/// The part that needs the largest bed, with the side of it.
fn largest(parts: &[Part]) -> Option<(&Part, f64, Box3)> {
    let needs = |part: &Part| part.solid.bounds().map(|bounds| (needed_bed_mm(&bounds), bounds));
    parts
        .iter()
        .filter_map(|part| needs(part).map(|(needed_mm, bounds)| (part, needed_mm, bounds)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Whether a configuration can be built and its parts of these names lie on its bed.
fn all_fit(configuration: &Configuration, names: &[&str]) -> bool {
    Design::new(configuration.clone()).and_then(|design| printed(&design)).is_ok_and(|mut parts| {
        parts.retain(|part| names.contains(&part.name.as_str()));
        largest(&parts).is_none_or(|(_, needed_mm, _)| needed_mm <= configuration.print.bed_mm)
    })
}

/// Whether all parts of a design can be built and lie on its bed: for a search, which shows no error.
pub(crate) fn can_be_printed(design: &Design) -> bool {
    let bed_mm = design.configuration().print.bed_mm;
    printed(design).is_ok_and(|parts| largest(&parts).is_none_or(|(_, needed_mm, _)| needed_mm <= bed_mm))
}

/// What makes room for a part: a larger bed, a smaller part, or none.
fn smaller(part: &Part) -> &'static [Change] {
    const BED: Change = Raise("print.bed_mm");
    match (part.role, part.name.as_str()) {
        (_, "coupon") => &[BED, Set("parts.coupon", "false")],
        (_, "guide-pulley") => &[BED, Set("parts.guide_pulley", "false"), Set("mount.kind", "\"none\"")],
        (Role::Mould, "mould-tray") => {
            &[BED, Lower("mould.layers"), Lower("shell.outer_radius_mm"), Ease("mould.wall_mm")]
        }
        (Role::Mount, _) => &[
            BED,
            Lower("mount.bore_distance_mm"),
            Lower("mount.pulley_distance_mm"),
            Lower("mount.rim_mm"),
            Set("mount.kind", "\"none\""),
        ],
        _ => &[
            BED,
            Lower("shell.outer_radius_mm"),
            Lower("segment.span_deg"),
            Ease("segment.end_margin_mm"),
            Ease("mould.wall_mm"),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::assign;

    fn said(assignments: &[&str]) -> Result<(), ConfigError> {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        let design = Design::new(c)?;
        fit_on_bed(&printed(&design)?, &design)
    }

    #[test]
    fn the_largest_part_is_named_and_each_way_out_leads_out() {
        for (set, part, ways) in [
            (&["print.bed_mm=55"][..], "coupon", 2),
            (&["shell.outer_radius_mm=60", "print.bed_mm=80"], "mould-core", 2),
            (&["shell.outer_radius_mm=120", "print.bed_mm=180"], "mould-core", 3),
            (&["mould.kind=none", "shell.outer_radius_mm=100", "print.bed_mm=140"], "support-right", 2),
            (&["mould.kind=one-piece", "mould.layers=12", "print.bed_mm=100"], "mould-tray", 2),
            (&["mount.kind=rig", "print.bed_mm=100"], "rig-plate", 2),
            (&["parts.guide_pulley=true", "parts.coupon=false", "print.bed_mm=50"], "guide-pulley", 1),
        ] {
            let Err(error) = said(set) else { panic!("{set:?} fits") };
            assert!(
                error.problem.starts_with(&format!("is too small for {part}: it is ")),
                "{set:?}: {error}"
            );
            let words = error.remedy.replace(", or ", "|").replace(" or ", "|").replace(", ", "|");
            let named: Vec<(String, String)> = words.split('|').map(assignment).collect();
            assert!(named.len() >= ways, "{set:?}: {error}");
            for (field, value) in named {
                let with = |value: String| {
                    let set: Vec<String> =
                        set.iter().map(|s| (*s).to_owned()).chain([format!("{field}={value}")]).collect();
                    said(&set.iter().map(String::as_str).collect::<Vec<_>>())
                };
                assert_eq!(with(value.clone()), Ok(()), "{set:?}: {error}");
                if field == "print.bed_mm" {
                    let smaller = value.parse::<f64>().unwrap() - 0.002;
                    assert!(with(smaller.to_string()).is_err(), "{set:?}: {error}");
                }
            }
        }
    }

    /// `raise it to 60.5`, `lower shell.wall_mm to 2`, `set parts.coupon = false`: the field and its value.
    fn assignment(way: &str) -> (String, String) {
        let (field, value) = match way.split(' ').collect::<Vec<_>>()[..] {
            [_, "it", "to", value] => ("print.bed_mm", value),
            [_, field, "to", value] | ["set", field, "=", value] => (field, value.trim_matches('"')),
            _ => panic!("{way}"),
        };
        (field.to_owned(), value.to_owned())
    }

    #[test]
    fn a_part_that_fits_to_a_hair_is_not_refused() {
        let Err(error) = said(&["print.bed_mm=70", "shell.outer_radius_mm=60"]) else { panic!() };
        let (_, bed) = &error.changes[0];
        assert_eq!(said(&[&format!("print.bed_mm={bed}"), "shell.outer_radius_mm=60"]), Ok(()));
    }
}
