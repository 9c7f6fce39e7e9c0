//! Several sessions of one rig: common constants, changes between sessions, and files that do not
//! match.

use std::path::Path;

use crate::harness::{done, ended, printed, repository};
use serde_json::Value;

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Another specimen of silicone in the second session: its constant is reported as a change, not as
/// scatter or an effect.
#[test]
fn changed_constants_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("other.toml"), "[constants]\nmu_s = 0.31\n").unwrap();
    done(path, &["-q", "simulate", "--seed", "21", "--out", "a"]);
    done(path, &["-q", "simulate", "--seed", "122", "--out", "b"]);
    done(path, &["-q", "simulate", "other.toml", "--seed", "121", "--out", "c"]);
    let output = printed(path, &["-q", "calibrate", "a/plateaus.csv", "c/plateaus.csv", "--out", "changed"]);
    let change = "changed: mu_s differs between sessions: +0.0 % in session a/plateaus.csv, +28.";
    assert!(output.contains(change), "{output}");
    let report = json(&path.join("changed/report.json"));
    let change = &report["changes"][0];
    let factor = |session: &str| change["factors"][session].as_f64().unwrap();
    let ratio = factor("a/plateaus.csv") / factor("c/plateaus.csv");
    assert!((ratio - 0.24 / 0.31).abs() < 0.03, "{change}");
    assert!(change["probability"].as_f64() > Some(0.99), "{change}");
    assert_eq!(report["changes"].as_array().unwrap().len(), 1, "{report}");
    assert_eq!(report["effects"].as_array().unwrap().len(), 0, "{}", report["effects"]);
    assert!(report["noise"]["mount_scale"].as_f64().unwrap() < 0.03, "{}", report["noise"]);
    let page = std::fs::read_to_string(path.join("changed/report.html")).unwrap();
    assert!(
        page.contains("The switch differs between the tables")
            && page.contains("mu_s differs between sessions")
    );
    assert!(output.contains("inconclusive: changed constants, but no effect"), "{output}");
    // Predictions are for the current switch; for rows of the first session, by its name, for the
    // earlier one.
    let rms = |table: &str| {
        done(path, &["-q", "predict", "--model", "changed/model.toml", "--rows", table, "--out", "p.csv"]);
        let text = std::fs::read_to_string(path.join("p.csv")).unwrap();
        let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
        let (read, predicted) = (column("force_N"), column("predicted_N"));
        let misses: Vec<f64> = text
            .lines()
            .skip(1)
            .map(|line| line.split(',').collect::<Vec<_>>())
            .map(|cells| cells[read].parse::<f64>().unwrap() - cells[predicted].parse::<f64>().unwrap())
            .collect();
        (misses.iter().map(|m| m * m).sum::<f64>() / misses.len() as f64).sqrt()
    };
    let named = |table: &str, session: &str| {
        let text = std::fs::read_to_string(path.join(table)).unwrap();
        let lines: Vec<String> = text
            .lines()
            .enumerate()
            .map(|(i, line)| format!("{line},{}", if i == 0 { "session" } else { session }))
            .collect();
        std::fs::write(path.join("named.csv"), lines.join("\n")).unwrap();
        rms("named.csv")
    };
    let (now, before, wrong) = (
        rms("c/plateaus-fresh.csv"),
        named("a/plateaus-fresh.csv", "a/plateaus.csv"),
        rms("a/plateaus-fresh.csv"),
    );
    assert!(now < 0.2 && before < 0.2 && wrong > 0.5, "{now} {before} {wrong}");
    let output = printed(path, &["-q", "calibrate", "a/plateaus.csv", "b/plateaus.csv", "--out", "same"]);
    assert!(!output.contains("changed"), "{output}");
    assert!(json(&path.join("same/report.json"))["changes"].is_null());
}

