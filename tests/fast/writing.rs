//! Files and folders that commands write: names that are not paths, complete sets, and which files
//! are removed, replaced or left alone.

use std::collections::BTreeSet;
use std::path::Path;

use crate::harness::{binary, done, ended, files, hashes, repository};

/// Writes few files, for speed.
const QUICK: [&str; 4] = ["-q", "generate", "--format", "stl"];

fn generate(folder: &Path, more: &[&str]) -> (Option<i32>, String) {
    ended(folder, &[&QUICK, more].concat())
}

fn names(folder: &Path) -> BTreeSet<String> {
    std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect()
}

/// Asserts that the folder has every file of its manifest with its hash, and no other files but
/// `others`.
fn assert_complete(folder: &Path, others: &[&str]) {
    let existing = hashes(folder);
    let manifest: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("manifest.json")).unwrap()).unwrap();
    let listed = manifest["files"].as_array().unwrap();
    for file in listed {
        assert_eq!(file["sha256"], existing[file["file"].as_str().unwrap()], "{file}");
    }
    let mut expected: BTreeSet<_> = listed.iter().map(|f| f["file"].as_str().unwrap().to_owned()).collect();
    expected.extend(others.iter().map(|name| (*name).to_owned()));
    expected.insert("manifest.json".to_owned());
    assert_eq!(existing.keys().cloned().collect::<BTreeSet<_>>(), expected);
}

#[test]
fn names_are_not_paths() {
    let folder = tempfile::tempdir().unwrap();
    let work = folder.path().join("work");
    std::fs::create_dir(&work).unwrap();
    let corpus = std::fs::read_to_string(repository("tests/corpus/names.txt")).unwrap();
    let refused: Vec<String> = corpus
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert!(refused.len() >= 20);
    for name in &refused {
        let toml = format!("[switch]\nname = {}\n", toml_edit::Value::from(name.as_str()));
        std::fs::write(work.join("mine.toml"), &toml).unwrap();
        let (code, output) = generate(&work, &["mine.toml"]);
        assert_eq!(code, Some(2), "{name:?}: {output}");
        assert!(
            output.starts_with("error: mine.toml:2:8: switch.name = ") && output.contains("1 to 80"),
            "{output}"
        );
        let sweep = format!(
            "[sweep]\nname = {}\n[axes]\n\"shell.width_mm\" = [14]\n",
            toml_edit::Value::from(name.as_str())
        );
        std::fs::write(work.join("sweep.toml"), sweep).unwrap();
        for more in [&["--out", "b"][..], &["--dry-run"]] {
            let (code, output) = ended(&work, &[&["-q", "batch", "sweep.toml"], more].concat());
            assert!(code == Some(2) && output.contains("sweep.name = "), "{name:?}: {output}");
        }
        std::fs::remove_file(work.join("sweep.toml")).unwrap();
        assert_eq!(names(&work), BTreeSet::from(["mine.toml".to_owned()]), "{name:?}");
        assert_eq!(names(folder.path()).len(), 1, "{name:?}");
    }
    // A file may have any name: the folder gets the most similar valid one.
    std::fs::write(work.join(".My {switch} (2).toml"), "[parts]\ncoupon = false\n").unwrap();
    assert_eq!(generate(&work, &[".My {switch} (2).toml"]).0, Some(0));
    assert_complete(&work.join("out/My -switch- -2-"), &[]);
    for name in ["переключатель 3+1", "スイッチ_2.0"] {
        let set = format!("switch.name={name:?}");
        assert_eq!(generate(&work, &["three-double", "--set", &set]).0, Some(0));
        assert_complete(&work.join("out").join(name), &[]);
    }
}

#[test]
fn only_stale_files_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path(), folder.path().join("set"));
    done(path, &["-q", "generate", "three-double", "--format", "stl,step,page", "--out", "set"]);
    std::fs::write(out.join("notes.txt"), "dear").unwrap();
    std::fs::write(out.join("coupon.step"), "changed by hand").unwrap();
    let more = ["three-double", "--out", "set", "--set", "parts.proxy=false"];
    let (code, output) = ended(path, &[&["generate", "--format", "stl"], &more[..]].concat());
    assert_eq!(code, Some(0), "{output}");
    assert!(output.contains("warning: set/coupon.step: was changed since it was written"), "{output}");
    assert_complete(&out, &["notes.txt", "coupon.step"]);
    assert!(!out.join("proxy.stl").exists() && !out.join("report.html").exists());
}

