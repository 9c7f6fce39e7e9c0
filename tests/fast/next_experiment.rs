//! The loop as a whole: a first table that cannot tell, the runs that are proposed, a second table, the verdict. And forms that are drawn
//! from one session and decided on by another.

use std::path::Path;

use crate::harness::{done, ended, printed};
use serde_json::Value;

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// The worked example of `model/doc/next-experiment.md`.
#[test]
fn what_the_paper_s_protocol_cannot_tell_is_told_by_the_runs_that_are_proposed() {
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
    let asked = questions.iter().find(|q| q["between"][0] == "rate_dependence").unwrap();
    assert!(asked["resolved_probability"].as_f64() > Some(0.8), "{asked}");
    assert!(asked["by_repeating"].as_f64() < Some(0.2), "{asked}");
    let sheet = std::fs::read_to_string(path.join("next/run-sheet.html")).unwrap();
    assert!(sheet.contains("mount 1: ") && sheet.contains("rate_dependence or none"));
    // The same model makes the same plan, and the runs can be rehearsed on it.
    done(path, &["-q", "experiment", "calibration", "--minutes", "60", "--out", "again"]);
    let bytes = |name: &str| std::fs::read(path.join(name)).unwrap();
    assert_eq!(bytes("next/next-runs.csv"), bytes("again/next-runs.csv"));
    // A cell that no load fits is no want of minutes.
    std::fs::write(path.join("tiny.toml"), "cell_limit_n = 0.1\n").unwrap();
    let (code, said) =
        ended(path, &["-q", "experiment", "calibration", "--rig", "tiny.toml", "--out", "none"]);
    assert!(code == Some(2) && said.contains("tiny.toml: cell_limit_n = 0.1: at every load"), "{said}");
    assert!(!said.contains("minutes") && !path.join("none").exists(), "{said}");
    let runs = ["--runs", "next/next-runs.csv"];
    done(
        path,
        &[&["-q", "simulate"], &runs[..], &["--model", "calibration/model.toml", "--out", "rehearsal"]]
            .concat(),
    );
    // The rig that has the effect makes them.
    done(path, &[&["-q", "simulate"], &runs[..], &truth, &["--seed", "5", "--out", "second"]].concat());
    let both =
        ["-q", "calibrate", "first/plateaus.csv", "second/plateaus.csv", "--plan", "next", "--out", "joined"];
    let said = printed(path, &both);
    assert!(said.starts_with("from first/plateaus.csv: inconclusive"), "{said}");
    let report = json(&path.join("joined/report.json"));
    assert_eq!(
        (&report["verdict"], &report["effects"][0]["id"]),
        (&"attributed".into(), &"rate_dependence".into())
    );
    let size = &report["effects"][0]["parameters"]["k"];
    let [low, high] = [0, 1].map(|i| size["ci95"][i].as_f64().unwrap());
    assert!(low < 0.2 && 0.2 < high && high - low < 0.1, "{size}");
    let sessions = report["sessions"].as_array().unwrap();
    assert_eq!((sessions.len(), &sessions[1]["verdict"]), (2, &"attributed".into()));
    // What was expected is held against what came: what is sure to be settled is.
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
    assert!(said.contains("second/plateaus.csv answers "), "{said}");
    let page = std::fs::read_to_string(path.join("joined/report.html")).unwrap();
    assert!(page.contains("rate_dependence or none at a size of 0.100 (99 %): <b>found</b>"));
}

#[test]
fn what_a_plan_cannot_be_made_of_is_one_error() {
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
        ("experiment other --out next", "other/report.json: missing field"),
        ("experiment other --rig rig.toml --out next", "rig.toml:1: loads_g = 0 weights is outside"),
        ("experiment other --minutes 0 --out next", "minutes"),
        ("experiment other --minutes nan --out next", "minutes"),
        ("simulate --runs runs.csv --out x", "runs.csv: column 'pins' is missing"),
        ("calibrate runs.csv --plan other --out x", "--plan is given 1 times and 0 tables follow the first"),
        ("calibrate runs.csv runs.csv --plan empty --out x", "empty/experiment.json: cannot read"),
        (
            "calibrate runs.csv runs.csv --plan other --out x",
            "other/experiment.json: schema = \"x/1\" is not",
        ),
    ] {
        let arguments: Vec<_> = ["-q"].into_iter().chain(arguments.split(' ')).collect();
        let (code, said) = ended(path, &arguments);
        assert!(code == Some(2) && said.contains(words) && said.len() < 600, "{arguments:?}: {said}");
        assert!(!path.join("next").exists() && !path.join("x").exists(), "{arguments:?}");
    }
}

/// A plan of the randomised protocol with something that no effect is.
fn rig(disturbance: &str) -> String {
    format!(
        "seed = 7\nprotocol = \"randomised\"\nspeeds_pct = [40.0, 50.0, 60.0, 70.0]\ndwells_s = [1.0, 3.0, 10.0]\n\
         repetitions = [8, 10]\nrepetitions_spread = 0\n[[disturbances]]\n{disturbance}\n"
    )
}

