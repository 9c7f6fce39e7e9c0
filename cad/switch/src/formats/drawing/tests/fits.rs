//! Every hole and every peg that meets another body has a tolerance and a purpose.

use super::{built, text_of};
use pinswitch_drafting::Sheet;

/// All tolerances.
const TOLERANCES: [&str; 7] = ["+0.1/0", "+0.2/0", "0/-0.2", "\u{b1}0.07", "H12", "H13", "H14"];
/// Holes without a mating part: the bore for the inner ring of the bearing, and the vents of the lid.
const FREE: [(&str, &str); 3] =
    [("guide-pulley", "\u{d8}18 through"), ("guide-pulley-2", "\u{d8}18 through"), ("mould-lid", "\u{d8}")];

/// Every kind of hardware on every mount, with other sizes than the defaults.
fn sets() -> Vec<String> {
    let fasteners = [
        "",
        "kind = \"screw\"\ndowel_diameter_mm = 2.0\n",
        "kind = \"insert\"\nhead_recess_mm = 1.6\n",
        "hole_diameter_mm = 3.2\nhead_recess_mm = 1.2\n",
        "hole_diameter_mm = 2.4\ncount = 3\ndowel_diameter_mm = 1.5\n",
        "count = 0\ndowel_diameter_mm = 2.0\n",
    ];
    let mounts = [
        "",
        "kind = \"flange\"\n[tendon]\nsheath_diameter_mm = 4.0\n",
        "kind = \"joint\"\nhole_diameter_mm = 6.6\n",
        "kind = \"rig\"\nhole_diameter_mm = 6.6\n[tendon]\nsheath_diameter_mm = 4.0\n",
        "kind = \"rig\"\n",
        "kind = \"rig\"\n[rig]\ncell = \"bar\"\n[print]\nbed_mm = 165.0\n",
    ];
    let others = [
        "",
        "[parts]\nguide_pulley = true\n[mould]\nkey_diameter_mm = 2.5\nkey_height_mm = 3.0\nclearance_mm = 0.05\n",
        "[mould]\nkind = \"one-piece\"\n",
    ];
    let mut all = Vec::new();
    for (i, fastener) in fasteners.iter().enumerate() {
        for (k, mount) in mounts.iter().enumerate() {
            let other = others[(i + k) % others.len()];
            all.push(format!("[layout]\npins = [5, 8, 11]\n[fasteners]\n{fastener}[mount]\n{mount}{other}"));
        }
    }
    all
}

fn has_tolerance(line: &str) -> bool {
    TOLERANCES.iter().any(|t| line.contains(t))
}

/// Lines of callouts of holes, pegs and grooves without a tolerance or a purpose.
fn missing_fits(sheet: &Sheet) -> Vec<String> {
    let mut missing = Vec::new();
    for a in &sheet.annotations {
        let is_hole = a.key.starts_with("hole ");
        let is_free = |line: &str| FREE.iter().any(|(part, w)| sheet.name == *part && line.contains(w));
        let meets = |line: &str| match a.key.split(' ').next() {
            Some("hole") => line.contains('\u{d8}') || line.contains("hexagon"),
            Some("round") => sheet.name.starts_with("mould") && line.contains('\u{d8}'),
            Some("groove") => sheet.name != "coupon" && line.contains(" R") && !line.contains(" on R"),
            _ => false,
        };
        // The zone of a position has no tolerance of its own.
        let sizes = a.text.lines().filter(|l| !l.starts_with("position "));
        let of_lines = sizes.filter(|l| meets(l) && !has_tolerance(l) && !is_free(l));
        missing.extend(of_lines.map(|l| format!("{}, {}: {l:?}", sheet.name, a.key)));
        let is_fitted = is_hole && has_tolerance(&a.text);
        if is_fitted && !a.text.contains("for ") {
            missing.push(format!("{}, {}: no purpose in {:?}", sheet.name, a.key, a.text));
        }
    }
    missing
}