#[test]
fn an_obstacle_leaves_the_set_complete() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("set");
    assert_eq!(generate(folder.path(), &["three-double", "--out", "set"]).0, Some(0));
    let before = hashes(&out);
    std::fs::create_dir(out.join("report.html")).unwrap();
    let (code, output) = ended(folder.path(), &["-q", "generate", "three-double", "--out", "set"]);
    assert!(code == Some(1) && output.contains("set/report.html: cannot write"), "{output}");
    assert!(output.contains("\n  help: ") && output.lines().count() == 2, "{output}");
    assert_eq!(hashes(&out), before);
    std::fs::remove_dir(out.join("report.html")).unwrap();
    done(folder.path(), &["-q", "generate", "three-double", "--out", "set"]);
    assert_complete(&out, &[]);
}

#[test]
fn unwritable_places_are_one_error() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    for (arguments, word) in [
        ("generate three-double --out /proc", "/proc: cannot write"),
        ("generate three-double --out /proc/x/y", "cannot write"),
        ("generate three-double --out file", "file: cannot write"),
        ("generate three-double --out file/x", "file/x: cannot write"),
        ("init three-double --out no/such/folder.toml", "its folder does not exist"),
        ("init three-double --out /proc/x.toml", "cannot write"),
        ("physics --out file", "file: cannot write"),
    ] {
        let arguments: Vec<_> = ["-q"].into_iter().chain(arguments.split(' ')).collect();
        let (code, output) = ended(folder.path(), &arguments);
        assert_eq!(code, Some(1), "{arguments:?}: {output}");
        assert!(output.contains(word) && output.len() < 600, "{arguments:?}: {output}");
        let lines = |start: &str| output.lines().filter(|line| line.starts_with(start)).count();
        assert_eq!((lines("error: "), lines("  help: ")), (1, 1), "{arguments:?}: {output}");
        assert_eq!(names(folder.path()).len(), 1, "{arguments:?}");
    }
}

#[test]
fn another_source_needs_force() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    assert_eq!(generate(path, &["three-double"]).0, Some(0));
    let before = hashes(&path.join("out/three-double"));
    done(path, &["init", "three-double", "--out", "mine.toml"]);
    let text = std::fs::read_to_string(path.join("mine.toml")).unwrap();
    let (code, output) = generate(path, &["mine.toml"]);
    assert_eq!(code, Some(2), "{output}");
    for word in ["error: out/three-double: ", "three-double,", "mine.toml", "--force", "--out"] {
        assert!(output.contains(word), "{word}: {output}");
    }
    assert_eq!(hashes(&path.join("out/three-double")), before);
    assert_eq!(generate(path, &["mine.toml", "--out", "out/mine"]).0, Some(0));
    assert_eq!(generate(path, &["mine.toml", "--force"]).0, Some(0));
    assert_ne!(hashes(&path.join("out/three-double")), before);
    // An edited file replaces its set, from any working directory.
    std::fs::write(path.join("mine.toml"), format!("{text}\n[shell]\nwidth_mm = 17.0\n")).unwrap();
    assert_eq!(generate(path, &["./mine.toml"]).0, Some(0));
    assert_eq!(generate(path, &[path.join("mine.toml").to_str().unwrap()]).0, Some(0));
    assert_eq!(generate(&path.join("out"), &["../mine.toml", "--out", "three-double"]).0, Some(0));
    assert_complete(&path.join("out/three-double"), &[]);
    // Files with the same name in two folders are two sources.
    for (place, width) in [("a", 15), ("b", 16)] {
        std::fs::create_dir(path.join(place)).unwrap();
        let text = format!("[switch]\nname = \"both\"\n[shell]\nwidth_mm = {width}\n");
        std::fs::write(path.join(place).join("x.toml"), text).unwrap();
    }
    assert_eq!(generate(path, &["a/x.toml"]).0, Some(0));
    let (code, output) = generate(path, &["b/x.toml"]);
    assert!(code == Some(2) && output.contains("a/x.toml") && output.contains("b/x.toml"), "{output}");
    // A file in the parent folder and a file with the name of a template are other sources, too.
    std::fs::write(path.join("x.toml"), "[switch]\nname = \"both\"\n[shell]\nwidth_mm = 17\n").unwrap();
    let (code, output) = generate(path, &["x.toml"]);
    assert!(
        code == Some(2)
            && output.contains(
                "another source, ../../a/x.toml, while this set is made from ../../x.toml [other-source]\n"
            ),
        "{output}"
    );
    std::fs::write(path.join("six-single"), "[shell]\nwidth_mm = 17\n").unwrap();
    assert_eq!(generate(path, &["six-single", "--out", "six"]).0, Some(0));
    std::fs::remove_file(path.join("six-single")).unwrap();
    let (code, output) = generate(path, &["six-single", "--out", "six"]);
    assert!(
        code == Some(2)
            && output.contains(
                "another source, ../six-single, while this set is made from six-single [other-source]\n"
            ),
        "{output}"
    );
    // A folder with the name of a template does not hide it.
    assert_eq!(generate(path, &["six-double", "--out", "six-double"]).0, Some(2));
    assert_eq!(generate(path, &["three-single", "--out", "three-single"]).0, Some(0));
    assert_eq!(generate(path, &["three-single", "--out", "three-single"]).0, Some(0));
    // A file of another program is not overwritten.
    std::fs::create_dir(path.join("papers")).unwrap();
    std::fs::write(path.join("papers/shell.stl"), "dear").unwrap();
    let (code, output) = generate(path, &["three-double", "--out", "papers"]);
    assert!(
        code == Some(2) && output.contains("papers/shell.stl: pinswitch did not write this file"),
        "{output}"
    );
    assert_eq!(files(&path.join("papers")).len(), 1);
}

