//! PRINTING.md: how to print, cast and assemble this very set, in its own numbers.

use std::fmt::Write as _;

use serde::Serialize;

use super::manifest::{Manifest, PartEntry};
use crate::config::{MouldKind, SubstrateKind};
use crate::design::Design;

/// The guide of a set. `pictures` says whether assembly.png and plate.png lie beside it.
pub fn printing_guide(design: &Design, manifest: &Manifest, pictures: bool) -> String {
    let c = design.configuration();
    let mut text = format!("# Printing and assembling {}\n\n", manifest.name);
    let picture = |text: &mut String, alt: &str, file: &str| {
        if pictures {
            let _ = writeln!(text, "![{alt}]({file})\n");
        }
    };
    picture(&mut text, "The parts, pulled apart", "assembly.png");
    print_section(&mut text, design, manifest);
    picture(&mut text, "The printed parts on a plate", "plate.png");
    if c.layout.substrate == SubstrateKind::Silicone && c.mould.kind != MouldKind::None {
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
            part.name,
            part.file,
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
    for check in checks(design, &manifest.parts) {
        let _ = if check.fine {
            writeln!(text, "- ok: {}", check.words)
        } else {
            writeln!(text, "- **look**: {}; {}", check.words, check.remedy)
        };
    }
    for warning in &manifest.warnings {
        let _ = writeln!(text, "- **warning**: {warning}");
    }
    text.push('\n');
}

fn bridge(mm: f64) -> String {
    if mm > 0.0 { format!("{mm:.2} mm") } else { "none".to_owned() }
}

/// A printability rule and whether this set keeps it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Whether it is kept.
    pub fine: bool,
    /// The rule in this set's numbers.
    pub words: String,
    /// What to change where it is not kept.
    pub remedy: &'static str,
}

/// Longest bridge that prints without sagging, mm (printing.md).
const LONGEST_BRIDGE_MM: f64 = 10.0;

/// The rules of printing.md, in numbers of `design` and its `parts`.
pub fn checks(design: &Design, parts: &[PartEntry]) -> Vec<Check> {
    let c = design.configuration();
    let pitch = c.segment.span_deg.to_radians() / c.segment.grooves as f64;
    let land = 2.0 * (c.shell.outer_radius_mm * (pitch / 2.0).sin() - c.segment.groove_radius_mm);
    let two_lines = 2.0 * c.print.line_mm;
    let check = |fine: bool, remedy: &'static str, words: String| Check { fine, words, remedy };
    let bridge = parts.iter().map(|p| p.widest_bridge_mm).fold(0.0, f64::max);
    let mut all = vec![
        check(
            c.print.line_mm >= c.print.nozzle_mm,
            "raise print.line_mm to the nozzle or more",
            format!("a line of {} mm from a nozzle of {} mm", c.print.line_mm, c.print.nozzle_mm),
        ),
        check(
            c.print.layer_mm <= 0.8 * c.print.nozzle_mm,
            "lower print.layer_mm",
            format!("layers of {} mm, at most four fifths of the nozzle", c.print.layer_mm),
        ),
        check(
            c.support.slot_clearance_mm >= 0.1,
            "raise support.slot_clearance_mm",
            format!(
                "slots {} mm wider than the pins; slicers close gaps under 0.10 mm",
                c.support.slot_clearance_mm
            ),
        ),
        check(
            c.support.slot_floor_mm >= 3.0 * c.print.layer_mm,
            "raise support.slot_floor_mm",
            format!("slot floors of {} mm, three layers or more", c.support.slot_floor_mm),
        ),
        check(
            bridge <= LONGEST_BRIDGE_MM,
            "lower pins.diameter_mm or mould.key_diameter_mm",
            format!("ceilings of up to {bridge:.2} mm to bridge, up to {LONGEST_BRIDGE_MM} mm print well"),
        ),
    ];
    if c.segment.grooves > 1 {
        all.push(check(
            land >= two_lines,
            "raise shell.outer_radius_mm or lower segment.grooves",
            format!("lands of {land:.2} mm between grooves, two lines are {two_lines:.2} mm"),
        ));
    }
    if c.fasteners.count > 0 {
        let rim = (c.shell.wall_mm - c.segment.groove_radius_mm - c.fasteners.hole_diameter_mm) / 2.0;
        all.push(check(
            rim >= 1.0,
            "raise shell.wall_mm or lower fasteners.hole_diameter_mm",
            format!("{rim:.2} mm of wall around the screw holes, 1.0 is good"),
        ));
    }
    all
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
        _ => "Pour slowly at one end until the basin above the layer is full.",
    };
    let release = match c.mould.kind {
        MouldKind::Split => {
            "Lift the lid, slide the ring off along the axis, and peel the layer from the core."
        }
        _ => "Cut along the ledge of the basin, and peel the layer out from one end.",
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
    let bed = if c.layout.substrate == SubstrateKind::Silicone { "silicone layer" } else { "proxy" };
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
