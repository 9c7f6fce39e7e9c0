//! The terminal: no control character of a foreign name, cell or argument reaches it, and `--json`
//! reports errors as JSON.

use std::io::{Read, Write};
use std::path::Path;

use crate::harness::{done, expect_code, json, pinswitch, printed, repository};
use crate::readers::RIG;
use serde_json::Value;

/// Text that erases the screen of a terminal, sets its title, and reverses the direction of text.
const ATTACK: &str = "\u{1b}[2J\u{1b}]0;pwned\u{7}\u{9b}2J\u{202e}";
/// The same in TOML and JSON.
const ESCAPED: &str = r"\u001b[2J\u001b]0;pwned\u0007\u009b2J\u202e";
/// The same without the characters that XML 1.0 forbids.
const XML_ATTACK: &str = "\u{9b}2J\u{202e}";

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).unwrap();
}

/// Runs a command and asserts that its output shows the printable part of the attack, but no
/// control character.
fn assert_neutral(folder: &Path, arguments: &[&str]) {
    let output = pinswitch(folder, arguments);
    let text = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    let is_active = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
    assert!(!text.contains(is_active), "{arguments:?}: {text:?}");
    assert!(text.contains("2J"), "{arguments:?}: {text}");
}

/// Simulates a table that a calibration accepts.
fn plateaus(folder: &Path) -> String {
    done(folder, &["-q", "simulate", "--randomised", "--out", "rig"]);
    std::fs::read_to_string(folder.join("rig/plateaus.csv")).unwrap()
}

/// Covers every argument that a message quotes.
#[test]
fn arguments_are_neutral() {
    let folder = tempfile::tempdir().unwrap();
    let at = |start: &str, end: &str| format!("{start}{ATTACK}{end}");
    for arguments in [
        vec!["generate", &at("a", "")],
        vec!["generate", "three-double", "--set", &at("shell.wi", "dth=3")],
        vec!["generate", "three-double", "--set", &at("label.text='a", "'")],
        vec!["generate", "three-double", "--preset", &at("p", "")],
        vec!["generate", "three-double", "--model", &at("m", ".toml")],
        // Errors of the arguments themselves.
        vec!["predict", "three-double", "--law", &at("", "")],
        vec!["predict", &at("--", "")],
        vec![&at("", "")],
        vec!["batch", &at("s", ".toml"), "--dry-run"],
        vec!["merge", &at("m", "")],
        vec!["check", &at("c", ".stl")],
        vec!["init", &at("i", "")],
        vec!["finger", &at("f", "")],
        vec!["tolerances", &at("t", "")],
        vec!["tolerances", "three-double", "--scatter", &at("s", "")],
        vec!["tolerances", "three-double", "--measured", &at("m", "=1")],
        vec!["segment", &at("r", ".toml"), "--out", "x.csv"],
        vec!["calibrate", &at("t", ".csv"), "--out", "x"],
        vec!["experiment", &at("e", ""), "--out", "x"],
        vec!["effects", "--effects", &at("e", ".toml")],
        vec!["simulate", "--effect", &at("e", "=1"), "--out", "x"],
        vec!["simulate", "--study", "1", "--only", &at("o", "")],
        vec!["design", "--threshold", &at("t", "")],
        vec!["design", "--threshold", "20", "--vary", &at("v", "")],
        vec!["view", &at("v", "")],
    ] {
        assert_neutral(folder.path(), &arguments);
    }
}

