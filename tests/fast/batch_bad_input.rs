//! Sweeps and destinations that cannot be used: one clear error each, exit code 2 or 1, and nothing is lost.

use std::path::Path;
use std::process::Command;

use crate::harness::{SWEEP, differences, done, ended, hashes, with_sweep};

/// Returns the exit code, and the only error with its help in one line.
fn refused(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let (code, output) = ended(folder, arguments);
    let part =
        |start: &str| output.lines().filter(|l| l.starts_with(start)).map(str::trim).collect::<Vec<_>>();
    let (errors, help) = (part("error: "), part("  help: "));
    assert!(errors.len() == 1 && help.len() <= 1, "{output}");
    (code, [errors, help].concat().join("; "))
}

#[test]
fn sweeps_that_make_no_sense_are_refused() {
    let axes = |text: &str| format!("[axes]\n{text}\n");
    for (sweep, expected) in [
        (
            axes("\"shell.with_mm\" = [1]"),
            "sweep.toml:2: shell.with_mm: is no known field; help: did you mean \"shell.width_mm\"?",
        ),
        (
            axes("\"support.slots\" = { from = 1, to = 3, step = 1 }"),
            "sweep.toml:2: support.slots: takes no numbers, so no range; help: give a list of values",
        ),
        (
            axes("\"shell.width_mm\" = [\"wide\"]"),
            "sweep.toml:2: shell.width_mm = \"wide\": is not accepted; help: give a number within 2 to 100",
        ),
        (axes("\"shell.width_mm\" = []"), "sweep.toml:2: shell.width_mm = []: is an empty axis"),
        (axes(""), "sweep.toml:1: sweep: is empty"),
        (String::new(), "sweep.toml:1: sweep: is empty"),
        (
            axes("\"shell.width_mm\" = { from = 16, to = 12, step = 1 }"),
            "sweep.toml:2: shell.width_mm = 16 to 12: runs backwards; help: write from = 12, to = 16",
        ),
        (axes("\"shell.width_mm\" = [12, 500]"), "sweep.toml:2: shell.width_mm = 500: is not accepted"),
        (
            "[axis]\n".to_owned(),
            "sweep.toml:1: axis: is no table of a sweep; help: known are sweep, set, axes",
        ),
        ("[sweep]\nbasis = 1\n".to_owned(), "sweep.toml:2: sweep.basis: is no known key"),
        (
            "[sweep]\nbase = \"four-double\"\n".to_owned(),
            "sweep.toml:2: sweep.base = \"four-double\": is neither a file",
        ),
        (
            "[sweep]\nparts = [\"shel\"]\n[axes]\n\"shell.width_mm\" = [12]\n".to_owned(),
            "sweep.toml:2: sweep.parts = \"shel\": is no part",
        ),
        ("[rows]\nfile = \"no.csv\"\n".to_owned(), "sweep.toml:2: rows.file = \"no.csv\": cannot be read"),
        ("[sample]\ncount = 5\n".to_owned(), "sweep.toml:1: sample: is empty"),
        (
            "[sample]\nmethod = \"sobol\"\ncount = 5\n".to_owned(),
            "sweep.toml:1: sample.method = \"sobol\": is no method",
        ),
        (
            format!(
                "{}[sample]\ncount = 2\n[sample.axes]\n\"shell.width_mm\" = [12]\n",
                axes("\"shell.width_mm\" = [12]")
            ),
            "sweep.toml:1: shell.width_mm: varies twice",
        ),
        (
            format!("{}[[constraints]]\nrequire = \"shell.width > 3\"\n", axes("\"shell.width_mm\" = [12]")),
            "sweep.toml:3: constraints.require = \"shell.width > 3\": has the unknown name \"shell.width\"",
        ),
        ("[axes\n".to_owned(), "sweep.toml:1: syntax"),
    ] {
        let folder = with_sweep(&sweep);
        let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
        assert_eq!(code, Some(2), "{error}");
        assert!(error.starts_with(&format!("error: {expected}")), "{error}\nexpected {expected}");
        assert!(!folder.path().join("b").exists());
    }
}

