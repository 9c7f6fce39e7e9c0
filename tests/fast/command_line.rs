//! The binary end to end: the commands of README, the content of the files, and the same bytes from
//! every run.

use crate::harness::{done, ended, files, json, pinswitch, printed, repository, sha256};
use serde_json::Value;

#[test]
fn first_command_makes_a_valid_set() {
    let folder = tempfile::tempdir().unwrap();
    // In a clone, the template is a file.
    let template = repository("templates/three-double.toml");
    done(folder.path(), &["generate", template.to_str().unwrap()]);
    let set = folder.path().join("out/three-double");
    let written = files(&set);
    for name in [
        "shell.stl",
        "mould-core.stl",
        "mould-ring.stl",
        "mould-lid.stl",
        "support-left.stl",
        "support-right.stl",
        "proxy.stl",
        "coupon.stl",
        "friction.csv",
        "friction.svg",
        "manifest.json",
        "assembly.3mf",
        "drawing.svg",
        "drawing.pdf",
        "drawing.dxf",
        "PRINTING.md",
        "assembly.png",
        "plate.png",
        "step-1.png",
        "step-15.png",
        "report.html",
    ] {
        assert!(written.contains_key(name), "{name} is missing");
    }
    assert_eq!(written.len(), 35, "{:?}", written.keys());

    let manifest: Value = serde_json::from_slice(&written["manifest.json"]).unwrap();
    let listed = manifest["files"].as_array().unwrap();
    assert_eq!(listed.len(), written.len() - 1);
    for file in listed {
        let bytes = &written[file["file"].as_str().unwrap()];
        assert_eq!(file["sha256"], sha256(bytes));
    }
    assert_eq!(manifest["bill_of_materials"]["pins"]["number"], 3);
    assert_eq!(manifest["friction"]["trust"], "published");
    assert!(manifest["mesh"]["largest_volume_error"].as_f64().unwrap() < 1e-4);

    let stl: Vec<_> = written.keys().filter(|n| n.ends_with(".stl")).cloned().collect();
    let mut check = vec!["check", "--bodies", "1"];
    check.extend(stl.iter().map(String::as_str));
    let verdict = done(&set, &check);
    assert_eq!(verdict.matches(": valid;").count(), stl.len(), "{verdict}");
}

#[test]
fn every_run_writes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a", "b"] {
        done(folder.path(), &["generate", "six-single", "--out", name]);
    }
    assert_eq!(files(&folder.path().join("a")), files(&folder.path().join("b")));
}

/// The seven measured conditions, with the friction of the paper's model and the measured friction,
/// in newtons (model/doc/friction-laws.md).
const CONDITIONS: [(&str, &str, f64); 7] = [
    ("six-single", "4.07", 5.097),
    ("three-double", "10.01", 9.667),
    ("three-single", "8.90", 8.495),
    ("silicone-only", "13.45", 12.97),
    ("proxy-six-single", "2.77", 3.935),
    ("proxy-three-double", "2.77", 5.829),
    ("proxy-three-single", "2.77", 5.893),
];

