//! The facts of the rig of a design, for its documents.

use pinswitch_friction::{Substrate, published};
use pinswitch_report::rig::{BoughtItem, Drive, RigFacts};
use std::f64::consts::TAU;

use super::RigBolts;
use crate::config::{CellKind, DriveKind, MountKind};
use crate::design::Design;
use crate::design::rig::{DRUM_MM, LOCKS};
use crate::documents::{Bill, bill_of_materials};

/// Returns the facts; `None` for a design without a rig.
pub fn rig_facts(design: &Design) -> Option<RigFacts> {
    let c = design.configuration();
    if c.mount.kind != MountKind::Rig {
        return None;
    }
    let rig = &c.rig;
    let mut pins = c.layout.pins.clone();
    pins.sort_unstable();
    let cell = match rig.cell {
        CellKind::SBeam => format!("S-beam load cell, M{} at both ends", rig.s_beam_thread_mm),
        CellKind::Bar => format!(
            "Bar load cell, {} x {} x {} mm, 2 x M{} and 2 x M{}",
            rig.bar_length_mm, rig.bar_side_mm, rig.bar_side_mm, rig.bar_screw_mm, rig.bar_load_thread_mm
        ),
    };
    let drive = match rig.drive {
        DriveKind::Actuator => Drive::Actuator { full_speed_mm_s: rig.full_speed_mm_s },
        DriveKind::Crank => {
            let around = TAU * (DRUM_MM + design.tendon_diameter_mm() / 2.0);
            Drive::Crank { step_mm: (around / LOCKS as f64 * 100.0).round() / 100.0 }
        }
    };
    Some(RigFacts {
        name: c.switch.name.to_string(),
        pins,
        has_silicone: c.layout.substrate == Substrate::Silicone,
        has_proxy: c.parts.proxy || c.layout.substrate == Substrate::Abs,
        wrap_angle_deg: c.layout.wrap_angle_deg,
        hook_mass_g: rig.hook_mass_g,
        weights_g: published::WEIGHTS_G.to_vec(),
        cell,
        cell_limit_n: rig.cell_limit_n,
        sample_rate_hz: rig.sample_rate_hz,
        drive,
        stroke_mm: rig.stroke_mm,
        items: items(design, &bill_of_materials(design)),
    })
}

/// Mechanical items, in the order of the assembly.
fn items(design: &Design, bill: &Bill) -> Vec<BoughtItem> {
    let mut all = Vec::new();
    let mut add = |quantity: usize, item: String, purpose: &str| {
        if quantity > 0 {
            all.push(BoughtItem::new(quantity, item, purpose));
        }
    };
    let pins = &bill.pins;
    add(
        pins.number + pins.spares,
        format!("Pin {} x {} mm, polished steel", pins.diameter_mm, pins.length_mm),
        "switch",
    );
    if let Some(f) = &bill.fasteners {
        let right = f.right_length_mm.map_or(0, |_| f.number / 2);
        let screw = |mm: f64| format!("Socket screw {} x {mm} (ISO 4762)", f.thread);
        add(f.number - right, screw(f.length_mm), "switch on the board");
        add(right, screw(f.right_length_mm.unwrap_or(f.length_mm)), "right support");
        add(f.nuts, format!("Nut {} (ISO 4032)", f.thread), "switch on the board");
        add(f.inserts, format!("Heat-set insert {}", f.thread), "shell");
    }
    if let Some(d) = &bill.dowels {
        add(d.number, format!("Dowel {} x {} (ISO 2338)", d.diameter_mm, d.length_mm), "shell and supports");
    }
    if let Some(mount) = &bill.mount {
        let pulleys = mount.pulleys;
        add(pulleys, format!("Bearing {}", mount.bearing.unwrap_or_default()), "guide pulleys");
        if let Some(mm) = mount.axle_length_mm {
            add(pulleys, format!("Hexagon bolt M8 x {mm} (ISO 4017)"), "axles of the guide pulleys");
            add(pulleys, "Washer M8 (ISO 7089)".to_owned(), "axles of the guide pulleys");
            add(pulleys, "Nut M8 (ISO 4032)".to_owned(), "axles of the guide pulleys");
        }
        if let Some(screw) = &mount.stop_screw {
            add(2, format!("Socket screw {screw} (ISO 4762) with nut"), "sheath stop");
        }
    }
    if let Some(bolts) = RigBolts::new(design) {
        rig_items(design, &bolts, &mut add);
    }
    let tendon = &bill.tendon;
    add(
        1,
        format!(
            "Coated rope {} mm, core {} mm, {} mm long",
            tendon.outer_diameter_mm, tendon.rope_diameter_mm, tendon.length_mm
        ),
        "tendon",
    );
    add(4, format!("Crimp sleeve for a rope of {} mm", tendon.outer_diameter_mm), "loops of the tendon");
    all
}

