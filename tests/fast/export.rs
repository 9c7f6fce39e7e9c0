//! `export`: tables and models for robot simulators.

use crate::harness::{done, json, pinswitch};
use serde_json::Value;

fn table(folder: &std::path::Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("switch.json")).unwrap()).unwrap()
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
    let drawn = |number: u32| table(&path.join(format!("finger/draw-00{number}")));
    assert_ne!(drawn(1), drawn(2));
    // The same seed draws the same models.
    export("again", &["--draws", "2", "--flexion", "60", "--seed", "1"]);
    assert_eq!(drawn(2), table(&path.join("again/draw-002")));
    let xml = std::fs::read_to_string(path.join("finger/finger.xml")).unwrap();
    assert!(xml.contains("range=\"0 60\"") && xml.contains("data=\"switch.json\""));
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
