//! PRINTING.md: how to print, cast and assemble this very set, in its own numbers.

use std::fmt::Write as _;

mod plates_section;

use self::plates_section::plates_section;
use super::markdown::escape;
use super::{Format, Inclusion, png};
use crate::built::Built;
use crate::config::{FastenerKind, MouldKind, MountKind};
use crate::design::Design;
use crate::design::rules::checklist;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::parallel::map_each;
use crate::parts::{LeftOut, printed, touches};
use crate::plates::{Plate, plates};
use crate::prediction::Prediction;
use crate::scene::{Stage, exploded_png, plate, stage_scene, stage_view};
use pinswitch_friction::Substrate;
use pinswitch_solid::render::View;

pub(super) const FORMAT: Format =
    Format { name: "guide", about: "PRINTING.md with pictures", inclusion: Inclusion::Default, make };

/// Pixels of the picture of the plate, across and up.
const PLATE_PIXELS: (u32, u32) = (900, 675);
/// Pixels of the picture of a step, across and up.
const STEP_PIXELS: (u32, u32) = (512, 384);

fn make(built: &Built, _: &Prediction, manifest: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let above = View { turn_deg: 0.0, rise_deg: 55.0 };
    let plates = plates(built);
    let mut files = vec![OutputFile::new("assembly.png", exploded_png(built)?)];
    for p in &plates {
        files.push(OutputFile::new(p.picture(), png(&plate(p), above, PLATE_PIXELS.0, PLATE_PIXELS.1)?));
    }
    let (text, stages) = printing_guide(built.design(), manifest, &plates);
    files.extend(step_pictures(built, &stages)?);
    files.push(OutputFile::new("PRINTING.md", text));
    Ok(files)
}

/// The name of the picture of a step, from 1.
fn step_picture(number: usize) -> String {
    format!("step-{number}.png")
}

/// A picture for each step of the assembly.
fn step_pictures(built: &Built, stages: &[Stage]) -> Result<Vec<OutputFile>, SetError> {
    let (width, height) = STEP_PIXELS;
    map_each((1..=stages.len()).collect(), |number| {
        let bodies = stage_scene(built, &stages[..number]);
        let view = stage_view(built.design(), stages[number - 1]);
        Ok(OutputFile::new(step_picture(number), png(&bodies, view, width, height)?))
    })
    .into_iter()
    .collect()
}

