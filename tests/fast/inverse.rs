//! `design`, from targets to configurations: the designs of the binary are predicted again; and
//! `physics`.

use crate::harness::{done, ended, json, pinswitch, repository};
use serde_json::Value;

fn column(curve: &Value, key: &str) -> Vec<f64> {
    curve[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// Options that keep a search short.
const SHORT: [&str; 4] = ["--starts", "5", "--draws", "200"];

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn designs_meet_their_targets() {
    let folder = tempfile::tempdir().unwrap();
    let request =
        ["design", "--threshold", "24", "--max-friction", "9", "--pins", "3..5", "--out", "found", "--json"];
    let report = json(folder.path(), &[&request[..], &SHORT].concat());
    assert_eq!(report["possible"], true);
    assert_eq!(report["request"]["targets"][1]["requirement"]["at_most"], 9.0);
    let proposals = report["proposals"].as_array().unwrap();
    assert!(proposals.len() >= 3);
    for (i, proposal) in proposals.iter().enumerate() {
        // `predict` uses the law of the search, on the file that the search wrote.
        let file = format!("found/design-{}.toml", i + 1);
        let curve = json(folder.path(), &["predict", &file, "--law", "physics", "--json"]);
        let (load, d) = (column(&curve, "load_n"), column(&curve, "friction_n"));
        let friction = proposal["friction_n"].as_f64().unwrap();
        assert!(
            (d.last().unwrap() / friction - 1.0).abs() < 0.002,
            "{file}: {} {friction}",
            d.last().unwrap()
        );
        assert!(*d.last().unwrap() <= 9.0 * 1.002);
        let share = column(&curve, "silicone_share");
        let after = share.iter().position(|s| *s >= 0.5).unwrap();
        let promised = proposal["threshold_n"].as_f64().unwrap();
        let step = load[1] - load[0];
        assert!(load[after - 1] - step <= promised && promised <= load[after] + step, "{file}: {promised}");
        assert!((21.6..=26.4).contains(&promised));
        let probability = proposal["probability"]["all"].as_f64().unwrap();
        assert!(probability > 0.0 && probability <= 1.0);
        let shares: f64 =
            proposal["uncertainty"].as_array().unwrap().iter().map(|s| s["share"].as_f64().unwrap()).sum();
        assert!((shares - 1.0).abs() < 1e-6);
        assert_eq!(proposal["sensitivity"].as_array().unwrap().len(), 7);
    }
    let stated: Vec<f64> = proposals.iter().map(|p| p["probability"]["all"].as_f64().unwrap()).collect();
    assert!(stated.windows(2).all(|w| w[0] >= w[1]), "{stated:?}");
    let made = pinswitch(folder.path(), &["generate", "found/design-1.toml", "--out", "parts"]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    assert!(folder.path().join("found/pareto.svg").exists());
}

#[test]
fn mirror_images_are_proposed_once() {
    let folder = tempfile::tempdir().unwrap();
    let request = ["design", "--threshold", "26", "--pins", "3", "--vary", "none", "--best", "8", "--json"];
    let report = json(folder.path(), &[&request[..], &SHORT].concat());
    let pins: Vec<Vec<f64>> =
        report["proposals"].as_array().unwrap().iter().map(|p| numbers(&p["pins"])).collect();
    assert!(!pins.is_empty());
    for (i, a) in pins.iter().enumerate() {
        let mirrored: Vec<f64> = a.iter().rev().map(|groove| 16.0 - groove).collect();
        assert!(!pins[..i].contains(&mirrored), "{pins:?}");
    }
}

#[test]
fn impossible_request_exits_with_reason() {
    let folder = tempfile::tempdir().unwrap();
    let request = ["design", "--max-friction", "at least 16", "--pins", "3..6", "--out", "found"];
    let output = pinswitch(folder.path(), &[&request[..], &SHORT].concat());
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    for word in
        ["no design meets the request", "blocked by", "raise wrap_deg", "friction at the heaviest load"]
    {
        assert!(message.contains(word), "{word}: {message}");
    }
    let report: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("found/design.json")).unwrap()).unwrap();
    assert_eq!(
        (&report["possible"], report["proposals"].as_array().unwrap().len()),
        (&Value::Bool(false), 1)
    );
    // The advised change meets the request.
    let best = &report["blocked"]["moves"][0];
    assert_eq!((&best["parameter"], &best["meets"]), (&Value::from("wrap_deg"), &Value::Bool(true)));
    let allowed = format!("wrap_deg={}..{0}", best["to"]);
    let again =
        ["design", "found/nearest.toml", "--max-friction", "at least 16", "--keep-pins", "--vary", &allowed];
    assert_eq!(json(folder.path(), &[&again[..], &["--json"], &SHORT].concat())["possible"], true);
}

#[test]
fn unprintable_request_names_limit() {
    let folder = tempfile::tempdir().unwrap();
    for (request, limit, is_moved) in [
        (&["design", "--threshold", "20", "--outer-width", "10"][..], "limits.outer_width_mm = 10", true),
        (&["design", "silicone-only", "--keep-pins", "--threshold", "20"], "layout.pins = []", false),
    ] {
        let few = ["--starts", "1", "--best", "1", "--draws", "50", "--vary", "none", "--json"];
        let output = pinswitch(folder.path(), &[request, &few[..]].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains("blocked by") && message.contains(limit), "{message}");
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["possible"], false);
        assert_eq!(report["proposals"].as_array().unwrap().len(), 1);
        assert!(report["blocked"]["limit"].as_str().unwrap().contains(limit));
        let moves = report["blocked"]["moves"].as_array().unwrap();
        assert_eq!(moves.iter().any(|m| m["parameter"] == "width_mm"), is_moved, "{moves:?}");
        // The shortfall after a change has the same measure as the present one.
        for missed in moves.iter().flat_map(|m| m["missed"].as_array().unwrap()) {
            let of = |key: &str| missed[key].as_f64().unwrap();
            assert!((of("by") - (of("value") - of("bound")).abs() / of("bound")).abs() < 1e-9);
        }
    }
}