/// Covers every file whose content a message quotes.
#[test]
fn content_of_files_is_neutral() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "key.toml", &format!("[shell]\n\"wi{ESCAPED}dth\" = 3\n"));
    write(
        path,
        "sweep.toml",
        &format!("[sweep]\nbase = \"b{ESCAPED}\"\n[axes]\n\"shell.width_mm\" = [14]\n"),
    );
    write(
        path,
        "axis.toml",
        &format!("[sweep]\nbase = \"three-double\"\n[axes]\n\"shell.w{ESCAPED}\" = [14]\n"),
    );
    write(
        path,
        "constraint.toml",
        &format!(
            "[sweep]\nbase = \"three-double\"\n[axes]\n\"shell.width_mm\" = [14]\n\
             [[constraints]]\nrequire = \"w{ESCAPED} > 1\"\n"
        ),
    );
    write(path, "request.toml", &format!("[targets]\n\"t{ESCAPED}\" = 20\n"));
    write(path, "plan.toml", &format!("[noise]\n\"n{ESCAPED}\" = 0.3\n"));
    write(path, "run.toml", &RIG.replace("a.csv", &format!("a{ESCAPED}.csv")));
    write(path, "rig.toml", &format!("\"r{ESCAPED}\" = 1\n"));
    let model = std::fs::read_to_string(repository("tests/corpus/model/accepted-baseline.toml")).unwrap();
    write(path, "model.toml", &model.replacen("name = \"", &format!("name = \"n{ESCAPED}"), 1));
    write(path, "effects.toml", &format!("schema = \"pinswitch.effects/1\"\n\"e{ESCAPED}\" = 1\n"));
    let header = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,\
                  position_mm,time_s,force_N";
    let row = format!("0,sil{ATTACK},5;8;11,up,251.2,3.0766,40,3,eccentric,1,25.40,447.49,2.8671");
    write(path, "table.csv", &format!("{header}\n{row}\n"));
    std::fs::create_dir(path.join("calibration")).unwrap();
    write(path, "calibration/report.json", &format!("{{\"verdict\": \"v{ESCAPED}\"}}"));
    for arguments in [
        "generate key.toml",
        "batch sweep.toml --dry-run",
        "batch axis.toml --dry-run",
        "batch constraint.toml --dry-run",
        "design --request request.toml",
        "simulate plan.toml --out x",
        "power plan.toml",
        "segment run.toml --out x.csv",
        "experiment calibration --rig rig.toml --out x",
        "experiment calibration --out x",
        "predict three-double --model model.toml",
        "effects --effects effects.toml",
        "calibrate table.csv --out x",
    ] {
        assert_neutral(path, &arguments.split(' ').collect::<Vec<_>>());
    }
}

/// Covers results on standard output, warnings and log lines of successful commands.
#[test]
fn results_are_neutral() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let named = format!("s{ATTACK}");
    let quick = ["generate", "three-double", "--format", "stl,3mf"];
    // The log line names the folder.
    assert_neutral(path, &[&quick[..], &["--out", &named]].concat());
    // The warning names a file that was changed.
    let part = path.join(&named).join("proxy.stl");
    std::fs::write(&part, "changed").unwrap();
    assert_neutral(path, &[&quick[..], &["-q", "--set", "parts.proxy=false", "--out", &named]].concat());
    // The verdict names a file, and the objects in it.
    let shell = path.join(&named).join("shell.stl");
    assert_neutral(path, &["check", shell.to_str().unwrap()]);
    let package = std::fs::read(path.join(&named).join("assembly.3mf")).unwrap();
    std::fs::write(path.join("named.3mf"), with_names(&package)).unwrap();
    assert_neutral(path, &["check", "named.3mf"]);
    // The summary names ignored columns, and tables.
    let table = plateaus(path);
    let (header, rows) = table.split_once('\n').unwrap();
    let rows: String = rows.lines().map(|row| format!("{row},1\n")).collect();
    write(path, "column.csv", &format!("{header},humidity{ATTACK}\n{rows}"));
    assert_neutral(path, &["calibrate", "column.csv", "--out", "calibrated"]);
    // The summary of a plan names its folder.
    assert_neutral(path, &["experiment", "calibrated", "--minutes", "60", "--out", &format!("e{ATTACK}")]);
}

/// Returns the 3MF with the attack at the start of every object's name.
fn with_names(package: &[u8]) -> Vec<u8> {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(package)).unwrap();
    let mut renamed = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for i in 0..archive.len() {
        let mut file = archive.by_index(i).unwrap();
        let (name, mut bytes) = (file.name().unwrap().into_owned(), Vec::new());
        file.read_to_end(&mut bytes).unwrap();
        if name.ends_with(".model") {
            let text = String::from_utf8(bytes).unwrap();
            assert!(text.contains(" name=\""));
            bytes = text.replace(" name=\"", &format!(" name=\"{XML_ATTACK}")).into_bytes();
        }
        renamed.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        renamed.write_all(&bytes).unwrap();
    }
    renamed.finish().unwrap().into_inner()
}

/// Data that is not on a terminal keeps its bytes.
#[test]
fn piped_data_keeps_its_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let table = plateaus(path);
    done(path, &["-q", "calibrate", "rig/plateaus.csv", "--out", "calibrated"]);
    let (header, rows) = table.split_once('\n').unwrap();
    let rows: String = rows.lines().take(3).map(|row| format!("{row},a\tb\n")).collect();
    write(path, "note.csv", &format!("{header},note\n{rows}"));
    let csv = printed(path, &["predict", "--model", "calibrated/model.toml", "--rows", "note.csv"]);
    assert_eq!(csv.matches("a\tb").count(), 3, "{csv}");
}

