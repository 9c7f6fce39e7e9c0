//! Files and folders that `generate` and others write: names that are no paths, sets that are whole, what goes and what stays.

use std::collections::BTreeSet;
use std::path::Path;

use crate::harness::{binary, done, ended, files, hashes, repository};

/// Makes few files, fast.
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

/// Every file that the manifest lists is there with its hash, and nothing else but `others`.
fn is_whole(folder: &Path, others: &[&str]) {
    let there = hashes(folder);
    let manifest: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("manifest.json")).unwrap()).unwrap();
    let listed = manifest["files"].as_array().unwrap();
    for file in listed {
        assert_eq!(file["sha256"], there[file["file"].as_str().unwrap()], "{file}");
    }
    let mut expected: BTreeSet<_> = listed.iter().map(|f| f["file"].as_str().unwrap().to_owned()).collect();
    expected.extend(others.iter().map(|name| (*name).to_owned()));
    expected.insert("manifest.json".to_owned());
    assert_eq!(there.keys().cloned().collect::<BTreeSet<_>>(), expected);
}

#[test]
fn a_name_is_no_path() {
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
        let (code, said) = generate(&work, &["mine.toml"]);
        assert_eq!(code, Some(2), "{name:?}: {said}");
        assert!(said.starts_with("error: mine.toml:2: switch.name = ") && said.contains("1 to 80"), "{said}");
        let sweep = format!(
            "[sweep]\nname = {}\n[axes]\n\"shell.width_mm\" = [14]\n",
            toml_edit::Value::from(name.as_str())
        );
        std::fs::write(work.join("sweep.toml"), sweep).unwrap();
        for more in [&["--out", "b"][..], &["--dry-run"]] {
            let (code, said) = ended(&work, &[&["-q", "batch", "sweep.toml"], more].concat());
            assert!(code == Some(2) && said.contains("sweep.name = "), "{name:?}: {said}");
        }
        std::fs::remove_file(work.join("sweep.toml")).unwrap();
        assert_eq!(names(&work), BTreeSet::from(["mine.toml".to_owned()]), "{name:?}");
        assert_eq!(names(folder.path()).len(), 1, "{name:?}");
    }
    // A file may be called anything: the folder gets the nearest name.
    std::fs::write(work.join(".My {switch} (2).toml"), "[parts]\ncoupon = false\n").unwrap();
    assert_eq!(generate(&work, &[".My {switch} (2).toml"]).0, Some(0));
    is_whole(&work.join("out/My -switch- -2-"), &[]);
    for name in ["переключатель 3+1", "スイッチ_2.0"] {
        let set = format!("switch.name={name:?}");
        assert_eq!(generate(&work, &["three-double", "--set", &set]).0, Some(0));
        is_whole(&work.join("out").join(name), &[]);
    }
}

#[test]
fn what_the_new_set_does_not_have_goes_and_what_is_not_ours_stays() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path(), folder.path().join("set"));
    done(path, &["-q", "generate", "three-double", "--format", "stl,step,page", "--out", "set"]);
    std::fs::write(out.join("notes.txt"), "dear").unwrap();
    std::fs::write(out.join("coupon.step"), "changed by hand").unwrap();
    let more = ["three-double", "--out", "set", "--set", "parts.proxy=false"];
    let (code, said) = ended(path, &[&["generate", "--format", "stl"], &more[..]].concat());
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("set/coupon.step: changed since it was made, and left"), "{said}");
    is_whole(&out, &["notes.txt", "coupon.step"]);
    assert!(!out.join("proxy.stl").exists() && !out.join("report.html").exists());
}

#[test]
fn a_folder_in_the_way_leaves_the_set_before_whole() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("set");
    assert_eq!(generate(folder.path(), &["three-double", "--out", "set"]).0, Some(0));
    let before = hashes(&out);
    std::fs::create_dir(out.join("report.html")).unwrap();
    let (code, said) = ended(folder.path(), &["-q", "generate", "three-double", "--out", "set"]);
    assert!(code == Some(1) && said.contains("set/report.html: cannot write"), "{said}");
    assert!(said.contains("move it away") && said.lines().count() == 1, "{said}");
    assert_eq!(hashes(&out), before);
    std::fs::remove_dir(out.join("report.html")).unwrap();
    done(folder.path(), &["-q", "generate", "three-double", "--out", "set"]);
    is_whole(&out, &[]);
}

#[test]
fn places_that_cannot_be_written_are_one_error_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    for (arguments, word) in [
        ("generate three-double --out /proc", "/proc: cannot write"),
        ("generate three-double --out /proc/x/y", "cannot write"),
        ("generate three-double --out file", "a file is in place of a folder"),
        ("generate three-double --out file/x", "a file is in place of a folder"),
        ("init three-double --out no/such/folder.toml", "create its folder"),
        ("init three-double --out /proc/x.toml", "cannot write"),
        ("physics --out file", "a file is in place of a folder"),
    ] {
        let arguments: Vec<_> = ["-q"].into_iter().chain(arguments.split(' ')).collect();
        let (code, said) = ended(folder.path(), &arguments);
        assert_eq!(code, Some(1), "{arguments:?}: {said}");
        assert!(said.contains(word) && said.contains("; ") && said.len() < 600, "{arguments:?}: {said}");
        assert_eq!(names(folder.path()).len(), 1, "{arguments:?}");
    }
}

