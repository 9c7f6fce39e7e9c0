//! PRINTING.md: instructions to print, cast and assemble a set, with its dimensions.

use std::fmt::Write as _;

mod assembly_section;
mod footing;
mod plates_section;

use self::assembly_section::assembly_section;
use self::footing::brim;
use self::plates_section::plates_section;
use super::markdown::escape;
use super::{Format, Inclusion, png};
use crate::built::Built;
use crate::config::MouldKind;
use crate::design::Design;
use crate::design::rules::checklist;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::parallel::map_each;
use crate::plates::{Plate, plates};
use crate::prediction::Prediction;
use crate::scene::{Stage, exploded_png, plate, stage_scene, stage_view};
use pinswitch_friction::Substrate;
use pinswitch_solid::render::View;

pub(super) const FORMAT: Format =
    Format { name: "guide", about: "PRINTING.md with pictures", inclusion: Inclusion::Default, make };

/// Width and height of the picture of a plate, pixels.
const PLATE_PIXELS: (u32, u32) = (900, 675);
/// Width and height of the picture of a step, pixels.
const STEP_PIXELS: (u32, u32) = (512, 384);

fn make(built: &Built, _: &Prediction, manifest: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    let above = View { turn_deg: 0.0, rise_deg: 55.0 };
    let plates = plates(built);
    let mut files = vec![OutputFile::new("assembly.png", exploded_png(built)?)];
    for p in &plates {
        files.push(OutputFile::new(p.picture(), png(&plate(p), above, PLATE_PIXELS.0, PLATE_PIXELS.1)?));
    }
    let (text, stages) = printing_guide(built, manifest, &plates);
    files.extend(step_pictures(built, &stages)?);
    files.push(OutputFile::new("PRINTING.md", text));
    Ok(files)
}

/// The name of the picture of a step, numbered from 1.
fn step_picture(number: usize) -> String {
    format!("step-{number}.png")
}

/// Renders a picture for each step of the assembly.
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

