//! User-defined effects, end to end: detected where present, not reported where absent, and
//! contained in the model.

use std::path::Path;

use crate::harness::{done, ended, expect_code, json, printed};

/// A session in which the speed varies independently of the load.
const PLAN: &str = "seed = 2\nprotocol = \"randomised\"\nlayouts = [[5, 8, 11]]\nweights_g = [251.2, 1003.2, 2005.0, 3007.2, 4007.8, 5002.5]
speeds_pct = [40, 44, 48, 52, 56, 60, 64, 70]\ndwells_s = [3]\nrepetitions = [6, 6]\n";

/// Creates a folder with the plan and the effects that `init` writes.
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

/// Returns the ids of the effects.
fn effect_ids(report: &serde_json::Value) -> Vec<&str> {
    report["effects"].as_array().unwrap().iter().filter_map(|e| e["id"].as_str()).collect()
}

#[test]
fn a_user_defined_effect_is_found() {
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
    // Eight speeds do not quite exclude a curve without a name.
    let effect = &with["effects"][0];
    let is_speed =
        |rival: &serde_json::Value| rival["id"].as_str().is_some_and(|id| id.ends_with("over speed"));
    assert_eq!(effect_ids(&with), ["lubricant_dip"], "{with}");
    assert!(["attributed", "ambiguous"].contains(&with["verdict"].as_str().unwrap()), "{with}");
    assert!(effect["probability"].as_f64() > Some(0.8), "{effect}");
    assert!(effect["rivals"].as_array().unwrap().iter().all(is_speed), "{effect}");
    for (name, truth) in [("a", 0.3), ("c", 52.0), ("w", 8.0)] {
        let size = effect["parameters"][name]["value"].as_f64().unwrap();
        assert!((size / truth - 1.0).abs() < 0.1, "{name} = {size}");
    }
    let page = std::fs::read_to_string(at.join("with/report.html")).unwrap();
    assert!(page.contains("lubricant_dip"));
    // From here on only the model is needed.
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
    // Without the effect in the vocabulary, its residual is reported as unattributed structure.
    done(at, &["-q", "calibrate", "rig/plateaus.csv", "--out", "without"]);
    let without = report(at, "without");
    assert!(!effect_ids(&without).contains(&"lubricant_dip"));
    assert_eq!(without["verdict"].as_str(), Some("unattributed"));
}

#[test]
fn an_absent_effect_is_not_reported() {
    let folder = folder();
    let at = folder.path();
    done(at, &["-q", "simulate", "plan.toml", "--out", "rig"]);
    done(at, &["-q", "calibrate", "rig/plateaus.csv", "--effects", "mine.toml", "--out", "null"]);
    let null = report(at, "null");
    assert_eq!(effect_ids(&null), Vec::<&str>::new());
    let candidates = null["candidates"].as_array().unwrap();
    assert_eq!(candidates.len(), 22);
    assert!(candidates.iter().any(|c| c["id"] == "lubricant_dip"));
}

/// Under another id, the formula of a built-in effect is confounded with it.
#[test]
fn formula_of_builtin_becomes_rival() {
    let folder = folder();
    let at = folder.path();
    let all = printed(at, &["effects", "--toml"]);
    let from = all.find("[[effect]]\nid = \"stroke_position\"").unwrap();
    let block = all[from..].split("\n\n").next().unwrap().replace("stroke_position", "mine");
    std::fs::write(at.join("copy.toml"), format!("schema = \"pinswitch.effects/1\"\n{block}\n")).unwrap();
    done(at, &["-q", "simulate", "plan.toml", "--effect", "stroke_position=0.2", "--out", "rig"]);
    done(at, &["-q", "calibrate", "rig/plateaus.csv", "--effects", "copy.toml", "--out", "both"]);
    let both = report(at, "both");
    let mut ids = effect_ids(&both);
    ids.extend(both["effects"][0]["rivals"].as_array().unwrap().iter().filter_map(|r| r["id"].as_str()));
    ids.sort_unstable();
    assert_eq!(ids, ["mine", "stroke_position"]);
}

