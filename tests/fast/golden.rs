//! Pinned hashes of every file of many sets. A commit that changes bytes accepts the new hashes and
//! explains the change.
//!
//! `PINSWITCH_ACCEPT=1 cargo test --test fast golden` writes the new hashes.

use std::collections::BTreeMap;
use std::path::Path;

use crate::harness::{differences, done, hashes, report_skipped, repository};

/// Templates whose sets are pinned, in addition to the configurations of `tests/golden`.
const TEMPLATES: [&str; 8] = [
    "six-single",
    "three-double",
    "three-single",
    "silicone-only",
    "proxy-six-single",
    "proxy-three-double",
    "proxy-three-single",
    "reference",
];
/// Presets of printers, applied to three-double.
const PRESETS: [&str; 3] = ["printer-fff-0.4", "printer-fff-0.25", "printer-dimension-elite"];

/// Returns the name of each set, and the arguments that make it.
fn sets() -> Vec<(String, Vec<String>)> {
    let owned = |all: &[&str]| all.iter().map(|s| (*s).to_owned()).collect();
    let mut sets: Vec<(String, Vec<String>)> = Vec::new();
    for entry in std::fs::read_dir(repository("tests/golden")).unwrap() {
        let path = entry.unwrap().path().canonicalize().unwrap();
        if path.extension().is_some_and(|e| e == "toml") {
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            sets.push((name, vec![path.to_string_lossy().into_owned()]));
        }
    }
    assert!(sets.len() >= 25, "only {} configurations", sets.len());
    sets.extend(TEMPLATES.map(|t| (format!("template-{t}"), owned(&[t]))));
    sets.extend(PRESETS.map(|p| (format!("preset-{p}"), owned(&["three-double", "--preset", p]))));
    sets
}

fn make(folder: &Path, sets: &[(String, Vec<String>)]) {
    for (name, arguments) in sets {
        // A manifest contains the path from its folder to the configuration. The copy keeps it
        // constant.
        let copied = |argument: &String| {
            let path = Path::new(argument);
            if path.is_absolute() {
                std::fs::copy(path, folder.join(path.file_name().unwrap())).unwrap();
            }
            path.file_name().unwrap().to_string_lossy().into_owned()
        };
        let arguments: Vec<String> = arguments.iter().map(copied).collect();
        let all: Vec<&str> = arguments.iter().map(String::as_str).collect();
        done(folder, &[&["-q", "generate", "--format", "all", "--out", name], &all[..]].concat());
        arguments.iter().filter(|name| name.ends_with(".toml")).for_each(|name| {
            std::fs::remove_file(folder.join(name)).unwrap();
        });
    }
}

/// Compares hashes with the pinned ones, or pins them.
fn compare(pinned: &str, hashes_of_run: &BTreeMap<String, String>) {
    let pinned = repository(pinned);
    if std::env::var_os("PINSWITCH_ACCEPT").is_some() {
        let lines: String = hashes_of_run.iter().map(|(name, hash)| format!("{hash}  {name}\n")).collect();
        std::fs::write(&pinned, lines).unwrap();
        return;
    }
    // Sines and cosines of the platform's library may differ in the last digit on other platforms.
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        report_skipped("the hashes are for x86-64 Linux");
        return;
    }
    let text = std::fs::read_to_string(&pinned).unwrap();
    let expected: BTreeMap<String, String> = text
        .lines()
        .map(|line| line.split_once("  ").unwrap())
        .map(|(hash, name)| (name.to_owned(), hash.to_owned()))
        .collect();
    let changed = differences(&expected, hashes_of_run);
    assert!(
        changed.is_empty(),
        "{} files have changed: if intended, run the test with PINSWITCH_ACCEPT=1 and explain the change in the commit\n{}",
        changed.len(),
        changed.join("\n")
    );
}

#[test]
fn bytes_match_golden_hashes() {
    let folder = tempfile::tempdir().unwrap();
    let sets = sets();
    let (first, second) = sets.split_at(sets.len() / 2);
    std::thread::scope(|scope| {
        scope.spawn(|| make(folder.path(), first));
        make(folder.path(), second);
    });
    compare("tests/golden/sets.sha256", &hashes(folder.path()));
}

#[test]
fn other_commands_match_golden_hashes() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &str| done(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
    let keep = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    run("init sweep --out sweep.toml");
    run("-q batch sweep.toml --out batch");
    run("-q design --threshold 26 --max-friction 8.5 --pins 3..4 --best 3 --out designs");
    run("-q physics --out physics");
    run("-q simulate --randomised --effect coating_ploughing=0.024 --effect load_cell_offset=0.8 --out rig");
    run("-q calibrate rig/plateaus.csv --out calibrated");
    run("-q calibrate --published --out published");
    run("-q predict --model calibrated/model.toml --rows rig/plateaus-fresh.csv --out predicted.csv");
    run("-q generate three-double --model calibrated/model.toml --format stl,page --out set");
    run("-q finger --out finger");
    keep("layouts.txt", run("layouts"));
    for layout in ["six-single", "three-double", "three-single"] {
        for law in ["paper", "layout", "physics"] {
            keep(
                &format!("predict-{layout}-{law}.json"),
                run(&format!("-q predict {layout} --law {law} --json")),
            );
        }
    }
    compare("tests/golden/commands.sha256", &hashes(folder.path()));
}
