//! `predict --rows` of configurations: a table in, a table of curves out.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::harness::{binary, done, ended, expect_code, files, json, repository};

/// Options of every run: a curve has 3 loads.
const BASE: [&str; 5] = ["predict", "three-double", "--set", "friction.points=3", "--rows"];
/// Columns of one load with their keys in `predict --json`.
const LOAD: [(&str, &str); 7] = [
    ("load_N", "load_n"),
    ("eccentric_N", "eccentric_n"),
    ("concentric_N", "concentric_n"),
    ("friction_N", "friction_n"),
    ("band_low_N", "band_low_n"),
    ("band_high_N", "band_high_n"),
    ("silicone_share", "silicone_share"),
];

/// Runs `predict --rows` in a folder; returns everything that is printed.
fn predicted(folder: &Path, rows: &str, out: &str, options: &[&str]) -> String {
    done(folder, &[&BASE[..], &[rows, "--out", out], options].concat())
}

/// Writes `count` rows with different curves.
fn write_rows(folder: &Path, count: usize) {
    let row = |i: usize| format!("\"[{}, 8, 11]\",{}\n", 4 + i % 2, 12.0 + i as f64 / count as f64);
    let text: String = (0..count).map(row).collect();
    std::fs::write(folder.join("rows.csv"), format!("layout.pins,shell.width_mm\n{text}")).unwrap();
}

/// Reads a table by columns.
fn lines(path: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let header = reader.headers().unwrap().clone();
    let line =
        |r: csv::StringRecord| header.iter().map(str::to_owned).zip(r.iter().map(str::to_owned)).collect();
    reader.records().map(|r| line(r.unwrap())).collect()
}

#[test]
fn curves_equal_single_predictions() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let rows = [("[5, 8, 11]", "14", "20"), ("[5,7,9,11]", "12.5", "25"), ("[7, 9]", "13", "18.3")];
    let text: String =
        rows.iter().map(|(pins, width, shore)| format!("\"{pins}\",{width},{shore}\n")).collect();
    let header = "layout.pins, shell.width_mm,silicone.hardness_shore_a\n";
    std::fs::write(path.join("rows.csv"), format!("{header}# three\n{text}")).unwrap();
    std::fs::copy(repository("tests/corpus/model/accepted-baseline.toml"), path.join("model.toml")).unwrap();
    for option in [&[][..], &["--law", "layout"], &["--model", "model.toml"]] {
        predicted(path, "rows.csv", "curves.csv", option);
        let table = lines(&path.join("curves.csv"));
        assert_eq!(table.len(), 9);
        for (i, (pins, width, shore)) in rows.iter().enumerate() {
            let sets = [
                format!("layout.pins={pins}"),
                format!("shell.width_mm={width}"),
                format!("silicone.hardness_shore_a={shore}"),
            ];
            let sets: Vec<_> = sets.iter().flat_map(|set| ["--set", set]).collect();
            let single = json(path, &[&BASE[..4], &sets, option, &["--json"]].concat());
            for load in 0..3 {
                let line = &table[3 * i + load];
                assert_eq!(line["row"], (i + 1).to_string());
                assert_eq!((&*line["status"], &*line["reason"]), ("predicted", ""));
                assert_eq!((line["law"].as_str(), line["trust"].as_str()), {
                    (single["law"].as_str().unwrap(), single["trust"].as_str().unwrap())
                });
                for (column, key) in LOAD {
                    let exact = single[key][load].as_f64().unwrap();
                    assert_eq!(line[column].parse(), Ok(exact), "{option:?} row {i} {column}");
                }
            }
        }
    }
}

