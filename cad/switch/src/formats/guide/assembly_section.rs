//! The section of the assembly: its steps, and the bodies that each step adds to its picture.

use std::fmt::Write as _;

use super::step_picture;
use crate::config::{DriveKind, FastenerKind, MouldKind, MountKind};
use crate::design::Design;
use crate::documents::{Manifest, layout_text};
use crate::parts::{LeftOut, printed, touches};
use crate::rig::RigBolts;
use crate::scene::Stage;
use pinswitch_friction::{Substrate, pluralise};

/// Writes the section; returns the bodies that each step adds.
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
            "Cut {} of {} mm, {:.1} mm long ({} spare). Deburr and polish them.",
            pluralise(bill.pins.number + bill.pins.spares, "pin"),
            bill.pins.diameter_mm,
            bill.pins.length_mm,
            bill.pins.spares
        ));
    }
    let is_silicone = c.layout.substrate == Substrate::Silicone;
    let bed = if is_silicone { "silicone layer" } else { "proxy" };
    // Before the silicone, since inserts are hot.
    if bill.fasteners.as_ref().is_some_and(|f| f.inserts > 0) {
        stages.push(Stage::Inserts);
        steps.push(
            "Press the inserts flush into both ends of the holes of the shell with a soldering iron. Let the shell cool.".to_owned(),
        );
    }
    stages.push(Stage::Bed);
    let source = if is_silicone && c.mould.kind == MouldKind::None {
        format!(
            "Use an existing silicone layer: this set has no mould (`mould.kind = \"none\"`). The layer is {:.1} mm wide and {} mm \
             thick, smooth inside, and has {} outside. The sheet `silicone-layer` of the drawing has all dimensions. ",
            design.layer_width_mm(),
            c.silicone.thickness_mm,
            pluralise(c.segment.grooves, "groove")
        )
    } else {
        String::new()
    };
    steps.push(format!("{source}Put the {bed} on the shell, with its grooves outward."));
    let keeps = if design.stops_mm().is_some() { ", between the stops at its ends" } else { "" };
    if let Some(last) = steps.last_mut() {
        last.insert_str(last.len() - 1, keeps);
    }
    if let Some(d) = &bill.dowels {
        stages.push(Stage::Dowels);
        steps.push(format!(
            "Cut {} dowels of {} mm, {} mm long, and put them into the shell.",
            d.number, d.diameter_mm, d.length_mm
        ));
    }
    let printed = printed(design).unwrap_or_default();
    let supports: Vec<_> = printed.iter().filter(|p| p.name.starts_with("support")).collect();
    // Arrow and label may be left out.
    let has_lost = |what: LeftOut| supports.iter().any(|p| p.left_out.contains(&what));
    let is_marked = c.label.engrave && !has_lost(LeftOut::Arrow);
    let marks = match (is_marked, has_lost(LeftOut::Label)) {
        (true, false) => {
            let label = &c.label.text;
            let label = if label.is_empty() {
                format!("the label of the layout ({})", layout_text(c))
            } else {
                format!("the label `{label}`")
            };
            format!(
                "Its outer face has {label} and an arrow. The arrow points to groove 1, on the side of the load; the `1` is on that side."
            )
        }
        (true, true) => {
            "The arrow on its outer face points to groove 1, on the side of the load; the `1` is on that side.".to_owned()
        }
        (false, _) if !c.label.engrave => {
            "The supports have no marks (`label.engrave = false`). Groove 1 is on the side of the load, which is on the right when you look at the outer face of the left support.".to_owned()
        }
        (false, _) => {
            "The arrow does not fit on the supports. Groove 1 is on the side of the load, which is on the right when you look at the outer face of the left support.".to_owned()
        }
    };
    let has_f = |line: &String| line.contains("F>1") || line.contains("1<F");
    let force = if supports.iter().flat_map(|s| &s.engraved).any(has_f) { " `F` is the load." } else { "" };
    let covered = if is_marked && c.mount.kind != MountKind::None {
        " The mounting plate covers the marks; the same marks on the right support stay visible."
    } else {
        ""
    };
    stages.push(Stage::LeftSupport);
    let edge = if is_silicone { "layer" } else { "proxy" };
    let has_lip = c.support.lip_depth_mm > 0.0 && !has_lost(LeftOut::Lip);
    let lip = if has_lip { format!(", with its lip over the edge of the {edge}") } else { String::new() };
    steps.push(format!("Put the left support (L) on the shell{lip}. {marks}{force}{covered}"));
    if bill.pins.number > 0 {
        let from = if is_marked { "counted from the `1`" } else { "counted from the side of the load" };
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
            " This set has no screws (`fasteners.count = 0`). Glue the plates of both supports to the ends of the shell with ABS cement \
             or epoxy. Keep slots and grooves free of it."
        }
        (None, Some(_)) => {
            " This set has no screws (`fasteners.count = 0`). The dowels locate the supports. Glue the supports to the ends of the shell \
             with ABS cement or epoxy. Keep slots and grooves free of it."
        }
    };
    steps.push(format!("Put the right support (R) on the shell.{slides}{joined}"));
    if let Some(step) = mounting_step(design, manifest) {
        stages.push(Stage::Mount);
        steps.push(step);
    }
    if let Some(step) = fastening_step(design, manifest) {
        stages.push(Stage::Fasteners);
        steps.push(step);
    }
    if let Some(step) = joint_step(design, manifest) {
        stages.push(Stage::Joint);
        steps.push(step);
    }
    // A separate pulley is not in the pictures.
    let mut pulley = pulley_step(design, manifest);
    if bill.mount.as_ref().is_some_and(|mount| mount.bearing.is_some())
        && let Some(step) = pulley.take()
    {
        stages.push(Stage::Pulley);
        steps.push(step);
    }
    if let Some(step) = stand_step(design) {
        stages.push(Stage::Stand);
        steps.push(step);
    }
    stages.push(Stage::Tendon);
    steps.push(format!(
        "Put {} mm of tendon ({} mm with its coating) over the {}. It touches {:.2} deg.{}",
        bill.tendon.length_mm,
        bill.tendon.outer_diameter_mm,
        carried_by(design, bed),
        c.layout.wrap_angle_deg,
        bed_contact(design)
    ));
    if let (Some(anchoring), Some(last)) = (anchoring(design, manifest), steps.last_mut()) {
        last.push_str(&anchoring);
    }
    if let (Some(pulley), Some(last)) = (pulley, steps.last_mut()) {
        last.insert_str(0, &format!("{pulley} "));
    }
    if let Some(step) = drive_step(design) {
        stages.push(Stage::Drive);
        steps.push(step);
    }
    let _ = write!(
        text,
        "## {section}. Assemble\n\nThe left support is on the left in the pictures. Added parts are in colour, at a distance from their \
         positions; other parts are grey.\n\n"
    );
    for (number, step) in (1..).zip(&steps) {
        let _ = writeln!(text, "{number}. {step}\n\n   ![Step {number}]({})\n", step_picture(number));
    }
    stages
}

