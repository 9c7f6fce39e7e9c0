//! What dimensions say: numbers, tolerances and fits. Where each comes from stands in cad/doc/drawing.md, "Tolerances
//! on drawings".

use std::f64::consts::PI;

use super::features::{ArcSlot, Features, Pieces, Round, Rounding, Slot, same};
use super::fits;
use crate::design::Design;
use crate::parts::{Material, Part, Role};
use pinswitch_solid::profile::Point2;

/// So many angles stand in one line of a list.
const ANGLES_IN_LINE: usize = 5;

/// A length or an angle with up to three digits behind the point.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// An angle.
pub(super) fn degrees(angle_rad: f64) -> String {
    format!("{}\u{b0}", number(angle_rad.to_degrees()))
}

/// `3 x ` before what is there three times.
pub(super) fn times(n: usize) -> String {
    if n == 1 { String::new() } else { format!("{n} \u{d7} ") }
}

/// The angle of a point about the axis, from +y toward +x.
pub(super) fn angle_rad(p: Point2) -> f64 {
    libm::atan2(p.x, p.y)
}

/// First angle and step of angles that are evenly spaced; at least three.
pub(super) fn even_step(angles_rad: &[f64]) -> Option<(f64, f64)> {
    let mut sorted = angles_rad.to_vec();
    sorted.sort_by(f64::total_cmp);
    let step = sorted.get(1)? - sorted[0];
    let is_even = sorted.len() > 2 && sorted.windows(2).all(|w| same(w[1] - w[0], step));
    is_even.then_some((sorted[0], step))
}

/// Where things lie on a radius: `on R16.75 at ±34.46°`.
pub(super) fn on_radius(places: &[Point2]) -> Vec<String> {
    let radius = places.first().map_or(0.0, |p| p.coords.norm());
    if same(radius, 0.0) || !places.iter().all(|p| same(p.coords.norm(), radius)) {
        return Vec::new();
    }
    let mut angles: Vec<f64> = places.iter().map(|p| angle_rad(*p)).collect();
    angles.sort_by(f64::total_cmp);
    let mut at: Vec<String> = match angles[..] {
        [a, b] if same(a, -b) => vec![format!("\u{b1}{}", degrees(b))],
        _ => match even_step(&angles) {
            Some((first, step)) => {
                vec![format!("{} + {} \u{d7} {}", degrees(first), angles.len() - 1, degrees(step))]
            }
            None => angles.iter().map(|a| degrees(*a)).collect(),
        },
    };
    let mut lines = vec![format!("on R{} at {}", number(radius), at.remove(0))];
    for (i, angle) in at.into_iter().enumerate() {
        // A long list of angles continues below.
        match lines.last_mut() {
            Some(line) if i % ANGLES_IN_LINE != ANGLES_IN_LINE - 2 => *line += &format!(", {angle}"),
            Some(line) => {
                *line += ",";
                lines.push(angle);
            }
            None => {}
        }
    }
    lines
}

/// What a peg or a rim is called. A round part's own height stands beside it.
pub(super) fn round(
    design: &Design,
    part: &Part,
    round: &Round,
    is_body: bool,
    is_axial: bool,
) -> Vec<String> {
    let (Some(first), Some(last)) = (round.levels.first(), round.levels.last()) else { return Vec::new() };
    let n = times(round.centres.len());
    let low = number(2.0 * first.1);
    let depth = number(last.0 - first.0);
    if matches!(part.role, Role::Pin { .. }) {
        return vec![pin(design)];
    }
    if let Some(fit) = fits::of_round(design, part, round) {
        let deviation = &fit.tolerance;
        let mut lines = vec![
            format!("{n}key \u{d8}{low} {deviation}, {depth} {} high,", fit.depth_tolerance),
            format!("\u{d8}{} {deviation} at its head, {}", number(2.0 * last.1), fit.purpose),
        ];
        lines.extend(on_radius(&round.centres));
        return lines;
    }
    let mut lines = match (same(first.1, last.1), is_body) {
        (true, true) => vec![format!("{n}\u{d8}{low}")],
        (true, false) => vec![format!("{n}\u{d8}{low} \u{d7} {depth}")],
        (false, _) => {
            let mut levels = round.levels[1..].to_vec();
            levels.dedup_by(|a, b| same(a.1, b.1));
            let at = |(z, r): &(f64, f64)| format!(", \u{d8}{} at {}", number(2.0 * r), number(z - first.0));
            vec![format!("{n}peg \u{d8}{low}{}", levels.iter().map(at).collect::<String>())]
        }
    };
    if is_axial {
        lines.extend(on_radius(&round.centres));
    }
    lines
}