/// The text of the guide, and the bodies that each step of the assembly adds.
fn printing_guide(built: &Built, manifest: &Manifest, plates: &[Plate<'_>]) -> (String, Vec<Stage>) {
    let design = built.design();
    let c = design.configuration();
    let mut text = format!("# Printing and assembling {}\n\n", escape(&manifest.name));
    let picture = |text: &mut String, alt: &str, file: &str| {
        let _ = writeln!(text, "![{alt}]({file})\n");
    };
    picture(&mut text, "Exploded view of the assembly", "assembly.png");
    print_section(&mut text, built, manifest);
    text.push_str(&plates_section(design, manifest, plates));
    let casts = c.layout.substrate == Substrate::Silicone && c.mould.kind != MouldKind::None;
    if casts {
        cast_section(&mut text, design, manifest);
    }
    let stages = assembly_section(&mut text, design, manifest, if casts { 3 } else { 2 });
    let f = &manifest.friction;
    let _ = write!(
        text,
        "## Predicted friction\n\nFriction is {:.2} N ({:.2} to {:.2} N) at a load of {:.2} N ({}). `friction.csv` and \
         `friction.svg` contain the curve.\n",
        f.friction_n,
        f.band_n[0],
        f.band_n[1],
        f.load_n,
        format!("{:?}", f.trust).to_lowercase()
    );
    (text, stages)
}

fn print_section(text: &mut String, built: &Built, manifest: &Manifest) {
    let design = built.design();
    let c = design.configuration();
    let has_mould = manifest.parts.iter().any(|p| p.name.starts_with("mould"));
    let infill = if has_mould { "100 % infill for the mould, " } else { "" };
    let _ = write!(
        text,
        "## 1. Print\n\nMaterial: ABS. Layer {} mm, line {} mm, nozzle {} mm, four walls, {infill}no supports. Every file is in print \
         orientation. Compensate the shrinkage of ABS in the slicer (0.7 % is usual).\n\n| part | file | mass | widest bridge |\n|---|---|---|---|\n",
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
    if let Some(brim) = brim(built.printed()) {
        let _ = write!(text, "\n{brim}\n");
    }
    let foot = if c.print.elephant_foot_mm > 0.0 {
        format!(
            "Bottom edges have a chamfer of {} mm. Disable the elephant-foot compensation of the slicer.",
            c.print.elephant_foot_mm
        )
    } else {
        "Enable the elephant-foot compensation of the slicer (0.2 mm). The parts have no chamfer.".to_owned()
    };
    let _ = write!(text, "\n{foot}\n");
    if c.parts.coupon && !c.layout.pins.is_empty() {
        let _ = write!(
            text,
            "\nPrint `coupon.stl` first and push a pin into each slot. Set `support.slot_clearance_mm` (now {}) to the smallest \
             clearance in which the pin slides, and generate the set again.\n",
            c.support.slot_clearance_mm
        );
    }
    text.push_str("\n### Checks\n\n");
    for check in checklist(design, manifest.widest_bridge_mm()) {
        let _ = if check.is_satisfied {
            writeln!(text, "- ok: {}", escape(&check.statement))
        } else {
            writeln!(text, "- **attention**: {}; {}", escape(&check.statement), escape(&check.remedy))
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
            "Put the ring on the base of the core, with the keys in the holes, and the lid on the ring. Clamp all three with a rubber band. Tape the parting line."
        }
        _ => "Level the tray, with its open side up.",
    };
    let pour = match c.mould.kind {
        MouldKind::Split => "Pour slowly through the funnel until silicone rises in both vents.",
        _ if c.mould.overfill_mm > 0.0 => "Pour slowly at one end until the basin above the layer is full.",
        _ => "Pour slowly at one end until the tray is full, and level the silicone with the brim.",
    };
    let release = match c.mould.kind {
        MouldKind::Split => {
            "Remove the lid, slide the ring off along the axis, and peel the layer from the core."
        }
        _ if c.mould.overfill_mm > 0.0 && c.mould.draft_deg > 0.0 => {
            "Cut along the ledge of the basin, and peel the layer out from one end. Only the walls above the ledge have a draft."
        }
        _ if c.mould.overfill_mm > 0.0 => {
            "Cut along the ledge of the basin, and peel the layer out from one end."
        }
        _ => "Peel the layer out from one end.",
    };
    let reason = if s.mix_g > s.pour_g * c.silicone.waste_factor {
        "smaller amounts are difficult to weigh"
    } else {
        "some remains in the cup"
    };
    let _ = write!(
        text,
        "## 2. Cast the silicone\n\n\
         1. Weigh {:.1} g of base and {:.1} g of curing agent ({:.0}:1), {:.1} g in total. The mould holds {:.2} ml ({:.2} g); {reason}.\n\
         2. Mix for three minutes and scrape the walls of the cup. Degas until the surface is flat.\n\
         3. {close} Do not use a release agent on ABS. Sulphur clay and latex gloves inhibit the cure.\n\
         4. {pour}\n\
         5. Cure for 48 h at 25 \u{b0}C, or for 4 h at 60 \u{b0}C. Above 70 \u{b0}C the mould softens. The mould compensates a shrinkage of {} % (0 at 25 \u{b0}C, about 1 at 60 \u{b0}C: `mould.shrinkage_pct`).\n\
         6. {release} Trim the flash with a blade. {} {:.1} mm wide and {:.1} mm thick.\n\n",
        s.base_g,
        s.agent_g,
        c.silicone.mix_ratio,
        s.mix_g,
        s.pour_ml,
        s.pour_g,
        c.mould.shrinkage_pct,
        "The layer is",
        design.layer_width_mm(),
        c.silicone.thickness_mm
    );
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

    /// Joints without screws, supports without an arrow, and supports without a lip.
    #[test]
    fn steps_describe_joints_and_marks() {
        let glued = guide("[layout]\npins = [5, 8, 11]\n[fasteners]\ncount = 0\n");
        assert!(glued.contains("Glue the plates of both supports to the ends of the shell"), "{glued}");
        let placed = guide("[layout]\npins = [5]\n[fasteners]\ncount = 0\ndowel_diameter_mm = 2.0\n");
        assert!(placed.contains("The dowels locate the supports. Glue the supports"), "{placed}");
        assert!(!guide("[layout]\npins = [5]\n").to_lowercase().contains("glue"));
        let crowded = "[layout]\npins = [3, 8, 13]\n[fasteners]\nkind = \"screw\"\ncount = 5\n";
        let text = guide(crowded);
        let warned = "**warning**: support-left: the arrow to groove 1 does not fit and is left out: ";
        assert!(text.contains(warned), "{text}");
        assert!(
            text.contains("The arrow does not fit on the supports")
                && text.contains("counted from the side of the load"),
            "{text}"
        );
        assert!(!text.contains("The arrow on its outer face") && !text.contains("same marks"), "{text}");
        let flat = guide("[layout]\npins = [5, 8, 11]\n[support]\nlip_depth_mm = 0.0\n");
        assert!(!flat.contains("with its lip over"), "{flat}");
    }

    /// The layer has grooves outside, and no ribs.
    #[test]
    fn an_existing_layer_is_described() {
        let text = guide("[layout]\npins = [5, 8, 11]\n[mould]\nkind = \"none\"\n");
        assert!(text.contains("smooth inside, and has 15 grooves outside"), "{text}");
        assert!(!text.contains("ribs"), "{text}");
    }

    /// Pins outside of the wrap have a warning, and the tendon is not over them.
    #[test]
    fn the_tendon_is_over_pins_within_the_wrap() {
        let text = guide("[layout]\npins = [1, 2, 15]\n");
        assert!(text.contains("**warning**: 3 pins are outside the wrap of 63.89 deg"), "{text}");
        assert!(text.contains("over the silicone layer. It touches"), "{text}");
        assert!(!text.contains("over the pins") && !text.contains("touches only its pins"), "{text}");
        assert!(text.contains("raise layout.wrap_angle_deg to 83.5"), "{text}");
        let one = guide("[layout]\npins = [8, 15]\n");
        assert!(one.contains("1 pin is outside the wrap") && one.contains("over the pins"), "{one}");
        assert!(!guide("[layout]\npins = [5, 8, 11]\n").contains("outside the wrap"));
    }

    /// The guide has grooves, and not the code of the label.
    #[test]
    fn steps_list_grooves_with_pins() {
        let uneven = guide("[layout]\npins = [4, 5, 14]\n");
        assert!(uneven.contains("the label of the layout (3 of 15: 4 5 14)"), "{uneven}");
        assert!(!uneven.contains("2018"), "{uneven}");
        let even = guide("[layout]\npins = [5, 8, 11]\n");
        assert!(even.contains("Put the pins into grooves 5, 8 and 11,"), "{even}");
    }

    #[test]
    fn slender_parts_need_a_brim() {
        let rigid = guide("[layout]\npins = [5, 8, 11]\n[parts]\nproxy = true\n");
        assert!(
            rigid.contains("Slender parts: add a brim of 5 mm to `proxy` (13.6 mm high on a foot"),
            "{rigid}"
        );
        assert!(!guide("[layout]\npins = [5, 8, 11]\n[parts]\nproxy = false\n").contains("brim of"));
    }

    /// Steps do not mention parts that are not in the set.
    #[test]
    fn steps_mention_parts_of_the_set() {
        let bare = guide("[layout]\npins = []\n");
        assert!(
            bare.contains("over the silicone layer. It touches")
                && bare.contains("touches the silicone over the full wrap")
        );
        assert!(!bare.contains("over the pins") && !bare.contains("A limp tendon"), "{bare}");
        let rigid = guide("[layout]\npins = [5, 8, 11]\nsubstrate = \"abs\"\n");
        assert!(
            rigid.contains("over the edge of the proxy") && !rigid.contains("edge of the layer"),
            "{rigid}"
        );
        let both = guide("[layout]\npins = [5, 8, 11]\n");
        assert!(
            both.contains("over the edge of the layer") && both.contains("over the pins. It touches"),
            "{both}"
        );
    }

    /// Sections are numbered without gaps.
    fn assert_numbered(text: &str) {
        let sections = text.lines().filter_map(|l| l.strip_prefix("## ")?.split_once(". "));
        let numbers: Vec<&str> = sections.map(|s| s.0).collect();
        let expected: Vec<String> = (1..=numbers.len()).map(|n| n.to_string()).collect();
        assert_eq!(numbers, expected, "{text}");
    }

    #[test]
    fn sections_match_the_set() {
        let usual = guide("[layout]\npins = [5, 8, 11]\n");
        assert_numbered(&usual);
        assert!(usual.contains("100 % infill for the mould") && usual.contains("push a pin into each slot"));
        assert!(!usual.contains("existing silicone layer") && !usual.contains("608"));

        let without_mould = guide("[layout]\npins = [5, 8, 11]\n[mould]\nkind = \"none\"\n");
        assert_numbered(&without_mould);
        assert!(!without_mould.contains("infill for the mould"), "{without_mould}");
        assert!(without_mould.contains("Use an existing silicone layer"), "{without_mould}");

        let rigid = guide("[layout]\npins = [5, 8, 11]\nsubstrate = \"abs\"\n");
        assert_numbered(&rigid);
        assert!(!rigid.contains("silicone layer") && !rigid.contains("infill for the mould"), "{rigid}");

        let bare = guide("[layout]\npins = []\n");
        assert!(!bare.contains("push a pin into each slot"), "{bare}");
    }

    #[test]
    fn singular_is_used_for_one() {
        let single = guide("[layout]\npins = [8]\n[fasteners]\ncount = 1\n[pins]\nspares = 0\n");
        assert!(single.contains("Fasten with 1 screw M3 x ") && single.contains("Cut 1 pin of"), "{single}");
        let words = ["pins", "screws", "dowels", "layers", "grooves", "holes", "nuts"];
        assert!(words.iter().all(|w| !single.contains(&format!(" 1 {w} "))), "{single}");
    }

    #[test]
    fn the_widest_bridge_has_its_place() {
        let rig = guide("[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"rig\"\n");
        assert!(rig.contains("the pocket for the bolt in rig-plate"), "{rig}");
        assert!(!rig.contains("lower pins.diameter_mm"), "{rig}");
    }

    #[test]
    fn covered_marks_are_noted() {
        let words = "The mounting plate covers the marks";
        let on = |kind: &str| guide(&format!("[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"{kind}\"\n"));
        assert!(["flange", "finger-link", "rig"].iter().all(|kind| on(kind).contains(words)));
        assert!(!on("none").contains(words));
        let unmarked = guide("[mount]\nkind = \"flange\"\n[label]\nengrave = false\n");
        assert!(!unmarked.contains(words) && !unmarked.contains("The arrow points"), "{unmarked}");
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