fn column(curve: &serde_json::Value, key: &str) -> Vec<f64> {
    curve[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn the_paper_law_equals_the_paper() {
    let folder = tempfile::tempdir().unwrap();
    for (name, friction, _) in CONDITIONS {
        let curve = json(folder.path(), &["predict", name, "--law", "paper", "--json"]);
        assert_eq!((curve["law"].as_str(), curve["trust"].as_str()), (Some("paper"), Some("published")));
        let (load, d) = (column(&curve, "load_n"), column(&curve, "friction_n"));
        assert!((load.last().unwrap() - 49.671).abs() < 1e-9);
        assert_eq!(format!("{:.2}", d.last().unwrap()), friction, "{name}");
    }
}

#[test]
fn default_bands_contain_the_measurements() {
    let folder = tempfile::tempdir().unwrap();
    for (name, _, measured) in CONDITIONS {
        let curve = json(folder.path(), &["predict", name, "--json"]);
        assert_eq!((curve["law"].as_str(), curve["trust"].as_str()), (Some("physics"), Some("published")));
        let (load, d) = (column(&curve, "load_n"), column(&curve, "friction_n"));
        let (e, c, low, high) = (
            column(&curve, "eccentric_n"),
            column(&curve, "concentric_n"),
            column(&curve, "band_low_n"),
            column(&curve, "band_high_n"),
        );
        for i in 0..load.len() {
            assert!(((c[i] - e[i]) / 2.0 - d[i]).abs() < 1e-9 && low[i] <= d[i] && d[i] <= high[i]);
        }
        let last = load.len() - 1;
        assert!(
            low[last] * 1.02 < measured && measured < high[last] / 1.02,
            "{name}: not well inside the band"
        );
        let others = curve["other_laws"].as_array().unwrap();
        assert!(others.iter().any(|law| law["law"] == "paper"), "{name}");
    }
}

#[test]
fn unpublished_layouts_report_their_status() {
    let folder = tempfile::tempdir().unwrap();
    let trust = |set: &str| {
        let curve = json(folder.path(), &["predict", "three-double", "--set", set, "--json"]);
        let reasons = curve["reasons"].as_array().unwrap().iter().map(|r| r.as_str().unwrap().to_owned());
        let trust = curve["trust"].as_str().unwrap().to_owned();
        (curve["law"].as_str().unwrap().to_owned(), trust, reasons.collect::<Vec<_>>().join("; "))
    };
    for (set, word, reason) in [
        ("layout.pins=[5,7,9,11]", "interpolated", "4 pins 11.93 deg apart"),
        ("layout.pins=[5,6]", "extrapolated", "2 pins;"),
        (
            "silicone.thickness_mm=3",
            "extrapolated",
            "layer thickness is 3 mm (published rig: 2 mm); predicted change of friction +",
        ),
        ("shell.outer_radius_mm=140", "extrapolated", "(published rig, assumed: 22 mm)"),
        ("shell.width_mm=20", "extrapolated", "layer width is 19.6 mm"),
        ("silicone.hardness_shore_a=45", "extrapolated", "hardness of the silicone is 45 Shore A"),
        ("silicone.mix_ratio=9", "extrapolated", "silicone.mix_ratio is 9"),
        ("layout.wrap_angle_deg=70", "extrapolated", "wrap angle is 70 deg"),
        ("friction.load_max_n=80", "extrapolated", "exceed the tested range, 3.08 to 49.67 N"),
    ] {
        let (law, trust, reasons) = trust(set);
        assert_eq!((law.as_str(), trust.as_str()), ("physics", word), "{set}");
        assert!(reasons.contains(reason), "{set}: {reasons}");
    }
}

#[test]
fn values_override_presets() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "generate",
        "three-double",
        "--preset",
        "printer-fff-0.4",
        "--set",
        "shell.width_mm=12",
        "--tolerance",
        "0.02",
        "--out",
        "set",
        "--json",
    ];
    let manifest = json(folder.path(), &arguments);
    let setting = |field: &str| {
        let all = manifest["settings"].as_array().unwrap();
        all.iter().find(|s| s["field"] == field).unwrap().clone()
    };
    assert_eq!(setting("print.elephant_foot_mm")["value"], 0.2);
    assert_eq!(setting("layout.pins")["value"], serde_json::json!([5, 8, 11]));
    assert_eq!(setting("shell.width_mm")["value"], 12.0);
    assert_eq!(setting("shell.width_mm")["origin"], "configured");
    assert_eq!(setting("mesh.chord_tolerance_mm")["value"], 0.02);
    assert_eq!(setting("shell.outer_radius_mm")["origin"], "assumed");
    assert_eq!(setting("segment.span_deg")["origin"], "published");
}