fn pin(design: &Design) -> String {
    let p = &design.configuration().pins;
    format!("\u{d8}{} \u{b1}{}", number(p.diameter_mm), number(p.tolerance_mm))
}

/// The width of a slot, and the tolerance that the pin's fit asks for: never narrower, at most 0.1 mm wider. The slots of the
/// coupon have none: what the machine makes of them is what the coupon is for.
pub(super) fn slot_width(part: &Part, slot: &Slot) -> String {
    let width = number(slot.width_mm);
    if is_coupon(part) { width } else { format!("{width} {}", fits::SLOT) }
}

/// Whether a part measures the machine that makes it.
fn is_coupon(part: &Part) -> bool {
    part.name == "coupon"
}

/// What slots are called.
pub(super) fn slot(design: &Design, part: &Part, slot: &Slot) -> Vec<String> {
    let n = times(slot.places.len());
    let depth = if slot.is_blind { format!("{} deep", number(slot.depth_mm)) } else { "through".to_owned() };
    let mut lines = if matches!(part.role, Role::Support { .. }) {
        vec![format!("{n}slot, {depth}"), format!("for pin {}", pin(design))]
    } else {
        vec![format!("{n}slot, {depth}")]
    };
    let outer: Vec<Point2> = slot.places.iter().map(|p| p.0).collect();
    let angles: Vec<f64> = outer.iter().map(|p| angle_rad(*p)).collect();
    if even_step(&angles).is_some() {
        // The angles have a dimension of their own.
        lines.push(format!("outer centres on R{}", number(outer[0].coords.norm())));
    } else {
        lines.extend(on_radius(&outer).into_iter().map(|l| l.replacen("on R", "outer centres on R", 1)));
    }
    lines
}

/// What a slot along an arc is called.
pub(super) fn arc_slot(slot: &ArcSlot) -> Vec<String> {
    let (low, high) = (number(slot.widths_mm.0), number(slot.widths_mm.1));
    let width = if low == high { format!("{low} wide") } else { format!("{low} wide, {high} at the top") };
    vec![
        format!("slot along R{}, {width}", number(slot.radius_mm)),
        format!("centres of its ends at \u{b1}{}", degrees(slot.half_rad)),
    ]
}

/// What grooves, ribs and rounded corners are called.
pub(super) fn rounding(part: &Part, rounding: &Rounding, f: &Features) -> Vec<String> {
    let is_axial = !f.axis_arcs.is_empty();
    let word = match (rounding.is_half_round, rounding.is_rib) {
        (true, true) => "rib ",
        (true, false) => "groove ",
        (false, _) => "",
    };
    let has_tolerance = rounding.is_half_round && !is_coupon(part);
    let tolerance = if has_tolerance { format!(" {}", fits::HALF_ROUND) } else { String::new() };
    let radius = number(rounding.radius_mm);
    let mut lines = vec![format!("{}{word}R{radius}{tolerance}", times(rounding.arcs.len()))];
    if rounding.is_half_round && !is_axial {
        lines.push("centres on the edge".to_owned());
    }
    let is_hole = |p: &Point2| f.bores.iter().any(|b| b.centres.iter().any(|c| (c - p).norm() < 1e-6));
    if !rounding.is_half_round && rounding.arcs.iter().all(|a| is_hole(&a.centre)) {
        lines.push("about the hole's axis".to_owned());
    }
    if rounding.is_half_round && is_axial {
        let centres: Vec<Point2> = rounding.arcs.iter().map(|a| a.centre).collect();
        let angles: Vec<f64> = centres.iter().map(|p| angle_rad(*p)).collect();
        if even_step(&angles).is_some() {
            lines.push(format!("centres on R{}", number(centres[0].coords.norm())));
        } else {
            lines.extend(on_radius(&centres).into_iter().map(|l| l.replacen("on R", "centres on R", 1)));
        }
    }
    lines
}

