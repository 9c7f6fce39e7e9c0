//! The shopping list and the list of tools.

use super::document::{Block, Table};
use crate::config::{FastenerKind, MouldKind, MountKind};
use crate::design::{AXLE_HEAD_MM, Design};
use crate::documents::{Bill, Manifest};
use crate::process::{Coating, Cure, ROOM_C, coating};
use pinswitch_friction::Substrate;

/// Hexagon keys of socket screws (ISO 4762): thread and width across flats, mm.
const KEYS_MM: [(&str, f64); 6] =
    [("M1.6", 1.5), ("M2", 1.5), ("M2.5", 2.0), ("M3", 2.5), ("M4", 3.0), ("M5", 4.0)];

/// A row of the shopping list: item, number or amount, use.
type Row = [String; 3];

fn row(item: impl Into<String>, amount: impl Into<String>, purpose: &str) -> Row {
    [item.into(), amount.into(), purpose.to_owned()]
}

pub(super) fn shopping(design: &Design, manifest: &Manifest) -> Vec<Block> {
    vec![
        Table::block(["item", "amount", "for"], items(design, manifest)),
        Block::Heading { number: None, text: "Tools".to_owned() },
        Block::List(tools(design, &manifest.bill_of_materials)),
    ]
}

fn items(design: &Design, manifest: &Manifest) -> Vec<Row> {
    let bill = &manifest.bill_of_materials;
    let mass_g: f64 = manifest.parts.iter().map(|p| p.mass_g).sum();
    // With what a printer uses for lines around the parts.
    let least_g = 5.0 * (1.1 * mass_g / 5.0).ceil();
    let mut rows = vec![row(material(design), format!("{least_g:.0} g or more"), "printed parts")];
    if bill.pins.number > 0 {
        let number = bill.pins.number + bill.pins.spares;
        rows.push(row(
            format!("{}, {} mm", design.configuration().process.pins.title(), bill.pins.diameter_mm),
            format!("rod for {number} pieces of {:.1} mm", bill.pins.length_mm),
            "pins",
        ));
    }
    rows.extend(silicone(design, bill));
    let t = &bill.tendon;
    let rope = match coating(design.configuration()) {
        Coating::Bare => format!("bare wire rope, {} mm", t.rope_diameter_mm),
        coating => {
            format!(
                "wire rope, {} mm, with {}, {} mm over the coating",
                t.rope_diameter_mm,
                coating.title(),
                t.outer_diameter_mm
            )
        }
    };
    rows.push(row(rope, format!("{} mm", t.length_mm), "tendon"));
    if design.joint().is_none() && design.rig_layout().is_none() {
        let clip = format!("wire rope clip or crimp sleeve for {} mm", t.outer_diameter_mm);
        rows.push(row(clip, "2", "loops at the ends of the tendon"));
    }
    rows.extend(fasteners(design, bill));
    if let Some(d) = &bill.dowels {
        rows.push(row(
            format!("steel rod, {} mm", d.diameter_mm),
            format!("{} pieces of {} mm", d.number, d.length_mm),
            "dowels",
        ));
    }
    if let Some(bearing) = bill.pulley_bearing {
        rows.push(row(format!("ball bearing {bearing}"), "1", "guide pulley"));
    }
    if let Some(m) = &bill.mount {
        let is_joint = design.configuration().mount.kind == MountKind::Joint;
        let (number, purpose) =
            if is_joint { (1, "axle of the joint") } else { (m.pulleys, "axles of the guide pulleys") };
        rows.extend(
            m.bearing.map(|b| row(format!("ball bearing {b}"), m.pulleys.to_string(), "guide pulleys")),
        );
        rows.extend(m.axle.as_ref().map(|axle| row(axle.clone(), number.to_string(), purpose)));
        rows.extend(m.crimp_sleeve.as_ref().map(|s| row(s.clone(), "1", "end of the tendon")));
        rows.extend(m.sheath_stop.as_ref().map(|s| row(s.clone(), "1 set", "sheath stop")));
    }
    rows
}

/// The material to print.
fn material(design: &Design) -> String {
    let material = design.configuration().process.material.data();
    let kind = if material.filament.is_some() { "filament" } else { "photopolymer" };
    format!("{kind}, {}", material.name)
}

/// The silicone to buy.
fn silicone(design: &Design, bill: &Bill) -> Vec<Row> {
    let Some(s) = &bill.silicone else { return Vec::new() };
    let c = design.configuration();
    let product = s.product.map_or_else(String::new, |product| format!(": {product}"));
    vec![row(
        format!("silicone of {} Shore A after cure{product}", c.silicone.hardness_shore_a),
        format!("{:.1} g of base, {:.1} g of curing agent", s.base_g, s.agent_g),
        "silicone layer",
    )]
}

