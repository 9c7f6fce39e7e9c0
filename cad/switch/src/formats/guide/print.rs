//! The section of printing: coupon, settings, plates, parts and checks.

use super::document::{Block, PictureSource, Step, Table};
use super::footing::brim;
use super::scenes::still;
use crate::built::Built;
use crate::design::rules::checklist;
use crate::documents::Manifest;
use crate::formats::markdown::escape;
use crate::plates::Plate;
use crate::process::instructions;
use crate::scene::{Bench, COUPON};
use pinswitch_friction::{Substrate, pluralise};

pub(super) fn print(built: &Built, manifest: &Manifest, plates: &[Plate<'_>]) -> Vec<Block> {
    let design = built.design();
    let mut blocks = vec![Block::Paragraph(settings(built, manifest))];
    if let Some(brim) = brim(built.printed()) {
        blocks.push(Block::Paragraph(brim));
    }
    blocks.push(Table::block(
        ["part", "file", "face on the bed", "mass", "widest bridge"],
        manifest.parts.iter().map(|part| {
            [
                escape(&part.name),
                escape(&part.file),
                face_on_bed(&part.name).to_owned(),
                format!("{:.2} g", part.mass_g),
                bridge(part.widest_bridge_mm),
            ]
        }),
    ));
    let has_pins = !design.configuration().layout.pins.is_empty();
    blocks.extend(spare_parts(built, manifest).map(Block::Paragraph));
    blocks.extend(coupon(built).map(Block::Step));
    blocks.push(Block::Step(print_step(built, manifest, plates)));
    for (index, plate) in plates.iter().enumerate() {
        let alt = match plate.of {
            1 => "The printed parts on a plate".to_owned(),
            _ => format!("Plate {}", plate.number),
        };
        blocks.push(Block::Picture { file: plate.picture(), alt, source: PictureSource::Plate(index) });
    }
    blocks.push(Block::Step(
        Step::new("Clean the parts")
            .text("Remove brims, strings and the edge of the first layer, which is wider than the others.")
            .text(if has_pins {
                "Clean slots and grooves with a blade, not with a file: a wide slot cannot be repaired."
            } else {
                "Clean grooves with a blade, not with a file."
            })
            .risk_if(
                has_pins,
                "Strings remain in a slot.",
                "A pin moves in jerks; pull the strings out with tweezers.",
            )
            .risk_if(!has_pins, "Strings remain in a groove.", "The layer is not flat on the shell."),
    ));
    blocks.push(Block::Heading { number: None, text: "Checks".to_owned() });
    let mut checks: Vec<String> = checklist(design, manifest.widest_bridge_mm())
        .into_iter()
        .map(|check| match check.is_satisfied {
            true => format!("ok: {}", escape(&check.statement)),
            false => format!("**attention**: {}; {}", escape(&check.statement), escape(&check.remedy)),
        })
        .collect();
    checks.extend(manifest.warnings.iter().map(|warning| format!("**warning**: {}", escape(warning.text()))));
    if !checks.is_empty() {
        blocks.push(Block::List(checks));
    }
    blocks
}

/// Parts that the switch does not need.
fn spare_parts(built: &Built, manifest: &Manifest) -> Option<String> {
    let c = built.design().configuration();
    let has = |name: &str| manifest.parts.iter().any(|part| part.name == name);
    let mut words = Vec::new();
    if has("proxy") && c.layout.substrate == Substrate::Silicone {
        words.push("`proxy` is a rigid copy of the silicone layer, to compare the friction without silicone. The switch does not need it.");
    }
    if has("coupon") && c.layout.pins.is_empty() {
        words.push("`coupon` tests slots for pins. A switch without pins does not need it.");
    }
    (!words.is_empty()).then(|| words.join(" "))
}

fn settings(built: &Built, manifest: &Manifest) -> String {
    let c = built.design().configuration();
    let has_mould = manifest.parts.iter().any(|p| p.name.starts_with("mould"));
    let infill = if has_mould {
        "100 % infill for the mould and 40 % or more for the others, "
    } else {
        "40 % infill or more, "
    };
    let foot = if c.print.elephant_foot_mm > 0.0 {
        format!(
            "Bottom edges have a chamfer of {} mm. Disable the elephant-foot compensation of the slicer.",
            c.print.elephant_foot_mm
        )
    } else {
        "Enable the elephant-foot compensation of the slicer (0.2 mm): the bottom edges have no chamfer."
            .to_owned()
    };
    format!(
        "{} Layer {} mm, line {} mm, nozzle {} mm, four walls, {infill}no support structures. Every file is in print \
         orientation. {foot}",
        instructions::print_material(c),
        c.print.layer_mm,
        c.print.line_mm,
        c.print.nozzle_mm
    )
}

/// The face of a part that is on the bed.
fn face_on_bed(name: &str) -> &'static str {
    match name {
        "shell" | "proxy" | "mould-ring" => "a flat side, axis vertical",
        "mould-core" => "the base",
        "mould-lid" => "the side of the mould",
        "mould-tray" => "the base, open side up",
        "support-left" | "support-right" | "base-flange" | "link-proximal" | "link-distal" | "rig-plate"
        | "rig-plate-2" => "the outer face",
        "coupon" => "the side without figures",
        _ => "a flat side",
    }
}

