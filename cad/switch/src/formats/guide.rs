//! PRINTING.md: how to print, cast and assemble this very set, in its own numbers.

use std::fmt::Write as _;

use super::markdown::escape;
use super::{Format, Inclusion, png};
use crate::built::Built;
use crate::config::MouldKind;
use crate::design::Design;
use crate::design::rules::checklist;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::prediction::Prediction;
use crate::scene::{exploded_png, plate};
use pinswitch_friction::Substrate;
use pinswitch_solid::render::View;

pub(super) const FORMAT: Format =
    Format { name: "guide", about: "PRINTING.md with pictures", inclusion: Inclusion::Default, make };

/// Pixels of the picture of the plate, across and up.
const PLATE_PIXELS: (u32, u32) = (900, 675);

fn make(built: &Built, _: &Prediction, manifest: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let above = View { turn_deg: 0.0, rise_deg: 55.0 };
    Ok(vec![
        OutputFile::new("assembly.png", exploded_png(built)?),
        OutputFile::new("plate.png", png(&plate(built), above, PLATE_PIXELS.0, PLATE_PIXELS.1)?),
        OutputFile::new("PRINTING.md", printing_guide(built.design(), manifest)),
    ])
}

/// The text of the guide; assembly.png and plate.png lie beside it.
fn printing_guide(design: &Design, manifest: &Manifest) -> String {
    let c = design.configuration();
    let mut text = format!("# Printing and assembling {}\n\n", escape(&manifest.name));
    let picture = |text: &mut String, alt: &str, file: &str| {
        let _ = writeln!(text, "![{alt}]({file})\n");
    };
    picture(&mut text, "The parts, pulled apart", "assembly.png");
    print_section(&mut text, design, manifest);
    picture(&mut text, "The printed parts on a plate", "plate.png");
    if c.layout.substrate == Substrate::Silicone && c.mould.kind != MouldKind::None {
        cast_section(&mut text, design, manifest);
    }
    assemble_section(&mut text, design, manifest);
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
    text
}

fn print_section(text: &mut String, design: &Design, manifest: &Manifest) {
    let c = design.configuration();
    let _ = write!(
        text,
        "## 1. Print\n\nMaterial ABS. Layer {} mm, line {} mm, nozzle {} mm, four walls, 100 % infill for the mould, no supports: every file lies in \
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
    if c.parts.coupon {
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
    let _ = write!(
        text,
        "## 2. Cast the silicone\n\n\
         1. Weigh {:.1} g of base and {:.1} g of curing agent ({:.0}:1), {:.1} g in all: the mould takes {:.2} ml ({:.2} g), and less cannot be weighed well.\n\
         2. Mix for three minutes, scraping the walls; degas until it lies flat.\n\
         3. {close} Use no release agent on ABS; a sulphur clay or latex gloves would stop the cure.\n\
         4. {pour}\n\
         5. Cure 48 h at 25 C, or 4 h at 60 C. Hotter than 70 C softens the mould. The mould is made for {} % of shrinkage (0 at 25 C, about 1 at 60 C: `mould.shrinkage_pct`).\n\
         6. {release} Trim flash with a blade. The layer is {:.1} mm wide and {:.1} mm thick.\n\n",
        s.base_g,
        s.agent_g,
        c.silicone.mix_ratio,
        s.mix_g,
        s.pour_ml,
        s.pour_g,
        c.mould.shrinkage_pct,
        design.layer_width_mm(),
        c.silicone.thickness_mm
    );
}

fn assemble_section(text: &mut String, design: &Design, manifest: &Manifest) {
    let c = design.configuration();
    let bill = &manifest.bill_of_materials;
    let mut steps = Vec::new();
    if bill.pins.number > 0 {
        steps.push(format!(
            "Cut {} pins of {} mm and {:.1} mm long ({} to spare); break their edges, polish them.",
            bill.pins.number + bill.pins.spares,
            bill.pins.diameter_mm,
            bill.pins.length_mm,
            bill.pins.spares
        ));
    }
    let bed = if c.layout.substrate == Substrate::Silicone { "silicone layer" } else { "proxy" };
    steps.push(format!("Lay the {bed} on the shell, grooves outwards."));
    steps.push("Put the left support on, its lip over the layer's edge.".to_owned());
    if bill.pins.number > 0 {
        steps.push(format!(
            "Put the pins into grooves {:?}, numbered from 1 along increasing angle, and into the slots of the support.",
            c.layout.pins
        ));
    }
    steps.push("Put the right support on. Every pin must slide to the end of its slot and back.".to_owned());
    if let Some(f) = &bill.fasteners {
        steps.push(format!(
            "Fasten with {} screws {} x {} and nuts, finger tight: the layer must bulge freely.",
            f.number, f.thread, f.length_mm
        ));
    }
    steps.push(format!(
        "Lay {} mm of tendon ({} mm over its coating) over the pins; it touches {:.2} deg.",
        bill.tendon.length_mm, bill.tendon.outer_diameter_mm, c.layout.wrap_angle_deg
    ));
    text.push_str("## 3. Assemble\n\n");
    for (i, step) in steps.iter().enumerate() {
        let _ = writeln!(text, "{}. {step}", i + 1);
    }
    text.push('\n');
}
