//! `generate --set mount.kind=rig`: one command makes the parts and the documents of a rig, which the other commands read.

use crate::harness::{done, files};

const DOCUMENTS: [&str; 6] =
    ["rig-bill.csv", "rig.toml", "run.toml", "plan.toml", "run-sheet.html", "wiring.svg"];

#[test]
fn one_command_makes_a_rig() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let set = ["--set", "mount.kind=rig", "--format", "stl,rig,guide", "--out", "rig"];
    done(path, &[&["-q", "generate", "three-double"], &set[..]].concat());
    let made = files(&path.join("rig"));
    for name in
        DOCUMENTS.iter().chain(&["rig-plate.stl", "guide-pulley-2.stl", "cell-mount.stl", "assembly.png"])
    {
        assert!(made.contains_key(*name), "{name}");
    }
    let sheet = String::from_utf8(made["run-sheet.html"].clone()).unwrap();
    assert!(
        sheet.contains("<td>503.6 g</td><td>62.53 g</td><td>5.55 N</td><td>48 % = 24.4 mm/s</td>"),
        "{sheet}"
    );
    // The plan has the runs of the sheet: three conditions of eleven weights with 12 and 29 repetitions.
    done(path, &["-q", "simulate", "rig/plan.toml", "--out", "rehearsal"]);
    let table = std::fs::read_to_string(path.join("rehearsal/plateaus.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 3 * 11 * (12 + 29));
    assert_eq!(sheet.matches(".csv</td>").count(), 3 * 11);
}

#[test]
fn sets_without_a_rig_have_none_of_its_documents() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["-q", "generate", "three-double", "--format", "stl,rig", "--out", "set"]);
    let made = files(&folder.path().join("set"));
    assert!(DOCUMENTS.iter().all(|name| !made.contains_key(*name)), "{:?}", made.keys());
}
