//! Sessions of one rig with the same effect.

use std::path::Path;

use crate::harness::{done, printed};
use serde_json::Value;

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Sessions with the same effect do not weaken each other.
#[test]
fn recurring_offsets_stay_attributed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (seed, name) in [("51", "a"), ("52", "b"), ("53", "c")] {
        let arguments = ["-q", "simulate", "--effect", "load_cell_offset=0.5", "--seed", seed, "--out", name];
        done(path, &arguments);
    }
    let tables = ["a/plateaus.csv", "b/plateaus.csv", "c/plateaus.csv"];
    for count in 1..=3 {
        let output = printed(path, &[&["-q", "calibrate"], &tables[..count], &["--out", "x"]].concat());
        assert!(
            output.contains("verdict: attributed")
                && output.contains("probability >0.999 that the load cell has an offset: 0."),
            "{output}"
        );
        let size = json(&path.join("x/report.json"))["effects"][0]["parameters"]["b"].clone();
        assert!((size["value"].as_f64().unwrap() - 0.5).abs() < 0.05, "{size}");
    }
}
