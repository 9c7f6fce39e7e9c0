//! Sweeps and destinations that cannot be used: one clear error each, exit code 2 or 1, and nothing
//! is lost.

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
    let errors = errors.iter().map(|error| error.rsplit_once(" [").unwrap().0).collect();
    (code, [errors, help].concat().join("; "))
}

#[test]
fn invalid_sweeps_are_refused() {
    let axes = |text: &str| format!("[axes]\n{text}\n");
    for (sweep, expected) in [
        (
            axes("\"shell.with_mm\" = [1]"),
            "sweep.toml:2:1: shell.with_mm: unknown field; help: did you mean \"shell.width_mm\"?",
        ),
        (
            axes("\"support.slots\" = { from = 1, to = 3, step = 1 }"),
            "sweep.toml:2:19: support.slots: range over a field that does not take numbers; help: give a list of values",
        ),
        (
            axes("\"shell.width_mm\" = [\"wide\"]"),
            "sweep.toml:2:20: shell.width_mm = \"wide\": not a number; help: give a number from 2 to 100",
        ),
        (
            format!(
                "{}[[constraints]]\nrequire = \"shell.width_mm + 1\"\n",
                axes("\"shell.width_mm\" = [12]")
            ),
            "sweep.toml:4:12: constraints.require = \"shell.width_mm + 1\": expected a condition, found a number",
        ),
        (
            format!("{}[[constraints]]\nbecause = \"x\"\n", axes("\"shell.width_mm\" = [12]")),
            "sweep.toml:3:1: constraints.require: missing, or not a string",
        ),
        (axes("\"shell.width_mm\" = []"), "sweep.toml:2:20: shell.width_mm = []: empty axis"),
        (axes(""), "sweep.toml:1:1: the sweep has no axes ([axes], [sample] or [rows])"),
        (String::new(), "sweep.toml:1:1: the sweep has no axes ([axes], [sample] or [rows])"),
        (
            axes("\"shell.width_mm\" = { from = 16, to = 12, step = 1 }"),
            "sweep.toml:2:20: shell.width_mm = 16 to 12: from is above to; help: write from = 12, to = 16",
        ),
        (axes("\"shell.width_mm\" = [12, 500]"), "sweep.toml:2:20: shell.width_mm = 500: outside 2 to 100"),
        ("[axis]\n".to_owned(), "sweep.toml:1:2: axis: unknown table; help: known are sweep, set, axes"),
        (
            "[sweep]\nbasis = 1\n".to_owned(),
            "sweep.toml:2:1: sweep.basis: unknown key; help: known are name, base",
        ),
        (
            "[sweep]\nbase = \"four-double\"\n".to_owned(),
            "sweep.toml:2:8: sweep.base = \"four-double\": neither a file",
        ),
        (
            "[sweep]\nparts = [\"shel\"]\n[axes]\n\"shell.width_mm\" = [12]\n".to_owned(),
            "sweep.toml:2:9: sweep.parts = \"shel\": unknown part",
        ),
        (
            "[rows]\nfile = \"no.csv\"\n".to_owned(),
            "sweep.toml:2:8: rows.file = \"no.csv\": cannot read the file",
        ),
        ("[sample]\ncount = 5\n".to_owned(), "sweep.toml:1:1: the sample has no points or no axes"),
        (
            "[sample]\nmethod = \"sobol\"\ncount = 5\n".to_owned(),
            "sweep.toml:1:1: sample.method = \"sobol\": unknown method",
        ),
        (
            format!(
                "{}[sample]\ncount = 2\n[sample.axes]\n\"shell.width_mm\" = [12]\n",
                axes("\"shell.width_mm\" = [12]")
            ),
            "sweep.toml:1:1: shell.width_mm: the field varies twice",
        ),
        (
            format!("{}[[constraints]]\nrequire = \"shell.width > 3\"\n", axes("\"shell.width_mm\" = [12]")),
            "sweep.toml:4:12: constraints.require = \"shell.width > 3\": unknown name 'shell.width'; help: did you mean shell.width_mm?",
        ),
        ("[axes\n".to_owned(), "sweep.toml:1:6: syntax: "),
    ] {
        let folder = with_sweep(&sweep);
        let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
        assert_eq!(code, Some(2), "{error}");
        assert!(error.starts_with(&format!("error: {expected}")), "{error}\nexpected {expected}");
        assert!(!folder.path().join("b").exists());
    }
}