#[test]
fn thresholds_equal_those_of_sets() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("rows.csv"), "layout.pins\n\"[5, 8, 11]\"\n[]\n").unwrap();
    predicted(folder.path(), "rows.csv", "curves.csv", &[]);
    let table = lines(&folder.path().join("curves.csv"));
    let set = ["-q", "generate", "three-double", "--set", "friction.points=3", "--out", "set"];
    done(folder.path(), &set);
    let manifest = std::fs::read(folder.path().join("set/manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_slice(&manifest).unwrap();
    let threshold_n = manifest["friction"]["threshold_n"].as_f64().unwrap();
    assert_eq!(table[0]["threshold_N"].parse(), Ok(threshold_n));
    // Without pins nothing switches.
    assert_eq!(table[3]["threshold_N"], "");
}

#[test]
fn refused_rows_do_not_stop_others() {
    let folder = tempfile::tempdir().unwrap();
    let text = "shell.width_mm,segment.grooves\n14,15\n-3,15\nwide,15\n14,40\n13,15\n";
    std::fs::write(folder.path().join("rows.csv"), text).unwrap();
    let output = predicted(folder.path(), "rows.csv", "curves.csv", &[]);
    assert_eq!(
        output,
        "[INFO ] curves.csv: 2 of 5 rows predicted, 3 refused, 0 failed\n\
         warning: 3 of 5 rows refused [variants-failed]\n  help: see columns status and reason\n"
    );
    let table = lines(&folder.path().join("curves.csv"));
    let of_row = |row: &str| table.iter().filter(|line| line["row"] == row).collect::<Vec<_>>();
    assert_eq!(["1", "2", "3", "4", "5"].map(|row| of_row(row).len()), [3, 1, 1, 1, 3]);
    for (row, width, reason) in [
        ("2", "-3", "shell.width_mm = -3: outside 2 to 100"),
        ("3", "", "shell.width_mm = \"wide\": not a number"),
        ("4", "14", "segment.grooves = 40: grooves overlap"),
    ] {
        let line = of_row(row)[0];
        assert_eq!((&*line["status"], &*line["shell.width_mm"]), ("refused", width));
        assert!(line["reason"].starts_with(reason), "{}", line["reason"]);
        assert!(LOAD.iter().all(|(column, _)| line[*column].is_empty()));
    }
}

#[test]
fn threads_do_not_change_bytes() {
    let folder = tempfile::tempdir().unwrap();
    write_rows(folder.path(), 600);
    for ending in ["csv", "parquet"] {
        let bytes = ["1", "2", "7"].map(|threads| {
            let out = format!("{threads}.{ending}");
            predicted(folder.path(), "rows.csv", &out, &["--threads", threads]);
            std::fs::read(folder.path().join(out)).unwrap()
        });
        assert!(bytes[0] == bytes[1] && bytes[0] == bytes[2], "{ending}");
    }
    let rows: Vec<_> =
        lines(&folder.path().join("1.csv")).into_iter().map(|line| line["row"].clone()).collect();
    let expected: Vec<_> =
        (1..=600).flat_map(|row: usize| [row.to_string(), row.to_string(), row.to_string()]).collect();
    assert_eq!(rows, expected);
}

/// Kills runs once a block is finished; also damages a block, which is predicted again.
#[test]
fn killed_runs_resume_with_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_rows(path, 2600);
    for ending in ["csv", "parquet"] {
        predicted(path, "rows.csv", &format!("whole.{ending}"), &[]);
        let out = format!("killed.{ending}");
        let work = path.join(format!(".{out}.work"));
        let mut child = binary()
            .args([&BASE[..], &["rows.csv", "--out", &out, "--threads", "1"]].concat())
            .current_dir(path)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let blocks = || -> Vec<_> {
            let entries = std::fs::read_dir(&work).into_iter().flatten().map(|e| e.unwrap().path());
            entries.filter(|p| p.file_name().unwrap().to_string_lossy().starts_with("block-")).collect()
        };
        let start = Instant::now();
        while blocks().len() < 3 && start.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(2));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let finished = blocks();
        assert!(finished.len() >= 3 && !path.join(&out).exists(), "the run was killed too early or too late");
        let mut bytes = std::fs::read(&finished[0]).unwrap();
        bytes[20] ^= 1;
        std::fs::write(&finished[0], bytes).unwrap();
        let output = predicted(path, "rows.csv", &out, &[]);
        let existing = 256 * (finished.len() - 1);
        assert!(output.contains(&format!("failed; {existing} existed before")), "{output}");
        let read = |name: &str| std::fs::read(path.join(name)).unwrap();
        assert!(read(&out) == read(&format!("whole.{ending}")), "{ending}");
        assert_eq!(files(&work).into_keys().collect::<Vec<_>>(), ["rows.json"]);
    }
}