/// What the pieces of a lip are called.
pub(super) fn pieces(pieces: &Pieces, slots: &[f64]) -> Vec<String> {
    let height = number(pieces.heights_mm.1 - pieces.heights_mm.0);
    let mut lines = vec![
        format!("lip R{} to R{}", number(pieces.inner_mm), number(pieces.outer_mm)),
        format!("{height} high, in {} pieces", pieces.spans_rad.len()),
    ];
    let mut gaps: Vec<f64> = Vec::new();
    for (from, to) in &pieces.spans_rad {
        for end in [from, to] {
            let gap = slots.iter().map(|s| (s - end).abs()).fold(f64::INFINITY, f64::min);
            if gap < PI && !gaps.iter().any(|g| same(*g, gap)) {
                gaps.push(gap);
            }
        }
    }
    let outermost = pieces.spans_rad.iter().map(|s| s.1).fold(f64::NEG_INFINITY, f64::max);
    gaps.sort_by(f64::total_cmp);
    if let Some(gap) = gaps.first() {
        lines.push(format!("edges {} beside slot centres", degrees(*gap)));
    }
    lines.push(format!("outermost edges at \u{b1}{}", degrees(outermost)));
    lines
}

/// What ends are called that do not lie in a plane through the axis.
pub(super) fn ends(shift_mm: f64, half_span_rad: f64) -> Vec<String> {
    vec![
        "end face parallel to the plane".to_owned(),
        format!("at \u{b1}{}, {} outside it", degrees(half_span_rad), number(shift_mm)),
    ]
}

/// What the title block says of the material.
pub(super) fn material(design: &Design, material: Material) -> String {
    match material {
        Material::Abs => "ABS, printed".to_owned(),
        Material::Silicone => {
            format!("Silicone, {} Shore A", number(design.configuration().silicone.hardness_shore_a))
        }
        Material::Steel => "Steel, polished".to_owned(),
    }
}

/// What the title block says of dimensions without a tolerance of their own.
pub(super) const fn general_tolerance(material: Material) -> &'static str {
    match material {
        Material::Abs => "ISO 2768-c printed, -m machined",
        Material::Silicone => "as the mould, ISO 2768-c",
        Material::Steel => "ISO 2768-m",
    }
}

/// General notes of a part.
pub(super) fn notes(design: &Design, part: &Part, features: &Features, has_lettering: bool) -> Vec<String> {
    let c = design.configuration();
    let mut notes = Vec::new();
    if has_lettering {
        let what =
            if is_coupon(part) { "the slots' clearances".to_owned() } else { part.engraved.join(", ") };
        // Supports have their marks on the face that was printed on the bed.
        let face = if matches!(part.role, Role::Support { .. }) { " in the far face" } else { "" };
        notes.push(format!("Engraved{face}: {what}, {} deep", number(c.label.depth_mm)));
    }
    let is_printed = part.material() == Material::Abs;
    if is_printed && c.print.elephant_foot_mm > 0.0 {
        notes.push(format!("Bottom edges {} \u{d7} 45\u{b0}", number(c.print.elephant_foot_mm)));
    }
    if part.name == "mould-tray" && c.mould.overfill_mm > 0.0 && c.mould.draft_deg > 0.0 {
        notes.push(format!("Walls of the basin: draft {}\u{b0}", number(c.mould.draft_deg)));
    }
    if features.axis_arcs.is_empty() && !features.slots.is_empty() {
        notes.push("Slots: through, with round ends".to_owned());
    }
    if is_coupon(part) {
        notes.push("Widths of slots and radii of grooves: without tolerance,".to_owned());
        notes.push("as the machine makes them; the coupon measures the machine".to_owned());
    }
    if features.bores.iter().any(|b| !b.is_plain()) {
        notes.push("Near face: the one shown in the front view".to_owned());
    }
    if let Some(copies) = features.copies {
        notes.push(format!("{} basins, all alike: what is said of one is so of each", copies.number));
    }
    let is_plate = features.axis_arcs.is_empty() && features.block.is_none() && !features.is_round_body();
    if is_plate && !features.bores.is_empty() {
        notes.push("Outline: straight lines that touch both arcs".to_owned());
    }
    if !features.axis_arcs.is_empty() {
        let axis = if features.copies.is_some() { "the axis of the basin" } else { "the pulley's axis" };
        notes.push(format!("R without a centre mark: about {axis}"));
        notes.push("Angles from the middle plane, + to the right".to_owned());
    }
    if part.engraved.iter().any(|line| line.contains(&design.label())) {
        notes.push(layout(design));
    }
    notes.extend(marks(&part.engraved));
    notes.extend(part.left_out_notes(design));
    notes
}

