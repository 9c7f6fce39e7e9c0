//! `provenance.json`: changed files are refused, external ones are listed, and every file names its sources.

use std::path::Path;

use crate::harness::flips::{assert_no_flip_is_believed, make_chain};
use crate::harness::{done, ended, json, printed, sha256};
use serde_json::Value;

/// Number of changed characters; the slow tests change 2,000.
const FLIPS: usize = 290;

fn document(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Each file that a command reads between a log and a set, with a changed character.
#[test]
fn changed_characters_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    make_chain(path);
    assert_no_flip_is_believed(path, FLIPS, 1);
    // Each file lists the hashes of the files from which it was made, back to the log.
    let hash = |file: &str| sha256(&std::fs::read(path.join(file)).unwrap());
    for (made, sources) in [
        ("table/plateaus.csv", &["rig/run.toml", "rig/000-silicone_0251g.csv.gz"][..]),
        ("calibration/model.toml", &["table/plateaus.csv"]),
        (
            "next/next-runs.csv",
            &["calibration/report.json", "calibration/model.toml", "calibration/residuals.csv"],
        ),
        ("second/plateaus.csv", &["next/next-runs.csv", "rig.toml"]),
        (
            "joined/model.toml",
            &["table/plateaus.csv", "second/plateaus.csv", "next/experiment.json", "next/next-runs.csv"],
        ),
    ] {
        let made = path.join(made);
        let manifest = document(&made.with_file_name("provenance.json"));
        let record = &manifest["records"][0];
        let name = made.file_name().unwrap().to_str().unwrap();
        let entry = record["files"].as_array().unwrap().iter().find(|file| file["file"] == name).unwrap();
        assert_eq!(entry["sha256"], hash(made.to_str().unwrap()).as_str());
        for source in sources {
            let listed = record["sources"].as_array().unwrap();
            let entry = listed.iter().find(|file| file["file"] == format!("../{source}")).unwrap();
            assert_eq!(entry["sha256"], hash(source).as_str(), "{source}");
            assert_eq!(entry["external"] == true, *source == "rig.toml", "{source}");
        }
    }
    let set = document(&path.join("set/manifest.json"));
    assert_eq!(set["friction"]["model_sha256"], hash("joined/model.toml").as_str());
}

/// A rig of one layout, for quick calibrations.
fn simulated(path: &Path) {
    std::fs::write(path.join("rig.toml"), "layouts = []\nrepetitions = [4, 4]\nrepetitions_spread = 0\n")
        .unwrap();
    done(path, &["-q", "simulate", "rig.toml", "--next", "--out", "rig"]);
}

#[test]
fn intended_changes_are_external_inputs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    simulated(path);
    let table = path.join("rig/plateaus.csv");
    let text = std::fs::read_to_string(&table).unwrap();
    let (shorter, _) = text.trim_end().rsplit_once('\n').unwrap();
    std::fs::write(&table, shorter).unwrap();
    let calibrate = ["-q", "calibrate", "rig/plateaus.csv", "--out", "calibration"];
    let (code, output) = ended(path, &calibrate);
    assert!(code == Some(2) && output.contains("remove provenance.json"), "{output}");
    // Under a name that the manifest does not list.
    std::fs::copy(&table, path.join("rig/mine.csv")).unwrap();
    let output =
        printed(path, &["-q", "calibrate", "rig/mine.csv", "rig/plateaus-next.csv", "--out", "mine"]);
    assert!(output.contains("external inputs, which no provenance.json lists: mine.csv\n"), "{output}");
    let external = |report: &Value| report["provenance"]["external"].clone();
    let listed = serde_json::json!([{"file": "mine.csv", "sha256": sha256(shorter.as_bytes())}]);
    assert_eq!(external(&document(&path.join("mine/report.json"))), listed);
    let page = std::fs::read_to_string(path.join("mine/report.html")).unwrap();
    assert!(page.contains("External inputs, which no provenance.json lists: mine.csv."));
    // Without the manifest.
    std::fs::remove_file(path.join("rig/provenance.json")).unwrap();
    let output = printed(path, &calibrate);
    assert!(output.contains("external inputs, which no provenance.json lists: plateaus.csv\n"), "{output}");
    // What a command wrote is not external.
    simulated(path);
    let output = printed(path, &calibrate);
    assert!(!output.contains("external"), "{output}");
    assert_eq!(external(&document(&path.join("calibration/report.json"))), serde_json::json!([]));
}

