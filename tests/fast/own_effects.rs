//! Effects of one's own, end to end: found where they are, silent where they are not, carried by the model.

use std::path::Path;

use crate::harness::{done, ended, expect_code, json, printed};

/// A session in which the speed varies apart from the load.
const PLAN: &str = "seed = 2\nprotocol = \"randomised\"\nlayouts = [[5, 8, 11]]\nweights_g = [251.2, 1003.2, 2005.0, 3007.2, 4007.8, 5002.5]
speeds_pct = [40, 44, 48, 52, 56, 60, 64, 70]\ndwells_s = [3]\nrepetitions = [6, 6]\n";

/// A folder with the plan and the effects that `init` writes.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("plan.toml"), PLAN).unwrap();
    done(folder.path(), &["init", "effects", "--out", "mine.toml"]);
    folder
}

fn report(folder: &Path, calibrated: &str) -> serde_json::Value {
    let text = std::fs::read(folder.join(calibrated).join("report.json")).unwrap();
    serde_json::from_slice(&text).unwrap()
}

/// Ids of what was found.
fn found(report: &serde_json::Value) -> Vec<&str> {
    report["effects"].as_array().unwrap().iter().filter_map(|e| e["id"].as_str()).collect()
}

#[test]
fn an_effect_of_ones_own_is_found_and_its_model_predicts_without_its_file() {
    let folder = folder();
    let at = folder.path();
    let simulate = [
        "-q",
        "simulate",
        "plan.toml",
        "--effects",
        "mine.toml",
        "--effect",
        "lubricant_dip=0.3",
        "--out",
        "rig",
    ];
    done(at, &simulate);
    done(at, &["-q", "calibrate", "rig/plateaus.csv", "--effects", "mine.toml", "--out", "with"]);
    let with = report(at, "with");
    assert_eq!((with["verdict"].as_str(), found(&with)), (Some("attributed"), vec!["lubricant_dip"]));
    let effect = &with["effects"][0];
    for (name, truth) in [("a", 0.3), ("c", 52.0), ("w", 8.0)] {
        let size = effect["parameters"][name]["value"].as_f64().unwrap();
        assert!((size / truth - 1.0).abs() < 0.1, "{name} = {size}");
    }
    let page = std::fs::read_to_string(at.join("with/report.html")).unwrap();
    assert!(page.contains("lubricant_dip"));
    // The model is all that is needed from here on.
    std::fs::remove_file(at.join("mine.toml")).unwrap();
    let rows = printed(at, &["predict", "--model", "with/model.toml", "--rows", "rig/plateaus-fresh.csv"]);
    let misses: Vec<f64> = rows
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<f64> = line.split(',').filter_map(|cell| cell.parse().ok()).collect();
            cells[cells.len() - 3] - cells[cells.len() - 2]
        })
        .collect();
    let rms = (misses.iter().map(|m| m * m).sum::<f64>() / misses.len() as f64).sqrt();
    assert!(rms < 0.4, "{rms} N on rows without noise");
    done(at, &["-q", "generate", "three-double", "--model", "with/model.toml", "--out", "part"]);
    // What the vocabulary lacks is no name, but it is not overlooked either.
    done(at, &["-q", "calibrate", "rig/plateaus.csv", "--out", "without"]);
    let without = report(at, "without");
    assert!(!found(&without).contains(&"lubricant_dip"));
    assert_eq!(without["verdict"].as_str(), Some("unattributed"));
}

#[test]
fn an_effect_that_is_absent_raises_no_alarm() {
    let folder = folder();
    let at = folder.path();
    done(at, &["-q", "simulate", "plan.toml", "--out", "rig"]);
    done(at, &["-q", "calibrate", "rig/plateaus.csv", "--effects", "mine.toml", "--out", "null"]);
    let null = report(at, "null");
    assert_eq!(found(&null), Vec::<&str>::new());
    let candidates = null["candidates"].as_array().unwrap();
    assert_eq!(candidates.len(), 22);
    assert!(candidates.iter().any(|c| c["id"] == "lubricant_dip"));
}

