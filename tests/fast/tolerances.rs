//! `tolerances`: contributions that sum to the scatter, simulated switches, allotted tolerances, files, and refusals.

use crate::harness::{done, expect_code, json, pinswitch};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The first-order scatter is that of the slopes and tolerances, and the simulated one is near it.
#[test]
fn contributions_sum_to_the_scatter() {
    let folder = tempfile::tempdir().unwrap();
    let report = json(folder.path(), &["tolerances", "three-double", "--draws", "500", "--json"]);
    assert_eq!(report["schema"], "pinswitch.tolerances/1");
    let mut variance = 0.0;
    let mut shares = 0.0;
    for dimension in report["dimensions"].as_array().unwrap() {
        let sd = number(&dimension["process"]["plus_minus"]) / number(&report["deviations_per_tolerance"]);
        let slopes = dimension["slopes"].as_array().unwrap();
        assert_eq!(slopes.len() as u64, dimension["count"].as_u64().unwrap());
        variance += slopes.iter().map(|slope| (number(slope) * sd).powi(2)).sum::<f64>();
        shares += number(&dimension["share"]);
        assert!(!dimension["process"]["source"].as_str().unwrap().is_empty());
    }
    assert!((shares - 1.0).abs() < 1e-9);
    let linear = number(&report["linear"]["standard_deviation_n"]);
    assert!((variance.sqrt() / linear - 1.0).abs() < 1e-9);
    let simulated = number(&report["simulated"]["standard_deviation_n"]);
    assert!((simulated / linear - 1.0).abs() < 0.2, "{simulated} for {linear}");
    assert_eq!(report["simulated"]["draws"], 500);
    // The threshold is that of the manifest.
    done(folder.path(), &["-q", "generate", "three-double", "--format", "stl", "--out", "set"]);
    let text = std::fs::read_to_string(folder.path().join("set/manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    assert!((number(&manifest["friction"]["threshold_n"]) - number(&report["threshold_n"])).abs() < 0.01);
}

#[test]
fn equal_seeds_give_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let run = |out: &str, seed: &str| {
        let arguments = ["-q", "tolerances", "three-double", "--scatter", "4", "--draws", "200"];
        done(folder.path(), &[&arguments[..], &["--seed", seed, "--out", out]].concat());
        ["tolerances.csv", "tolerances.json"]
            .map(|name| std::fs::read(folder.path().join(out).join(name)).unwrap())
    };
    let (first, again, other) = (run("a", "5"), run("b", "5"), run("c", "6"));
    assert_eq!(first, again);
    assert_eq!(first[0], other[0], "the table has no simulated number");
    assert_ne!(first[1], other[1]);
}

/// A share is that of the threshold, and measured tolerances replace those of the process.
#[test]
fn allotted_tolerances_reach_the_scatter() {
    let folder = tempfile::tempdir().unwrap();
    let scatter = |arguments: &[&str]| {
        let all = ["tolerances", "three-double", "--draws", "200", "--json"];
        json(folder.path(), &[&all[..], arguments].concat())
    };
    let report = scatter(&["--scatter", "15%"]);
    let allocation = &report["allocation"];
    assert!((number(&allocation["wanted_n"]) - 0.15 * number(&report["threshold_n"])).abs() < 1e-9);
    assert!(number(&allocation["reached_n"]) <= number(&allocation["wanted_n"]));
    assert_eq!(
        allocation["tolerances"].as_array().unwrap().len(),
        report["dimensions"].as_array().unwrap().len()
    );
    let measured = scatter(&["--measured", "hardness=1", "--measured", "groove_depth=0.01"]);
    let sd = |report: &Value| number(&report["linear"]["standard_deviation_n"]);
    assert!(sd(&measured) < 0.6 * sd(&report));
}

/// The report is printed, with the smallest reachable scatter, and the exit code is 1.
#[test]
fn unreachable_scatter_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["tolerances", "three-double", "--scatter", "0.2", "--draws", "10"];
    let output = expect_code(1, folder.path(), &[&arguments[..], &["--json"]].concat());
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["allocation"]["possible"], false);
    let best = number(&report["allocation"]["best_n"]);
    assert!(best > 0.2 && report["allocation"]["tolerances"].is_null());
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains(&format!("the best processes reach a scatter of \u{b1}{best:.2} N")), "{text}");
    let within = format!("{:.2}", best + 0.01);
    let output = pinswitch(
        folder.path(),
        &["-q", "tolerances", "three-double", "--draws", "10", "--scatter", &within],
    );
    assert!(output.status.success(), "what the help proposes is possible");
}

#[test]
fn invalid_arguments_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["three-double", "--scatter", "0"][..],
        &["three-double", "--scatter", "x%"],
        &["three-double", "--measured", "no_such=1"],
        &["three-double", "--measured", "layer_thickness=-1"],
        &["three-double", "--measured", "layer_thickness=5"],
        &["three-double", "--draws", "1"],
        &["silicone-only"],
        &["proxy-three-double"],
        &["six-single"],
    ] {
        let output = expect_code(2, folder.path(), &[&["tolerances"][..], arguments].concat());
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(text.starts_with("error: "), "{arguments:?}: {text}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
}
