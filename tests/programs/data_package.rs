//! The descriptor of a calibration against the reference implementation of Data Package.

use std::path::Path;
use std::process::Command;

use crate::harness::{done, report_skipped};

/// Frictionless checks the descriptor, sizes and hashes, and every cell against the type of its column.
#[test]
fn frictionless_accepts_a_calibration() {
    let frictionless = Path::new("/tmp/pinswitch-linters/bin/frictionless");
    if !frictionless.exists() {
        report_skipped("frictionless is not installed");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("rig.toml"), "layouts = []\nrepetitions = [4, 4]\nrepetitions_spread = 0\n")
        .unwrap();
    done(path, &["-q", "simulate", "rig.toml", "--out", "rig"]);
    done(path, &["-q", "calibrate", "rig/plateaus.csv", "--out", "calibration"]);
    let validate = || {
        let arguments = ["validate", "calibration/datapackage.json", "--json"];
        Command::new(frictionless).args(arguments).current_dir(path).output().unwrap()
    };
    let output = validate();
    let report = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{report}{}", String::from_utf8_lossy(&output.stderr));
    assert!(report.contains("residuals.csv"), "{report}");
    // It does look at the bytes.
    let residuals = path.join("calibration/residuals.csv");
    let text = std::fs::read_to_string(&residuals).unwrap();
    std::fs::write(&residuals, text.replacen("silicone", "Silicone", 1)).unwrap();
    assert!(!validate().status.success(), "a changed table is accepted");
}
