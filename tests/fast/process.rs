//! The process of a switch from the command line: the cure in guide, bill and curve, and switches as measured.

use std::path::Path;

use serde_json::Value;

use crate::harness::{done, ended, files};

fn generate(folder: &Path, arguments: &[&str]) -> std::collections::BTreeMap<String, Vec<u8>> {
    let format = if arguments.contains(&"--format") { &[][..] } else { &["--format", "guide"][..] };
    done(folder, &[&["-q", "generate"], arguments, format, &["--out", "set", "--force"]].concat());
    files(&folder.join("set"))
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let (code, text) = ended(folder, arguments);
    assert_eq!(code, Some(2), "{arguments:?}: {text}");
    text
}

fn manifest(files: &std::collections::BTreeMap<String, Vec<u8>>) -> Value {
    serde_json::from_slice(&files["manifest.json"]).unwrap()
}

fn guide(files: &std::collections::BTreeMap<String, Vec<u8>>) -> String {
    String::from_utf8(files["PRINTING.md"].clone()).unwrap()
}

/// Guide and bill have the same cure, and where there is none, neither promises the curve.
#[test]
fn guide_bill_and_curve_have_one_cure() {
    let folder = tempfile::tempdir().unwrap();
    for (sets, cure, post_cure, trust) in [
        (&[][..], Some("48 h at 25 °C"), Some("2 h at 130 °C"), "published"),
        (&["process.oven_c=25"], None, None, "extrapolated"),
        (&["process.oven_c=25", "silicone.hardness_shore_a=44"], Some("48 h at 25 °C"), None, "extrapolated"),
        (&["process.silicone=smooth-sil-950"], Some("18 h at 25 °C"), None, "extrapolated"),
        (&["mould.shrinkage_pct=0.9"], Some("4 h at 60 °C"), Some("2 h at 130 °C"), "published"),
        (&["mould.shrinkage_pct=2"], None, None, "extrapolated"),
        (&["silicone.hardness_shore_a=20"], None, None, "extrapolated"),
    ] {
        let options: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let files = generate(folder.path(), &[&["three-double"], options.as_slice()].concat());
        let (manifest, guide) = (manifest(&files), guide(&files));
        let silicone = &manifest["bill_of_materials"]["silicone"];
        assert_eq!(manifest["friction"]["trust"], trust, "{sets:?}");
        let written = |key: &str| {
            let cure = silicone.get(key)?;
            Some(format!("{} h at {} °C", cure["hours"].as_f64()?, cure["temperature_c"].as_f64()?))
        };
        for (key, expected) in [("mould_cure", cure), ("post_cure", post_cure)] {
            assert_eq!(written(key).as_deref(), expected, "{sets:?}: {key}");
        }
        let promised: Vec<&str> =
            guide.split("Cure for ").skip(1).chain(guide.split("outside the mould for ").skip(1)).collect();
        assert_eq!(promised.len(), cure.iter().chain(&post_cure).count(), "{sets:?}: {guide}");
        for (text, expected) in promised.iter().zip(cure.iter().chain(&post_cure)) {
            assert!(text.starts_with(expected), "{sets:?}: {text:.60}");
        }
        if cure.is_none() {
            assert!(guide.contains("**No cure makes this layer**"), "{guide}");
            assert!(!manifest["warnings"].as_array().unwrap().is_empty(), "{sets:?}");
        }
    }
}

/// A cure that the mould or its shrinkage contradicts is refused with a value that agrees.
#[test]
fn contradicting_cures_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (sets, problem) in [
        (
            &["process.cure_c=60"][..],
            "compensates a shrinkage of 0 %, and Sylgard 184 cured at 60 C shrinks by 0.88 %",
        ),
        (
            &["process.cure_c=60", "mould.shrinkage_pct=0.9", "process.material=pla"],
            "a mould of PLA softens above 45 C",
        ),
    ] {
        let options: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let error = refused(folder.path(), &[&["generate", "three-double"], options.as_slice()].concat());
        assert!(error.contains(problem) && error.contains("help: "), "{error}");
        let fixed = [
            &["generate", "three-double", "--fix", "--format", "stl", "--out", "fixed", "--force"],
            options.as_slice(),
        ];
        done(folder.path(), &fixed.concat());
    }
}

/// The shopping list follows from the materials: mass of the parts, and mix of the silicone.
#[test]
fn materials_change_masses_and_mix() {
    let folder = tempfile::tempdir().unwrap();
    let abs = manifest(&generate(folder.path(), &["three-double"]));
    let other = [
        "three-double",
        "--set",
        "process.material=petg",
        "--set",
        "process.silicone=dragon-skin-30",
        "--set",
        "silicone.hardness_shore_a=30",
    ];
    let files = generate(folder.path(), &other);
    let petg = manifest(&files);
    let mass = |m: &Value| m["parts"][0]["mass_g"].as_f64().unwrap();
    assert!((mass(&petg) / mass(&abs) - 1.27 / 1.04).abs() < 1e-9);
    let silicone = &petg["bill_of_materials"]["silicone"];
    assert_eq!((silicone["base_g"].as_f64(), silicone["agent_g"].as_f64()), (Some(5.5), Some(5.5)));
    let guide = guide(&files);
    assert!(guide.contains("Material: PETG.") && guide.contains("of Dragon Skin 30 (1:1)"), "{guide}");
    assert!(!guide.contains("ABS"), "{guide}");
}

/// A measured switch has another curve and the same parts, and its document says what to do.
#[test]
fn measured_switches_have_a_corrected_curve() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["init", "measured", "--out", "measured.toml"]);
    let planned = generate(folder.path(), &["three-double", "--format", "stl"]);
    std::fs::write(
        folder.path().join("soft.toml"),
        "hardness_shore_a = [43.5, 44.5]\nlayer_thickness_mm = 2.1\n",
    )
    .unwrap();
    let made = generate(folder.path(), &["three-double", "--format", "stl", "--measured", "soft.toml"]);
    let stl = |name: &&String| name.ends_with(".stl");
    assert!(planned.keys().any(|name| stl(&name)));
    for name in planned.keys().filter(stl) {
        assert_eq!(planned[name], made[name], "{name}");
    }
    assert_ne!(planned["friction.csv"], made["friction.csv"]);
    let [planned, corrected] = [&planned, &made].map(manifest);
    let threshold = |m: &Value| m["friction"]["threshold_n"].as_f64().unwrap();
    let measured = &corrected["measured"];
    assert_eq!(measured["planned_threshold_n"].as_f64(), Some(threshold(&planned)));
    assert_eq!(measured["measured_threshold_n"].as_f64(), Some(threshold(&corrected)));
    assert!(threshold(&corrected) < 0.85 * threshold(&planned));
    let document = String::from_utf8(made["MEASURED.md"].clone()).unwrap();
    assert!(
        document.contains("cast a layer of") && document.contains("silicone.thickness_mm = 1.9"),
        "{document}"
    );
    // The shipped example is usable unchanged, and `predict` has the same curve as the set.
    done(folder.path(), &["-q", "predict", "three-double", "--measured", "measured.toml"]);
    let csv = done(folder.path(), &["-q", "predict", "three-double", "--measured", "soft.toml"]);
    assert_eq!(csv.as_bytes(), made["friction.csv"]);
    let error =
        refused(folder.path(), &["predict", "three-double", "--measured", "soft.toml", "--law", "layout"]);
    assert!(error.contains("--law"), "{error}");
}