#[test]
fn a_form_drawn_from_one_session_is_confirmed_by_another_and_refuted_by_one_without_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let step = "size = 0.15\ntarget = \"friction\"\nkind.step = { at = 0.45, over = 0.0 }";
    std::fs::write(path.join("step.toml"), rig(step)).unwrap();
    done(path, &["-q", "simulate", "step.toml", "--next", "--out", "step"]);
    let said = printed(path, &["-q", "calibrate", "step/plateaus.csv", "--out", "first"]);
    assert!(said.contains("looks like a step on friction"), "{said}");
    let form = json(&path.join("first/report.json"))["effects"][0]["form"].clone();
    assert_eq!((&form["shape"], &form["acts_on"]), (&"step".into(), &"friction".into()), "{form}");
    let id = form["id"].as_str().unwrap();
    // Whether it comes again is the first thing to ask of another session; what it was drawn from does not answer that.
    done(path, &["-q", "experiment", "first", "--minutes", "240", "--out", "plan"]);
    let plan = json(&path.join("plan/experiment.json"));
    let asked = plan["questions"].as_array().unwrap().iter().find(|q| q["between"][0] == id);
    assert!(asked.is_some_and(|q| q["resolved_probability"].as_f64() > Some(0.9)), "{plan}");
    // The plan carries the form, so that whether it came again is answered without its file.
    assert_eq!(
        std::fs::read(path.join("plan/discovered.toml")).unwrap(),
        std::fs::read(path.join("first/discovered.toml")).unwrap()
    );
    done(path, &["-q", "simulate", "step.toml", "--runs", "plan/next-runs.csv", "--out", "made"]);
    let tables = ["step/plateaus.csv", "made/plateaus.csv"];
    done(path, &[&["-q", "calibrate"], &tables[..], &["--plan", "plan", "--out", "joined"]].concat());
    let answers = json(&path.join("joined/report.json"))["sessions"][1]["asked"]["questions"].clone();
    let answer = answers.as_array().unwrap().iter().find(|q| q["between"][0] == id).unwrap();
    // A step lies at a share of its own session: in one of another length it is not where it was drawn.
    assert_ne!(answer["answer"], "open", "{answers}");
    // What it was drawn from names nothing, and is not taken away from under the calibration that reads it.
    let own = ["-q", "calibrate", "step/plateaus.csv", "--effects", "first/discovered.toml", "--out"];
    let said = printed(path, &[&own[..], &["own"]].concat());
    assert!(said.starts_with("verdict: unattributed") && said.contains("on trial: drawn"), "{said}");
    let (code, said) = ended(path, &[&own[..], &["first"]].concat());
    assert!(code == Some(2) && path.join("first/discovered.toml").exists(), "{said}");
    // The step came after three hours: an hour cannot show it, and says so.
    done(path, &["-q", "experiment", "first", "--minutes", "60", "--out", "short"]);
    let short = json(&path.join("short/experiment.json"));
    let never = short["unanswerable"].as_array().unwrap().iter().find(|q| q["between"][0] == id).unwrap();
    assert!(never["why"].as_str().unwrap().contains("more --minutes may help"), "{never}");
    let discovered = ["--effects", "first/discovered.toml"];
    let confirmed =
        [&["-q", "calibrate", "step/plateaus-next.csv"], &discovered[..], &["--out", "second"]].concat();
    let said = printed(path, &confirmed);
    assert!(said.starts_with("verdict: attributed") && said.contains(id), "{said}");
    let size = json(&path.join("second/report.json"))["effects"][0]["parameters"]["a"].clone();
    assert!((size["value"].as_f64().unwrap() - 0.15).abs() < 0.04, "{size}");
    // On a rig without it nothing of the kind is named, and a size like that is excluded or said to be open.
    std::fs::write(path.join("none.toml"), rig("").replace("[[disturbances]]", "")).unwrap();
    done(path, &["-q", "simulate", "none.toml", "--out", "none"]);
    done(path, &[&["-q", "calibrate", "none/plateaus.csv"], &discovered[..], &["--out", "third"]].concat());
    let report = json(&path.join("third/report.json"));
    assert!(report["effects"].as_array().unwrap().iter().all(|e| e["id"] != id), "{}", report["effects"]);
    // A folder is not left with the form of an earlier calibration.
    done(path, &["-q", "calibrate", "none/plateaus.csv", "--out", "first"]);
    assert!(!path.join("first/discovered.toml").exists());
}

/// Curves go to the heaviest load of the paper, whatever was recorded.
#[test]
fn loads_that_curves_need_and_nobody_recorded_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    done(path, &["-q", "simulate", "--out", "whole"]);
    let table = std::fs::read_to_string(path.join("whole/plateaus.csv")).unwrap();
    let at = table.lines().next().unwrap().split(',').position(|c| c == "load_N").unwrap();
    let is_light = |line: &&str| line.split(',').nth(at).unwrap().parse::<f64>().is_ok_and(|n| n < 26.0);
    let light: Vec<&str> = table.lines().take(1).chain(table.lines().skip(1).filter(is_light)).collect();
    std::fs::write(path.join("light.csv"), light.join("\n")).unwrap();
    let asked = |table: &str, folder: &str| {
        done(path, &["-q", "calibrate", table, "--out", folder]);
        done(path, &["-q", "experiment", folder, "--minutes", "60", "--out", "plan"]);
        let plan = json(&path.join("plan/experiment.json"));
        let of = |q: &&Value| q["between"][0].as_str().unwrap().starts_with("friction_above_");
        plan["questions"].as_array().unwrap().iter().find(of).cloned()
    };
    let question = asked("light.csv", "few").unwrap();
    let chance = |key: &str| question[key].as_f64().unwrap();
    assert!(chance("resolved_probability") > 0.2 + chance("by_repeating"), "{question}");
    assert_eq!(asked("whole/plateaus.csv", "all"), None);
}