#[test]
fn changed_sources_give_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    simulated(path);
    done(path, &["-q", "calibrate", "rig/plateaus.csv", "--out", "calibration"]);
    let predict = ["-q", "predict", "--model", "calibration/model.toml", "--rows", "rig/plateaus-next.csv"];
    assert!(!done(path, &predict).contains("warning"));
    done(path, &["-q", "simulate", "rig.toml", "--seed", "2", "--next", "--out", "rig"]);
    let output = done(path, &predict);
    let source = Path::new("calibration").join("../rig/plateaus.csv");
    let warning = format!(
        "warning: calibration/model.toml: was made from {}, which has changed since",
        source.display()
    );
    assert_eq!(output.matches(&warning).count(), 1, "{output}");
    assert!(output.contains("help: run `pinswitch calibrate` again"), "{output}");
}

/// Several commands write into one folder: each replaces the entries of its own files.
#[test]
fn commands_share_the_manifest_of_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    simulated(path);
    done(path, &["-q", "calibrate", "rig/plateaus.csv", "--out", "rig"]);
    done(path, &["-q", "experiment", "rig", "--out", "rig"]);
    done(path, &["-q", "calibrate", "rig/plateaus-next.csv", "--out", "rig"]);
    let commands: Vec<Value> = document(&path.join("rig/provenance.json"))["records"]
        .as_array()
        .unwrap()
        .iter()
        .map(|record| record["command"].clone())
        .collect();
    assert_eq!(commands, ["simulate", "experiment", "calibrate"]);
    let report = path.join("rig/report.json");
    let text = std::fs::read_to_string(&report).unwrap();
    std::fs::write(&report, text.replacen("\"rows\": ", "\"rows\": 1", 1)).unwrap();
    let (code, output) = ended(path, &["-q", "experiment", "rig", "--out", "x"]);
    assert!(code == Some(2) && output.contains("rig/report.json: was changed"), "{output}");
    std::fs::write(&report, text).unwrap();
    // A damaged manifest is not replaced silently; that of another program is neither read nor replaced.
    let manifest = path.join("rig/provenance.json");
    let simulate = ["-q", "simulate", "rig.toml", "--out", "rig"];
    let text = std::fs::read_to_string(&manifest).unwrap();
    std::fs::write(&manifest, text.replacen("simulate", "simulated", 1)).unwrap();
    let (code, output) = ended(path, &simulate);
    assert!(
        code == Some(2) && output.contains("rig/provenance.json: was changed since pinswitch"),
        "{output}"
    );
    std::fs::write(&manifest, "{\"entity\": {}}").unwrap();
    assert!(json(path, &["-q", "experiment", "rig", "--json", "--out", "x"])["schema"].is_string());
    let (code, output) = ended(path, &simulate);
    assert!(
        code == Some(2) && output.contains("rig/provenance.json: is not a manifest of pinswitch"),
        "{output}"
    );
    assert_eq!(std::fs::read(&manifest).unwrap(), b"{\"entity\": {}}");
}

/// The descriptor of a calibration lists every other result with its size and hash, each table with its columns, and the
/// table that it was made from.
#[test]
fn a_calibration_is_a_data_package() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    simulated(path);
    done(path, &["-q", "calibrate", "rig/plateaus.csv", "--out", "calibration"]);
    let calibration = path.join("calibration");
    let package = document(&calibration.join("datapackage.json"));
    let resources = package["resources"].as_array().unwrap();
    for entry in std::fs::read_dir(&calibration).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let listed = resources.iter().find(|resource| resource["path"] == name.as_str());
        if ["datapackage.json", "provenance.json"].contains(&name.as_str()) {
            assert!(listed.is_none(), "{name}");
            continue;
        }
        let listed = listed.unwrap_or_else(|| panic!("{name} is not listed"));
        let bytes = std::fs::read(calibration.join(&name)).unwrap();
        assert_eq!(listed["bytes"], bytes.len(), "{name}");
        assert_eq!(listed["hash"], format!("sha256:{}", sha256(&bytes)), "{name}");
    }
    let residuals = resources.iter().find(|resource| resource["path"] == "residuals.csv").unwrap();
    let fields = residuals["schema"]["fields"].as_array().unwrap();
    let names: Vec<&str> = fields.iter().map(|field| field["name"].as_str().unwrap()).collect();
    let text = std::fs::read_to_string(calibration.join("residuals.csv")).unwrap();
    assert_eq!(names.join(","), text.lines().next().unwrap());
    let of = |name: &str| fields.iter().find(|field| field["name"] == name).unwrap();
    assert_eq!((&of("force_N")["type"], &of("force_N")["unit"]), (&"number".into(), &"N".into()));
    assert_eq!((&of("repetition")["type"], &of("substrate")["type"]), (&"number".into(), &"any".into()));
    assert_eq!(package["sources"][0]["title"], "plateaus.csv");
    let table = std::fs::read(path.join("rig/plateaus.csv")).unwrap();
    assert_eq!(package["sources"][0]["hash"], format!("sha256:{}", sha256(&table)));
}