/// The text of the guide, and what each step of the assembly adds; the pictures of both lie beside it.
fn printing_guide(design: &Design, manifest: &Manifest, plates: &[Plate<'_>]) -> (String, Vec<Stage>) {
    let c = design.configuration();
    let mut text = format!("# Printing and assembling {}\n\n", escape(&manifest.name));
    let picture = |text: &mut String, alt: &str, file: &str| {
        let _ = writeln!(text, "![{alt}]({file})\n");
    };
    picture(&mut text, "The parts, pulled apart", "assembly.png");
    print_section(&mut text, design, manifest);
    text.push_str(&plates_section(design, manifest, plates));
    let casts = c.layout.substrate == Substrate::Silicone && c.mould.kind != MouldKind::None;
    if casts {
        cast_section(&mut text, design, manifest);
    }
    let stages = assemble_section(&mut text, design, manifest, if casts { 3 } else { 2 });
    let f = &manifest.friction;
    let _ = write!(
        text,
        "## What to expect\n\n{:.2} N of friction at {:.2} N of load ({:.2} to {:.2} N), {}. The whole curve is in friction.csv and \
         friction.svg.\n",
        f.friction_n,
        f.load_n,
        f.band_n[0],
        f.band_n[1],
        format!("{:?}", f.trust).to_lowercase()
    );
    (text, stages)
}

fn print_section(text: &mut String, design: &Design, manifest: &Manifest) {
    let c = design.configuration();
    let has_mould = manifest.parts.iter().any(|p| p.name.starts_with("mould"));
    let infill = if has_mould { "100 % infill for the mould, " } else { "" };
    let _ = write!(
        text,
        "## 1. Print\n\nMaterial ABS. Layer {} mm, line {} mm, nozzle {} mm, four walls, {infill}no supports: every file lies in \
         print orientation. Shrinkage: set it in the slicer (0.7 % for ABS is usual), not here.\n\n| part | file | mass | widest ceiling to bridge |\n|---|---|---|---|\n",
        c.print.layer_mm, c.print.line_mm, c.print.nozzle_mm
    );
    for part in &manifest.parts {
        let _ = writeln!(
            text,
            "| {} | {} | {:.2} g | {} |",
            escape(&part.name),
            escape(&part.file),
            part.mass_g,
            bridge(part.widest_bridge_mm)
        );
    }
    let foot = if c.print.elephant_foot_mm > 0.0 {
        format!(
            "Bottom edges carry a chamfer of {} mm: switch the slicer's elephant-foot compensation off.",
            c.print.elephant_foot_mm
        )
    } else {
        "Leave the slicer's elephant-foot compensation on (0.2 mm): the parts carry no chamfer.".to_owned()
    };
    let _ = write!(text, "\n{foot}\n");
    if c.parts.coupon && !c.layout.pins.is_empty() {
        let _ = write!(
            text,
            "\nPrint `coupon.stl` first and push a pin into each slot. Take the smallest clearance in which it slides, set it as \
             `support.slot_clearance_mm` (now {}), and generate again.\n",
            c.support.slot_clearance_mm
        );
    }
    text.push_str("\n### Checks\n\n");
    for check in checklist(design, manifest.widest_bridge_mm()) {
        let _ = if check.is_kept {
            writeln!(text, "- ok: {}", escape(&check.statement))
        } else {
            writeln!(text, "- **look**: {}; {}", escape(&check.statement), escape(&check.remedy))
        };
    }
    for warning in &manifest.warnings {
        let _ = writeln!(text, "- **warning**: {}", escape(warning));
    }
    text.push('\n');
}

fn bridge(mm: f64) -> String {
    if mm > 0.0 { format!("{mm:.2} mm") } else { "none".to_owned() }
}

fn cast_section(text: &mut String, design: &Design, manifest: &Manifest) {
    let c = design.configuration();
    let Some(s) = &manifest.bill_of_materials.silicone else { return };
    let close = match c.mould.kind {
        MouldKind::Split => {
            "Stand the ring on the core's base, keys into holes, lid on top, and clamp all three with a rubber band. Tape the parting line."
        }
        _ => "Stand the tray level, its open side up.",
    };
    let pour = match c.mould.kind {
        MouldKind::Split => "Pour slowly through the funnel until silicone rises in both vents.",
        _ if c.mould.overfill_mm > 0.0 => "Pour slowly at one end until the basin above the layer is full.",
        _ => "Pour slowly at one end until the tray is full, and strike it off level with the brim.",
    };
    let release = match c.mould.kind {
        MouldKind::Split => {
            "Lift the lid, slide the ring off along the axis, and peel the layer from the core."
        }
        _ if c.mould.overfill_mm > 0.0 && c.mould.draft_deg > 0.0 => {
            "Cut along the ledge of the basin, and peel the layer out from one end: above the ledge the walls lean, those \
             of the layer are upright."
        }
        _ if c.mould.overfill_mm > 0.0 => {
            "Cut along the ledge of the basin, and peel the layer out from one end."
        }
        _ => "Peel the layer out from one end.",
    };
    let why = if s.mix_g > s.pour_g * c.silicone.waste_factor {
        "and less cannot be weighed well"
    } else {
        "and some stays in the cup"
    };
    let _ = write!(
        text,
        "## 2. Cast the silicone\n\n\
         1. Weigh {:.1} g of base and {:.1} g of curing agent ({:.0}:1), {:.1} g in all: the mould takes {:.2} ml ({:.2} g), {why}.\n\
         2. Mix for three minutes, scraping the walls; degas until it lies flat.\n\
         3. {close} Use no release agent on ABS; a sulphur clay or latex gloves would stop the cure.\n\
         4. {pour}\n\
         5. Cure 48 h at 25 C, or 4 h at 60 C. Hotter than 70 C softens the mould. The mould is made for {} % of shrinkage (0 at 25 C, about 1 at 60 C: `mould.shrinkage_pct`).\n\
         6. {release} Trim flash with a blade. {} {:.1} mm wide and {:.1} mm thick.\n\n",
        s.base_g,
        s.agent_g,
        c.silicone.mix_ratio,
        s.mix_g,
        s.pour_ml,
        s.pour_g,
        c.mould.shrinkage_pct,
        if s.layers > 1 { format!("The {} layers are", s.layers) } else { "The layer is".to_owned() },
        design.layer_width_mm(),
        c.silicone.thickness_mm
    );
}

/// Writes the section; returns what each of its steps adds.
fn assemble_section(text: &mut String, design: &Design, manifest: &Manifest, section: usize) -> Vec<Stage> {
    let c = design.configuration();
    let bill = &manifest.bill_of_materials;
    let (mut steps, mut stages) = (Vec::new(), Vec::new());
    if bill.pins.number > 0 {
        stages.push(Stage::CutPins);
        steps.push(format!(
            "Cut {} of {} mm and {:.1} mm long ({} to spare); break their edges, polish them.",
            counted(bill.pins.number + bill.pins.spares, "pin"),
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
             thick, its ribs fit the {} of the shell; the sheet `silicone-layer` of the drawing has all its dimensions. ",
            design.layer_width_mm(),
            c.silicone.thickness_mm,
            counted(c.segment.grooves, "groove")
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
    let marks = match (is_marked, has_lost(LeftOut::Label)) {
        (true, false) => {
            "Outside it says the layout. The load pulls on the side of groove 1: the arrow points there, and the `1` stands there."
        }
        (true, true) => {
            "The load pulls on the side of groove 1: the arrow outside points there, and the `1` stands there."
        }
        (false, _) if !c.label.engrave => {
            "The supports have no marks (`label.engrave = false`): the load pulls on the side of groove 1, which seen from outside the left support is on the right."
        }
        (false, _) => {
            "There is no room for an arrow on the supports: the load pulls on the side of groove 1, which seen from outside the left support is on the right."
        }
    };
    let covered = if is_marked && c.mount.kind != MountKind::None {
        " The mounting plate covers them later: the same marks on the right support stay visible."
    } else {
        ""
    };
    stages.push(Stage::LeftSupport);
    let edge = if is_silicone { "layer's" } else { "proxy's" };
    let has_lip = c.support.lip_depth_mm > 0.0 && !has_lost(LeftOut::Lip);
    let lip = if has_lip { format!(", its lip over the {edge} edge") } else { String::new() };
    steps.push(format!("Put the left support (L) on{lip}. {marks}{covered}"));
    if bill.pins.number > 0 {
        let from = if is_marked { "counted from the `1`" } else { "counted from the load's side" };
        stages.push(Stage::Pins);
        steps.push(format!(
            "Put the pins into grooves {:?}, {from}, and into the slots of the support.",
            c.layout.pins
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
        if bill.pins.number > 0 { "pins" } else { bed },
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
            counted(f.number / 2, "screw"),
            f.thread,
            f.length_mm,
            f.number / 2,
            f.thread
        ),
        None => format!("{} {} x {}", counted(f.number, "screw"), f.thread, f.length_mm),
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

/// `1 screw`, `2 screws`.
fn counted(number: usize, word: &str) -> String {
    format!("{number} {word}{}", if number == 1 { "" } else { "s" })
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
    if places.is_empty() {
        return format!(
            " As a limp string it lies on its pins only; load brings it down to the {bed} between them."
        );
    }
    let radius = design.tendon_axis_radius_mm() - design.tendon_diameter_mm() / 2.0;
    if c.layout.pins.is_empty() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config;

    fn guide(text: &str) -> String {
        let (configuration, _) = config::read(text, "x.toml").unwrap();
        let built = Built::new(Design::new(configuration).unwrap()).unwrap();
        let prediction = Prediction::of(built.design());
        let set =
            crate::set::Set::new(&built, &prediction, &super::super::named(&["guide"]).unwrap()).unwrap();
        let bytes = set.files.iter().find(|f| f.name == "PRINTING.md").unwrap().bytes.clone();
        String::from_utf8(bytes).unwrap()
    }

    /// Without screws something else joins, without room for an arrow none is spoken of, and without a lip none.
    #[test]
    fn steps_name_what_holds_and_marks_the_supports() {
        let glued = guide("[layout]\npins = [5, 8, 11]\n[fasteners]\ncount = 0\n");
        assert!(glued.contains("glue the plates of both supports to the ends of the shell"), "{glued}");
        let placed = guide("[layout]\npins = [5]\n[fasteners]\ncount = 0\ndowel_diameter_mm = 2.0\n");
        assert!(placed.contains("the dowels place the supports; glue these"), "{placed}");
        assert!(!guide("[layout]\npins = [5]\n").contains("glue"));
        let crowded = "[layout]\npins = [3, 8, 13]\n[fasteners]\nkind = \"screw\"\ncount = 5\n";
        let text = guide(crowded);
        let warned = "**warning**: support-left: the arrow to groove 1 does not fit and is left out: ";
        assert!(text.contains(warned), "{text}");
        assert!(
            text.contains("no room for an arrow") && text.contains("counted from the load's side"),
            "{text}"
        );
        assert!(!text.contains("the arrow outside") && !text.contains("same marks"), "{text}");
        let flat = guide("[layout]\npins = [5, 8, 11]\n[support]\nlip_depth_mm = 0.0\n");
        assert!(!flat.contains("its lip over"), "{flat}");
    }

    /// What a set does not have is in none of its steps.
    #[test]
    fn steps_name_what_the_set_has() {
        let bare = guide("[layout]\npins = []\n");
        assert!(
            bare.contains("over the silicone layer; it touches")
                && bare.contains("on the silicone all the way")
        );
        assert!(!bare.contains("over the pins") && !bare.contains("Beside the pins"), "{bare}");
        let rigid = guide("[layout]\npins = [5, 8, 11]\nsubstrate = \"abs\"\n");
        assert!(rigid.contains("over the proxy's edge") && !rigid.contains("layer's edge"), "{rigid}");
        let both = guide("[layout]\npins = [5, 8, 11]\n");
        assert!(
            both.contains("over the layer's edge") && both.contains("over the pins; it touches"),
            "{both}"
        );
    }

    /// Numbers of sections and of steps follow each other, whatever is in the set.
    fn assert_numbered(text: &str) {
        let sections = text.lines().filter_map(|l| l.strip_prefix("## ")?.split_once(". "));
        let numbers: Vec<&str> = sections.map(|s| s.0).collect();
        let expected: Vec<String> = (1..=numbers.len()).map(|n| n.to_string()).collect();
        assert_eq!(numbers, expected, "{text}");
    }

    #[test]
    fn a_guide_speaks_of_what_is_in_the_set() {
        let usual = guide("[layout]\npins = [5, 8, 11]\n");
        assert_numbered(&usual);
        assert!(usual.contains("100 % infill for the mould") && usual.contains("push a pin into each slot"));
        assert!(!usual.contains("cast before") && !usual.contains("608"));

        let without_mould = guide("[layout]\npins = [5, 8, 11]\n[mould]\nkind = \"none\"\n");
        assert_numbered(&without_mould);
        assert!(!without_mould.contains("infill for the mould"), "{without_mould}");
        assert!(without_mould.contains("Take a silicone layer that was cast before"), "{without_mould}");

        let rigid = guide("[layout]\npins = [5, 8, 11]\nsubstrate = \"abs\"\n");
        assert_numbered(&rigid);
        assert!(!rigid.contains("silicone layer") && !rigid.contains("infill for the mould"), "{rigid}");

        let bare = guide("[layout]\npins = []\n");
        assert!(!bare.contains("push a pin into each slot"), "{bare}");
    }

    #[test]
    fn one_is_one() {
        let single = guide("[layout]\npins = [8]\n[fasteners]\ncount = 1\n[pins]\nspares = 0\n");
        assert!(single.contains("Fasten with 1 screw M3 x ") && single.contains("Cut 1 pin of"), "{single}");
        let words = ["pins", "screws", "dowels", "layers", "grooves", "holes", "nuts"];
        assert!(words.iter().all(|w| !single.contains(&format!(" 1 {w} "))), "{single}");
    }

    #[test]
    fn the_widest_bridge_of_a_rig_is_told_with_its_place() {
        let rig = guide("[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"rig\"\n");
        assert!(rig.contains("the pocket for the axle's bolt in rig-plate"), "{rig}");
        assert!(!rig.contains("lower pins.diameter_mm"), "{rig}");
    }

    #[test]
    fn marks_under_a_mounting_plate_are_told() {
        let words = "The mounting plate covers them later";
        let on = |kind: &str| guide(&format!("[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"{kind}\"\n"));
        assert!(["flange", "finger-link", "rig"].iter().all(|kind| on(kind).contains(words)));
        assert!(!on("none").contains(words));
        let unmarked = guide("[mount]\nkind = \"flange\"\n[label]\nengrave = false\n");
        assert!(!unmarked.contains(words) && !unmarked.contains("the `1` stands there"), "{unmarked}");
        assert!(unmarked.contains("The supports have no marks (`label.engrave = false`)"), "{unmarked}");
    }

    #[test]
    fn a_guide_pulley_has_its_bearing_and_its_step() {
        let alone = guide("[layout]\npins = [5, 8, 11]\n[parts]\nguide_pulley = true\n");
        assert!(alone.contains("Press a 608 bearing into `guide-pulley`"), "{alone}");
        let rig = guide("[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"rig\"\n");
        assert_eq!(rig.matches("608").count(), 1, "{rig}");
        assert!(rig.contains("Put `pulley-spacer` on the bolt (M8 x "), "{rig}");
    }
}