#[test]
fn too_many_variants_want_a_yes() {
    let folder = with_sweep("[axes]\n\"shell.width_mm\" = { from = 10, to = 30, step = 0.001 }\n");
    let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
    assert_eq!(code, Some(2));
    assert_eq!(
        error,
        "error: sweep.toml: 20001 variants are more than 10000; help: allow them with --yes, or make a part of them with --shard"
    );
    assert!(!folder.path().join("b").exists());
}

#[test]
fn shards_that_are_none_are_refused() {
    let folder = with_sweep(SWEEP);
    let (code, said) = ended(folder.path(), &["batch", "sweep.toml", "--out", "b", "--shard", "4/3"]);
    assert!(code == Some(2) && said.contains("\"4/3\" is no shard; give K/N"), "{said}");
    let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", "b", "--shard", "1/99"]);
    assert!(
        code == Some(2) && error.contains("--shard = 1/99: no variant is in this shard: the sweep has 24"),
        "{error}"
    );
}

#[test]
fn a_folder_with_something_else_is_left_alone() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    done(path, &["batch", "sweep.toml", "--out", "b"]);
    let before = hashes(&path.join("b"));
    std::fs::write(path.join("other.toml"), SWEEP.replace("\"small\"", "\"other\"")).unwrap();
    let (code, error) = refused(path, &["batch", "other.toml", "--out", "b"]);
    assert_eq!(code, Some(2));
    assert_eq!(error, "error: b holds another sweep (\"small\"); give another --out, nothing was changed");
    std::fs::create_dir(path.join("papers")).unwrap();
    std::fs::write(path.join("papers/thesis"), "dear").unwrap();
    let (code, error) = refused(path, &["batch", "sweep.toml", "--out", "papers"]);
    assert_eq!(code, Some(2));
    assert_eq!(
        error,
        "error: papers holds files that are no batch; give an empty or new --out, nothing was changed"
    );
    assert_eq!(std::fs::read_dir(path.join("papers")).unwrap().count(), 1);
    assert_eq!(differences(&before, &hashes(&path.join("b"))), Vec::<String>::new());
    let (code, error) = refused(path, &["merge", "papers"]);
    assert!(code == Some(2) && error.contains("papers holds no batch: there is no batch.json"), "{error}");
}

#[test]
fn a_place_that_cannot_be_written_is_refused() {
    let folder = with_sweep(SWEEP);
    std::fs::write(folder.path().join("file"), "").unwrap();
    // A file is no folder, and nobody writes into /proc, not even an administrator.
    let long = "x".repeat(300);
    for out in ["file", "file/b", "/proc/b", "gopher://bucket/b", "s4://bucket/b", &long] {
        let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", out]);
        assert!(code == Some(2) && error.starts_with(&format!("error: {out}")), "{error}");
        assert!(error.contains("; give a") || error.contains("give another --out"), "{error}");
    }
}