/// Written out under another id, a built-in effect is its own rival: no data can tell the two apart.
#[test]
fn a_built_in_effect_written_out_is_its_rival() {
    let folder = folder();
    let at = folder.path();
    let all = printed(at, &["effects", "--toml"]);
    let from = all.find("[[effect]]\nid = \"stroke_position\"").unwrap();
    let block = all[from..].split("\n\n").next().unwrap().replace("stroke_position", "mine");
    std::fs::write(at.join("copy.toml"), format!("schema = \"pinswitch.effects/1\"\n{block}\n")).unwrap();
    done(at, &["-q", "simulate", "plan.toml", "--effect", "stroke_position=0.2", "--out", "rig"]);
    done(at, &["-q", "calibrate", "rig/plateaus.csv", "--effects", "copy.toml", "--out", "both"]);
    let both = report(at, "both");
    let mut ids = found(&both);
    ids.extend(both["effects"][0]["rivals"].as_array().unwrap().iter().filter_map(|r| r["id"].as_str()));
    ids.sort_unstable();
    assert_eq!(ids, ["mine", "stroke_position"]);
}

#[test]
fn power_tries_effects_of_ones_own_and_effects_lists_them() {
    let folder = folder();
    let at = folder.path();
    let listed = printed(at, &["effects", "--effects", "mine.toml"]);
    assert!(listed.contains("rate_dependence") && listed.contains("lubricant_dip"), "{listed}");
    // Written out, they stand after the built-in ones; all can be read once those have ids of their own.
    let written = printed(at, &["effects", "--toml", "--effects", "mine.toml"]);
    let ids: Vec<&str> = written.lines().filter(|line| line.starts_with("id = ")).collect();
    assert_eq!((ids.len(), ids[16]), (17, "id = \"lubricant_dip\""), "{written}");
    let renamed = written.replace("\nid = \"", "\nid = \"own_");
    std::fs::write(at.join("all.toml"), &renamed).unwrap();
    let again = printed(at, &["effects", "--effects", "all.toml"]);
    assert!(again.contains("own_rate_dependence") && again.contains("own_lubricant_dip"), "{again}");
    let small =
        "layouts = []\nweights_g = [1000, 3000, 5000]\nrepetitions = [3, 3]\nrepetitions_spread = 0\n";
    std::fs::write(at.join("small.toml"), small).unwrap();
    let power = json(at, &["-q", "power", "small.toml", "--effects", "mine.toml", "--runs", "1", "--json"]);
    let mine: Vec<_> = power.as_array().unwrap().iter().filter(|p| p["id"] == "lubricant_dip").collect();
    assert_eq!(mine.len(), 2, "a small and a large size");
}