/// The step that fastens the plates to the shell.
fn fastening_step(design: &Design, manifest: &Manifest) -> Option<String> {
    let c = design.configuration();
    let f = manifest.bill_of_materials.fasteners.as_ref()?;
    let fastening = design.fastening();
    let into = match (f.inserts > 0, fastening.nut_trap) {
        (true, _) => "into the inserts, from both sides",
        (false, Some(_)) if f.nuts == 1 => "from the left, into a nut in the trap of the right support",
        (false, Some(_)) => "from the left, into nuts in the traps of the right support",
        (false, None) if f.nuts == 1 => "and a nut",
        (false, None) => "and nuts",
    };
    let recesses = [fastening.nut_trap, fastening.counterbore, fastening.mount_counterbore];
    let pierced = if recesses.iter().any(Option::is_some) {
        format!(
            " A skin of {} mm closes the hole above every recess, so that it prints without support. Break it with the screw.",
            design.membrane_mm()
        )
    } else {
        String::new()
    };
    let tight = if c.fasteners.kind == FastenerKind::Insert || c.layout.substrate != Substrate::Silicone {
        ""
    } else {
        ", finger tight, so that the layer can bulge"
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

/// The step of the mounting plate.
fn mounting_step(design: &Design, manifest: &Manifest) -> Option<String> {
    let c = design.configuration();
    let m = manifest.bill_of_materials.mount.as_ref()?;
    let mut step = match c.mount.kind {
        MountKind::None => return None,
        MountKind::Flange => format!(
            "Put `base-flange` on the outer face of the left support. The same screws fasten it. It has {} mounting holes of {} mm.",
            m.holes, m.hole_diameter_mm
        ),
        MountKind::Joint => format!(
            "Put the axle ({}) through `link-proximal` from outside, with its head in the pocket, and put the link on the outer face of \
             the left support. The same screws fasten it. Its {} holes of {} mm fasten it to the base of the finger.",
            m.axle.as_deref().unwrap_or_default(),
            m.holes,
            m.hole_diameter_mm
        ),
        MountKind::Rig => {
            let (bolts, heads) = if m.pulleys == 1 { ("bolt", "its head") } else { ("bolts", "their heads") };
            let joint = if design.has_board_joint() {
                "Bolt `rig-plate`, `rig-plate-2` and `rig-splice` together, with the splice behind the joint. "
            } else {
                ""
            };
            format!(
                "{joint}Put the {bolts} of the guide pulleys through the board (`rig-plate`) from behind, with {heads} in the pockets, and \
                 put the board on the outer face of the left support. The same screws fasten it."
            )
        }
    };
    if let Some(hardware) = &m.sheath_stop {
        let _ = write!(
            step,
            " Screw `sheath-stop` to it ({hardware}). The end of the sheath rests on the step of its channel."
        );
    }
    Some(step)
}

/// The step of the distal link of a joint.
fn joint_step(design: &Design, manifest: &Manifest) -> Option<String> {
    let joint = design.joint()?;
    let m = manifest.bill_of_materials.mount.as_ref()?;
    let [low, high] = joint.flexion_deg;
    Some(format!(
        "Put a washer on the axle, and the hub of `link-distal` on it, through the hollow of the shell, with its lug between the stops. \
         Put the second washer and the self-locking nut on the axle. Tighten the nut until the link has no play, and loosen it until \
         the link falls by its own weight. It turns from {low} to {high} deg of flexion, at which its lug meets a stop. Its {} holes of \
         {} mm fasten it to the load.",
        m.holes, m.hole_diameter_mm
    ))
}

/// How the tendon of a joint is guided and anchored.
fn anchoring(design: &Design, manifest: &Manifest) -> Option<String> {
    let joint = design.joint()?;
    let sleeve = manifest.bill_of_materials.mount.as_ref()?.crimp_sleeve.as_deref()?;
    let [low, high] = joint.flexion_deg.map(|deg| joint.contact(deg).wrap_rad().to_degrees());
    Some(format!(
        " That is the wrap in the picture, at a flexion of {} deg; it grows from {low:.1} to {high:.1} deg between the stops. Lead \
         the tendon from the motor through the channel of `link-proximal`, over the switch, and through the channel of \
         `link-distal`. Crimp a sleeve on its end ({sleeve}), which rests on the anchor.",
        joint.assembled_deg
    ))
}

/// The step of the guide pulley, on the rig or separate.
fn pulley_step(design: &Design, manifest: &Manifest) -> Option<String> {
    let bill = &manifest.bill_of_materials;
    let mount = bill.mount.as_ref();
    if let (Some(bearing), Some(axle)) = (mount.and_then(|m| m.bearing), mount.and_then(|m| m.axle.as_ref()))
    {
        let both = design.has_drive_pulley();
        let (number, drive) = if both {
            ("each of the two guide pulleys", " `guide-pulley-2` leads it to the drive.")
        } else {
            ("`guide-pulley`", "")
        };
        return Some(format!(
            "Press a {bearing} bearing into {number}. Put `pulley-spacer` on the bolt ({axle}), then the pulley with its bearing toward \
             the board, washer and nut. A pulley turns freely, {} mm of tendon from the switch. `guide-pulley` leads the tendon to the \
             load.{drive}",
            design.configuration().mount.pulley_distance_mm
        ));
    }
    let bearing = bill.pulley_bearing?;
    Some(format!(
        "Press a {bearing} bearing into `guide-pulley`, and mount it on an axle of 8 mm on the side of the load. The pulley leads the \
         tendon to the load."
    ))
}

/// The step of the feet of the rig.
fn stand_step(design: &Design) -> Option<String> {
    let (layout, bolts) = (design.rig_layout()?, RigBolts::new(design)?);
    Some(format!(
        "Bolt `rig-foot-left` and `rig-foot-right` behind the board: 4 bolts M6 x {} from the front, with washers. Put the feet on the \
         table, with the left end of the board {:.0} mm from its edge, so that the guide pulley of the load is beyond the edge. The load \
         hangs {:.0} mm from the edge. Clamp both feet.",
        bolts.foot_mm,
        layout.board_x_mm[0] - layout.edge_x_mm,
        layout.edge_x_mm - layout.load_x_mm
    ))
}

/// The step of cell, drive and load of the rig.
fn drive_step(design: &Design) -> Option<String> {
    let c = design.configuration();
    let (layout, bolts) = (design.rig_layout()?, RigBolts::new(design)?);
    let (thread, number, mm) = bolts.cell;
    let cell = format!(
        "Bolt the load cell to `cell-mount` ({number} x M{thread} x {mm} in its open slots) and screw the eye bolt into its free end."
    );
    let along = layout.drive.x - layout.board_x_mm[1];
    let drive = match c.rig.drive {
        DriveKind::Actuator => format!(
            "Bolt the actuator to `cell-mount` (M{0} x {1}, {2} washers under its eye) and to `actuator-foot` (M{0} x {3}). Clamp the foot \
             with its bolt {along:.0} mm from the right end of the board.",
            bolts.drive_thread_mm, bolts.pin_mm, layout.packing, bolts.axle_mm
        ),
        DriveKind::Crank => format!(
            "Bolt `crank-drum` to `crank-foot` (M8 x {}) and `crank-knob` to its lever. Clamp the foot with the axle {along:.0} mm from the \
             right end of the board. Tie a tendon from the bolt of `cell-mount` to the drum. The M5 bolt through a hole of the drum locks it.",
            bolts.axle_mm
        ),
    };
    Some(format!(
        "{cell} {drive} Crimp the end of the tendon to the eye bolt, and the other end to the hook. With the load lifted, the weights \
         stay below the table top; with the load lowered, they hang {} mm lower and clear the floor. `rig-bill.csv` lists everything to \
         buy, `wiring.svg` shows the connections, and `run-sheet.html` lists the runs.",
        c.rig.stroke_mm
    ))
}

/// The contact of the unloaded tendon with silicone or proxy.
fn bed_contact(design: &Design) -> String {
    let c = design.configuration();
    let bed = if c.layout.substrate == Substrate::Silicone { "silicone" } else { "proxy" };
    let places: Vec<String> = touches(design)
        .iter()
        .filter(|t| t.pin.is_none())
        .map(|t| format!("{:.1} to {:.1} deg", t.from_rad.to_degrees(), t.to_rad.to_degrees()))
        .collect();
    if places.is_empty() && design.contact().pins().count() > 0 {
        return format!(" A limp tendon touches only its pins; load presses it onto the {bed} between them.");
    }
    let radius = design.tendon_axis_radius_mm() - design.tendon_diameter_mm() / 2.0;
    if design.contact().pins().count() == 0 {
        return format!(
            " It touches the {bed} over the full wrap, {:.1} mm.",
            2.0 * design.half_wrap_rad() * radius
        );
    }
    let length: f64 =
        touches(design).iter().filter(|t| t.pin.is_none()).map(|t| (t.to_rad - t.from_rad) * radius).sum();
    format!(
        " A limp tendon also touches the {bed} at {}, {length:.1} mm in total. Its bending stiffness lifts it at light loads; higher \
         loads increase the contact.",
        places.join(" and ")
    )
}

/// The support of the tendon: the pins, if there is one within the wrap.
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
