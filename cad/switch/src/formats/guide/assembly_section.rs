//! How the switch is put together, step by step, and what each step adds to its picture.

use std::fmt::Write as _;

use super::step_picture;
use crate::config::{FastenerKind, MouldKind, MountKind};
use crate::design::Design;
use crate::documents::Manifest;
use crate::parts::{LeftOut, printed, touches};
use crate::scene::Stage;
use pinswitch_friction::{Substrate, pluralise};

/// Writes the section; returns what each of its steps adds.
pub(super) fn assembly_section(
    text: &mut String,
    design: &Design,
    manifest: &Manifest,
    section: usize,
) -> Vec<Stage> {
    let c = design.configuration();
    let bill = &manifest.bill_of_materials;
    let (mut steps, mut stages) = (Vec::new(), Vec::new());
    if bill.pins.number > 0 {
        stages.push(Stage::CutPins);
        steps.push(format!(
            "Cut {} of {} mm and {:.1} mm long ({} to spare); break their edges, polish them.",
            pluralise(bill.pins.number + bill.pins.spares, "pin"),
            bill.pins.diameter_mm,
            bill.pins.length_mm,
            bill.pins.spares
        ));
    }
    let is_silicone = c.layout.substrate == Substrate::Silicone;
    let bed = if is_silicone { "silicone layer" } else { "proxy" };
    // Before the silicone is near: inserts are pressed in hot.
    if bill.fasteners.as_ref().is_some_and(|f| f.inserts > 0) {
        stages.push(Stage::Inserts);
        steps.push(
            "Press the inserts into both ends of the shell's holes with a soldering iron, flush; let the shell cool.".to_owned(),
        );
    }
    stages.push(Stage::Bed);
    let from_where = if is_silicone && c.mould.kind == MouldKind::None {
        format!(
            "Take a silicone layer that was cast before: this set has no mould (`mould.kind = \"none\"`). It is {:.1} mm wide and {} mm \
             thick, smooth inside, where it lies on the shell, with {} outside; the sheet `silicone-layer` of the drawing has all its \
             dimensions. ",
            design.layer_width_mm(),
            c.silicone.thickness_mm,
            pluralise(c.segment.grooves, "groove")
        )
    } else {
        String::new()
    };
    steps.push(format!("{from_where}Lay the {bed} on the shell, grooves outwards."));
    let keeps = if design.stops_mm().is_some() { ", between the stops at its ends" } else { "" };
    if let Some(last) = steps.last_mut() {
        last.insert_str(last.len() - 1, keeps);
    }
    if let Some(d) = &bill.dowels {
        stages.push(Stage::Dowels);
        steps.push(format!(
            "Cut {} dowels of {} mm and {} mm long, and put them into the shell.",
            d.number, d.diameter_mm, d.length_mm
        ));
    }
    let printed = printed(design).unwrap_or_default();
    let supports: Vec<_> = printed.iter().filter(|p| p.name.starts_with("support")).collect();
    // What found no room is left out: there may be no arrow to go by, and no label.
    let has_lost = |what: LeftOut| supports.iter().any(|p| p.left_out.contains(&what));
    let is_marked = c.label.engrave && !has_lost(LeftOut::Arrow);
    let arrow = "the arrow points there, and the `1` stands there.";
    let marks = match (is_marked, has_lost(LeftOut::Label)) {
        (true, false) => {
            format!("Outside it says {}. The load pulls on the side of groove 1: {arrow}", layout_mark(design))
        }
        (true, true) => {
            "The load pulls on the side of groove 1: the arrow outside points there, and the `1` stands there.".to_owned()
        }
        (false, _) if !c.label.engrave => {
            "The supports have no marks (`label.engrave = false`): the load pulls on the side of groove 1, which seen from outside the left support is on the right.".to_owned()
        }
        (false, _) => {
            "There is no room for an arrow on the supports: the load pulls on the side of groove 1, which seen from outside the left support is on the right.".to_owned()
        }
    };
    let says_f = |line: &String| line.contains("F>1") || line.contains("1<F");
    let force = if supports.iter().flat_map(|s| &s.engraved).any(says_f) { " `F` is the load." } else { "" };
    let covered = if is_marked && c.mount.kind != MountKind::None {
        " The mounting plate covers them later: the same marks on the right support stay visible."
    } else {
        ""
    };
    stages.push(Stage::LeftSupport);
    let edge = if is_silicone { "layer's" } else { "proxy's" };
    let has_lip = c.support.lip_depth_mm > 0.0 && !has_lost(LeftOut::Lip);
    let lip = if has_lip { format!(", its lip over the {edge} edge") } else { String::new() };
    steps.push(format!("Put the left support (L) on{lip}. {marks}{force}{covered}"));
    if bill.pins.number > 0 {
        let from = if is_marked { "counted from the `1`" } else { "counted from the load's side" };
        stages.push(Stage::Pins);
        steps.push(format!(
            "Put the {} into {}, {from}, and into the slots of the support.",
            if bill.pins.number == 1 { "pin" } else { "pins" },
            groove_list(&c.layout.pins)
        ));
    }
    let slides =
        if bill.pins.number > 0 { " Every pin must slide to the end of its slot and back." } else { "" };
    stages.push(Stage::RightSupport);
    let joined = match (&bill.fasteners, &bill.dowels) {
        (Some(_), _) => "",
        (None, None) => {
            " No screws hold this set (`fasteners.count = 0`): glue the plates of both supports to the ends of the shell, with ABS cement \
             or epoxy, and keep it out of slots and grooves."
        }
        (None, Some(_)) => {
            " No screws hold this set (`fasteners.count = 0`): the dowels place the supports; glue these to the ends of the shell, with \
             ABS cement or epoxy, and keep it out of slots and grooves."
        }
    };
    steps.push(format!("Put the right support (R) on.{slides}{joined}"));
    if let Some(step) = mounting_step(design, manifest) {
        stages.push(Stage::Mount);
        steps.push(step);
    }
    if let Some(step) = fastening_step(design, manifest) {
        stages.push(Stage::Fasteners);
        steps.push(step);
    }
    // A pulley on somebody else's axle is on no picture of the switch.
    let mut beside = pulley_step(design, manifest);
    if bill.mount.as_ref().is_some_and(|mount| mount.bearing.is_some())
        && let Some(step) = beside.take()
    {
        stages.push(Stage::Pulley);
        steps.push(step);
    }
    stages.push(Stage::Tendon);
    steps.push(format!(
        "Lay {} mm of tendon ({} mm over its coating) over the {}; it touches {:.2} deg.{}",
        bill.tendon.length_mm,
        bill.tendon.outer_diameter_mm,
        carried_by(design, bed),
        c.layout.wrap_angle_deg,
        where_it_lies(design)
    ));
    if let (Some(beside), Some(last)) = (beside, steps.last_mut()) {
        last.insert_str(0, &format!("{beside} "));
    }
    let _ = write!(
        text,
        "## {section}. Assemble\n\nThe pictures show the left support on the left. What a step adds is in colour and apart from its \
         place; what is there already is grey.\n\n"
    );
    for (number, step) in (1..).zip(&steps) {
        let _ = writeln!(text, "{number}. {step}\n\n   ![Step {number}]({})\n", step_picture(number));
    }
    stages
}