#[test]
fn written_template_generates_same_parts() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["init", "three-single", "--out", "mine.toml"]);
    done(folder.path(), &["generate", "mine.toml", "--out", "a"]);
    done(folder.path(), &["generate", "three-single", "--out", "b"]);
    // The manifests differ only in the source.
    let set = |name: &str| {
        let mut all = files(&folder.path().join(name));
        let manifest = String::from_utf8(all.remove("manifest.json").unwrap()).unwrap();
        (all, manifest.replace("../mine.toml", "three-single"))
    };
    assert_eq!(set("a"), set("b"));
    let again = pinswitch(folder.path(), &["init", "three-single", "--out", "mine.toml"]);
    assert_eq!(again.status.code(), Some(2));
}

#[test]
fn help_and_listings_are_complete() {
    let folder = tempfile::tempdir().unwrap();
    let help = printed(folder.path(), &["--help"]);
    for command in
        ["generate", "batch", "merge", "predict", "check", "layouts", "init", "render", "completions", "man"]
    {
        assert!(help.contains(command), "{command}");
        assert!(printed(folder.path(), &[command, "--help"]).contains("Usage"));
    }
    let layouts = done(folder.path(), &["layouts"]);
    assert!(
        layouts.contains("three-double")
            && layouts.contains("9.667 N")
            && layouts.contains("printer-fff-0.4")
    );
    assert_eq!(json(folder.path(), &["layouts", "--json"])["conditions"].as_array().unwrap().len(), 7);
    for shell in ["bash", "zsh", "fish"] {
        assert!(done(folder.path(), &["completions", shell]).contains("pinswitch"));
    }
    let reference = done(folder.path(), &["init", "reference"]);
    assert!(reference.contains("outer_radius_mm = 20.0") && reference.contains("Origin: assumed"));
}

#[test]
fn pictures_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for scene in ["assembled", "exploded", "plate"] {
        done(
            folder.path(),
            &["render", "three-double", "--scene", scene, "--width", "200", "--out", "p.png"],
        );
        assert!(std::fs::read(folder.path().join("p.png")).unwrap().starts_with(b"\x89PNG"));
    }
}

#[test]
fn infinite_angles_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for view in ["--turn=nan", "--rise=inf"] {
        let output = pinswitch(folder.path(), &["render", "three-double", view, "--out", "p.png"]);
        assert_eq!(output.status.code(), Some(2), "{view}");
    }
    assert!(!folder.path().join("p.png").exists());
}

#[test]
fn check_reports_faults() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["generate", "three-double", "--out", "set"]);
    let shell = std::fs::read(folder.path().join("set/shell.stl")).unwrap();
    // Without one facet the mesh has a hole.
    let mut holed = shell.clone();
    holed.truncate(shell.len() - 50);
    let count = u32::from_le_bytes(shell[80..84].try_into().unwrap()) - 1;
    holed[80..84].copy_from_slice(&count.to_le_bytes());
    std::fs::write(folder.path().join("holed.stl"), holed).unwrap();
    std::fs::write(folder.path().join("cut.stl"), &shell[..shell.len() / 2]).unwrap();
    let check = |arguments: &[&str]| {
        let output = pinswitch(folder.path(), arguments);
        let text = [output.stdout, output.stderr].concat();
        (output.status.code(), String::from_utf8(text).unwrap())
    };
    let (code, text) = check(&["check", "holed.stl"]);
    assert!(
        code == Some(1) && text.contains("NOT VALID") && text.contains("3 edges have only one facet"),
        "{text}"
    );
    let (code, text) = check(&["check", "cut.stl"]);
    assert!(code == Some(2) && text.contains("header announces"), "{text}");
    assert_eq!(check(&["check", "no-such.stl"]).0, Some(2));
    assert_eq!(check(&["check", "set/shell.stl", "--bodies", "2"]).0, Some(1));
    let verdict = json(folder.path(), &["check", "set/shell.stl", "--json"]);
    assert_eq!(verdict[0]["valid"], true);
}

