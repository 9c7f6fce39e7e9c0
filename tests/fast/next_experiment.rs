//! Proposed runs: invalid input, tables without a plan, and loads that were never recorded. The whole loop is in
//! `tests/slow/next_experiment.rs`.

use std::path::Path;

use crate::harness::{done, ended};
use serde_json::Value;

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

#[test]
fn invalid_input_gives_one_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::create_dir(path.join("empty")).unwrap();
    std::fs::create_dir(path.join("other")).unwrap();
    std::fs::write(path.join("other/report.json"), "{}").unwrap();
    let plan = r#"{"schema": "x/1", "minutes": 1.0, "questions": []}"#;
    std::fs::write(path.join("other/experiment.json"), plan).unwrap();
    std::fs::write(path.join("rig.toml"), "loads_g = []").unwrap();
    std::fs::write(path.join("runs.csv"), "series,substrate\n1,glass\n").unwrap();
    for (arguments, words) in [
        ("experiment empty --out next", "empty/report.json: cannot read"),
        ("experiment other --out next", "missing field `schema`"),
        (
            "experiment other --rig rig.toml --out next",
            "rig.toml:1:11: loads_g = 0 weights: 1 to 40 weights are possible",
        ),
        ("experiment other --minutes 0 --out next", "minutes"),
        ("experiment other --minutes nan --out next", "minutes"),
        ("simulate --runs runs.csv --out x", "runs.csv: column 'pins' is missing"),
        ("calibrate runs.csv --plan other --out x", "--plan is given 1 times, but 0 tables follow the first"),
        ("calibrate runs.csv runs.csv --plan empty --out x", "empty/experiment.json: cannot read"),
        (
            "calibrate runs.csv runs.csv --plan other --out x",
            "other/experiment.json: schema = \"x/1\": is not",
        ),
    ] {
        let arguments: Vec<_> = ["-q"].into_iter().chain(arguments.split(' ')).collect();
        let (code, output) = ended(path, &arguments);
        assert!(code == Some(2) && output.contains(words) && output.len() < 600, "{arguments:?}: {output}");
        assert!(!path.join("next").exists() && !path.join("x").exists(), "{arguments:?}");
    }
}

/// Four runs, as `experiment` writes them.
const RUNS: &str = "series,substrate,pins,sweep,load_mass_g,speed_pct,dwell_s,repetitions_eccentric,repetitions_concentric,mount,minutes,asks
1,silicone,5;8;11,up,1003.2,40,3,4,4,1,9,x
2,silicone,5;8;11,up,2005,70,3,4,4,1,3,x
3,silicone,5;8;11,down,2005,40,3,4,4,1,3,x
4,abs,5;8;11,up,1003.2,40,10,4,4,2,9,x
";

/// Returns a plan with one field changed.
fn asks(from: &str, to: &str) -> String {
    let plan = r#"{"schema": "pinswitch.experiment/1", "minutes": 24.0, "questions": [
        {"between": ["friction_above_26_N", "none"], "resolved_probability": 0.7},
        {"between": ["rate_dependence", "wear_drift"], "resolved_probability": 0.9}]}"#;
    assert!(plan.contains(from), "{from}");
    plan.replacen(from, to, 1)
}

