//! The text of PRINTING.md follows the configuration.

use crate::built::Built;
use crate::config;
use crate::design::Design;
use crate::prediction::Prediction;

fn guide(text: &str) -> String {
    let (configuration, _) = config::read(text, "x.toml").unwrap();
    let built = Built::new(Design::new(configuration).unwrap()).unwrap();
    let prediction = Prediction::of(built.design());
    let set = crate::set::Set::new(&built, &prediction, &crate::formats::named(&["guide"]).unwrap()).unwrap();
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
    assert!(text.contains("over the silicone layer. It is wrapped"), "{text}");
    assert!(!text.contains("over the pins") && !text.contains("touches only its pins"), "{text}");
    assert!(text.contains("raise layout.wrap_angle_deg to 83.5"), "{text}");
    let one = guide("[layout]\npins = [8, 15]\n");
    assert!(one.contains("1 pin is outside the wrap") && one.contains("over the pins"), "{one}");
    assert!(!guide("[layout]\npins = [5, 8, 11]\n").contains("outside the wrap"));
}

/// The guide quotes the engraved label, with the grooves that it means.
#[test]
fn steps_list_grooves_with_pins() {
    let uneven = guide("[layout]\npins = [4, 5, 14]\n");
    assert!(uneven.contains("the label `2018` of the layout (3 of 15: 4 5 14)"), "{uneven}");
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
        bare.contains("over the silicone layer. It is wrapped")
            && bare.contains("touches the silicone over the full wrap")
    );
    assert!(!bare.contains("over the pins") && !bare.contains("A limp tendon"), "{bare}");
    let rigid = guide("[layout]\npins = [5, 8, 11]\nsubstrate = \"abs\"\n");
    assert!(rigid.contains("over the edge of the proxy") && !rigid.contains("edge of the layer"), "{rigid}");
    let both = guide("[layout]\npins = [5, 8, 11]\n");
    assert!(
        both.contains("over the edge of the layer") && both.contains("over the pins. It is wrapped"),
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
    assert!(single.contains("Tighten the 1 screw M3 x ") && single.contains("Cut 1 pin of"), "{single}");
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
    assert!(["flange", "joint", "rig"].iter().all(|kind| on(kind).contains(words)));
    assert!(!on("none").contains(words));
    let unmarked = guide("[mount]\nkind = \"flange\"\n[label]\nengrave = false\n");
    assert!(!unmarked.contains(words) && !unmarked.contains("The arrow points"), "{unmarked}");
    assert!(unmarked.contains("The supports have no marks (`label.engrave = false`)"), "{unmarked}");
}

#[test]
fn a_joint_has_its_axle_and_its_sleeve() {
    let joint = guide("[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"joint\"\naxle_mm = 6.0\n");
    let (list, _) = joint.split_once("## 2. Print").unwrap();
    assert!(list.contains("2 washers and lock nut | 1 | axle of the joint |"), "{list}");
    assert!(list.contains("crimp sleeve for a rope of ") && list.contains("a spanner of 10 mm"), "{list}");
    assert!(!list.contains("guide pulley"), "{list}");
}

#[test]
fn a_guide_pulley_has_its_bearing_and_its_step() {
    let alone = guide("[layout]\npins = [5, 8, 11]\n[parts]\nguide_pulley = true\n");
    assert!(alone.contains("Press a 608 bearing into `guide-pulley`"), "{alone}");
    let rig = guide("[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"rig\"\n");
    let (list, steps) = rig.split_once("## 2. Print").unwrap();
    assert!(list.contains("ball bearing 608 | 2 |"), "{rig}");
    assert!(list.contains("washer and nut | 2 | axles of the guide pulleys |"), "{rig}");
    assert_eq!(steps.matches("608").count(), 1, "{rig}");
    assert!(rig.contains("Put `pulley-spacer` on the bolt (M8 x "), "{rig}");
}
