//! The closed loop on simulated rigs, with the command line: simulate, segment, calibrate, predict,
//! generate.

use crate::harness::expect_code;
use serde_json::Value;
use std::path::Path;
use std::process::Output;

/// Runs the command line in a folder and asserts its exit code.
fn pinswitch(code: i32, folder: &Path, arguments: &str) -> Output {
    expect_code(code, folder, &arguments.split_whitespace().collect::<Vec<_>>())
}

fn report(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("cal/report.json")).unwrap()).unwrap()
}

/// Simulates a rig with these options and calibrates it.
fn verdict(folder: &Path, options: &str) -> (String, Vec<String>, Value) {
    pinswitch(0, folder, &format!("simulate {options} --out rig"));
    pinswitch(0, folder, "calibrate rig/plateaus.csv --out cal");
    let report = report(folder);
    let mut ids: Vec<String> = report["effects"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|e| {
            let rivals = e["rivals"].as_array().unwrap().iter().map(|r| r["id"].clone());
            std::iter::once(e["id"].clone()).chain(rivals).collect::<Vec<_>>()
        })
        .map(|id| id.as_str().unwrap().to_owned())
        .collect();
    ids.sort();
    (report["verdict"].as_str().unwrap().to_owned(), ids, report)
}

/// Returns the verdict; `nothing` without effects, which is `none` only if every effect that acts on the
/// table is excluded.
fn believed<'a>(verdict: &'a str, report: &serde_json::Value) -> &'a str {
    let any = |list: &str, is_open: fn(&serde_json::Value) -> bool| {
        report[list].as_array().unwrap().iter().any(is_open)
    };
    let open =
        any("limits", |limit| limit["excluded"] == false) || any("invisible", |i| i["possible"].is_array());
    match verdict {
        "none" if !open => "nothing",
        "inconclusive" if open => "nothing",
        other => other,
    }
}

#[test]
fn simulated_rigs_reach_every_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let unnamed =
        "seed = 4\n[[disturbances]]\nsize = 0.2\n[disturbances.kind.spot]\nat = 0.4\nwidth = 0.12\n";
    std::fs::write(at.join("spot.toml"), unnamed).unwrap();
    let cases = [
        ("", "nothing", &[][..]),
        ("--randomised", "nothing", &[]),
        ("--randomised --effect load_cell_offset=0.8", "attributed", &["load_cell_offset"]),
        ("--effect adhesion=0.5", "attributed", &["adhesion"]),
        ("--effect rate_dependence=0.5", "ambiguous", &["fixture_compliance", "rate_dependence"]),
        ("--randomised --effect rate_dependence=0.5", "attributed", &["rate_dependence"]),
        ("spot.toml", "unattributed", &["unattributed"]),
    ];
    for (options, expected, effects) in cases {
        let (verdict, ids, report) = verdict(at, options);
        let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
        assert_eq!((believed(&verdict, &report), &ids[..]), (expected, effects), "{options}");
        for effect in report["effects"].as_array().unwrap() {
            let rivals = effect["rivals"].as_array().unwrap().iter();
            let probability = |of: &serde_json::Value| of["probability"].as_f64().unwrap();
            let explained = probability(effect) + rivals.map(probability).sum::<f64>();
            assert!(explained > 0.9, "{effect}");
            assert!(effect["error_after_N"].as_f64() < effect["error_before_N"].as_f64(), "{effect}");
            if expected == "ambiguous" {
                assert!(effect["rivals"][0]["experiment"].as_str().unwrap().len() > 10, "{effect}");
            }
        }
        if expected == "unattributed" {
            assert_eq!(report["effects"][0]["covariate"], "position");
        }
        let layouts = |m: &str| report[m]["heldout_layouts_rmse_N"].as_f64().unwrap();
        assert!(layouts("augmented") <= 1.02 * layouts("baseline"), "{options}");
    }
}

