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