#[test]
fn unplanned_tables_give_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::create_dir(path.join("plan")).unwrap();
    std::fs::write(path.join("plan/experiment.json"), asks("0.7", "0.7")).unwrap();
    std::fs::write(path.join("plan/next-runs.csv"), RUNS).unwrap();
    let lines: Vec<&str> = RUNS.lines().collect();
    // Simulates a table of some of the runs.
    let made = |name: &str, of: &[&str]| {
        let runs: Vec<&str> = lines[..1].iter().chain(of).copied().collect();
        std::fs::write(path.join("runs.csv"), runs.join("\n")).unwrap();
        done(path, &["-q", "simulate", "--runs", "runs.csv", "--out", name]);
    };
    // The plan is checked before the tables; the first table is missing, so nothing is calibrated.
    let output = |name: &str| {
        let table = format!("{name}/plateaus.csv");
        let (code, output) =
            ended(path, &["-q", "calibrate", "absent.csv", &table, "--plan", "plan", "--out", "x"]);
        assert_eq!(code, Some(2), "{output}");
        output
    };
    done(path, &["-q", "simulate", "--seed", "2", "--out", "before"]);
    made("whole", &lines[1..]);
    made("part", &lines[1..4]);
    made("half", &lines[1..3]);
    // Other speeds, or one run twice, are not the planned runs.
    let fast: Vec<String> =
        lines[1..].iter().map(|line| line.replace(",40,", ",55,").replace(",70,", ",55,")).collect();
    made("fast", &fast.iter().map(String::as_str).collect::<Vec<_>>());
    let twice = format!("5{}", &lines[1][1..]);
    made("twice", &[lines[1], &twice]);
    made("turned", &[lines[4], lines[1], lines[2], lines[3]]);
    assert!(!output("whole").contains("runs of plan"), "{}", output("whole"));
    let runs = Path::new("plan/next-runs.csv").display();
    for (name, words) in [
        ("part", format!("part/plateaus.csv: lacks 1 of the 4 runs of {runs}")),
        ("half", format!("half/plateaus.csv: lacks 2 of the 4 runs of {runs}")),
        (
            "before",
            format!(
                "before/plateaus.csv: contains none of the 4 runs of {runs} [plan-not-followed]\n  help: give the table"
            ),
        ),
        (
            "fast",
            format!(
                "fast/plateaus.csv: contains none of the 4 runs of {runs} [plan-not-followed]\n  help: give the table"
            ),
        ),
        (
            "twice",
            format!(
                "twice/plateaus.csv: contains only 1 of the 4 runs of {runs} [plan-not-followed]\n  help: give the table"
            ),
        ),
        (
            "turned",
            format!("turned/plateaus.csv: the order of the series differs from that of the runs of {runs}"),
        ),
    ] {
        assert!(output(name).contains(&words), "{name}: {}", output(name));
    }
    for (from, to, words) in [
        ("0.9", "1.9", "questions[1].resolved_probability = 1.9: outside 0 to 1"),
        ("24.0", "-1", "minutes = -1: must be above 0"),
        ("wear_drift", "gravity", "questions[1].between[1] = \"gravity\": unknown effect"),
    ] {
        std::fs::write(path.join("plan/experiment.json"), asks(from, to)).unwrap();
        let output = output("whole");
        assert!(
            output.contains(words) && output.contains("experiment.json") && output.len() < 600,
            "{output}"
        );
    }
    std::fs::write(path.join("plan/experiment.json"), asks("0.7", "0.7")).unwrap();
    std::fs::remove_file(path.join("plan/next-runs.csv")).unwrap();
    let output = output("whole");
    assert!(output.contains(&format!("{runs}: file not found")) && !path.join("x").exists(), "{output}");
}

/// Curves extend to the heaviest load of the paper, whatever was recorded.
#[test]
fn unrecorded_loads_of_curves_are_proposed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    done(path, &["-q", "simulate", "--out", "whole"]);
    let table = std::fs::read_to_string(path.join("whole/plateaus.csv")).unwrap();
    let at = table.lines().next().unwrap().split(',').position(|c| c == "load_N").unwrap();
    let is_light = |line: &&str| line.split(',').nth(at).unwrap().parse::<f64>().is_ok_and(|n| n < 26.0);
    let light: Vec<&str> = table.lines().take(1).chain(table.lines().skip(1).filter(is_light)).collect();
    std::fs::write(path.join("light.csv"), light.join("\n")).unwrap();
    let question_of = |table: &str, folder: &str| {
        done(path, &["-q", "calibrate", table, "--out", folder]);
        done(path, &["-q", "experiment", folder, "--minutes", "60", "--out", "plan"]);
        let plan = json(&path.join("plan/experiment.json"));
        let of = |q: &&Value| q["between"][0].as_str().unwrap().starts_with("friction_above_");
        plan["questions"].as_array().unwrap().iter().find(of).cloned()
    };
    let question = question_of("light.csv", "few").unwrap();
    let chance = |key: &str| question[key].as_f64().unwrap();
    assert!(chance("resolved_probability") > chance("by_repeating"), "{question}");
    assert_eq!(question_of("whole/plateaus.csv", "all"), None);
}