#[test]
fn finished_tables_are_kept_unless_inputs_change() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_rows(path, 3);
    let modified = || std::fs::metadata(path.join("curves.csv")).unwrap().modified().unwrap();
    predicted(path, "rows.csv", "curves.csv", &[]);
    let (first, bytes) = (modified(), std::fs::read(path.join("curves.csv")).unwrap());
    let output = predicted(path, "rows.csv", "curves.csv", &["--threads", "2"]);
    assert!(output.contains("3 of 3 rows predicted, 0 refused, 0 failed; 3 existed before"), "{output}");
    assert_eq!(modified(), first);
    // A changed output is written again.
    std::fs::write(path.join("curves.csv"), "edited").unwrap();
    predicted(path, "rows.csv", "curves.csv", &[]);
    assert!(std::fs::read(path.join("curves.csv")).unwrap() == bytes);
    for option in
        [&["--set", "shell.wall_mm=5.5"][..], &["--law", "layout"], &["--preset", "printer-fff-0.4"]]
    {
        let output = predicted(path, "rows.csv", "curves.csv", option);
        assert!(!output.contains("existed before"), "{option:?}: {output}");
    }
    write_rows(path, 4);
    assert!(
        predicted(path, "rows.csv", "curves.csv", &[])
            .contains(": 4 of 4 rows predicted, 0 refused, 0 failed\n")
    );
}

/// A file that pyarrow wrote, with lists and 32-bit numbers.
#[test]
fn parquet_and_csv_rows_have_equal_curves() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::copy(
        repository("tests/corpus/configurations/accepted-lists.parquet"),
        path.join("rows.parquet"),
    )
    .unwrap();
    let text = "layout.pins,shell.width_mm,segment.grooves,support.slots\n\
                \"[5, 8, 11]\",12.5,15,all\n\"[4, 8, 12]\",13.1,15,occupied\n,14,15,all\n";
    std::fs::write(path.join("rows.csv"), text).unwrap();
    for (rows, out) in [("rows.csv", "csv.csv"), ("rows.parquet", "parquet.csv")] {
        predicted(path, rows, out, &[]);
    }
    let read = |name: &str| std::fs::read_to_string(path.join(name)).unwrap();
    assert_eq!(read("csv.csv"), read("parquet.csv"));
    assert_eq!(read("csv.csv").lines().count(), 1 + 3 + 3 + 1);
}

#[test]
fn unusable_tables_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (text, problem) in [
        ("", "t.csv:1: the table has no rows"),
        ("shell.width_mm\n", "t.csv:1: the table has no rows"),
        ("shell.with_mm\n12\n", "t.csv:1:1: shell.with_mm: unknown field [unknown-field]\n"),
        ("shell.width_mm,note\n12,a\n", "t.csv:1:16: note: unknown field [unknown-field]\n"),
        ("shell.width_mm,shell.width_mm\n1,2\n", "t.csv:1:16: shell.width_mm: two columns have this name"),
        ("shell.width_mm,layout.pins\n12\n", "t.csv:2: expected 2 cells, found 1"),
        (
            "shell.width_mm,load_N\n12,3\n",
            "t.csv: ambiguous table: shell.width_mm is a parameter, and load_N is",
        ),
        ("series,load_N\na,3\n", "t.csv: a plateau table needs a calibrated model"),
        ("PAR1", "t.csv: cannot write or read the Parquet table"),
    ] {
        std::fs::write(path.join("t.csv"), text).unwrap();
        let (code, output) = ended(path, &[&BASE[..], &["t.csv", "--out", "curves.csv"]].concat());
        assert_eq!(code, Some(2), "{text:?}: {output}");
        assert!(output.starts_with(&format!("error: {problem}")), "{text:?}: {output}");
    }
    write_rows(path, 2);
    std::fs::create_dir(path.join("folder.csv")).unwrap();
    for (arguments, code, problem) in [
        ("three-double --rows rows.csv", 2, "no file for the curves"),
        ("three-double --rows rows.csv --out curves.txt", 2, "--out = curves.txt: unknown format"),
        ("--rows rows.csv --out curves.csv", 2, "no configuration for the rows to change"),
        (
            "three-double --rows rows.csv --out curves.csv --fitted-session",
            2,
            "--fitted-session is for plateau",
        ),
        ("three-double --rows rows.csv --out rows.csv", 2, "rows.csv: is an input of this command"),
        (
            "three-double --rows rows.csv --out no/curves.csv",
            1,
            "no/curves.csv: cannot write: its folder does not",
        ),
        ("three-double --rows rows.csv --out folder.csv", 1, "folder.csv: cannot write"),
    ] {
        let arguments: Vec<_> = ["-q", "predict"].into_iter().chain(arguments.split(' ')).collect();
        let output = expect_code(code, path, &arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(message.starts_with(&format!("error: {problem}")), "{arguments:?}: {message}");
    }
    assert_eq!(files_left(path), ["folder.csv", "rows.csv", "t.csv"]);
}

fn files_left(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
