//! The loop: a first table that is not conclusive, the proposed runs, a second table, and the
//! verdict. Also forms that are derived from one session and tested with another.

use std::path::Path;

use crate::harness::{done, ended, printed};
use serde_json::Value;

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// The example of `model/doc/next-experiment.md`.
#[test]
fn proposed_runs_resolve_a_confounded_effect() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let truth = ["--effect", "rate_dependence=0.2"];
    done(path, &[&["-q", "simulate"], &truth[..], &["--out", "first"]].concat());
    done(path, &["-q", "calibrate", "first/plateaus.csv", "--out", "calibration"]);
    assert_ne!(json(&path.join("calibration/report.json"))["verdict"], "attributed");
    done(path, &["-q", "experiment", "calibration", "--minutes", "60", "--out", "next"]);
    let plan = json(&path.join("next/experiment.json"));
    assert!(plan["minutes"].as_f64().unwrap() <= 60.0, "{plan}");
    let questions = plan["questions"].as_array().unwrap();
    let question = questions.iter().find(|q| q["between"][0] == "rate_dependence").unwrap();
    assert!(question["resolved_probability"].as_f64() > Some(0.8), "{question}");
    assert!(question["by_repeating"].as_f64() < question["resolved_probability"].as_f64(), "{question}");
    let sheet = std::fs::read_to_string(path.join("next/run-sheet.html")).unwrap();
    assert!(sheet.contains("mount 1: ") && sheet.contains("rate_dependence or none"));
    // The same model gives the same plan, and the runs can be rehearsed with it.
    done(path, &["-q", "experiment", "calibration", "--minutes", "60", "--out", "again"]);
    let bytes = |name: &str| std::fs::read(path.join(name)).unwrap();
    assert_eq!(bytes("next/next-runs.csv"), bytes("again/next-runs.csv"));
    // A load cell that no load fits is not a lack of time.
    std::fs::write(path.join("tiny.toml"), "cell_limit_n = 0.1\n").unwrap();
    let (code, output) =
        ended(path, &["-q", "experiment", "calibration", "--rig", "tiny.toml", "--out", "none"]);
    assert!(
        code == Some(2) && output.contains("tiny.toml: cell_limit_n = 0.1: the load cell would exceed"),
        "{output}"
    );
    assert!(!output.contains("minutes") && !path.join("none").exists(), "{output}");
    let runs = ["--runs", "next/next-runs.csv"];
    done(
        path,
        &[&["-q", "simulate"], &runs[..], &["--model", "calibration/model.toml", "--out", "rehearsal"]]
            .concat(),
    );
    // The runs are made on the rig with the effect.
    done(path, &[&["-q", "simulate"], &runs[..], &truth, &["--seed", "5", "--out", "second"]].concat());
    let both =
        ["-q", "calibrate", "first/plateaus.csv", "second/plateaus.csv", "--plan", "next", "--out", "joined"];
    let output = printed(path, &both);
    assert!(output.starts_with("from first/plateaus.csv: inconclusive"), "{output}");
    let report = json(&path.join("joined/report.json"));
    assert_eq!(
        (&report["verdict"], &report["effects"][0]["id"]),
        (&"attributed".into(), &"rate_dependence".into())
    );
    let size = &report["effects"][0]["parameters"]["k"];
    let [low, high] = [0, 1].map(|i| size["ci95"][i].as_f64().unwrap());
    assert!(high - low < 0.1, "{size}");
    // An interval misses the truth in one of twenty sessions: of three, at most one does.
    let misses = ["5", "6", "7"].into_iter().filter(|seed| {
        let second = format!("second-{seed}");
        done(path, &[&["-q", "simulate"], &runs[..], &truth, &["--seed", seed, "--out", &second]].concat());
        let table = format!("{second}/plateaus.csv");
        done(path, &["-q", "calibrate", "first/plateaus.csv", &table, "--out", &format!("with-{seed}")]);
        let report = json(&path.join(format!("with-{seed}/report.json")));
        let size = &report["effects"][0]["parameters"]["k"]["ci95"];
        assert_eq!(
            (&report["verdict"], &report["effects"][0]["id"]),
            (&"attributed".into(), &"rate_dependence".into())
        );
        !(size[0].as_f64() < Some(0.2) && Some(0.2) < size[1].as_f64())
    });
    assert!(misses.count() <= 1);
    let sessions = report["sessions"].as_array().unwrap();
    assert_eq!((sessions.len(), &sessions[1]["verdict"]), (2, &"attributed".into()));
    // Expected answers are compared with the actual ones: certain answers are given.
    let answers = sessions[1]["asked"]["questions"].as_array().unwrap();
    let answer = |id: &str| &answers.iter().find(|q| q["between"][0] == id).unwrap()["answer"];
    assert_eq!(
        (answer("rate_dependence"), answer("dwell_relaxation")),
        (&"found".into(), &"excluded".into())
    );
    assert!(
        answers.iter().all(|q| q["resolved_probability"].as_f64() < Some(0.9) || q["answer"] != "open"),
        "{answers:?}"
    );
    assert!(output.contains("second/plateaus.csv answers "), "{output}");
    let page = std::fs::read_to_string(path.join("joined/report.html")).unwrap();
    let line = page.split("<li>").find(|line| line.contains("rate_dependence or none")).unwrap();
    assert!(line.contains("&gt;99 %") && line.contains("<b>found</b>"), "{line}");
    // The report lists the runs; a heavier load precedes descending ones in their mount.
    assert!(page.contains("proposed runs:<ul><li>") && page.contains("with loads descending"));
    let runs = std::fs::read_to_string(path.join("next/next-runs.csv")).unwrap();
    let cells: Vec<Vec<&str>> = runs.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let load = |run: &[&str]| run[4].parse::<f64>().unwrap();
    for (i, run) in cells.iter().enumerate().filter(|(_, run)| run[3] == "down") {
        assert!(cells[..i].iter().any(|before| before[9] == run[9] && load(before) > load(run)), "{run:?}");
    }
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
            format!("before/plateaus.csv: contains none of the 4 runs of {runs}\n  help: give the table"),
        ),
        ("fast", format!("fast/plateaus.csv: contains none of the 4 runs of {runs}\n  help: give the table")),
        (
            "twice",
            format!("twice/plateaus.csv: contains only 1 of the 4 runs of {runs}\n  help: give the table"),
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

/// Returns a plan of the randomised protocol with a disturbance that is not an effect.
fn rig(disturbance: &str) -> String {
    format!(
        "seed = 7\nprotocol = \"randomised\"\nspeeds_pct = [40.0, 50.0, 60.0, 70.0]\ndwells_s = [1.0, 3.0, 10.0]\n\
         repetitions = [8, 10]\nrepetitions_spread = 0\n[[disturbances]]\n{disturbance}\n"
    )
}

#[test]
fn derived_forms_need_another_session() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let step = "size = 0.15\ntarget = \"friction\"\nkind.step = { at = 0.45, over = 0.0 }";
    std::fs::write(path.join("step.toml"), rig(step)).unwrap();
    done(path, &["-q", "simulate", "step.toml", "--next", "--out", "step"]);
    let output = printed(path, &["-q", "calibrate", "step/plateaus.csv", "--out", "first"]);
    assert!(output.contains("resembles a step on friction"), "{output}");
    let form = json(&path.join("first/report.json"))["effects"][0]["form"].clone();
    assert_eq!((&form["shape"], &form["acts_on"]), (&"step".into(), &"friction".into()), "{form}");
    let id = form["id"].as_str().unwrap();
    // The first question is whether another session shows it; the data from which it was derived
    // cannot answer that.
    done(path, &["-q", "experiment", "first", "--minutes", "240", "--out", "plan"]);
    let plan = json(&path.join("plan/experiment.json"));
    let question = plan["questions"].as_array().unwrap().iter().find(|q| q["between"][0] == id);
    assert!(question.is_some_and(|q| q["resolved_probability"].as_f64() > Some(0.9)), "{plan}");
    // The plan contains the form, so that the question is answered without its file.
    assert_eq!(
        std::fs::read(path.join("plan/discovered.toml")).unwrap(),
        std::fs::read(path.join("first/discovered.toml")).unwrap()
    );
    done(path, &["-q", "simulate", "step.toml", "--runs", "plan/next-runs.csv", "--out", "made"]);
    let tables = ["step/plateaus.csv", "made/plateaus.csv"];
    done(path, &[&["-q", "calibrate"], &tables[..], &["--plan", "plan", "--out", "joined"]].concat());
    // The readings of the second session decide, which may leave the question open: the place of a step
    // is a share of its session, so it differs in a session of another length.
    let joined = json(&path.join("joined/report.json"));
    let trial = &joined["trials"][0];
    assert!(trial["id"] == id && trial["outcome"] != "drawn", "{trial}");
    assert!(trial["probability"].is_f64() && trial["size"]["value"].as_f64() > Some(0.0), "{trial}");
    // The data from which it was derived do not attribute it, and its file is not overwritten by
    // the calibration that reads it.
    let own = ["-q", "calibrate", "step/plateaus.csv", "--effects", "first/discovered.toml", "--out"];
    let output = printed(path, &[&own[..], &["own"]].concat());
    assert!(
        output.contains("verdict: unattributed") && output.contains(&format!("trial of {id}: drawn")),
        "{output}"
    );
    let (code, output) = ended(path, &[&own[..], &["first"]].concat());
    assert!(code == Some(2) && path.join("first/discovered.toml").exists(), "{output}");
    // The step is after three hours, so one hour cannot show it.
    done(path, &["-q", "experiment", "first", "--minutes", "60", "--out", "short"]);
    let short = json(&path.join("short/experiment.json"));
    let never = short["unanswerable"].as_array().unwrap().iter().find(|q| q["between"][0] == id).unwrap();
    assert!(never["why"].as_str().unwrap().contains("more --minutes may help"), "{never}");
    let discovered = ["--effects", "first/discovered.toml"];
    let confirmed =
        [&["-q", "calibrate", "step/plateaus-next.csv"], &discovered[..], &["--out", "second"]].concat();
    let output = printed(path, &confirmed);
    assert!(
        output.contains("verdict: attributed") && output.contains(&format!("that {id} acts")),
        "{output}"
    );
    let size = json(&path.join("second/report.json"))["effects"][0]["parameters"]["a"].clone();
    assert!((size["value"].as_f64().unwrap() - 0.15).abs() < 0.04, "{size}");
    // On a rig without it, the effect is not attributed, and its size is excluded or open.
    std::fs::write(path.join("none.toml"), rig("").replace("[[disturbances]]", "")).unwrap();
    done(path, &["-q", "simulate", "none.toml", "--out", "none"]);
    done(path, &[&["-q", "calibrate", "none/plateaus.csv"], &discovered[..], &["--out", "third"]].concat());
    let report = json(&path.join("third/report.json"));
    assert!(report["effects"].as_array().unwrap().iter().all(|e| e["id"] != id), "{}", report["effects"]);
    // The form of an earlier calibration is removed from a folder.
    done(path, &["-q", "calibrate", "none/plateaus.csv", "--out", "first"]);
    assert!(!path.join("first/discovered.toml").exists());
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