#[test]
fn shipped_requests_are_answered() {
    let folder = tempfile::tempdir().unwrap();
    for (name, code) in [("gripper", 0), ("small-joint", 0), ("impossible", 1)] {
        let file = repository(&format!("templates/requests/{name}.toml"));
        let request = [
            "design",
            "--request",
            &file.to_string_lossy(),
            "--starts",
            "3",
            "--draws",
            "100",
            "--best",
            "2",
        ];
        let (exit_code, message) = ended(folder.path(), &request);
        assert_eq!(exit_code, Some(code), "{name}: {message}");
    }
}

#[test]
fn design_uses_calibrated_model() {
    let folder = tempfile::tempdir().unwrap();
    done(
        folder.path(),
        &["-q", "simulate", "--randomised", "--effect", "load_cell_offset=0.8", "--out", "rig"],
    );
    done(folder.path(), &["-q", "calibrate", "rig/plateaus.csv", "--out", "calibrated"]);
    let model = ["--model", "calibrated/model.toml"];
    let request =
        ["design", "--max-friction", "between 8 and 11", "--pins", "3", "--vary", "none", "--out", "found"];
    let report = json(folder.path(), &[&request[..], &model, &["--json"], &SHORT].concat());
    assert_eq!(report["possible"], true);
    // `generate` computes the same curve with the same model.
    let proposal = &report["proposals"][0];
    let set = json(
        folder.path(),
        &[&["generate", "found/design-1.toml", "--out", "parts", "--json"], &model[..]].concat(),
    );
    let (proposed, generated) =
        (proposal["friction_n"].as_f64().unwrap(), set["friction"]["friction_n"].as_f64().unwrap());
    assert!((proposed / generated - 1.0).abs() < 1e-3, "{proposed} {generated}");
}