#[test]
fn another_configuration_asks_before_it_replaces_a_set() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    assert_eq!(generate(path, &["three-double"]).0, Some(0));
    let before = hashes(&path.join("out/three-double"));
    done(path, &["init", "three-double", "--out", "mine.toml"]);
    let text = std::fs::read_to_string(path.join("mine.toml")).unwrap();
    let (code, said) = generate(path, &["mine.toml"]);
    assert_eq!(code, Some(2), "{said}");
    for word in ["out/three-double holds", "three-double,", "mine.toml", "--force", "--out"] {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert_eq!(hashes(&path.join("out/three-double")), before);
    assert_eq!(generate(path, &["mine.toml", "--out", "out/mine"]).0, Some(0));
    assert_eq!(generate(path, &["mine.toml", "--force"]).0, Some(0));
    assert_ne!(hashes(&path.join("out/three-double")), before);
    // The same file, edited, replaces its own set, from whatever folder.
    std::fs::write(path.join("mine.toml"), format!("{text}\n[shell]\nwidth_mm = 17.0\n")).unwrap();
    assert_eq!(generate(path, &["./mine.toml"]).0, Some(0));
    assert_eq!(generate(path, &[path.join("mine.toml").to_str().unwrap()]).0, Some(0));
    assert_eq!(generate(&path.join("out"), &["../mine.toml", "--out", "three-double"]).0, Some(0));
    is_whole(&path.join("out/three-double"), &[]);
    // Files of the same name in two folders are two configurations.
    for (place, width) in [("a", 15), ("b", 16)] {
        std::fs::create_dir(path.join(place)).unwrap();
        let text = format!("[switch]\nname = \"both\"\n[shell]\nwidth_mm = {width}\n");
        std::fs::write(path.join(place).join("x.toml"), text).unwrap();
    }
    assert_eq!(generate(path, &["a/x.toml"]).0, Some(0));
    let (code, said) = generate(path, &["b/x.toml"]);
    assert!(code == Some(2) && said.contains("a/x.toml") && said.contains("b/x.toml"), "{said}");
    // So are a file and one that it is named after, further down, and a file that is called like a template.
    std::fs::write(path.join("x.toml"), "[switch]\nname = \"both\"\n[shell]\nwidth_mm = 17\n").unwrap();
    let (code, said) = generate(path, &["x.toml"]);
    assert!(
        code == Some(2) && said.contains("made from ../../a/x.toml, and this one is made from ../../x.toml"),
        "{said}"
    );
    std::fs::write(path.join("six-single"), "[shell]\nwidth_mm = 17\n").unwrap();
    assert_eq!(generate(path, &["six-single", "--out", "six"]).0, Some(0));
    std::fs::remove_file(path.join("six-single")).unwrap();
    let (code, said) = generate(path, &["six-single", "--out", "six"]);
    assert!(
        code == Some(2) && said.contains("made from ../six-single, and this one is made from six-single;"),
        "{said}"
    );
    // A folder that is called like a template is none.
    assert_eq!(generate(path, &["six-double", "--out", "six-double"]).0, Some(2));
    assert_eq!(generate(path, &["three-single", "--out", "three-single"]).0, Some(0));
    assert_eq!(generate(path, &["three-single", "--out", "three-single"]).0, Some(0));
    // A file that no set of ours lists is not overwritten.
    std::fs::create_dir(path.join("papers")).unwrap();
    std::fs::write(path.join("papers/shell.stl"), "dear").unwrap();
    let (code, said) = generate(path, &["three-double", "--out", "papers"]);
    assert!(code == Some(2) && said.contains("papers/shell.stl is not from a set of ours"), "{said}");
    assert_eq!(files(&path.join("papers")).len(), 1);
}

#[test]
fn a_part_that_was_changed_by_hand_is_not_lost() {
    let folder = tempfile::tempdir().unwrap();
    let (path, part) = (folder.path(), folder.path().join("set/shell.stl"));
    let again = |more: &[&str]| generate(path, &[&["three-double", "--out", "set"], more].concat());
    assert_eq!(again(&[]).0, Some(0));
    let made = std::fs::read(&part).unwrap();
    std::fs::write(&part, "repaired by hand").unwrap();
    let (code, said) = again(&["--set", "shell.width_mm=15"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("set/shell.stl was changed since it was made; give --force"), "{said}");
    assert_eq!(std::fs::read(&part).unwrap(), b"repaired by hand");
    assert_eq!(again(&["--force"]).0, Some(0));
    assert_eq!(std::fs::read(&part).unwrap(), made);
}

#[test]
fn no_command_writes_over_what_it_reads() {
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
        let (code, said) = ended(path, &arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert!(said.contains("is read by this very command; give another --out"), "{arguments:?}: {said}");
        assert_eq!(files(path), before, "{arguments:?}");
    }
}

#[test]
fn of_two_runs_into_one_folder_one_wins_and_the_other_says_so() {
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
            let said = String::from_utf8_lossy(&lost.stderr);
            assert!(
                lost.status.code() == Some(1)
                    && said
                        .starts_with("error: set: cannot write: another run is writing into this folder; ")
                    && said.lines().count() == 1,
                "{said}"
            );
            refused += 1;
        }
        is_whole(&folder.path().join("set"), &[]);
    }
    assert!(refused > 0, "no two of twelve runs ever met");
}

#[test]
fn manifests_do_not_depend_on_where_files_lie() {
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
