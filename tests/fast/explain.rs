//! Codes of errors and warnings: every code is used, printed, and explained by `explain`.

use std::collections::BTreeSet;
use std::path::Path;

use pinswitch_diagnostic::{Area, Code};

use crate::harness::{binary, expect_code, json, repository};

/// Document with the pages of all codes.
const DOCUMENT: &str = "cad/doc/diagnostics.md";
/// Most columns of a document.
const COLUMNS: usize = 120;

/// Returns the text of every source file of the crates that report errors.
fn sources(folder: &Path, text: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_table = path.ends_with("model/diagnostic/src");
        if path.is_dir() && !is_table && !path.ends_with("target") {
            sources(&path, text);
        } else if path.extension().is_some_and(|e| e == "rs") {
            text.push_str(&std::fs::read_to_string(path).unwrap());
        }
    }
}

#[test]
fn every_code_is_used() {
    let mut text = String::new();
    sources(&repository("cad"), &mut text);
    sources(&repository("model"), &mut text);
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let used: BTreeSet<&str> =
        text.split("codes::").skip(1).filter_map(|rest| rest.split(|c| !is_name(c)).next()).collect();
    let unused: Vec<&str> = Code::all()
        .map(Code::name)
        .filter(|name| !used.contains(name.to_uppercase().replace('-', "_").as_str()))
        .collect();
    assert!(unused.is_empty(), "{unused:?}");
}

/// A command line that fails, and the code that it prints.
const FAILURES: &[(i32, &str, &str)] = &[
    (2, "generate three-double --set segment.grooves=40", "grooves-overlap"),
    (2, "generate three-double --set shell.wall_mm=1", "wall-under-grooves"),
    (2, "generate three-double --set segment.groves=4", "unknown-field"),
    (2, "generate three-double --set shell.width_mm=1e9", "out-of-range"),
    (2, "generate three-double --set shell.width_mm=wide", "wrong-type"),
    (2, "generate no-such.toml", "file-not-found"),
    (2, "calibrate no-such.csv --out out", "cannot-read"),
    (2, "calibrate latin.csv --out out", "not-utf-8"),
    (2, "calibrate header.csv --out out", "missing-column"),
    (2, "import uncertain.csv --dry-run", "ambiguous-number"),
    (2, "effects --effects mine.toml", "unknown-name"),
    (2, "check folder", "not-a-file"),
    (2, "check broken.stl", "malformed-mesh-file"),
    (2, "batch sweep.toml --out out", "invalid-axis"),
    (2, "merge folder", "not-a-batch-folder"),
    (2, "design --threshold soon", "malformed-value"),
    (2, "generate --bogus", "usage"),
    (2, "init plan --out header.csv", "file-in-the-way"),
    (1, "init plan --out no/such/plan.toml", "cannot-write"),
    (2, "explain nonsense", "unknown-word"),
];

fn write_inputs(path: &Path) {
    std::fs::create_dir(path.join("folder")).unwrap();
    let latin = b"series,substrate,pins,direction,load_N,force_N\n\xe9,silicone,,eccentric,1,1\n";
    std::fs::write(path.join("latin.csv"), latin).unwrap();
    std::fs::write(path.join("header.csv"), "series,load_N\na,1\n").unwrap();
    let uncertain = "Force [N],Load [kg],Direction\n\"1,234\",\"1,000\",pull\n\"1,100\",\"1,000\",release\n";
    std::fs::write(path.join("uncertain.csv"), uncertain).unwrap();
    std::fs::write(path.join("broken.stl"), "solid a\nfacet normal 0 0 1\nouter lop\n").unwrap();
    std::fs::write(path.join("sweep.toml"), "[sweep]\nbase = \"three-double\"\n").unwrap();
    let effects = std::fs::read_to_string(repository("templates/rig/effects.toml")).unwrap();
    std::fs::write(path.join("mine.toml"), effects.replace("speed_pct", "sped_pct")).unwrap();
}