/// A wrong weight must not be attributed to an effect; its series is listed.
#[test]
fn a_mislabelled_weight_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    for (seed, protocol) in [(11, "paper"), (12, "randomised")] {
        let plan = format!("seed = {seed}\nprotocol = \"{protocol}\"\n[noise]\nmislabelled_series = 1\n");
        std::fs::write(folder.path().join("plan.toml"), plan).unwrap();
        let (verdict, ids, report) = verdict(folder.path(), "plan.toml");
        assert_eq!(believed(&verdict, &report), "nothing", "{ids:?}");
        let bad = report["bad_series"].as_array().unwrap();
        // In addition to single bad readings, one series is wrong in both directions.
        let of = |direction: &str| -> Vec<&str> {
            bad.iter()
                .filter(|b| b["direction"] == direction)
                .map(|b| b["series"].as_str().unwrap())
                .collect()
        };
        let both = of("eccentric").into_iter().filter(|s| of("concentric").contains(s)).count();
        assert_eq!(both, 1, "{bad:?}");
        assert!(bad.iter().all(|b| b["standard_deviations"].as_f64().unwrap().abs() > 8.0), "{bad:?}");
    }
}

/// The curve of a printed part includes effects of the switch and excludes those of the rig, which
/// the output reports.
#[test]
fn predictions_come_from_the_better_model() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let options = "--randomised --effect coating_ploughing=0.024 --effect load_cell_offset=1.2";
    let (verdict, ids, _) = verdict(at, options);
    assert_eq!(
        (verdict.as_str(), ids.join(" ")),
        ("attributed", "coating_ploughing load_cell_offset".to_owned())
    );
    let errors = ["baseline", "model"].map(|model| {
        let rows = "--rows rig/plateaus-fresh.csv --out p.csv";
        pinswitch(0, at, &format!("predict --model cal/{model}.toml {rows}"));
        let text = std::fs::read_to_string(at.join("p.csv")).unwrap();
        let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        assert_eq!(header[header.len() - 2..], ["predicted_N", "sd_N"]);
        let truth = header.iter().position(|h| *h == "force_N").unwrap();
        let misses: Vec<f64> = text
            .lines()
            .skip(1)
            .map(|l| l.split(',').map(|c| c.parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>())
            .map(|c| (c[truth] - c[c.len() - 2]).powi(2))
            .collect();
        (misses.iter().sum::<f64>() / misses.len() as f64).sqrt()
    });
    assert!(errors[1] < 0.1 * errors[0], "{errors:?}");
    // The offset of the rig is excluded from the part's curve.
    let output = pinswitch(0, at, "generate three-double --model cal/model.toml --out set -v");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("the curve includes effects of the switch: coating_ploughing"), "{message}");
    assert!(message.contains("the curve excludes effects of the measurement: load_cell_offset"), "{message}");
    let manifest = std::fs::read_to_string(at.join("set/manifest.json")).unwrap();
    assert!(
        manifest.contains("the curve excludes effects of the measurement: load_cell_offset"),
        "{manifest}"
    );
    let curve = std::fs::read_to_string(at.join("set/friction.csv")).unwrap();
    let header: Vec<&str> = curve.lines().next().unwrap().split(',').collect();
    let at_column = |name: &str| {
        header.iter().position(|h| h.starts_with(name)).unwrap_or_else(|| panic!("{name}: {header:?}"))
    };
    let last: Vec<f64> =
        curve.lines().last().unwrap().split(',').map(|c| c.parse().unwrap_or(f64::NAN)).collect();
    let (load, eccentric, concentric) =
        (last[at_column("load")], last[at_column("eccentric")], last[at_column("concentric")]);
    // An offset of 1.2 N would shift both directions alike: without it, G = sqrt(Fe Fc) equals the
    // load for any friction.
    assert!(((eccentric * concentric).sqrt() - load).abs() < 0.6, "{load} {eccentric} {concentric}");
}