/// Items of the stand, of the cell and of the drive.
fn rig_items(design: &Design, bolts: &RigBolts, add: &mut impl FnMut(usize, String, &str)) {
    let c = design.configuration();
    add(4, format!("Hexagon bolt M6 x {} (ISO 4014)", bolts.foot_mm), "feet");
    add(8, "Washer M6 (ISO 7089)".to_owned(), "feet");
    add(4, "Nut M6 (ISO 4032)".to_owned(), "feet");
    add(4, "G-clamp, opening 60 mm or more".to_owned(), "feet of board and drive on the table");
    if let Some((thread, mm)) = bolts.splice {
        add(4, format!("Hexagon bolt M{thread} x {mm} (ISO 4017) with nut"), "joint of the board");
    }
    let (thread, number, mm) = bolts.cell;
    let kind = if RigBolts::has_socket_screws(design) {
        format!("Socket screw M{thread} x {mm} (ISO 4762)")
    } else {
        format!("Hexagon bolt M{thread} x {mm} (ISO 4017)")
    };
    add(number, kind, "cell on its mount");
    add(number, format!("Washer M{thread} (ISO 7089)"), "cell on its mount");
    let eye = match c.rig.cell {
        CellKind::SBeam => c.rig.s_beam_thread_mm,
        CellKind::Bar => c.rig.bar_load_thread_mm,
    };
    add(1, format!("Eye bolt M{eye}, eye of 10 mm"), "tendon on the cell");
    let thread = bolts.drive_thread_mm;
    let packing = design.rig_layout().map_or(0, |layout| layout.packing);
    match bolts.crank_mm {
        None => {
            add(
                1,
                format!("Hexagon bolt M{thread} x {} (ISO 4017)", bolts.pin_mm),
                "actuator on the cell mount",
            );
            add(1, format!("Hexagon bolt M{thread} x {} (ISO 4014)", bolts.axle_mm), "actuator on its foot");
            add(packing + 3, format!("Washer M{thread} (ISO 7089)"), "both eyes of the actuator");
            add(2, format!("Lock nut M{thread} (ISO 7040)"), "both eyes of the actuator");
        }
        Some([lock, knob]) => {
            add(
                1,
                format!("Hexagon bolt M{thread} x {} (ISO 4017)", bolts.pin_mm),
                "tendon on the cell mount",
            );
            add(2, format!("Nut M{thread} (ISO 4032)"), "tendon on the cell mount");
            add(1, format!("Hexagon bolt M8 x {} (ISO 4014)", bolts.axle_mm), "axle of the drum");
            add(2, "Washer M8 (ISO 7089)".to_owned(), "axle of the drum");
            add(1, "Lock nut M8 (ISO 7040)".to_owned(), "axle of the drum");
            add(1, format!("Hexagon bolt M5 x {lock} (ISO 4014)"), "locking pin of the drum");
            add(1, format!("Hexagon bolt M6 x {knob} (ISO 4014)"), "knob");
            add(2, "Washer M6 (ISO 7089)".to_owned(), "knob");
            add(1, "Lock nut M6 (ISO 7040)".to_owned(), "knob");
        }
    }
}
