//! The schemas of what the program writes: they accept every report and JSON file of every command, and refuse any change
//! of a key or of a type.

#![cfg(unix)]

use std::collections::{BTreeMap, BTreeSet};

use pinswitch_calibration::segmentation::Finding;
use pinswitch_friction::Direction;
use serde_json::{Value, json};

use crate::harness::{printed, repository};
use crate::report_documents::{DOCUMENTS, Document, PRINTED};

/// Keys that may be absent, by kind.
const OPTIONAL: &[(&str, &[&str])] = &[
    ("batch-record", &["verify"]),
    (
        "calibration-report",
        &[
            "asked",
            "by_repeating",
            "changes",
            "error_before_N",
            "expected_error_N",
            "extrapolation",
            "form",
            "heldout_layouts_rmse_N",
            "includes",
            "least_squares_N",
            "note",
            "possible",
            "probability",
            "promise_N",
            "promise_baseline_N",
            "provenance",
            "readings",
            "repetition",
            "runs",
            "sessions",
            "shape",
            "side",
            "size",
            "trials",
            "unknown_columns",
        ],
    ),
    ("check-report", &["parts"]),
    ("experiment-report", &["size"]),
    ("explain-report", &["document"]),
    ("failure", &["causes", "changes", "column", "field", "file", "help", "line", "location", "value"]),
    ("finger-report", &["joint", "joint_path", "wrap_middle_deg"]),
    (
        "manifest",
        &[
            "batch",
            "checksum",
            "content",
            "crimp_sleeve",
            "measured",
            "model_sha256",
            "mould_cure",
            "mount",
            "plates",
            "post_cure",
            "print",
            "product",
            "pulleys",
            "source",
            "verification",
        ],
    ),
    ("provenance", &["external"]),
    ("simulated-faults", &["missing_after", "odd_speed"]),
];
/// Keys of tables with a row for each name.
const TABLES: &[&str] = &["factors", "others", "parameters", "shape", "tables"];

fn schema(kind: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    serde_json::from_str(&printed(folder.path(), &["schema", kind])).unwrap()
}

/// Returns the texts of the help of `pinswitch schema`, by kind.
fn kinds() -> BTreeMap<String, String> {
    let folder = tempfile::tempdir().unwrap();
    let help = printed(folder.path(), &["schema", "--help"]);
    let mut all: BTreeMap<String, String> = BTreeMap::new();
    let mut last = None;
    for line in help.lines().map(str::trim) {
        match line.strip_prefix("- ").and_then(|line| line.split_once(':')) {
            Some((kind, text)) => {
                last = Some(kind.to_owned());
                all.insert(kind.to_owned(), text.trim().to_owned());
            }
            None if line.is_empty() => last = None,
            None => {
                if let Some(text) = last.as_ref().and_then(|kind| all.get_mut(kind)) {
                    text.push(' ');
                    text.push_str(line);
                }
            }
        }
    }
    all
}

#[test]
fn every_document_is_valid() {
    let mut validators = BTreeMap::new();
    for Document { kind, origin, content } in DOCUMENTS.iter() {
        let validator = validators.entry(kind).or_insert_with(|| {
            let schema = schema(kind);
            assert!(jsonschema::meta::is_valid(&schema), "{kind}");
            assert!(schema["title"].as_str().unwrap().ends_with(" (pinswitch)"), "{kind}");
            assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
            jsonschema::validator_for(&schema).unwrap()
        });
        let errors: Vec<String> =
            validator.iter_errors(content).map(|e| format!("{}: {e}", e.instance_path())).take(5).collect();
        assert!(errors.is_empty(), "{kind}, {origin}: {errors:#?}");
    }
}

/// Cuts lists to two items: one that is complete is as good as all.
fn shortened(value: &Value) -> Value {
    match value {
        // A list of up to four numbers may be a tuple.
        Value::Array(items) if items.len() > 4 => items.iter().take(2).map(shortened).collect(),
        Value::Array(items) => items.iter().map(shortened).collect(),
        Value::Object(entries) => {
            Value::Object(entries.iter().map(|(key, value)| (key.clone(), shortened(value))).collect())
        }
        other => other.clone(),
    }
}

/// Collects the places of all values within `value`, as JSON pointers.
fn places(value: &Value, place: &str, all: &mut Vec<String>) {
    all.push(place.to_owned());
    match value {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| places(item, &format!("{place}/{i}"), all));
        }
        Value::Object(entries) => entries.iter().for_each(|(key, value)| {
            places(value, &format!("{place}/{}", key.replace('~', "~0").replace('/', "~1")), all);
        }),
        _ => {}
    }
}

/// Returns a value of another type.
fn of_another_type(value: &Value) -> Value {
    match value {
        Value::String(_) | Value::Bool(_) => json!(7.5),
        // A value that may be absent may be anything but an unknown object.
        Value::Null => json!({ "not_a_key": true }),
        Value::Number(_) | Value::Array(_) | Value::Object(_) => json!("a word"),
    }
}