#[test]
fn malformed_targets_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("odd.toml"), "[targets]\nthreshold_n = 20\n[vary]\nthickness = true\n")
        .unwrap();
    for (arguments, word) in [
        (&["design", "--threshold=-1"][..], "--threshold = -1"),
        (&["design", "--max-friction", "NaN"], "--max-friction = NaN"),
        (&["design", "--threshold", "roughly 20"], "at most 8"),
        (&["design", "--friction", "at most 8"], "the load is missing"),
        (
            &["design", "--friction", "at most 3 at 50", "--friction", "at least 5 at 50"],
            "'friction at 50 N at most 3 N' and 'friction at 50 N at least 5 N'",
        ),
        (&["design", "--threshold", "24", "--load-range", "30..60"], "targets.load_range_n = 30..60"),
        (
            &["design", "--max-friction", "5", "--friction", "at least 8 at 49.671"],
            "'friction at 49.671 N at least 8 N'",
        ),
        (
            &["design", "--friction", "at most 5 at 50", "--friction", "at least 8 at 30"],
            "friction increases with load",
        ),
        (&["design", "--threshold", "1e-30"], "0.2 to 1000"),
        (&["design", "--threshold", "20", "--pins", "6..3"], "runs backwards"),
        (&["design", "--threshold", "20", "--pins", "0..3"], "at least 1 pin"),
        (&["design", "--threshold", "20", "--pins", "3..99"], "1 to 15 pins"),
        (&["design", "--threshold", "20", "--load-range", "50..3"], "runs backwards"),
        (&["design", "--threshold", "20", "--vary", "thickness"], "layer_mm"),
        (&["design", "--threshold", "20", "--vary", "layer_mm=1..99"], "0.3 to 10"),
        (&["design", "--threshold", "20", "--outer-radius=-3"], "outside 0.1 to 1000 mm"),
        (&["design", "--threshold", "20", "--best", "0"], "--best = 0"),
        (&["design", "--request", "no-such.toml"], "cannot read"),
        (&["design", "--request", "odd.toml"], "vary.thickness"),
        (&["design", "--threshold", "20", "--model", "odd.toml"], "odd.toml"),
        (
            &["design", "--threshold", "20", "--model", "odd.toml", "--set", "segment.grooves=13"],
            "segment.grooves = 13",
        ),
        (&["predict", "three-double", "--model", "odd.toml", "--law", "paper"], "cannot be used with"),
        (&["design"], "the request has no target"),
        (
            &["predict", "three-double", "--set", "layout.pins=[2,3,9]", "--law", "paper"],
            "six-single, three-double",
        ),
        (
            &["predict", "proxy-six-single", "--law", "layout"],
            "pins on silicone only [law-does-not-apply]\n  help: use the law paper or physics",
        ),
        (&["physics", "silicone-only", "--out", "x"], "pins on silicone"),
    ] {
        let output = pinswitch(folder.path(), arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(word), "{arguments:?}: {message}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn physics_reports_constants_and_errors() {
    let folder = tempfile::tempdir().unwrap();
    let report = json(folder.path(), &["physics", "--out", "shown", "--json"]);
    assert!(report["fit"]["rms"].as_f64().unwrap() <= 0.04);
    let hypotheses = report["hypotheses"].as_array().unwrap();
    assert_eq!(hypotheses[0]["hypothesis"]["bed"]["outside"], "on_silicone");
    assert!(hypotheses.iter().all(|h| !h["compared"].as_array().unwrap().is_empty()));
    let laws = report["evidence"].as_array().unwrap();
    let left_out =
        |law: &str| laws.iter().find(|l| l["law"] == law).unwrap()["rms_left_out"].as_f64().unwrap();
    assert!(left_out("physics") < left_out("layout") && left_out("layout") < left_out("paper"));
    assert!(folder.path().join("shown/contact.svg").exists());
}