/// Standard output is one JSON document with exit code, location, problem and help; standard error
/// keeps its text.
#[test]
fn errors_are_json() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "sweep.toml", "[sweep]\n");
    for arguments in [
        "generate three-double --set segment.grooves=40",
        "batch sweep.toml --dry-run",
        "merge nowhere",
        "predict no-such",
        "design --threshold 20 --best 0",
        "finger no-such",
        "tolerances silicone-only",
        "physics silicone-only --out x",
        "check no-such.stl nor-this.stl",
        "experiment nowhere --out x",
        "power no-such.toml",
    ] {
        let text: Vec<&str> = arguments.split(' ').collect();
        let plain = expect_code(2, path, &text);
        assert!(plain.stdout.is_empty(), "{arguments}");
        let output = expect_code(2, path, &[&text[..], &["--json"]].concat());
        assert_eq!(output.stderr, plain.stderr, "{arguments}");
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        let error = &document["error"];
        assert_eq!(error["exit_code"], 2, "{arguments}: {document}");
        let diagnostics = error["diagnostics"].as_array().unwrap();
        let errors = String::from_utf8(plain.stderr).unwrap();
        assert_eq!(diagnostics.len(), errors.matches("error: ").count(), "{arguments}: {document}");
        for diagnostic in diagnostics {
            let problem = diagnostic["problem"].as_str().unwrap();
            assert!(!problem.is_empty() && errors.contains(problem), "{arguments}: {document}");
        }
    }
    let location = |arguments: &[&str]| -> Value {
        let output = expect_code(2, path, arguments);
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        document["error"]["diagnostics"][0].clone()
    };
    let diagnostic = location(&["generate", "three-double", "--set", "segment.grooves=40", "--json"]);
    assert_eq!(
        diagnostic["location"],
        serde_json::json!({ "file": "--set", "field": "segment.grooves", "value": "40" })
    );
    assert!(diagnostic["help"].as_str().unwrap().contains("lower it to 20"), "{diagnostic}");
    assert_eq!(diagnostic["changes"][0], serde_json::json!({ "field": "segment.grooves", "value": "20" }));
}

/// A list of verdicts that lacks a file could be taken for all of them.
#[test]
fn verdicts_are_of_every_file_or_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    done(path, &["-q", "generate", "three-double", "--format", "stl", "--out", "set"]);
    let output = expect_code(2, path, &["check", "set/shell.stl", "no-such.stl", "--json"]);
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let diagnostic = &document["error"]["diagnostics"][0];
    assert_eq!(
        (&diagnostic["code"], &diagnostic["location"]["file"]),
        (&"cannot-read".into(), &"no-such.stl".into())
    );
    assert_eq!(json(path, &["check", "set/shell.stl", "--json"])[0]["valid"], true);
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    done(path, &["man", "--out", "man"]);
    let help = printed(path, &["--help"]);
    let commands = help.lines().skip_while(|l| *l != "Commands:").skip(1).take_while(|l| !l.is_empty());
    let commands = commands.filter(|l| !l.starts_with("   ")).filter_map(|l| l.split_whitespace().next());
    let mut pages = 1;
    for command in commands.filter(|command| *command != "help") {
        let page = std::fs::read_to_string(path.join(format!("man/pinswitch-{command}.1"))).unwrap();
        assert!(page.contains(".SH SYNOPSIS") && page.contains("pinswitch"), "{command}: {page}");
        pages += 1;
    }
    let generate = std::fs::read_to_string(path.join("man/pinswitch-generate.1")).unwrap().replace('\\', "");
    for option in ["--out", "--format", "--set", "--preset", "--tolerance", "--json"] {
        assert!(generate.contains(option), "{option}: {generate}");
    }
    assert!(path.join("man/pinswitch.1").is_file());
    assert_eq!(std::fs::read_dir(path.join("man")).unwrap().count(), pages);
}

/// A foreign name cannot print a line of its own.
#[test]
fn line_feeds_of_files_are_neutral() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write(path, "forged.toml", "[switch]\n\"x\\n[INFO ] 8 parts made\" = 1\n");
    let output = expect_code(2, path, &["generate", "forged.toml"]);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("switch.x\\n[INFO ] 8 parts made"), "{text}");
    assert!(!text.lines().any(|line| line.starts_with("[INFO ]")), "{text}");
}

#[test]
fn usage_errors_are_json() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [&["generate", "--json"][..], &["check", "--json", "--bogus"]] {
        let output = expect_code(2, folder.path(), arguments);
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(document["error"]["exit_code"], 2);
        let diagnostic = &document["error"]["diagnostics"][0];
        assert!(!diagnostic["problem"].as_str().unwrap().is_empty(), "{document}");
        assert!(diagnostic["help"].as_str().unwrap().contains("Usage: "), "{document}");
        assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: "));
    }
}