#[test]
fn mismatched_files_give_one_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    done(path, &["-q", "simulate", "--effect", "rate_dependence=0.2", "--out", "a"]);
    std::fs::copy(path.join("a/plateaus.csv"), path.join("copy.csv")).unwrap();
    done(path, &["init", "effects", "--out", "mine.toml"]);
    done(path, &["-q", "calibrate", "a/plateaus.csv", "--out", "plain"]);
    done(path, &["-q", "calibrate", "a/plateaus.csv", "--effects", "mine.toml", "--out", "mine"]);
    done(path, &["-q", "experiment", "plain", "--minutes", "30", "--out", "next"]);
    done(path, &["-q", "experiment", "mine", "--effects", "mine.toml", "--minutes", "30", "--out", "own"]);
    // Runs with other weights than the table.
    let runs = std::fs::read_to_string(path.join("next/next-runs.csv")).unwrap();
    std::fs::create_dir(path.join("foreign")).unwrap();
    std::fs::copy(path.join("next/experiment.json"), path.join("foreign/experiment.json")).unwrap();
    let heavier: Vec<String> = runs
        .lines()
        .enumerate()
        .map(|(i, line)| {
            let mut cells: Vec<&str> = line.split(',').collect();
            if i > 0 {
                cells[4] = "90000";
            }
            cells.join(",")
        })
        .collect();
    std::fs::write(path.join("foreign/next-runs.csv"), heavier.join("\n")).unwrap();
    done(path, &["-q", "simulate", "--seed", "9", "--out", "b"]);
    for (name, file) in [("cut", "residuals.csv"), ("other", "model.toml")] {
        let to = path.join(name);
        std::fs::create_dir(&to).unwrap();
        for entry in std::fs::read_dir(path.join("plain")).unwrap() {
            let entry = entry.unwrap();
            std::fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
        }
        // Without it, the changed files are external inputs.
        std::fs::remove_file(to.join("provenance.json")).unwrap();
        let text = std::fs::read_to_string(to.join(file)).unwrap();
        let changed = match name {
            "cut" => text.lines().take(500).collect::<Vec<_>>().join("\n"),
            _ => {
                let baseline = std::fs::read_to_string(path.join("plain/baseline.toml")).unwrap();
                // A changed model without its hash is accepted.
                let (model, _) = baseline.trim_end().rsplit_once('\n').unwrap();
                model.replacen("value = 0.", "value = 0.1", 1)
            }
        };
        std::fs::write(to.join(file), changed).unwrap();
    }
    for (command, words) in [
        ("calibrate a/plateaus.csv copy.csv --out x", "copy.csv: 3"),
        (
            "calibrate a/plateaus.csv b/plateaus.csv --plan foreign --out x",
            "b/plateaus.csv: contains none of the",
        ),
        (
            "experiment cut --out x",
            "cut: report.json, model.toml and residuals.csv are incomplete or from different calibrations",
        ),
        (
            "experiment other --out x",
            "other: report.json, model.toml and residuals.csv are incomplete or from",
        ),
        ("experiment mine --out x", "mine/report.json: the calibration tested the effect 'lubricant_dip'"),
    ] {
        let arguments: Vec<&str> = ["-q"].into_iter().chain(command.split(' ')).collect();
        let (code, output) = ended(path, &arguments);
        assert!(code == Some(2) && output.contains(words), "{command}: {output}");
        assert!(!path.join("x").exists(), "{command}");
    }
}

/// The runs for a rig with another wrap have that wrap, and are rehearsed with it.
#[test]
fn runs_have_the_table_wrap() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("wide.toml"), "wrap_angle_deg = 95.0\n").unwrap();
    done(path, &["-q", "simulate", "wide.toml", "--out", "a"]);
    done(path, &["-q", "calibrate", "a/plateaus.csv", "--out", "c"]);
    done(path, &["-q", "experiment", "c", "--minutes", "30", "--out", "next"]);
    let runs = std::fs::read_to_string(path.join("next/next-runs.csv")).unwrap();
    assert!(runs.lines().next().unwrap().ends_with(",wrap_angle_deg") && runs.contains(",95\n"), "{runs}");
    assert!(std::fs::read_to_string(path.join("next/run-sheet.html")).unwrap().contains("wrap 95 deg"));
    let wraps = |folder: &str| {
        let text = std::fs::read_to_string(path.join(folder).join("plateaus.csv")).unwrap();
        let at = text.lines().next().unwrap().split(',').position(|c| c == "wrap_angle_deg").unwrap();
        text.lines().skip(1).all(|line| line.split(',').nth(at) == Some("95"))
    };
    done(path, &["-q", "simulate", "wide.toml", "--runs", "next/next-runs.csv", "--out", "b"]);
    done(path, &["-q", "simulate", "--model", "c/model.toml", "--runs", "next/next-runs.csv", "--out", "d"]);
    // A plan without the column has the wrap of the rig.
    let bare: Vec<&str> = runs.lines().map(|line| line.rsplit_once(',').unwrap().0).collect();
    std::fs::write(path.join("bare.csv"), bare.join("\n")).unwrap();
    done(path, &["-q", "simulate", "wide.toml", "--runs", "bare.csv", "--out", "e"]);
    assert!(wraps("b") && wraps("d") && wraps("e"));
}

/// Small sessions of an independent simulator whose friction on silicone differs: 30 % more in the fifth of 15, and 6 % of scatter
/// among 20. Without it, scatter of the mounts explains the readings badly, but no step from there gains at once.
#[test]
fn one_of_many_sessions_differs() {
    let folder = tempfile::tempdir().unwrap();
    for (table, session, factor) in
        [("one-of-15-differs", "s4", Some(1.3)), ("each-of-20-differs", "s0", None)]
    {
        let path = repository(&format!("tests/data/many-sessions/{table}.csv"));
        done(folder.path(), &["-q", "calibrate", path.to_str().unwrap(), "--out", table]);
        let report = json(&folder.path().join(table).join("report.json"));
        assert_eq!(report["effects"].as_array().unwrap().len(), 0, "{table}: {}", report["effects"]);
        let [change] = report["changes"].as_array().unwrap().as_slice() else { panic!("{report}") };
        assert_eq!((&change["constant"], &change["by"]), (&"mu_s".into(), &"session".into()));
        assert!(change["probability"].as_f64() > Some(0.95), "{change}");
        if let Some(factor) = factor {
            let found = change["factors"][session].as_f64().unwrap();
            assert!((found - factor).abs() < 0.05, "{change}");
        }
        assert!(report["noise"]["mount_scale"].as_f64().unwrap() < 0.02, "{}", report["noise"]);
        let error = &report["expected_error_N"];
        let value = error["value"].as_f64().unwrap();
        let end = |end: usize| error["ci90"][end].as_f64().unwrap();
        assert!(end(0) < value && value < end(1), "{error}");
    }
}