#[test]
fn changed_parts_need_force() {
    let folder = tempfile::tempdir().unwrap();
    let (path, part) = (folder.path(), folder.path().join("set/shell.stl"));
    let again = |more: &[&str]| generate(path, &[&["three-double", "--out", "set"], more].concat());
    assert_eq!(again(&[]).0, Some(0));
    let made = std::fs::read(&part).unwrap();
    std::fs::write(&part, "repaired by hand").unwrap();
    let (code, output) = again(&["--set", "shell.width_mm=15"]);
    assert_eq!(code, Some(2), "{output}");
    assert!(
        output
            .contains("set/shell.stl: was changed since it was written [changed-file]\n  help: give --force"),
        "{output}"
    );
    assert_eq!(std::fs::read(&part).unwrap(), b"repaired by hand");
    assert_eq!(again(&["--force"]).0, Some(0));
    assert_eq!(std::fs::read(&part).unwrap(), made);
}

#[test]
fn inputs_are_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    done(path, &["-q", "init", "three-double", "--out", "own.toml"]);
    std::fs::write(path.join("shell.stl"), "[parts]\ncoupon = false\n").unwrap();
    let rig = ["--randomised", "--out", "."];
    done(path, &[&["-q", "simulate"], &rig[..]].concat());
    std::fs::rename(path.join("plateaus.csv"), path.join("residuals.csv")).unwrap();
    std::os::unix::fs::symlink("own.toml", path.join("link.toml")).unwrap();
    std::fs::copy(repository("tests/corpus/model/accepted-baseline.toml"), path.join("model.toml")).unwrap();
    let before = files(path);
    for arguments in [
        "render own.toml --out own.toml",
        "render link.toml --out ./own.toml",
        "render own.toml --out link.toml",
        "generate shell.stl --out . --force",
        "predict --model model.toml --rows residuals.csv --out residuals.csv",
        "predict --model model.toml --rows residuals.csv --out model.toml",
    ] {
        let arguments: Vec<_> = ["-q"].into_iter().chain(arguments.split(' ')).collect();
        let (code, output) = ended(path, &arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {output}");
        assert!(
            output.contains(": is an input of this command [output-is-input]\n  help: give another --out"),
            "{arguments:?}: {output}"
        );
        assert_eq!(files(path), before, "{arguments:?}");
    }
}

#[test]
fn concurrent_runs_fail_immediately() {
    let folder = tempfile::tempdir().unwrap();
    let run = || {
        let mut command = binary();
        command.args(["-q", "generate", "three-double", "--out", "set"]).current_dir(folder.path());
        command.stderr(std::process::Stdio::piped()).spawn().unwrap()
    };
    let mut refused = 0;
    for _ in 0..4 {
        let runs: Vec<_> = (0..3).map(|_| run()).collect();
        let outcomes: Vec<_> = runs.into_iter().map(|child| child.wait_with_output().unwrap()).collect();
        assert!(outcomes.iter().any(|o| o.status.success()));
        for lost in outcomes.iter().filter(|o| !o.status.success()) {
            let output = String::from_utf8_lossy(&lost.stderr);
            assert!(
                lost.status.code() == Some(1)
                    && output.starts_with(
                        "error: set: cannot write: another run is writing into this folder: process "
                    )
                    && output.lines().count() == 2,
                "{output}"
            );
            refused += 1;
        }
        assert_complete(&folder.path().join("set"), &[]);
    }
    assert!(refused > 0, "no two of twelve runs overlapped");
}

#[test]
fn manifests_do_not_depend_on_paths() {
    let bytes = |relative: &str| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(folder.path().join("work")).unwrap();
        std::fs::write(folder.path().join("mine.toml"), "[parts]\ncoupon = false\n").unwrap();
        let absolute = folder.path().join("mine.toml");
        let config = if relative.is_empty() { absolute.to_str().unwrap() } else { relative };
        assert_eq!(generate(&folder.path().join("work"), &[config, "--out", "set"]).0, Some(0));
        std::fs::read(folder.path().join("work/set/manifest.json")).unwrap()
    };
    assert_eq!(bytes(""), bytes("../mine.toml"));
    let text = String::from_utf8(bytes("")).unwrap();
    assert!(text.contains("\"name\": \"../../mine.toml\"") && !text.contains("/tmp"), "{text}");
}
