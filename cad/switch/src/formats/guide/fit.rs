//! The section of fitting: cut pins that slide in their slots.

use super::document::{Block, Step};
use super::scenes::still;
use crate::config::Slots;
use crate::design::Design;
use crate::documents::Manifest;
use crate::scene::{Bench, Bodies, CUT_PIN};
use pinswitch_friction::pluralise;

pub(super) fn fit(design: &Design, manifest: &Manifest, bodies: &Bodies) -> Vec<Block> {
    let pins = &manifest.bill_of_materials.pins;
    if pins.number == 0 {
        return Vec::new();
    }
    let c = design.configuration();
    let number = pins.number + pins.spares;
    let cut = Step::new("Cut the pins")
        .text(format!(
            "Cut {} of {} mm from the rod, {:.1} mm long ({} spare), with eye protection: the ends fly off. Deburr the ends with the file \
             and the abrasive paper; the sides are smooth as bought.",
            pluralise(number, "pin"),
            pins.diameter_mm,
            pins.length_mm,
            pins.spares
        ))
        .risk("A pin is too long.", "The right support does not reach the shell; shorten the pin.")
        .risk("A burr remains.", "The pin scratches a fingernail, and later cuts the coating of the tendon.")
        .picture(still(
            Bench::Loose,
            bodies.names(Bench::Loose, CUT_PIN),
            &match pins.spares {
                0 => format!("{} {} x {}", pluralise(number, "pin"), pins.diameter_mm, pins.length_mm),
                spares => {
                    format!("{} + {spares} spare {} x {}", pins.number, pins.diameter_mm, pins.length_mm)
                }
            },
        ));
    let slots = Step::new("Try the pins in the supports")
        .text(format!(
            "Put a pin into {}. It must slide by its own weight over the whole length of the slot, {:.2} mm more than its diameter.",
            slots(design),
            design.slot().outer_mm - design.slot().inner_mm
        ))
        .risk(
            "The first layer of a slot is narrow.",
            "The pin enters only from one side; clean the edge with a blade.",
        )
        .risk(
            &format!("The clearance of {} mm is too small for this printer.", c.support.slot_clearance_mm),
            "No pin slides; raise `support.slot_clearance_mm` and print the supports again.",
        );
    vec![Block::Step(cut), Block::Step(slots)]
}

/// The slots that hold pins: `slots 5, 8 and 11 of each support, counted from the side of the load`.
fn slots(design: &Design) -> String {
    let c = design.configuration();
    match c.support.slots {
        Slots::Occupied => "every slot of both supports".to_owned(),
        Slots::All => {
            let list = super::groove_list(&c.layout.pins).replace("groove", "slot");
            format!("{list} of each support, counted from the side of the load")
        }
    }
}
