//! Optional and unknown columns of a plateau table, and repeated readings.

use serde_json::Value;

use pinswitch_calibration::table::{PlateauRow, PlateauTable};
use pinswitch_simulation::{Plan, simulate};

use crate::harness::pinswitch;

/// Returns the text of a table with columns added at its end.
fn with_columns(
    rows: &[PlateauRow],
    names: &[&str],
    cells: impl Fn(usize, &PlateauRow) -> Vec<String>,
) -> String {
    let text = PlateauTable::write(rows);
    let (header, lines) = text.split_once('\n').unwrap();
    let mut out = format!("{header},{}\n", names.join(","));
    for (i, (line, row)) in lines.lines().zip(rows).enumerate() {
        out.push_str(&format!("{line},{}\n", cells(i, row).join(",")));
    }
    out
}

/// Calibrates a table; returns the printed text and the report.
fn calibrated(text: &str) -> (String, Value) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), text).unwrap();
    let output = pinswitch(folder.path(), &["-q", "calibrate", "t.csv", "--out", "out"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let message = String::from_utf8(output.stdout).unwrap();
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(!page.contains("NaN") && !page.contains("inf "), "the page contains a number that is not finite");
    assert!(page.contains("Noise components") && page.contains("Limits on effects that were not detected"));
    let report = std::fs::read(folder.path().join("out/report.json")).unwrap();
    (message, serde_json::from_slice(&report).unwrap())
}

fn small() -> Plan {
    Plan { layouts: vec![vec![5, 8, 11]], repetitions: [6, 6], seed: 31, ..Plan::randomised() }
}

#[test]
fn ignored_columns_are_listed() {
    let rows = simulate(&small()).rows;
    let text = with_columns(&rows, &["humidity", "session", "note"], |_, _| {
        ["41", "monday", "ok"].map(str::to_owned).to_vec()
    });
    let (output, report) = calibrated(&text);
    assert_eq!(report["ignored_columns"], serde_json::json!(["humidity", "note"]));
    assert!(output.contains("ignored columns: humidity, note\n"), "{output}");
    let (output, report) = calibrated(&PlateauTable::write(&rows));
    assert_eq!(report["ignored_columns"], serde_json::json!([]));
    assert!(!output.contains("ignored columns"), "{output}");
}

#[test]
fn readings_are_unique_in_a_session() {
    let rows = simulate(&small()).rows;
    let of = |second: &str| {
        let monday = with_columns(&rows, &["session"], |_, _| vec!["monday".to_owned()]);
        let again = with_columns(&rows, &["session"], |_, _| vec![second.to_owned()]);
        let text = monday + again.split_once('\n').unwrap().1;
        PlateauTable::read(text.as_bytes(), "t.csv")
    };
    assert_eq!(of("tuesday").unwrap().rows.len(), 2 * rows.len());
    let error = of("monday").unwrap_err().to_string();
    let line = rows.len() + 2;
    assert!(error.starts_with(&format!("t.csv:{line}:45: repetition = 1: ")), "{error}");
    assert!(error.contains("repeats the series, direction and time of line 2"), "{error}");
}

#[test]
fn labels_are_read() {
    let rows = simulate(&small()).rows;
    let text = with_columns(&rows, &["specimen", "operator", "mount", "session"], |i, _| {
        ["b", "ann", "7", if i == 0 { "" } else { "monday" }].map(str::to_owned).to_vec()
    });
    let table = PlateauTable::read(text.as_bytes(), "t.csv").unwrap();
    let labels = &table.rows[1].labels;
    assert_eq!(
        [&labels.session, &labels.mount, &labels.operator, &labels.specimen],
        ["monday", "7", "ann", "b"]
    );
    assert_eq!(table.rows[0].labels.session, "");
    assert!(table.ignored_columns().is_empty());
}

/// Two operators who zero the load cell differently are reported by operator, not as an offset of the load
/// cell.
#[test]
fn differences_between_operators_are_structure() {
    let mut rows = simulate(&Plan { seed: 32, ..Plan::randomised() }).rows;
    let ann = |row: &PlateauRow| row.series.parse::<usize>().unwrap() % 2 == 0;
    for row in &mut rows {
        row.force_n += if ann(row) { 0.25 } else { -0.25 };
    }
    let text =
        with_columns(&rows, &["operator"], |_, row| vec![if ann(row) { "ann" } else { "ben" }.to_owned()]);
    let (output, report) = calibrated(&text);
    let [effect] = report["effects"].as_array().unwrap().as_slice() else { panic!("{output}") };
    assert_eq!(
        (&effect["id"], &effect["covariate"]),
        (&"unattributed".into(), &"operator".into()),
        "{output}"
    );
    assert!(output.contains("an effect without a name acts over operator"), "{output}");
}
