//! The parts list: assembled parts, bought parts, and the tools that are printed with them.

use super::words;
use crate::built::Built;
use crate::documents::{STOP_SCREWS, bill_of_materials};
use crate::parts::{Part, Role};
use crate::process::coating;
use crate::rig::RigBolts;
use pinswitch_drafting::number;

/// A row of the parts list.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Item {
    pub(super) number: usize,
    pub(super) quantity: String,
    pub(super) designation: String,
    pub(super) part_number: String,
    pub(super) material: String,
    /// The body at its balloon, `tendon`, or a kind of hardware; empty without a balloon.
    pub(super) shown: String,
}

/// Returns the number of a part, as in the 3MF package.
pub(super) fn part_number(built: &Built, part: &str) -> String {
    format!("{}/{part}", built.design().configuration().switch.name)
}

/// Returns all rows: assembled parts, pins, bought parts, then parts that are not in the assembly.
pub(super) fn items(built: &Built) -> Vec<Item> {
    let design = built.design();
    let bill = bill_of_materials(design);
    let assembled: Vec<&Part> = built.assembly().map(|b| &b.part).filter(|p| p.role != Role::Stand).collect();
    let mut all = Vec::new();
    let mut add = |quantity: String, designation: String, number: String, material: String, shown: &str| {
        all.push(Item {
            number: all.len() + 1,
            quantity,
            designation,
            part_number: number,
            material,
            shown: shown.to_owned(),
        });
    };
    let material = |part: &Part| words::material(design, part.material());
    // Pins and tendon are among the bought parts.
    for part in assembled.iter().filter(|p| !matches!(p.role, Role::Pin { .. } | Role::Tendon)) {
        let name = &part.name;
        add("1".to_owned(), designation(name), part_number(built, name), material(part), name);
    }
    if let Some(pin) = assembled.iter().find(|p| matches!(p.role, Role::Pin { .. })) {
        let spares =
            if bill.pins.spares > 0 { format!(", plus {} spare", bill.pins.spares) } else { String::new() };
        let words = format!(
            "Pin \u{d8}{} \u{b1}{} \u{d7} {}{spares}",
            number(bill.pins.diameter_mm),
            number(design.configuration().pins.tolerance_mm),
            number(bill.pins.length_mm)
        );
        let middle = nearest_pin(&assembled);
        let shown = middle.map_or_else(|| pin.name.clone(), |p| p.name.clone());
        add(bill.pins.number.to_string(), words, part_number(built, "pin"), material(pin), &shown);
    }
    let mut bought = |quantity: usize, words: String, shown: &str| {
        // Heat-set inserts are made of brass.
        let material = if words.starts_with("Heat-set") { "Brass" } else { "Steel" };
        add(quantity.to_string(), words, "bought".to_owned(), material.to_owned(), shown);
    };
    if let Some(screws) = &bill.fasteners {
        let with = if screws.nuts > 0 { " with nut" } else { "" };
        let words = |mm: f64| format!("Screw {} \u{d7} {}{with}", screws.thread, number(mm));
        let from_right = screws.right_length_mm.map_or(0, |_| screws.number / 2);
        bought(screws.number - from_right, words(screws.length_mm), "screw");
        screws.right_length_mm.into_iter().for_each(|mm| bought(from_right, words(mm), "screw"));
        if screws.inserts > 0 {
            bought(screws.inserts, format!("Heat-set insert {}", screws.thread), "screw");
        }
    }
    if let Some(dowels) = &bill.dowels {
        let words = format!("Dowel \u{d8}{} \u{d7} {}", number(dowels.diameter_mm), number(dowels.length_mm));
        bought(dowels.number, words, "dowel");
    }
    if let Some(bearing) = bill.pulley_bearing {
        bought(1, format!("Bearing {bearing}"), "");
    }
    let mount = bill.mount.as_ref();
    let bearing = mount.and_then(|m| m.bearing).map(|b| format!("Bearing {b}"));
    let pulleys = mount.map_or(0, |m| m.pulleys);
    bearing.into_iter().for_each(|words| bought(pulleys, words, "bearing"));
    mount.and_then(|m| m.axle.clone()).into_iter().for_each(|words| bought(pulleys.max(1), words, "axle"));
    let sleeve = mount.and_then(|m| m.crimp_sleeve.as_deref()).map(designation);
    sleeve.into_iter().for_each(|words| bought(1, words, ""));
    if let Some(bolts) = RigBolts::new(design) {
        bought(4, format!("Bolt M6 \u{d7} {} with nut, feet", number(bolts.foot_mm)), "");
        if let Some((thread, mm)) = bolts.splice {
            bought(4, format!("Bolt M{} \u{d7} {} with nut, splice", number(thread), number(mm)), "");
        }
    }
    if let Some(screw) = mount.and_then(|m| m.stop_screw.as_ref()) {
        bought(STOP_SCREWS, format!("Screw {} with nut", screw.replace(" x ", " \u{d7} ")), "stop screw");
    }
    let tendon = format!(
        "Tendon \u{d8}{}, rope \u{d8}{}, {} long",
        number(bill.tendon.outer_diameter_mm),
        number(bill.tendon.rope_diameter_mm),
        number(bill.tendon.length_mm)
    );
    add(
        "1".to_owned(),
        tendon,
        "bought".to_owned(),
        coating(design.configuration()).with_rope().to_owned(),
        "tendon",
    );
    for part in built.printed().iter().map(|p| p.part()) {
        if !assembled.iter().any(|a| a.name == part.name) {
            let place = if part.role == Role::Stand { "on the table" } else { "not in the assembly" };
            let words = format!("{} ({place})", designation(&part.name));
            add("1".to_owned(), words, part_number(built, &part.name), material(part), "");
        }
    }
    all
}

/// The pin nearest to the middle, through which the section is cut.
fn nearest_pin<'a>(assembled: &[&'a Part]) -> Option<&'a Part> {
    let off = |part: &Part| {
        part.solid.bounds().map_or(f64::INFINITY, |(low, high)| f64::midpoint(low.x, high.x).abs())
    };
    let pins = assembled.iter().copied().filter(|p| matches!(p.role, Role::Pin { .. }));
    pins.min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// Returns the name of a part as a title: `support-left` becomes `Support left`.
pub(super) fn designation(name: &str) -> String {
    let words = name.replace('-', " ");
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Configuration, assign};
    use crate::design::Design;

    #[test]
    fn screws_and_nuts_are_counted_together() {
        let mut c = Configuration::default();
        for a in ["layout.pins=[5, 8, 11]", "mount.kind=rig", "tendon.sheath_diameter_mm=4"] {
            assign(&mut c, a).unwrap();
        }
        let items = items(&Built::new(Design::new(c).unwrap()).unwrap());
        let of = |words: &str| items.iter().filter(|i| i.designation.contains(words)).collect::<Vec<_>>();
        let screws = of("Screw M3 \u{d7} ");
        assert_eq!(screws.len(), 2, "{screws:?}");
        assert!(
            screws.iter().all(|i| i.quantity == "2" && i.designation.ends_with(" with nut")),
            "{screws:?}"
        );
        assert!(items.iter().all(|i| !i.designation.starts_with(|c: char| c.is_ascii_digit())), "{items:?}");
    }
}
