//! The section of checks: what to measure, and what to expect.

use super::document::{Block, Table};
use crate::design::Design;
use crate::documents::Manifest;
use pinswitch_friction::Substrate;

pub(super) fn check(design: &Design, manifest: &Manifest) -> Vec<Block> {
    let c = design.configuration();
    let bill = &manifest.bill_of_materials;
    let mut of_parts: Vec<[String; 4]> = Vec::new();
    let mut of_switch: Vec<[String; 4]> = Vec::new();
    let row = |what: &str, with: &str, expect: String, otherwise: &str| {
        [what.to_owned(), with.to_owned(), expect, otherwise.to_owned()]
    };
    if bill.pins.number > 0 {
        of_parts.push(row(
            "diameter of a pin",
            "micrometer",
            format!("{} mm", bill.pins.diameter_mm),
            "set `pins.diameter_mm` to the measured value and generate again",
        ));
        if c.parts.coupon {
            of_parts.push(row(
                "coupon: smallest slot in which a pin slides by its weight",
                "a pin",
                format!("number {:.0} or less", c.support.slot_clearance_mm * 100.0),
                "set `support.slot_clearance_mm` to the number divided by 100 and generate again; from 35 on, reduce the flow of the printer \
                 instead",
            ));
        }
        let is_silicone = c.layout.substrate == Substrate::Silicone;
        if is_silicone {
            of_switch.push(row(
                "travel of each pin in its slots",
                "finger",
                "it moves inward when pressed and returns".to_owned(),
                "clean its slots; turn the pin; straighten or replace it",
            ));
        }
    }
    if c.layout.substrate == Substrate::Silicone {
        of_parts.push(row(
            "thickness of the layer between two grooves",
            "calipers, without pressure",
            format!("{} mm", c.silicone.thickness_mm),
            if bill.pins.number > 0 {
                "this thickness changes the load at which the switch switches: cast again, or set `silicone.thickness_mm` to the measured value for its curve"
            } else {
                "cast again, or set `silicone.thickness_mm` to the measured value for its curve"
            },
        ));
        of_parts.push(row(
            "width of the layer",
            "calipers",
            format!("{:.1} mm", design.layer_width_mm()),
            "trim a wider layer: it must not touch both supports",
        ));
    }
    of_switch.push(row(
        "gap between the supports",
        "calipers",
        format!("{} mm", c.shell.width_mm),
        "a support is not seated; look for a string or a burr on the ends of the shell",
    ));
    of_parts.push(row(
        "outer diameter of the tendon",
        "calipers",
        format!("{} mm", bill.tendon.outer_diameter_mm),
        "set `tendon.coating_mm` to half of the difference to the rope, and generate again",
    ));
    let parts = "Measure the parts before you put the switch together: pins and tendon before you print, the layer after you cast it. To \
                 generate again is `pinswitch generate CONFIG --set TABLE.KEY=VALUE --out DIR`.";
    let switch = "Check the finished switch before its first load.";
    let heads = ["measure", "with", "expect", "otherwise"];
    vec![
        Block::Paragraph(parts.to_owned()),
        Table::block(heads, of_parts),
        Block::Paragraph(switch.to_owned()),
        Table::block(heads, of_switch),
    ]
}