#[test]
fn what_stands_in_the_way_is_refused_by_a_dry_run_as_by_the_run() {
    let folder = with_sweep(SWEEP);
    done(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
    let before = hashes(&folder.path().join("b"));
    for name in ["variants.csv", "variants.parquet", "index.html", "curves.svg", "threshold.svg"] {
        let file = folder.path().join("b").join(name);
        std::fs::remove_file(&file).unwrap();
        std::fs::create_dir(&file).unwrap();
        for more in [&["--dry-run"][..], &[]] {
            let arguments = [&["batch", "sweep.toml", "--out", "b"], more].concat();
            let (code, error) = refused(folder.path(), &arguments);
            assert!(code == Some(2) && error.contains(name) && error.contains("move it away"), "{error}");
        }
        std::fs::remove_dir(&file).unwrap();
    }
    done(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
    assert_eq!(differences(&before, &hashes(&folder.path().join("b"))), Vec::<String>::new());
}

#[test]
fn a_dry_run_says_what_single_variants_would_fail_at() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    done(path, &["batch", "sweep.toml", "--out", "b"]);
    let made = std::fs::read_dir(path.join("b/variants")).unwrap().map(|e| e.unwrap().path()).next().unwrap();
    let dry = || ended(path, &["batch", "sweep.toml", "--out", "b", "--dry-run"]);
    assert_eq!(dry().0, Some(0));
    // What has the name of no variant is in nobody's way.
    std::fs::write(path.join("b/variants/notes.txt"), "dear").unwrap();
    assert_eq!(dry().0, Some(0));
    std::fs::remove_file(made.join("manifest.json")).unwrap();
    std::fs::create_dir(made.join("manifest.json")).unwrap();
    let (code, said) = dry();
    assert!(
        code == Some(1) && said.contains("manifest.json: blocks the output: its variant would fail"),
        "{said}"
    );
    assert_eq!(ended(path, &["batch", "sweep.toml", "--out", "b"]).0, Some(1));
    std::fs::remove_dir_all(&made).unwrap();
    std::fs::write(&made, "a file where a folder must be").unwrap();
    assert_eq!(dry().0, Some(1));
    assert_eq!(ended(path, &["batch", "sweep.toml", "--out", "b"]).0, Some(1));
}

#[test]
fn too_many_rows_are_counted_and_not_read() {
    let folder = with_sweep("[rows]\nfile = \"rows.csv\"\n");
    // Of these rows, all are wrong: had one been read, that would be the error.
    let rows = format!("shell.width_mm\n{}", "wide\n".repeat(200_000));
    std::fs::write(folder.path().join("rows.csv"), rows).unwrap();
    let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
    assert!(
        code == Some(2) && error.contains("200000 variants are more than 10000; help: allow them with --yes"),
        "{error}"
    );
    std::fs::write(folder.path().join("rows.csv"), "shell.width_mm\n12\nwide\n").unwrap();
    let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
    assert!(
        code == Some(2) && error.contains("rows.csv:3: shell.width_mm = \"wide\": is not accepted"),
        "{error}"
    );
    let many = format!("[axes]\n\"shell.width_mm\" = [{}]\n", "12.5, ".repeat(200_000));
    std::fs::write(folder.path().join("sweep.toml"), many).unwrap();
    let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
    assert!(code == Some(2) && error.contains("put the values into a CSV"), "{error}");
}

#[test]
fn a_full_disk_stops_the_run_and_room_lets_it_go_on() {
    let folder = with_sweep(SWEEP);
    let (path, disk) = (folder.path(), folder.path().join("disk"));
    std::fs::create_dir(&disk).unwrap();
    let mount = |options: &str| {
        let run = Command::new("mount").args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(&disk).output();
        run.is_ok_and(|o| o.status.success())
    };
    if !mount("size=1m") {
        crate::harness::say_skipped("only an administrator can mount a small disk");
        return;
    }
    let outcome = std::panic::catch_unwind(|| {
        let (code, error) = refused(path, &["batch", "sweep.toml", "--out", "disk/b"]);
        assert!(mount("remount,size=50m"));
        let resumed = ended(path, &["batch", "sweep.toml", "--out", "disk/b"]);
        (code, error, resumed, hashes(&disk.join("b")))
    });
    assert!(Command::new("umount").arg(&disk).status().unwrap().success());
    let (code, error, resumed, files) = outcome.unwrap();
    assert_eq!(code, Some(1), "{error}");
    assert!(
        error.contains("No space left on device")
            && error.contains("make room")
            && error.ends_with("variants are there: then give the same command again"),
        "{error}"
    );
    assert_eq!(resumed.0, Some(0), "{}", resumed.1);
    done(path, &["batch", "sweep.toml", "--out", "whole"]);
    assert_eq!(differences(&hashes(&path.join("whole")), &files), Vec::<String>::new());
}