fn fasteners(design: &Design, bill: &Bill) -> Vec<Row> {
    let Some(f) = &bill.fasteners else {
        let c = design.configuration();
        let glue = row(c.process.material.data().glue, "a few drops", "joints of shell and supports");
        return if c.fasteners.count == 0 { vec![glue] } else { Vec::new() };
    };
    let screw = |number: usize, length: f64| {
        row(format!("socket screw {} x {length} (ISO 4762)", f.thread), number.to_string(), "supports")
    };
    let mut rows = match f.right_length_mm {
        Some(right_mm) => vec![screw(f.number / 2, f.length_mm), screw(f.number / 2, right_mm)],
        None => vec![screw(f.number, f.length_mm)],
    };
    if f.nuts > 0 {
        rows.push(row(format!("nut {} (ISO 4032)", f.thread), f.nuts.to_string(), "supports"));
    }
    if let Some([hole, length]) = design.fastening().insert_mm.filter(|_| f.inserts > 0) {
        let item = format!("heat-set insert {}, {length} mm long, for a hole of {hole} mm", f.thread);
        rows.push(row(item, f.inserts.to_string(), "shell"));
    }
    rows
}

fn tools(design: &Design, bill: &Bill) -> Vec<String> {
    let c = design.configuration();
    let mut tools = vec![format!(
        "a printer for {} with a nozzle of {} mm and a bed of {} x {} mm or more",
        c.process.material.data().name,
        c.print.nozzle_mm,
        c.print.bed_mm,
        c.print.bed_mm
    )];
    let mut add = |is_needed: bool, tool: &str| {
        if is_needed {
            tools.push(tool.to_owned());
        }
    };
    let has_pins = bill.pins.number > 0;
    add(true, "calipers, and a deburring knife or a sharp blade");
    add(
        has_pins || bill.dowels.is_some(),
        "a rotary tool with a cutting disc or hard-wire cutters, a fine file, abrasive paper of grit 1000",
    );
    add(has_pins || bill.dowels.is_some(), "eye protection for cutting");
    add(has_pins, "a micrometer for the diameter of the pins, tweezers, and a pen");
    if let Some(s) = &bill.silicone {
        add(true, "a scale with a resolution of 0.1 g, a cup, and a flat stick");
        add(true, "nitrile gloves; latex prevents the cure");
        let is_hot = |cure: &Option<Cure>| cure.is_some_and(|cure| cure.temperature_c > ROOM_C);
        add(is_hot(&s.mould_cure), "an oven for the cure in the mould, not one for food");
        add(is_hot(&s.post_cure), "an oven for the post-cure, not one for food, and a flat metal tray");
        add(true, "a durometer for Shore A, if there is one");
        add(true, "a vacuum chamber, if there is one, to remove bubbles");
        add(c.mould.kind == MouldKind::Split, "two strong rubber bands and adhesive tape");
    }
    if let Some(f) = &bill.fasteners {
        let key = KEYS_MM.iter().find(|(name, _)| *name == f.thread).map(|(_, mm)| mm);
        if let Some(mm) = key {
            add(true, &format!("a hexagon key of {mm} mm for the screws {}", f.thread));
        }
        let flats = design.fastening().thread.map(|t| t.nut_mm[0]);
        if let Some(flats) = flats.filter(|_| f.nuts > 0 && design.fastening().nut_trap.is_none()) {
            add(true, &format!("a spanner of {flats} mm for the nuts"));
        }
        add(c.fasteners.kind == FastenerKind::Insert, "a soldering iron with a clean tip for the inserts");
        add(f.inserts == 0, "adhesive tape to keep the screws in place");
    }
    if bill.mount.as_ref().is_some_and(|m| m.axle.is_some()) {
        let flats = design.joint().map_or(AXLE_HEAD_MM[0], |joint| joint.axle.head_mm[0]);
        add(true, &format!("a spanner of {flats} mm for the nut of the axle"));
        add(design.joint().is_some(), "pliers to crimp the sleeve");
    }
    let bearing = bill.mount.as_ref().and_then(|m| m.bearing).or(bill.pulley_bearing);
    add(bearing.is_some(), "a vice to press the bearing into the pulley");
    add(
        c.layout.substrate == Substrate::Silicone || has_pins,
        "a luggage scale or a set of weights to check the switch",
    );
    tools
}
