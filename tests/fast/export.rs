//! `export`: tables and models for robot simulators.

use crate::harness::{done, json, pinswitch};
use serde_json::Value;

fn table(folder: &std::path::Path) -> Value {
    read(&folder.join("switch.json"))
}

fn read(file: &std::path::Path) -> Value {
    serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap()
}

#[test]
fn tables_contain_the_curve() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    done(path, &["export", "three-double", "--to", "fmu", "--out", "unit"]);
    let (table, curve) = (table(&path.join("unit")), json(path, &["predict", "three-double", "--json"]));
    assert_eq!(table["load_n"], curve["load_n"]);
    assert_eq!(table["eccentric_n"][0], curve["eccentric_n"]);
    assert_eq!(table["concentric_n"][0], curve["concentric_n"]);
    assert!(std::fs::read(path.join("unit/switch.fmu")).unwrap().starts_with(b"PK"));
}

#[test]
fn fingers_have_a_table_over_the_wrap() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let export = |out: &str, more: &[&str]| {
        let arguments =
            ["export", "three-double", "--set", "friction.points=5", "--to", "mujoco", "--out", out];
        done(path, &[&arguments[..], more].concat());
        table(&path.join(out))
    };
    let finger = export("finger", &["--draws", "2", "--flexion", "60"]);
    let wraps = finger["wrap_rad"].as_array().unwrap();
    assert!((wraps.last().unwrap().as_f64().unwrap() - 60f64.to_radians()).abs() < 1e-12);
    let friction = |wrap: usize| {
        let at = |key: &str| finger[key][wrap][4].as_f64().unwrap();
        at("concentric_n") - at("eccentric_n")
    };
    assert!((1..wraps.len()).all(|i| friction(i) > friction(i - 1)), "more wrap, more friction");
    let drawn = |folder: &str, number: u32| read(&path.join(format!("{folder}/switch-00{number}.json")));
    assert_ne!(drawn("finger", 1), drawn("finger", 2));
    let second = std::fs::read_to_string(path.join("finger/finger-002.xml")).unwrap();
    assert!(second.contains("data=\"switch-002.json\""), "{second}");
    // The same seed draws the same models.
    export("again", &["--draws", "2", "--flexion", "60", "--seed", "1"]);
    assert_eq!(drawn("finger", 2), drawn("again", 2));
    let xml = std::fs::read_to_string(path.join("finger/finger.xml")).unwrap();
    assert!(xml.contains("range=\"0 60\"") && xml.contains("data=\"switch.json\""));
}

/// The paper's law holds at the wrap of its layouts; a joint changes its wrap, also in a unit.
#[test]
fn tables_have_the_wraps_that_apply() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for format in ["csv", "mujoco"] {
        done(path, &["export", "three-double", "--law", "paper", "--to", format, "--out", format]);
        let (table, curve) =
            (table(&path.join(format)), json(path, &["predict", "three-double", "--law", "paper", "--json"]));
        assert_eq!(table["concentric_n"], serde_json::json!([curve["concentric_n"]]));
    }
    let joint = ["export", "three-double", "--set", "mount.kind=joint", "--set", "friction.points=5"];
    done(path, &[&joint[..], &["--to", "fmu", "--out", "unit"]].concat());
    done(path, &[&joint[..], &["--to", "mujoco", "--out", "finger"]].concat());
    let (unit, finger) = (table(&path.join("unit")), table(&path.join("finger")));
    assert!(unit["wrap_rad"].as_array().unwrap().len() > 2);
    assert_eq!(unit, finger);
}

/// Models of an earlier export do not stay among those of the next one; other files do.
#[test]
fn an_export_replaces_the_one_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let export = |more: &[&str]| {
        let arguments = ["export", "three-double", "--set", "friction.points=5", "--out", "finger"];
        done(path, &[&arguments[..], more].concat());
        let mut names: Vec<String> = std::fs::read_dir(path.join("finger"))
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .filter(|name| !name.starts_with('.') && name != "provenance.json")
            .collect();
        names.sort();
        names
    };
    assert_eq!(export(&["--to", "mujoco", "--draws", "3"]).len(), 12);
    std::fs::write(path.join("finger/mine.txt"), "dear").unwrap();
    std::fs::write(path.join("finger/switch-003.csv"), "changed").unwrap();
    let left = export(&["--to", "urdf", "--draws", "1"]);
    let expected = [
        "finger-001.urdf",
        "finger.urdf",
        "mine.txt",
        "switch-001.csv",
        "switch-001.json",
        "switch-003.csv",
        "switch.csv",
        "switch.json",
    ];
    assert_eq!(left, expected);
}

/// A set with a joint exports its own links, stops and contacts.
#[test]
fn joints_export_their_geometry() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let text = "[switch]\nname = \"jointed\"\n[layout]\npins = [5, 8, 11]\n\
                [mount]\nkind = \"joint\"\nproximal_mm = 62.0\ndistal_mm = 55.0\nflexion_max_deg = 70.0\n";
    std::fs::write(path.join("joint.toml"), text).unwrap();
    done(path, &["export", "joint.toml", "--to", "mujoco", "--out", "finger"]);
    let xml = std::fs::read_to_string(path.join("finger/finger.xml")).unwrap();
    for part in ["range=\"0 70\"", "pos=\"0.062000 0 0\"", "fromto=\"0 0 0 0.055000 0 0\""] {
        assert!(xml.contains(part), "{part}: {xml}");
    }
    let finger = table(&path.join("finger"));
    let over = json(path, &["finger", "joint.toml", "--joint", "0..70", "--json"]);
    let over = &over["layouts"][0]["over_joint"][1];
    let wraps = finger["wrap_rad"].as_array().unwrap();
    let last = finger["load_n"].as_array().unwrap().len() - 1;
    let mut compared = 0;
    for (row, wrap) in wraps.iter().enumerate() {
        // From stop to stop, the wrap of this joint grows by the flexion, here in steps of 5 degrees.
        let flexion = wrap.as_f64().unwrap().to_degrees();
        let point = &over["points"][flexion.round() as usize];
        assert!((point["joint_deg"].as_f64().unwrap() - flexion).abs() < 1e-6, "{flexion}");
        for (key, tension) in [("concentric_n", "pulling_n"), ("eccentric_n", "holding_n")] {
            let (ours, theirs) = (finger[key][row][last].as_f64().unwrap(), point[tension].as_f64().unwrap());
            assert!((ours / theirs - 1.0).abs() < 1e-6, "{flexion} {key}: {ours} for {theirs}");
            compared += 1;
        }
    }
    assert!(compared >= 24, "{compared}");
    for option in ["--proximal", "--distal", "--flexion", "--wrap-at-straight", "--wrap-per-flexion"] {
        let arguments = ["export", "joint.toml", "--to", "urdf", option, "1", "--out", "other"];
        let output = pinswitch(path, &arguments);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(
            error.contains("jointed has a joint, whose parts determine links, stops and wrap"),
            "{error}"
        );
    }
}

#[test]
fn impossible_fingers_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["export", "three-double", "--to", "urdf", "--out", "finger", "--distal", "0"];
    let output = pinswitch(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(error.contains("distal_mm = 0: outside 1 to 1000"), "{error}");
    assert!(!folder.path().join("finger").exists());
}