/// How plates and shell are joined.
fn fastening_step(design: &Design, manifest: &Manifest) -> Option<String> {
    let c = design.configuration();
    let f = manifest.bill_of_materials.fasteners.as_ref()?;
    let fastening = design.fastening();
    let into = match (f.inserts > 0, fastening.nut_trap) {
        (true, _) => "into the inserts, from both sides",
        (false, Some(_)) if f.nuts == 1 => {
            "from the left, into a nut that lies in the trap of the right support"
        }
        (false, Some(_)) => "from the left, into nuts that lie in the traps of the right support",
        (false, None) if f.nuts == 1 => "and a nut",
        (false, None) => "and nuts",
    };
    let recesses = [fastening.nut_trap, fastening.counterbore, fastening.mount_counterbore];
    let pierced = if recesses.iter().any(Option::is_some) {
        format!(
            " A skin of {} mm closes the holes above every recess, so that no support is needed: break it with the screw.",
            design.membrane_mm()
        )
    } else {
        String::new()
    };
    let tight = if c.fasteners.kind == FastenerKind::Insert || c.layout.substrate != Substrate::Silicone {
        ""
    } else {
        ", finger tight: the layer must bulge freely"
    };
    let screws = match f.right_length_mm {
        Some(right_mm) => format!(
            "{} {} x {} from the left and {} {} x {right_mm} from the right",
            pluralise(f.number / 2, "screw"),
            f.thread,
            f.length_mm,
            f.number / 2,
            f.thread
        ),
        None => format!("{} {} x {}", pluralise(f.number, "screw"), f.thread, f.length_mm),
    };
    Some(format!("Fasten with {screws} {into}{tight}.{pierced}"))
}