/// Raw logs with faulty moves, from segmentation to calibration.
#[test]
fn raw_logs_pass_the_whole_loop() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let plan = "seed = 3\nlayouts = [[5, 8, 11]]\nweights_g = [503.6, 1503.9, 2505.4, 3508.6, 5002.5]\n\
                speeds_pct = [52]\n[raw]\nodd_speed_share = 0.3\nmissing_share = 0.3\n[[effects]]\n\
                id = \"load_cell_offset\"\nvalues = [1.4]\n";
    std::fs::write(at.join("plan.toml"), plan).unwrap();
    pinswitch(0, at, "simulate plan.toml --out rig --raw");
    pinswitch(0, at, "segment rig/run.toml --out found.csv");
    let found = std::fs::read_to_string(at.join("found.csv")).unwrap();
    let truth = std::fs::read_to_string(at.join("rig/truth.csv")).unwrap();
    assert_eq!(found.lines().count(), truth.lines().count());
    let (mut sum, mut count) = (0.0, 0.0);
    for (f, t) in found.lines().zip(truth.lines()).skip(1) {
        let (f, t): (Vec<&str>, Vec<&str>) = (f.split(',').collect(), t.split(',').collect());
        assert_eq!((f[8], f[9]), (t[1], t[2]));
        sum += (f[12].parse::<f64>().unwrap() - t[3].parse::<f64>().unwrap()).powi(2);
        count += 1.0;
    }
    assert!(f64::sqrt(sum / count) < 0.02, "{}", f64::sqrt(sum / count));
    let sidecar: Value = serde_json::from_slice(&std::fs::read(at.join("found.json")).unwrap()).unwrap();
    let faults: Value = serde_json::from_slice(&std::fs::read(at.join("rig/faults.json")).unwrap()).unwrap();
    for entry in sidecar["series"].as_array().unwrap() {
        let file = entry["file"].as_str().unwrap();
        let seen = |what: &str| entry["findings"].as_array().unwrap().iter().any(|f| f["what"] == what);
        assert_eq!(seen("missing_repetition"), faults[file]["missing_after"].is_array(), "{entry}");
        assert_eq!(seen("odd_speed"), faults[file]["odd_speed"].is_array(), "{entry}");
        assert!(seen("lost_samples"), "{entry}");
    }
    pinswitch(0, at, "calibrate found.csv --out cal");
    assert_eq!(report(at)["effects"][0]["id"], "load_cell_offset", "{}", report(at)["effects"]);
}

/// Predicate for the lines of a table to keep.
type Rows<'a> = &'a dyn Fn(&[&str]) -> bool;

/// Two loads, one direction or one condition: the report lists what is open.
#[test]
fn little_data_leaves_open_questions() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    pinswitch(0, at, "simulate --out rig");
    let all = std::fs::read_to_string(at.join("rig/plateaus.csv")).unwrap();
    let keep = |test: &dyn Fn(&[&str]) -> bool| {
        let mut text = all.lines().next().unwrap().to_owned() + "\n";
        for line in all.lines().skip(1).filter(|l| test(&l.split(',').collect::<Vec<_>>())) {
            text.push_str(line);
            text.push('\n');
        }
        std::fs::write(at.join("little.csv"), text).unwrap();
    };
    let cases: [(&str, Rows<'_>, &[&str]); 3] = [
        (
            "two loads",
            &|c| c[4] == "251.2" || c[4] == "5002.5",
            &["dwell_relaxation", "switching_hysteresis"],
        ),
        ("one direction", &|c| c[8] == "eccentric", &["dwell_relaxation", "direction_asymmetry"]),
        (
            "one condition",
            &|c| c[1] == "silicone" && c[2].is_empty(),
            &["coating_stiffening", "polygon_bending"],
        ),
    ];
    for (name, test, open) in cases {
        keep(test);
        pinswitch(0, at, "calibrate little.csv --out cal");
        let report = report(at);
        assert!(
            ["none", "inconclusive", "ambiguous"].contains(&report["verdict"].as_str().unwrap()),
            "{name}: {}",
            report["effects"]
        );
        let invisible: Vec<&str> =
            report["invisible"].as_array().unwrap().iter().map(|i| i["id"].as_str().unwrap()).collect();
        assert!(open.iter().all(|id| invisible.contains(id)), "{name}: {invisible:?}");
    }
    keep(&|c| c[4] == "251.2");
    std::fs::remove_dir_all(at.join("cal")).unwrap();
    let refused = pinswitch(2, at, "calibrate little.csv --out cal");
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        message.contains("load_N") && message.contains("one load at one angle does not determine"),
        "{message}"
    );
    assert!(!at.join("cal").exists());
}

#[test]
fn requested_effects_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    for (options, expected) in [
        ("--effect gravity=1", "use one of"),
        ("--effect run_in=0.1", "run_in needs 3 values"),
        ("--effect adhesion=much", "a value is not a number"),
    ] {
        let output = pinswitch(2, folder.path(), &format!("simulate {options} --out rig"));
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains(expected), "{message}");
        assert!(!folder.path().join("rig").exists());
    }
}