#[test]
fn faults_are_placed_and_the_cause_is_named() {
    let folder = folder();
    let at = folder.path();
    done(at, &["-q", "simulate", "plan.toml", "--out", "rig"]);
    let good = std::fs::read_to_string(at.join("mine.toml")).unwrap();
    std::fs::write(at.join("bad.toml"), good.replace("speed_pct - c", "sped_pct - c")).unwrap();
    for command in ["calibrate rig/plateaus.csv --effects bad.toml --out x", "effects --effects bad.toml"] {
        let arguments: Vec<&str> = command.split(' ').collect();
        let (code, said) = ended(at, &arguments);
        assert_eq!(code, Some(2), "{said}");
        assert!(
            said.contains("bad.toml:12:24: unknown variable 'sped_pct'; did you mean speed_pct?"),
            "{said}"
        );
    }
    let (code, said) = ended(at, &["effects", "--effects", "mine.toml", "--effects", "mine.toml"]);
    assert!(code == Some(2) && said.contains("id 'lubricant_dip' is given twice"), "{said}");
    // The heaviest load of this table was not among those that any formula is tried on.
    let log = good.replace("-a * exp(-((speed_pct - c)/w)^2)", "a*c/w*sqrt(1 - previous_load_n/49.4)");
    std::fs::write(at.join("log.toml"), log).unwrap();
    let (code, said) = ended(at, &["calibrate", "rig/plateaus.csv", "--effects", "log.toml", "--out", "x"]);
    assert!(code == Some(2) && said.contains("has no number where a = "), "{said}");
    assert!(said.contains(", at which a fit may begin, in row "), "{said}");
    assert!(!at.join("x").exists());
    // Formulas that say something else than they seem to, or nothing.
    for (from, to, words) in [
        ("id = \"lubricant_dip\"", "id = \"none\"", "id 'none' is what reports call"),
        ("-a * exp(-((speed_pct - c)/w)^2)", "-a*(40 < speed_pct < c)*w/w", "a comparison of a comparison"),
        ("-a * exp(-((speed_pct - c)/w)^2)", "0*a*speed_pct/(c + w)", "such an effect does nothing"),
    ] {
        assert!(good.contains(from), "{from}");
        std::fs::write(at.join("odd.toml"), good.replace(from, to)).unwrap();
        let (code, said) = ended(at, &["effects", "--effects", "odd.toml"]);
        assert!(code == Some(2) && said.contains(words) && said.contains("odd.toml:"), "{to}: {said}");
    }
    for (effect, words) in [
        ("lubricant_dp=0.1,50,5", "did you mean lubricant_dip?"),
        ("coating_stiffening=1,99", "= 99: m must be from 0.9 to 2.1"),
        ("adhesion=-1", "= -1: c must not be negative"),
    ] {
        let (code, said) =
            ended(at, &["simulate", "--effects", "mine.toml", "--effect", effect, "--out", "x"]);
        assert!(code == Some(2) && said.contains(words), "{effect}: {said}");
    }
    std::fs::write(at.join("kind.toml"), "[[disturbances]]\nkind = \"resonance\"\nsize = 0.1\n").unwrap();
    let (code, said) = ended(at, &["simulate", "kind.toml", "--out", "x"]);
    assert!(code == Some(2) && said.contains("kind.resonance = {"), "{said}");
    // The field that was the cause, and no flag that was not.
    let (code, said) = ended(at, &["simulate", "--randomised", "--raw", "--out", "raw"]);
    assert!(code == Some(2) && said.contains("dwells_s") && !said.contains("--effect"), "{said}");
}

/// What `init` writes is accepted as it stands.
#[test]
fn starters_are_accepted_by_their_commands() {
    let folder = folder();
    let at = folder.path();
    for name in ["effects", "plan", "run", "rig", "sweep"] {
        done(at, &["init", name, "--out", &format!("start-{name}.toml")]);
    }
    done(at, &["-q", "simulate", "start-plan.toml", "--effects", "start-effects.toml", "--out", "rig"]);
    done(at, &["-q", "calibrate", "rig/plateaus.csv", "--effects", "start-effects.toml", "--out", "found"]);
    // The logs that the run names, from a simulated rig.
    let raw = "layouts = [[5, 8, 11]]\nweights_g = [2505.4, 5002.5]\nrepetitions = [5, 5]\nrepetitions_spread = 0\nproxy = false\n";
    std::fs::write(at.join("raw.toml"), raw).unwrap();
    done(at, &["-q", "simulate", "raw.toml", "--raw", "--out", "raw"]);
    let mut logs: Vec<_> = std::fs::read_dir(at.join("raw"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.to_string_lossy().ends_with(".csv.gz"))
        .collect();
    logs.sort();
    for (log, name) in logs.iter().zip(["silicone-5002g.csv.gz", "device-2505g.csv.gz"]) {
        std::fs::copy(log, at.join(name)).unwrap();
    }
    expect_code(0, at, &["-q", "segment", "start-run.toml", "--out", "plateaus.csv"]);
}
