//! PRINTING.md: how to print, cast and assemble this very set, in its own numbers.

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
    let (text, stages) = printing_guide(built, manifest, &plates);
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
fn printing_guide(built: &Built, manifest: &Manifest, plates: &[Plate<'_>]) -> (String, Vec<Stage>) {
    let design = built.design();
    let c = design.configuration();
    let mut text = format!("# Printing and assembling {}\n\n", escape(&manifest.name));
    let picture = |text: &mut String, alt: &str, file: &str| {
        let _ = writeln!(text, "![{alt}]({file})\n");
    };
    picture(&mut text, "The parts, pulled apart", "assembly.png");
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

fn print_section(text: &mut String, built: &Built, manifest: &Manifest) {
    let design = built.design();
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
    if let Some(brim) = brim(built.printed()) {
        let _ = write!(text, "\n{brim}\n");
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
        let _ = if check.is_satisfied {
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
        _ if c.mould.overfill_mm > 0.0 && s.layers > 1 => {
            "Pour slowly at one end of each until the basins above the layers are full."
        }
        _ if c.mould.overfill_mm > 0.0 => "Pour slowly at one end until the basin above the layer is full.",
        _ if s.layers > 1 => {
            "Pour slowly at one end of each until all are full, and strike them off level with the brim."
        }
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

    /// The layer is smooth inside: its grooves, and nothing like ribs, are outside.
    #[test]
    fn a_layer_that_was_cast_before_is_told_as_it_is() {
        let text = guide("[layout]\npins = [5, 8, 11]\n[mould]\nkind = \"none\"\n");
        assert!(
            text.contains("smooth inside, where it lies on the shell, with 15 grooves outside"),
            "{text}"
        );
        assert!(!text.contains("ribs"), "{text}");
    }

    /// Pins that the tendon does not reach are warned about, and nothing is laid over them.
    #[test]
    fn a_tendon_is_laid_over_pins_that_it_reaches() {
        let text = guide("[layout]\npins = [1, 2, 15]\n");
        assert!(text.contains("**warning**: 3 pins lie outside the wrap of 63.89 deg"), "{text}");
        assert!(text.contains("over the silicone layer; it touches"), "{text}");
        assert!(!text.contains("over the pins") && !text.contains("on its pins only"), "{text}");
        assert!(text.contains("raise layout.wrap_angle_deg to 83.5"), "{text}");
        let one = guide("[layout]\npins = [8, 15]\n");
        assert!(one.contains("1 pin lies outside the wrap") && one.contains("over the pins"), "{one}");
        assert!(!guide("[layout]\npins = [5, 8, 11]\n").contains("outside the wrap"));
    }

    /// Nobody reads a hexadecimal number as grooves unless it is told.
    #[test]
    fn the_mark_of_a_layout_is_told() {
        let uneven = guide("[layout]\npins = [4, 9, 14]\n");
        assert!(
            uneven.contains("`2108`, the layout: one bit for each of grooves 4, 9 and 14")
                || uneven.contains("5/4"),
            "{uneven}"
        );
        let odd = guide("[layout]\npins = [4, 5, 14]\n");
        assert!(odd.contains("`2018`, the layout: one bit for each of grooves 4, 5 and 14"), "{odd}");
        let even = guide("[layout]\npins = [5, 8, 11]\n");
        assert!(even.contains("`3x3/5`, the layout: number of pins, step, and first groove"), "{even}");
        assert!(even.contains("Put the pins into grooves 5, 8 and 11,"), "{even}");
    }

    #[test]
    fn tall_and_thin_parts_want_a_brim() {
        let rigid = guide("[layout]\npins = [5, 8, 11]\n[parts]\nproxy = true\n");
        assert!(rigid.contains("Tall and thin: give `proxy` (13.6 mm high on a foot"), "{rigid}");
        assert!(!guide("[layout]\npins = [5, 8, 11]\n[parts]\nproxy = false\n").contains("brim of"));
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
