//! Whether the printed parts fit on the print bed, by their exact outlines.

use super::{Part, Role, printed, reference_bodies};
use crate::config::{ConfigError, Location};
use crate::design::Design;
use crate::design::rules::Direction::{self, Lower, Raise, Restore, Set};
use pinswitch_diagnostic::codes;
use pinswitch_solid::files::{BED_EDGE_MM, Box3, needed_bed_mm};

/// Checks that each of `parts` fits on the bed.
///
/// # Errors
/// [`ConfigError`] names the part that needs the largest bed, its size, and the bed.
pub fn fit_on_bed(parts: &[Part], design: &Design) -> Result<(), ConfigError> {
    let bed_mm = design.configuration().print.bed_mm;
    match largest(parts) {
        Some((part, needed_mm, (low, high))) if needed_mm > bed_mm => {
            let problem = format!(
                "bed too small for {} ({:.1} x {:.1} mm, with {BED_EDGE_MM} mm free along each edge)",
                part.name,
                high.x - low.x,
                high.y - low.y
            );
            let location = Location::field("print.bed_mm", bed_mm.to_string());
            Err(ConfigError::new(codes::PART_EXCEEDS_BED, problem).with_location(location))
        }
        _ => Ok(()),
    }
}

/// Returns the part that needs the largest bed, the side of that bed, and the bounds of the part.
fn largest(parts: &[Part]) -> Option<(&Part, f64, Box3)> {
    let needs = |part: &Part| part.solid.bounds().map(|bounds| (needed_bed_mm(&bounds), bounds));
    parts
        .iter()
        .filter_map(|part| needs(part).map(|(needed_mm, bounds)| (part, needed_mm, bounds)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Whether all outlines of a design can be constructed and all printed parts fit on its bed. Cheaper than building.
pub(crate) fn can_be_printed(design: &Design) -> bool {
    printed(design).is_ok_and(|parts| fit_on_bed(&parts, design).is_ok()) && reference_bodies(design).is_ok()
}

/// Returns directions that make room on the bed for the largest part: a larger bed, a smaller part, or none.
pub(crate) fn room_on_bed(design: &Design) -> Vec<Direction> {
    let parts = printed(design).unwrap_or_default();
    largest(&parts).map_or_else(Vec::new, |(part, ..)| smaller(part).to_vec())
}

fn smaller(part: &Part) -> &'static [Direction] {
    const BED: Direction = Raise("print.bed_mm");
    match (part.role, part.name.as_str()) {
        (_, "coupon") => &[BED, Set("parts.coupon", "false")],
        (_, "guide-pulley" | "guide-pulley-2") => {
            &[BED, Set("parts.guide_pulley", "false"), Set("mount.kind", "\"none\"")]
        }
        (Role::Mould, "mould-tray") => &[BED, Lower("shell.outer_radius_mm"), Restore("mould.wall_mm")],
        (Role::Mount | Role::Stand | Role::DistalLink, _) => &[
            BED,
            Lower("mount.proximal_mm"),
            Lower("mount.distal_mm"),
            Lower("mount.pulley_distance_mm"),
            Lower("mount.rim_mm"),
            Set("mount.kind", "\"none\""),
        ],
        _ => &[
            BED,
            Lower("shell.outer_radius_mm"),
            Lower("segment.span_deg"),
            Restore("segment.end_margin_mm"),
            Restore("mould.wall_mm"),
        ],
    }
}