#[test]
fn power_includes_user_defined_effects() {
    let folder = folder();
    let at = folder.path();
    let listed = printed(at, &["effects", "--effects", "mine.toml"]);
    assert!(listed.contains("rate_dependence") && listed.contains("lubricant_dip"), "{listed}");
    // As formulas, they follow the built-in ones; all can be read once those have other ids.
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
fn problems_are_located() {
    let folder = folder();
    let at = folder.path();
    done(at, &["-q", "simulate", "plan.toml", "--out", "rig"]);
    let good = std::fs::read_to_string(at.join("mine.toml")).unwrap();
    std::fs::write(at.join("bad.toml"), good.replace("speed_pct - c", "sped_pct - c")).unwrap();
    for command in ["calibrate rig/plateaus.csv --effects bad.toml --out x", "effects --effects bad.toml"] {
        let arguments: Vec<&str> = command.split(' ').collect();
        let (code, output) = ended(at, &arguments);
        assert_eq!(code, Some(2), "{output}");
        assert!(
            output.contains("bad.toml:12:24: unknown variable 'sped_pct' [unknown-name]\n")
                && output.contains("\n  help: did you mean speed_pct?"),
            "{output}"
        );
    }
    let (code, output) = ended(at, &["effects", "--effects", "mine.toml", "--effects", "mine.toml"]);
    assert!(code == Some(2) && output.contains("duplicate id 'lubricant_dip'"), "{output}");
    // The heaviest load of this table exceeds those of the probe rows.
    let log = good.replace("-a * exp(-((speed_pct - c)/w)^2)", "a*c/w*sqrt(1 - previous_load_n/49.4)");
    std::fs::write(at.join("log.toml"), log).unwrap();
    let (code, output) = ended(at, &["calibrate", "rig/plateaus.csv", "--effects", "log.toml", "--out", "x"]);
    assert!(code == Some(2) && output.contains("is not finite at its start value a = "), "{output}");
    assert!(output.contains(" (row "), "{output}");
    assert!(!at.join("x").exists());
    // Formulas that are valid but do not mean what they seem to.
    for (from, to, words) in [
        ("id = \"lubricant_dip\"", "id = \"none\"", "id 'none' means the absence of every effect"),
        ("-a * exp(-((speed_pct - c)/w)^2)", "-a*(40 < speed_pct < c)*w/w", "comparisons cannot be chained"),
        ("-a * exp(-((speed_pct - c)/w)^2)", "0*a*speed_pct/(c + w)", "so the effect does nothing"),
    ] {
        assert!(good.contains(from), "{from}");
        std::fs::write(at.join("odd.toml"), good.replace(from, to)).unwrap();
        let (code, output) = ended(at, &["effects", "--effects", "odd.toml"]);
        assert!(code == Some(2) && output.contains(words) && output.contains("odd.toml:"), "{to}: {output}");
    }
    for (effect, words) in [
        ("lubricant_dp=0.1,50,5", "did you mean lubricant_dip?"),
        ("coating_stiffening=1,99", "= 99: m must be from 0.9 to 2.1"),
        ("adhesion=-1", "= -1: c must not be negative"),
    ] {
        let (code, output) =
            ended(at, &["simulate", "--effects", "mine.toml", "--effect", effect, "--out", "x"]);
        assert!(code == Some(2) && output.contains(words), "{effect}: {output}");
    }
    std::fs::write(at.join("kind.toml"), "[[disturbances]]\nkind = \"resonance\"\nsize = 0.1\n").unwrap();
    let (code, output) = ended(at, &["simulate", "kind.toml", "--out", "x"]);
    assert!(code == Some(2) && output.contains("kind.resonance = {"), "{output}");
    // The error names the field that caused it, and no other flag.
    let (code, output) = ended(at, &["simulate", "--randomised", "--raw", "--out", "raw"]);
    assert!(code == Some(2) && output.contains("dwells_s") && !output.contains("--effect"), "{output}");
}

/// Files written by `init` are accepted unchanged.
#[test]
fn starter_files_are_accepted() {
    let folder = folder();
    let at = folder.path();
    for name in ["effects", "plan", "run", "rig", "sweep"] {
        done(at, &["init", name, "--out", &format!("start-{name}.toml")]);
    }
    done(at, &["-q", "simulate", "start-plan.toml", "--effects", "start-effects.toml", "--out", "rig"]);
    done(at, &["-q", "calibrate", "rig/plateaus.csv", "--effects", "start-effects.toml", "--out", "found"]);
    // The logs named by the run, from a simulated rig.
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