#[test]
fn failures_print_explained_codes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_inputs(path);
    for (exit_code, command, code) in FAILURES {
        let arguments: Vec<&str> = command.split_whitespace().collect();
        let output = expect_code(*exit_code, path, &arguments);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        let is_printed = error.lines().any(|line| line.ends_with(&format!(" [{code}]")));
        assert!(is_printed && error.starts_with("error: "), "{command}: {error}");
        let page = expect_code(0, path, &["explain", code]);
        let title = Code::from_name(code).unwrap().title();
        assert!(String::from_utf8_lossy(&page.stdout).starts_with(&format!("{code}: {title}\n\n")));
    }
}

#[test]
fn warnings_print_their_code() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["generate", "three-double", "--set", "support.slot_clearance_mm=0.35", "--out", "set"];
    let output = expect_code(0, folder.path(), &arguments);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("too much play: print the coupon and lower it [slots-too-wide]"), "{text}");
    // A file has the text alone.
    let manifest = std::fs::read_to_string(folder.path().join("set/manifest.json")).unwrap();
    assert!(manifest.contains("lower it") && !manifest.contains("slots-too-wide"));
}

#[test]
fn similar_codes_are_proposed() {
    let output = binary().args(["explain", "groves-overlap"]).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2));
    assert!(error.contains("  help: did you mean grooves-overlap"), "{error}");
}

#[test]
fn listing_and_json_have_every_code() {
    let folder = tempfile::tempdir().unwrap();
    let listing = expect_code(0, folder.path(), &["explain"]).stdout;
    let listing = String::from_utf8(listing).unwrap();
    let all = json(folder.path(), &["explain", "--json"]);
    for code in Code::all() {
        assert!(listing.contains(&format!("  {code} ")) && listing.contains(code.title()), "{code}");
        let page = all.as_array().unwrap().iter().find(|page| page["code"] == code.name()).unwrap();
        assert_eq!(page["text"], code.text());
    }
    let page = json(folder.path(), &["explain", "grooves-overlap", "--json"]);
    assert_eq!(page["document"], "cad/doc/print-limits.md");
    let failure =
        binary().args(["generate", "three-double", "--set", "segment.grooves=40", "--json"]).output();
    let failure: serde_json::Value = serde_json::from_slice(&failure.unwrap().stdout).unwrap();
    assert_eq!(failure["error"]["diagnostics"][0]["code"], "grooves-overlap");
}

/// Returns a text in lines of at most [`COLUMNS`] characters.
fn wrapped(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut().filter(|line| line.chars().count() + 1 + word.chars().count() <= COLUMNS) {
            Some(line) => *line += &format!(" {word}"),
            None => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

/// Returns the document of all codes.
fn document() -> String {
    let mut text = "# Errors and warnings\n\n".to_owned();
    text += &wrapped(
        "Every error and every warning ends with a code in brackets, which names its kind. `pinswitch explain CODE` prints \
         the section of a code, and with `--json` the code is the first key of a diagnostic. A code is stable: a program \
         may compare it, while the text of a message may change.",
    );
    text += "\n\n`PINSWITCH_ACCEPT=1 cargo test --test fast explain` writes this document from `model/diagnostic/src/codes`.\n";
    for area in Area::all() {
        text += &format!("\n## {}\n", area.title);
        for code in area.codes {
            text += &format!("\n### `{code}`\n\n{}.\n", code.title());
            for paragraph in code.text().split("\n\n") {
                text += &format!("\n{}\n", wrapped(paragraph));
            }
            if let Some(document) = code.document() {
                let (folder, name) = document.rsplit_once('/').unwrap();
                let path = match folder {
                    "cad/doc" => name.to_owned(),
                    _ => format!("../../{document}"),
                };
                text += &format!("\nIn: [{document}]({path})\n");
            }
        }
    }
    text
}

#[test]
fn document_lists_every_page() {
    let path = repository(DOCUMENT);
    if std::env::var_os("PINSWITCH_ACCEPT").is_some() {
        std::fs::write(&path, document()).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(
        written,
        document(),
        "{DOCUMENT} is stale: run PINSWITCH_ACCEPT=1 cargo test --test fast explain"
    );
}