#[test]
fn changed_documents_are_invalid() {
    let mut optional: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
    for Document { kind, origin, content } in DOCUMENTS.iter() {
        let validator = jsonschema::validator_for(&schema(kind)).unwrap();
        let whole = shortened(content);
        assert!(validator.is_valid(&whole), "{kind}, {origin}");
        let mut all = Vec::new();
        places(&whole, "", &mut all);
        let is_valid = |place: &str, change: &dyn Fn(&mut Value)| {
            let mut changed = whole.clone();
            change(changed.pointer_mut(place).unwrap());
            validator.is_valid(&changed)
        };
        for place in all {
            // The value of a setting has the type of its field.
            if !(*kind == "manifest" && place.starts_with("/settings/") && place.contains("/value")) {
                let is_valid = is_valid(&place, &|value| *value = of_another_type(value));
                assert!(!is_valid, "{kind}, {origin}: {place} of another type");
            }
            let Some(entries) = whole.pointer(&place).and_then(Value::as_object) else { continue };
            let is_valid_with = is_valid(&place, &|value| value["not_a_key"] = json!({}));
            assert!(!is_valid_with, "{kind}, {origin}: another key in {place}");
            let is_table = TABLES.iter().any(|table| place.ends_with(&format!("/{table}")));
            if is_table || (*kind == "simulated-faults" && place.is_empty()) {
                continue;
            }
            for key in entries.keys() {
                let remove = |value: &mut Value| drop(value.as_object_mut().unwrap().remove(key));
                if is_valid(&place, &remove) {
                    optional.entry(kind).or_default().insert(key.clone());
                }
            }
        }
    }
    let owned = |keys: &[&str]| keys.iter().map(|key| (*key).to_owned()).collect();
    let listed: BTreeMap<_, _> = OPTIONAL.iter().map(|(kind, keys)| (*kind, owned(keys))).collect();
    assert_eq!(optional, listed);
}

/// A new command with `--json`, or a new kind, needs a schema and a document here.
#[test]
fn every_command_with_json_has_a_schema() {
    let folder = tempfile::tempdir().unwrap();
    let help = printed(folder.path(), &["--help"]);
    let commands = help.split("Commands:").nth(1).and_then(|text| text.split("\n\n").next()).unwrap();
    let is_name = |line: &&str| line.starts_with("  ") && !line.starts_with("   ");
    let commands: Vec<&str> =
        commands.lines().filter(is_name).filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.len() > 20, "{help}");
    let kinds = kinds();
    let with_json: Vec<&str> = commands
        .into_iter()
        .filter(|command| {
            *command != "help" && printed(folder.path(), &[command, "--help"]).contains("  --json\n")
        })
        .collect();
    assert!(with_json.len() > 10, "{with_json:?}");
    for command in with_json {
        let words = format!("`{command} --json`");
        assert!(kinds.values().any(|text| text.contains(&words)), "no schema of {words}: {kinds:?}");
        let begin = format!("{command} ");
        assert!(PRINTED.iter().any(|(_, _, line)| line.starts_with(&begin)), "no document of {words}");
    }
    let read = crate::schemas::KINDS.map(|(kind, ..)| kind).into_iter().chain(["configuration"]);
    let document = std::fs::read_to_string(repository("model/doc/file-formats.md")).unwrap();
    for kind in kinds.keys() {
        assert!(document.contains(&format!("`{kind}`")), "{kind} is not in model/doc/file-formats.md");
    }
    let checked: BTreeSet<&str> = DOCUMENTS.iter().map(|document| document.kind).chain(read).collect();
    assert_eq!(checked, kinds.keys().map(String::as_str).collect());
}

/// Every kind of finding, of which logs have few.
#[test]
fn every_finding_is_valid() {
    let (direction, time_s) = (Direction::Eccentric, 1.5);
    let findings = [
        Finding::Spikes { samples: 2 },
        Finding::LostSamples { samples: 2 },
        Finding::UnusableLines { lines: 2 },
        Finding::Clipped { force_n: 70.0, share: 0.1 },
        Finding::OddSpeed { direction, repetition: 1, ratio: 0.7 },
        Finding::MissingRepetition { direction, after: 1 },
        Finding::UnreadableRest { time_s },
        Finding::UncertainDirection { time_s, probability: 0.9, reason: "power".to_owned() },
        Finding::Departure { field: "stroke_mm", declared: 150.0, measured: 120.0 },
        Finding::ScheduledMoves { moves: 2 },
        Finding::UnsettledCycles { share: f64::NAN },
        Finding::DwellByForce,
        Finding::ReversedPosition,
        Finding::Unloaded { plateaus: 2 },
        Finding::TimeUnit { declared_s: 1.0, measured_s: 1e-3 },
        Finding::CoarseClock { step_s: 0.1 },
        Finding::ClockRollOver { time_s, modulus_s: 65.536 },
        Finding::ClockReset { time_s },
    ];
    let validator = jsonschema::validator_for(&schema("segmentation-report")).unwrap();
    let report = |finding: Value| {
        json!({ "schema": "pinswitch.segmentation/1", "series": [{
            "file": "a.csv", "eccentric": 1, "concentric": 1, "motion": "cycles", "source": "force", "findings": [finding],
        }] })
    };
    for finding in findings {
        let mut finding = serde_json::to_value(&finding).unwrap();
        assert!(validator.is_valid(&report(finding.clone())), "{finding}");
        finding["not_a_key"] = json!(1);
        assert!(!validator.is_valid(&report(finding.clone())), "{finding}");
    }
}
