//! Texts of the sheets of a switch: materials, general tolerances, notes, and the meaning of marks.

use super::fits::is_coupon;
use crate::design::Design;
use crate::documents::layout_text;
use crate::parts::{Part, Role, Substance};
use pinswitch_drafting::{lettering, number};

/// The material in the title block.
pub(super) fn material(design: &Design, material: Substance) -> String {
    match material {
        Substance::Plastic => format!("{}, printed", design.configuration().process.material.data().name),
        Substance::Silicone => {
            format!("Silicone, {} Shore A", number(design.configuration().silicone.hardness_shore_a))
        }
        Substance::Steel => design.configuration().process.pins.material().to_owned(),
    }
}

/// Width of the zone of the general profile of surfaces of printed parts, mm: twice the tolerance of printed heights,
/// 0.254 mm + 0.1 % of some 30 mm, rounded.
const GENERAL_PROFILE_MM: f64 = 0.6;

/// The general tolerances in the title block: of sizes by ISO 2768-1, of geometry by ISO 22081, and of cast parts by
/// ISO 3302-1.
pub(super) fn general_tolerance(material: Substance) -> String {
    match material {
        Substance::Plastic => {
            format!("ISO 2768-1 c (milled: m); profile of surfaces {GENERAL_PROFILE_MM} (ISO 22081)")
        }
        Substance::Silicone => "ISO 3302-1 M3, cast".to_owned(),
        Substance::Steel => "ISO 2768-1 m".to_owned(),
    }
}

/// The surface texture in the title block; empty without a requirement.
pub(super) fn surface_texture(part: &Part) -> &'static str {
    match part.role {
        // The silicone copies the walls of its mould.
        Role::Layer | Role::Mould => "Ra 12.5 where it forms the layer",
        Role::Pin { .. } => "Ra 0.8",
        _ => "",
    }
}

/// Returns the note about the engravings of a part.
pub(super) fn engraving(design: &Design, part: &Part) -> Option<String> {
    if !lettering(&part.solid).contains(&true) {
        return None;
    }
    let what = if is_coupon(part) { "the slots' clearances".to_owned() } else { part.engraved.join(", ") };
    // The marks of supports are on the face that is printed on the bed.
    let face = if matches!(part.role, Role::Support { .. }) { " in the far face" } else { "" };
    Some(format!("Engraved{face}: {what}, {} deep", number(design.configuration().label.depth_mm)))
}

/// Notes about the manufacture of a part.
pub(super) fn notes(design: &Design, part: &Part) -> Vec<String> {
    let m = &design.configuration().mould;
    let mut notes = Vec::new();
    if part.name == "mould-tray" && m.overfill_mm > 0.0 && m.draft_deg > 0.0 {
        notes.push(format!("Walls of the basin: draft {}\u{b0}", number(m.draft_deg)));
    }
    if is_coupon(part) {
        notes.push("Slot widths and groove radii: no tolerance,".to_owned());
        notes.push("the coupon measures the machine".to_owned());
    }
    notes
}

/// The meaning of the marks of a part, and the omitted features.
pub(super) fn legend(design: &Design, part: &Part) -> Vec<String> {
    let mut notes = Vec::new();
    if part.engraved.iter().any(|line| line.contains(&design.label())) {
        notes.push(layout(design));
    }
    notes.extend(marks(&part.engraved));
    notes.extend(part.left_out_notes(design));
    notes
}

/// The meaning of the label of a layout: the grooves with pins.
pub(super) fn layout(design: &Design) -> String {
    format!("Layout {}", layout_text(design.configuration()))
}

/// The meaning of the arrow on a support.
pub(super) fn marks(engraved: &[String]) -> Option<String> {
    let arrow = ["1<", ">1"].into_iter().find(|arrow| engraved.iter().any(|line| line.contains(arrow)))?;
    let is_named = |name: &&str| engraved.iter().any(|line| line.contains(name));
    let name = ["LOAD", "F"].into_iter().find(is_named).map_or_else(String::new, |name| format!(" ({name})"));
    Some(format!("{arrow}: direction of groove 1 and of the load{name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arrow_is_explained() {
        let engraved = |lines: &[&str]| marks(&lines.iter().map(|l| (*l).to_owned()).collect::<Vec<_>>());
        assert_eq!(engraved(&["1<F R"]).unwrap(), "1<: direction of groove 1 and of the load (F)");
        assert_eq!(engraved(&["418"]), None);
    }
}