#[test]
fn large_sweeps_need_confirmation() {
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
fn invalid_shards_are_refused() {
    let folder = with_sweep(SWEEP);
    let (code, output) = ended(folder.path(), &["batch", "sweep.toml", "--out", "b", "--shard", "4/3"]);
    assert!(
        code == Some(2)
            && output.contains(
                "error: --shard = 4/3: invalid shard: expected K/N with 1 <= K <= N [invalid-shard]\n  help: write"
            ),
        "{output}"
    );
    let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", "b", "--shard", "1/99"]);
    assert!(
        code == Some(2) && error.contains("--shard = 1/99: no variant is in this shard: the sweep has 24"),
        "{error}"
    );
}

#[test]
fn folders_with_other_files_stay_unchanged() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    done(path, &["batch", "sweep.toml", "--out", "b"]);
    let before = hashes(&path.join("b"));
    std::fs::write(path.join("other.toml"), SWEEP.replace("\"small\"", "\"other\"")).unwrap();
    let (code, error) = refused(path, &["batch", "other.toml", "--out", "b"]);
    assert_eq!(code, Some(2));
    assert_eq!(
        error,
        "error: b contains another sweep (\"small\"); help: give another --out, or the options of that batch, such as --verify (nothing was changed)"
    );
    std::fs::create_dir(path.join("papers")).unwrap();
    std::fs::write(path.join("papers/thesis"), "dear").unwrap();
    let (code, error) = refused(path, &["batch", "sweep.toml", "--out", "papers"]);
    assert_eq!(code, Some(2));
    assert_eq!(
        error,
        "error: papers is not empty and not a batch folder (batch.json not found); help: give an empty or new --out (nothing was \
         changed)"
    );
    assert_eq!(std::fs::read_dir(path.join("papers")).unwrap().count(), 1);
    assert_eq!(differences(&before, &hashes(&path.join("b"))), Vec::<String>::new());
    let (code, error) = refused(path, &["merge", "papers"]);
    assert!(
        code == Some(2) && error.contains("papers is not a batch folder (batch.json not found)"),
        "{error}"
    );
}

#[test]
fn unwritable_destinations_are_refused() {
    let folder = with_sweep(SWEEP);
    std::fs::write(folder.path().join("file"), "").unwrap();
    // A file is not a folder, and not even an administrator can write into /proc.
    let long = "x".repeat(300);
    for out in ["file", "file/b", "/proc/b", "gopher://bucket/b", "s4://bucket/b", &long] {
        let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", out]);
        let shown = &out[..out.len().min(40)];
        assert!(code == Some(2) && error.starts_with(&format!("error: {shown}")), "{error}");
        assert!(error.contains("; help: give a") || error.contains("give another --out"), "{error}");
    }
    // The path is valid, but the system refuses to write there, also for an administrator.
    if Path::new("/sys").is_dir() {
        for command in ["batch sweep.toml", "generate three-double"] {
            let arguments: Vec<_> = command.split(' ').chain(["-q", "--out", "/sys/b"]).collect();
            let (code, error) = refused(folder.path(), &arguments);
            assert!(code == Some(1) && error.starts_with("error: /sys/b: cannot write: "), "{error}");
            assert!(error.ends_with("; help: give an --out that can be written"), "{error}");
        }
    }
}

#[test]
fn obstructed_products_are_refused() {
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
fn dry_runs_report_obstructed_variants() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    done(path, &["batch", "sweep.toml", "--out", "b"]);
    let made = std::fs::read_dir(path.join("b/variants")).unwrap().map(|e| e.unwrap().path()).next().unwrap();
    let dry = || ended(path, &["batch", "sweep.toml", "--out", "b", "--dry-run"]);
    assert_eq!(dry().0, Some(0));
    // A file without the name of a variant does not obstruct.
    std::fs::write(path.join("b/variants/notes.txt"), "dear").unwrap();
    assert_eq!(dry().0, Some(0));
    std::fs::remove_file(made.join("manifest.json")).unwrap();
    std::fs::create_dir(made.join("manifest.json")).unwrap();
    let (code, message) = dry();
    assert!(
        code == Some(1) && message.contains("manifest.json: blocks the output: its variant would fail"),
        "{message}"
    );
    assert_eq!(ended(path, &["batch", "sweep.toml", "--out", "b"]).0, Some(1));
    std::fs::remove_dir_all(&made).unwrap();
    std::fs::write(&made, "a file where a folder must be").unwrap();
    assert_eq!(dry().0, Some(1));
    assert_eq!(ended(path, &["batch", "sweep.toml", "--out", "b"]).0, Some(1));
}

#[test]
fn rows_are_counted_before_reading() {
    let folder = with_sweep("[rows]\nfile = \"rows.csv\"\n");
    // Every row is invalid: the error of a row would show that it was read.
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
        code == Some(2) && error.contains("rows.csv:3:1: shell.width_mm = \"wide\": not a number"),
        "{error}"
    );
    let many = format!("[axes]\n\"shell.width_mm\" = [{}]\n", "12.5, ".repeat(200_000));
    std::fs::write(folder.path().join("sweep.toml"), many).unwrap();
    let (code, error) = refused(folder.path(), &["batch", "sweep.toml", "--out", "b"]);
    assert!(code == Some(2) && error.contains("put the values into a CSV"), "{error}");
}

#[test]
fn runs_resume_after_a_full_disk() {
    let folder = with_sweep(SWEEP);
    let (path, disk) = (folder.path(), folder.path().join("disk"));
    std::fs::create_dir(&disk).unwrap();
    let mount = |options: &str| {
        let run = Command::new("mount").args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(&disk).output();
        run.is_ok_and(|o| o.status.success())
    };
    if !mount("size=1m") {
        crate::harness::report_skipped("only an administrator can mount a small disk");
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
            && error.ends_with(" of 24 variants are finished)")
            && error.contains("make room, or give another --out, then run the same command again to resume"),
        "{error}"
    );
    assert_eq!(resumed.0, Some(0), "{}", resumed.1);
    done(path, &["batch", "sweep.toml", "--out", "whole"]);
    assert_eq!(differences(&hashes(&path.join("whole")), &files), Vec::<String>::new());
}
