//! An independent rig with scatter on which the study was not tuned: tendon seatings, mounts,
//! masks, a memory, a slow sine, another tendon, two operators. The expected error of each table is
//! compared with a later session of the same rig.

use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::harness::{expect_code, repository};

fn unpack(name: &str, folder: &Path) -> PathBuf {
    let packed = repository("tests/data/second-rig").join(format!("{name}.csv.gz"));
    let mut text = String::new();
    flate2::read::MultiGzDecoder::new(std::fs::File::open(packed).unwrap())
        .read_to_string(&mut text)
        .unwrap();
    let path = folder.join(format!("{name}.csv"));
    std::fs::write(&path, text).unwrap();
    path
}

fn run(arguments: &[&dyn AsRef<OsStr>]) {
    let arguments: Vec<&OsStr> = arguments.iter().map(|a| a.as_ref()).collect();
    expect_code(0, Path::new("."), &arguments);
}

/// Returns the readings of a column of a table.
fn column(path: &Path, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|h| h == name).unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

/// Returns the report of a set, and the ratio of its expected error to the error of its model on
/// the later session.
fn assess(name: &str) -> (Value, f64) {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let out = at.join("out");
    run(&[&"calibrate", &unpack(name, at), &"--out", &out]);
    let next = unpack(&format!("{name}-next"), at);
    let predicted = at.join("predicted.csv");
    run(&[&"predict", &"--model", &out.join("model.toml"), &"--rows", &next, &"--out", &predicted]);
    let misses = column(&predicted, "predicted_N").into_iter().zip(column(&next, "force_N"));
    let squares: Vec<f64> = misses.map(|(p, y)| (p - y).powi(2)).collect();
    let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    let report: Value = serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
    let promised = report["promise_N"].as_f64().unwrap();
    (report, promised / error)
}

/// Returns the ids of the effects, with `unattributed:covariate` for unattributed structure.
fn named(report: &Value) -> Vec<String> {
    let name = |e: &Value| match e["id"].as_str().unwrap() {
        "unattributed" => format!("unattributed:{}", e["covariate"].as_str().unwrap()),
        id => id.to_owned(),
    };
    let mut names: Vec<String> = report["effects"].as_array().unwrap().iter().map(name).collect();
    names.sort();
    names
}

#[test]
fn verdicts_and_expected_errors_are_correct() {
    let sets: [(&str, &[&str]); 10] = [
        ("set-01", &[]),
        ("set-02", &[]),
        ("set-03", &[]),
        ("set-04", &["guide_drag", "rate_dependence"]),
        ("set-05", &["guide_drag", "load_cell_gain"]),
        ("set-06", &["unattributed:load"]),
        ("set-07", &["unattributed:time"]),
        ("set-08", &["unattributed:time"]),
        ("set-09", &["load_cell_offset"]),
        ("set-10", &[]),
    ];
    for (name, truth) in sets {
        let (report, ratio) = assess(name);
        assert_eq!(named(&report), truth, "{name}");
        // In set 03 the friction of every mount differs in the later session, so a single session
        // cannot predict its error.
        let most = if name == "set-03" { 1.4 } else { 1.15 };
        assert!((0.8..most).contains(&ratio), "{name}: {ratio}");
        let verdict = report["verdict"].as_str().unwrap();
        let open = report["limits"].as_array().unwrap().iter().any(|l| l["excluded"] == false)
            || report["invisible"].as_array().unwrap().iter().any(|i| i["possible"].is_array());
        match (truth.is_empty(), open) {
            (true, true) => assert_eq!(verdict, "inconclusive", "{name}"),
            (true, false) => assert_eq!(verdict, "none", "{name}"),
            _ => assert!(["attributed", "unattributed"].contains(&verdict), "{name}: {verdict}"),
        }
        // A small effect in a protocol that confounds it never gives `none`.
        assert!(name != "set-10" || verdict == "inconclusive", "{name}");
    }
}

#[test]
fn scatter_is_a_component_of_noise() {
    let part = |name: &str, part: &str| {
        let (report, _) = assess(name);
        let parts = report["noise_parts"].as_array().unwrap().clone();
        parts.iter().find(|p| p["part"] == part).map(|p| p["size"].as_f64().unwrap())
    };
    // The rigs have 3 and 2 % between series, and 4 % between mounts.
    assert!((0.02..0.05).contains(&part("set-01", "series_scale").unwrap()));
    assert!((0.012..0.032).contains(&part("set-02", "series_scale").unwrap()));
    assert!((0.02..0.061).contains(&part("set-03", "mount").unwrap()));
}