/// What the switch is mounted by.
fn mounting_step(design: &Design, manifest: &Manifest) -> Option<String> {
    let c = design.configuration();
    let m = manifest.bill_of_materials.mount.as_ref()?;
    let mut step = match c.mount.kind {
        MountKind::None => return None,
        MountKind::Flange => format!(
            "Lay `base-flange` outside the left support: the same screws hold it, and {} holes of {} mm take the switch to its place.",
            m.holes, m.hole_diameter_mm
        ),
        MountKind::FingerLink => format!(
            "Lay `finger-link` outside the left support: the same screws hold it; its two bores of {} mm are {} mm apart.",
            m.hole_diameter_mm, c.mount.bore_distance_mm
        ),
        MountKind::Rig => format!(
            "Put the axle's bolt through `rig-plate` from below, its head in the pocket, and lay the plate outside the left support: the \
             same screws hold it, and {} holes of {} mm take it to the table. No head stands out below it.",
            m.holes, m.hole_diameter_mm
        ),
    };
    if let Some(hardware) = &m.sheath_stop {
        let _ = write!(
            step,
            " Screw `sheath-stop` on it ({hardware}): the sheath's end rests on the step of its channel."
        );
    }
    Some(step)
}

/// The guide pulley on its axle, on the rig or by itself.
fn pulley_step(design: &Design, manifest: &Manifest) -> Option<String> {
    let bill = &manifest.bill_of_materials;
    let mount = bill.mount.as_ref();
    if let (Some(bearing), Some(axle)) = (mount.and_then(|m| m.bearing), mount.and_then(|m| m.axle.as_ref()))
    {
        return Some(format!(
            "Press the {bearing} bearing into `guide-pulley`. Put `pulley-spacer` on the bolt ({axle}), then the pulley, its bearing \
             towards the plate, washer and nut: it turns freely on the load's side, {} mm from the switch along the tendon, which runs on \
             over it to the load.",
            design.configuration().mount.pulley_distance_mm
        ));
    }
    let bearing = bill.pulley_bearing?;
    Some(format!(
        "Press a {bearing} bearing into `guide-pulley`, and put it on an axle of 8 mm beside the switch, on the load's side: the tendon \
         runs on over it to the load."
    ))
}

/// Where the unloaded tendon lies on the bed beside its pins.
fn where_it_lies(design: &Design) -> String {
    let c = design.configuration();
    let bed = if c.layout.substrate == Substrate::Silicone { "silicone" } else { "proxy" };
    let places: Vec<String> = touches(design)
        .iter()
        .filter(|t| t.pin.is_none())
        .map(|t| format!("{:.1} to {:.1} deg", t.from_rad.to_degrees(), t.to_rad.to_degrees()))
        .collect();
    if places.is_empty() && design.contact().pins().count() > 0 {
        return format!(
            " As a limp string it lies on its pins only; load brings it down to the {bed} between them."
        );
    }
    let radius = design.tendon_axis_radius_mm() - design.tendon_diameter_mm() / 2.0;
    if design.contact().pins().count() == 0 {
        return format!(
            " It lies on the {bed} all the way, {:.1} mm.",
            2.0 * design.half_wrap_rad() * radius
        );
    }
    let length: f64 =
        touches(design).iter().filter(|t| t.pin.is_none()).map(|t| (t.to_rad - t.from_rad) * radius).sum();
    format!(
        " Beside the pins it comes down to the {bed}, and rubs there: as a limp string at {}, {length:.1} mm in all; its stiffness \
         keeps it off at light loads, and load brings more of it down.",
        places.join(" and ")
    )
}

/// What the tendon lies on: the pins, where there is one within the wrap.
fn carried_by<'a>(design: &Design, bed: &'a str) -> &'a str {
    if design.contact().pins().count() > 0 { "pins" } else { bed }
}

/// `groove 5`, `grooves 5, 8 and 11`.
fn groove_list(grooves: &[usize]) -> String {
    let words: Vec<String> = grooves.iter().map(ToString::to_string).collect();
    match words.as_slice() {
        [.., last] if words.len() > 1 => {
            format!("grooves {} and {last}", words[..words.len() - 1].join(", "))
        }
        _ => format!("groove {}", words.join("")),
    }
}

/// What the mark of the layout says.
fn layout_mark(design: &Design) -> String {
    let c = design.configuration();
    let label = design.label();
    if !c.label.text.is_empty() {
        return format!("`{label}`");
    }
    let is_code = !label.contains(['/', 'x']) && !c.layout.pins.is_empty();
    if is_code {
        let grooves = groove_list(&c.layout.pins);
        return format!(
            "`{label}`, the layout: one bit for each of {grooves} as a hexadecimal number, groove 1 the lowest"
        );
    }
    match c.layout.pins.len() {
        0 => format!("`{label}`, the layout: no pins"),
        1 => format!("`{label}`, the layout: one pin, in {}", groove_list(&c.layout.pins)),
        _ => format!("`{label}`, the layout: number of pins, step, and first groove"),
    }
}