fn bridge(mm: f64) -> String {
    if mm > 0.0 { format!("{mm:.2} mm") } else { "none".to_owned() }
}

/// Whether the coupon is printed before the other parts.
fn coupon_is_first(built: &Built) -> bool {
    let c = built.design().configuration();
    c.parts.coupon && !c.layout.pins.is_empty()
}

/// The step of the coupon; `None` without coupon or pins.
fn coupon(built: &Built) -> Option<Step> {
    let c = built.design().configuration();
    if !coupon_is_first(built) {
        return None;
    }
    Some(
        Step::new("Print the coupon and choose the clearance")
            .text("Print `coupon.stl` first and push a pin into each slot. The uncut rod will do.")
            .text(
                "The number at a slot is its clearance in hundredths of a millimetre: the slot 20 is 0.20 mm wider than the pin.",
            )
            .text(format!(
                "Find the smallest clearance in which the pin slides by its weight. If it is more than {} mm, generate the set again with \
                 it: `pinswitch generate CONFIG --set support.slot_clearance_mm=0.25 --out DIR`.",
                c.support.slot_clearance_mm
            ))
            .text("Lay the pin into the grooves at the upper edge: half of it is in the groove.")
            .risk(
                "The slots are tighter than their numbers.",
                "No pin enters the slots 10 and 15, which is usual; if it slides only from 35 on, reduce the flow of the printer.",
            )
            .picture(still(Bench::Loose, vec![COUPON.to_owned()], "Coupon")),
    )
}

fn print_step(built: &Built, manifest: &Manifest, plates: &[Plate<'_>]) -> Step {
    let bed_mm = built.design().configuration().print.bed_mm;
    let has_files = !manifest.plates.is_empty();
    let step = Step::new(if plates.len() == 1 { "Print the plate" } else { "Print the plates" });
    let step = match plates {
        [only] if has_files => step.text(format!(
            "`{}` contains all parts on one plate, centred on a bed of {bed_mm} x {bed_mm} mm (`print.bed_mm`). Slice it unchanged.",
            only.package()
        )),
        _ if has_files => {
            let lists: Vec<String> = plates
                .iter()
                .map(|plate| {
                    let names: Vec<&str> =
                        plate.parts.iter().map(|(part, _)| part.part().name.as_str()).collect();
                    format!("`{}` contains {}.", plate.package(), escape(&names.join(", ")))
                })
                .collect();
            step.text(format!(
                "The parts need {} plates of {bed_mm} x {bed_mm} mm (`print.bed_mm`), with a file each. Slice the files unchanged.",
                plates.len()
            ))
            .text(lists.join(" "))
        }
        _ if coupon_is_first(built) => {
            let others = pluralise(manifest.parts.len().saturating_sub(1), "other file");
            step.text(format!("Print the {others} of the table as in the picture."))
        }
        _ => step.text(format!(
            "Print the {} of the table as in the picture.",
            pluralise(manifest.parts.len(), "file")
        )),
    };
    step.risk(
        "A part lifts from the bed at its corners.",
        "Its lower face is not flat on a table; print it again with a brim and a closed chamber.",
    )
}