#[test]
fn mating_features_have_a_tolerance() {
    let (mut drawn, mut missing) = (0, Vec::new());
    for text in sets() {
        let Some(built) = built(&text) else { continue };
        drawn += 1;
        let sheets = super::sheets(&built);
        missing.extend(sheets.iter().flat_map(missing_fits).map(|o| format!("{text:?}: {o}")));
    }
    assert!(drawn >= 20, "only {drawn} sets were drawn");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// All texts of a part.
fn texts_of(text: &str, part: &str) -> String {
    let built = built(text).unwrap();
    let all = super::sheets(&built);
    let sheet = all.iter().find(|s| s.name == part).unwrap();
    sheet.annotations.iter().map(|a| a.text.as_str()).collect::<Vec<_>>().join("\n")
}

#[test]
fn fits_match_the_mating_parts() {
    let rig = "[layout]\npins = [5, 8, 11]\n[mount]\nkind = \"rig\"\n[tendon]\nsheath_diameter_mm = 4.0\n";
    let plate = texts_of(rig, "rig-plate");
    for words in [
        "\u{d8}6.6 H13 through, for M6",
        "hexagon AF 13.2 +0.2/0",
        "\u{d8}8.4 H12",
        "for M8",
        // The holes of the shell and those of the sheath stop are equal, and have one callout.
        "4 \u{d7} \u{d8}6 +0.2/0",
        "\u{d8}3.4 H13",
        "for M3",
    ] {
        assert!(plate.contains(words), "{words} is not in {plate:?}");
    }
    let of = [
        (rig, "guide-pulley", "\u{d8}22.1 +0.1/0, 7 deep, near face, for bearing 608"),
        (rig, "pulley-spacer", "\u{d8}8.4 H12 through, for M8"),
        (rig, "sheath-stop", "\u{d8}3.4 H13 through, for M3"),
        ("[parts]\nguide_pulley = true\n", "guide-pulley", "+0.1/0, 7 deep, near face, for bearing 608"),
        ("[mount]\nkind = \"joint\"\n", "link-distal", "\u{d8}5.1 +0.1/0 through, for axle M5"),
        ("[mount]\nkind = \"joint\"\n", "link-proximal", "hexagon AF 8.2 +0.2/0"),
        ("[fasteners]\ndowel_diameter_mm = 2.0\n", "shell", "\u{d8}2.1 +0.1/0 through, for dowel 2"),
        ("[fasteners]\ndowel_diameter_mm = 2.0\n", "support-left", "\u{d8}2.1 +0.1/0, 1.5 deep"),
        ("", "support-right", "hexagon AF 5.7 +0.2/0, 1.5 deep, far face\nfor nut M3"),
        ("", "shell", "groove R0.5 +0.1/0"),
        ("", "mould-ring", "rib R0.5 \u{b1}0.07"),
        ("", "silicone-layer", "groove R0.5 \u{b1}0.07"),
        (
            "",
            "mould-core",
            "key \u{d8}3 0/-0.2, 2.5 0/-0.2 high,\n\u{d8}2 0/-0.2 at its head, for hole \u{d8}3.4",
        ),
        (
            "",
            "mould-ring",
            "\u{d8}3.4 +0.2/0, 2.9 +0.2/0 deep, far face,\n\u{d8}2.4 +0.2/0 at its end, for key",
        ),
        ("", "mould-lid", "\u{d8}3.4 +0.2/0 through, for key \u{d8}3"),
    ];
    for (text, part, words) in of {
        let texts = texts_of(text, part);
        assert!(texts.contains(words), "{part}: {words:?} is not in {texts:?}");
    }
}

/// The coupon measures the machine in steps that a tolerance would hide.
#[test]
fn the_coupon_has_no_tolerances() {
    let built = built("").unwrap();
    let all = super::sheets(&built);
    let coupon = all.iter().find(|s| s.name == "coupon").unwrap();
    assert!(coupon.annotations.iter().all(|a| !has_tolerance(&a.text)), "{:?}", coupon.annotations);
    assert!(text_of(coupon, "slots").contains("\n1.04, 1.09, 1.14, "), "{}", text_of(coupon, "slots"));
    let words = super::complete::texts(coupon).join(" ");
    assert!(words.contains("the coupon measures the machine"), "{words}");
}