/// What the label of a layout stands for: which grooves hold pins.
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

/// Numbers in ascending order, three and more that follow each other as `4 to 7`.
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

/// What the marks of a support stand for, beside its layout.
pub(super) fn marks(engraved: &[String]) -> Option<String> {
    let arrow = ["1<", ">1"].into_iter().find(|arrow| engraved.iter().any(|line| line.contains(arrow)))?;
    let is_named = |name: &&str| engraved.iter().any(|line| line.contains(name));
    let pull = ["LOAD", "F"].into_iter().find(is_named).map_or_else(String::new, |name| format!(" ({name})"));
    Some(format!("{arrow}: to groove 1, where the load{pull} pulls"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_solid::profile::polar;

    #[test]
    fn the_layout_is_told_in_grooves() {
        let told = |pins: &str| {
            let mut c = crate::config::Configuration::default();
            crate::config::assign(&mut c, &format!("layout.pins={pins}")).unwrap();
            layout(&Design::new(c).unwrap())
        };
        assert_eq!(told("[4, 5, 11]"), "418: pins in grooves 4, 5, 11");
        assert_eq!(told("[11, 5, 8]"), "3x3/5: pins in grooves 5, 8, 11");
        assert_eq!(told("[1, 2, 3, 7]"), "47: pins in grooves 1 to 3, 7");
        assert_eq!(told("[8]"), "1/8: pin in groove 8");
        assert_eq!(told("[]"), "BARE: no pins");
        let engraved = |lines: &[&str]| marks(&lines.iter().map(|l| (*l).to_owned()).collect::<Vec<_>>());
        assert_eq!(engraved(&["1<F R"]).unwrap(), "1<: to groove 1, where the load (F) pulls");
        assert_eq!(engraved(&["418"]), None);
    }

    #[test]
    fn places_on_a_radius_are_said_in_the_shortest_way() {
        let at = |degrees: &[f64]| {
            on_radius(&degrees.iter().map(|d| polar(10.0, d.to_radians())).collect::<Vec<_>>()).join("|")
        };
        assert_eq!(at(&[-30.0, 30.0]), "on R10 at \u{b1}30\u{b0}");
        assert_eq!(at(&[-30.0, 0.0, 30.0]), "on R10 at -30\u{b0} + 2 \u{d7} 30\u{b0}");
        assert_eq!(at(&[-30.0, 5.0, 31.0]), "on R10 at -30\u{b0}, 5\u{b0}, 31\u{b0}");
        assert_eq!(at(&[0.0]), "on R10 at 0\u{b0}");
        let many: Vec<f64> = (0..15).map(|i| f64::from(i * i) * 0.5 - 40.0).collect();
        let text = at(&many);
        assert!(text.split('|').all(|l| l.len() < 60) && text.matches('\u{b0}').count() == 15, "{text}");
        assert_eq!(on_radius(&[Point2::origin()]), Vec::<String>::new());
    }
}
