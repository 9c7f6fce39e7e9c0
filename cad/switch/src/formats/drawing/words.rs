//! Texts of the sheets of a switch: materials, general tolerances, notes, and the meaning of marks.

use super::fits::is_coupon;
use crate::design::Design;
use crate::parts::{Material, Part, Role};
use pinswitch_drafting::{lettering, number};

/// The material in the title block.
pub(super) fn material(design: &Design, material: Material) -> String {
    match material {
        Material::Abs => "ABS, printed".to_owned(),
        Material::Silicone => {
            format!("Silicone, {} Shore A", number(design.configuration().silicone.hardness_shore_a))
        }
        Material::Steel => "Steel, polished".to_owned(),
    }
}

/// The general tolerance in the title block.
pub(super) const fn general_tolerance(material: Material) -> &'static str {
    match material {
        Material::Abs => "ISO 2768-c printed, -m machined",
        Material::Silicone => "as the mould, ISO 2768-c",
        Material::Steel => "ISO 2768-m",
    }
}

/// The note about what is engraved in a part.
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
        notes.push("Widths of slots and radii of grooves: without tolerance,".to_owned());
        notes.push("as the machine makes them; the coupon measures the machine".to_owned());
    }
    notes
}

/// The meaning of the marks of a part, and what was left out of it.
pub(super) fn legend(design: &Design, part: &Part) -> Vec<String> {
    let mut notes = Vec::new();
    if part.engraved.iter().any(|line| line.contains(&design.label())) {
        notes.push(layout(design));
    }
    notes.extend(marks(&part.engraved));
    notes.extend(part.left_out_notes(design));
    notes
}

/// The meaning of the label of a layout: which grooves hold pins.
pub(super) fn layout(design: &Design) -> String {
    let mut pins = design.configuration().layout.pins.clone();
    pins.sort_unstable();
    let holds = match pins[..] {
        [] => "no pins".to_owned(),
        [only] => format!("pin in groove {only}"),
        _ => format!("pins in grooves {}", runs(&pins)),
    };
    format!("{}: {holds}", design.label())
}

/// Joins ascending numbers, with three or more consecutive ones as `4 to 7`.
fn runs(numbers: &[usize]) -> String {
    let mut all: Vec<(usize, usize)> = Vec::new();
    for number in numbers {
        match all.last_mut() {
            Some((_, last)) if *last + 1 == *number => *last = *number,
            _ => all.push((*number, *number)),
        }
    }
    let word = |(first, last): &(usize, usize)| match last - first {
        0 => first.to_string(),
        1 => format!("{first}, {last}"),
        _ => format!("{first} to {last}"),
    };
    all.iter().map(word).collect::<Vec<_>>().join(", ")
}

/// The meaning of the arrow on a support.
pub(super) fn marks(engraved: &[String]) -> Option<String> {
    let arrow = ["1<", ">1"].into_iter().find(|arrow| engraved.iter().any(|line| line.contains(arrow)))?;
    let is_named = |name: &&str| engraved.iter().any(|line| line.contains(name));
    let pull = ["LOAD", "F"].into_iter().find(is_named).map_or_else(String::new, |name| format!(" ({name})"));
    Some(format!("{arrow}: to groove 1, where the load{pull} pulls"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_layout_is_written_in_grooves() {
        let text = |pins: &str| {
            let mut c = crate::config::Configuration::default();
            crate::config::assign(&mut c, &format!("layout.pins={pins}")).unwrap();
            layout(&Design::new(c).unwrap())
        };
        assert_eq!(text("[4, 5, 11]"), "418: pins in grooves 4, 5, 11");
        assert_eq!(text("[11, 5, 8]"), "3x3/5: pins in grooves 5, 8, 11");
        assert_eq!(text("[1, 2, 3, 7]"), "47: pins in grooves 1 to 3, 7");
        assert_eq!(text("[8]"), "1/8: pin in groove 8");
        assert_eq!(text("[]"), "BARE: no pins");
        let engraved = |lines: &[&str]| marks(&lines.iter().map(|l| (*l).to_owned()).collect::<Vec<_>>());
        assert_eq!(engraved(&["1<F R"]).unwrap(), "1<: to groove 1, where the load (F) pulls");
        assert_eq!(engraved(&["418"]), None);
    }
}