#[test]
fn empty_studies_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, words) in [
        (
            &["--study", "1", "--forms", "--only", "singles"][..],
            "--only = singles: no kind of rig in this study has this group or name [unknown-word]\n  help: give one of the groups outside,",
        ),
        (
            &["--study", "1", "--only", "no-such-rig"],
            "one of the groups bench-nulls, bench-outside, bench-pairs, bench-singles, confounded, masks, nulls, outside, pairs, \
             scattered, singles,",
        ),
        (&["--study", "0"], "0 is not in 1..=400"),
        (&["--study", "1", "--first-seed", "18446744073709551615"], "18446744073709551615 is not in"),
    ] {
        let (code, output) = ended(folder.path(), &[&["simulate"], arguments].concat());
        assert_eq!(code, Some(2), "{output}");
        assert!(output.contains(words), "{output}");
    }
}

/// Options without effect are errors.
#[test]
fn ignored_options_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, option) in [
        ("--only nulls --out x", "--only"),
        ("--first-seed 3 --out x", "--first-seed"),
        ("--every-noise --out x", "--every-noise"),
        ("--forms --out x", "--forms"),
        ("--experiments --out x", "--experiments"),
        ("--randomised --runs next-runs.csv --out x", "--randomised"),
        ("--model model.toml --raw --out x", "--model"),
        ("--model model.toml --study 1", "--model"),
        ("--model model.toml --runs r.csv --effects mine.toml --out x", "--effects"),
        ("--rig rig.toml --next --out x", "--rig"),
        ("--rig rig.toml --study 1", "--rig"),
        ("--effects mine.toml --study 1", "--effects"),
    ] {
        let arguments: Vec<&str> = ["simulate"].into_iter().chain(arguments.split(' ')).collect();
        let (code, output) = ended(folder.path(), &arguments);
        assert!(code == Some(2) && output.contains(option), "{arguments:?}: {output}");
        assert!(output.contains("cannot be used with"), "{arguments:?}: {output}");
        assert!(!folder.path().join("x").exists(), "{arguments:?}");
    }
}

#[test]
fn noise_comes_from_a_calibration() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("noisy.toml"), "[noise]\nrepetition_N = 0.3\nseries_scale = 0.04\n").unwrap();
    done(path, &["-q", "simulate", "noisy.toml", "--out", "noisy"]);
    done(path, &["-q", "calibrate", "noisy/plateaus.csv", "--out", "calibration"]);
    done(path, &["-q", "simulate", "--noise", "calibration/model.toml", "--out", "same"]);
    let plan = std::fs::read_to_string(path.join("same/plan.toml")).unwrap();
    let noise = |key: &str| -> f64 {
        let line = plan.lines().find_map(|line| line.strip_prefix(key)?.trim().strip_prefix('='));
        line.unwrap().trim().parse().unwrap()
    };
    assert!((noise("repetition_N") - 0.3).abs() < 0.03, "{plan}");
    assert!((noise("series_scale") - 0.04).abs() < 0.015, "{plan}");
    // The noise hides effects that a quiet rig shows.
    std::fs::write(path.join("plan.toml"), "layouts = []\nrepetitions = [4, 4]\nrepetitions_spread = 0\n")
        .unwrap();
    let attributed = |more: &[&str]| -> u64 {
        let json: Value = serde_json::from_str(&printed(
            path,
            &[&["power", "plan.toml", "--runs", "1", "--json"], more].concat(),
        ))
        .unwrap();
        json.as_array().unwrap().iter().map(|p| p["named"].as_u64().unwrap()).sum()
    };
    let (quiet, noisy) = (attributed(&[]), attributed(&["--noise", "calibration/model.toml"]));
    assert!(noisy < quiet, "{noisy} of {quiet}");
    let (code, output) = ended(path, &["power", "plan.toml", "--noise", "plan.toml"]);
    assert!(code == Some(2) && output.contains("plan.toml"), "{output}");
}
