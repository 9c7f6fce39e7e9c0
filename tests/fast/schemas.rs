//! The schemas of `pinswitch schema` accept what the program reads, and refuse what it refuses.

use crate::harness::{done, expect_code, repository};
use crate::readers::{Reading, judge};
use pinswitch_switch::config::{self, Configuration};
use pinswitch_switch::measured::Measured;
use pinswitch_switch::templates::{EXAMPLES, TEMPLATES};
use proptest::prelude::*;
use serde_json::Value;
use toml_edit::Value as TomlValue;

fn validator(kind: &str) -> jsonschema::Validator {
    let folder = tempfile::tempdir().unwrap();
    let schema: Value = serde_json::from_str(&done(folder.path(), &["schema", kind])).unwrap();
    assert!(jsonschema::meta::is_valid(&schema));
    jsonschema::validator_for(&schema).unwrap()
}

fn json(toml: &str) -> Value {
    serde_json::to_value(toml::from_str::<toml::Table>(toml).unwrap()).unwrap()
}

#[test]
fn every_template_is_valid() {
    let configuration = validator("configuration");
    for template in TEMPLATES {
        assert!(configuration.is_valid(&json(template.text)), "{}", template.name);
    }
    assert!(configuration.is_valid(&json(&config::reference_toml())));
    let (_, measured) = EXAMPLES.iter().find(|example| example.0 == "measured").unwrap();
    assert!(validator("measured").is_valid(&json(measured)));
    for wrong in ["[shel]\nwidth_mm = 12", "[shell]\nwidth = 12", "width_mm = 12"] {
        assert!(!configuration.is_valid(&json(wrong)), "{wrong}");
    }
}

/// What `init --schema` writes is complete for an editor: the file names its schema, which accepts it.
#[test]
fn a_started_file_names_its_schema() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let kinds = KINDS.iter().map(|kind| kind.0).filter(|kind| EXAMPLES.iter().any(|(name, _)| name == kind));
    let mut count = 0;
    for name in kinds.chain(["three-double", "printer-fff-0.4", "reference"]) {
        let file = format!("{name}.toml");
        let arguments = ["init", name, "--schema", "--out", &file];
        done(path, &arguments);
        let text = std::fs::read_to_string(path.join(&file)).unwrap();
        let named = text.lines().next().and_then(|line| line.strip_prefix("#:schema ./")).unwrap();
        assert_eq!(named, format!("{name}.schema.json"));
        let schema: Value = serde_json::from_slice(&std::fs::read(path.join(named)).unwrap()).unwrap();
        let validator = jsonschema::validator_for(&schema).unwrap();
        assert!(validator.is_valid(&json(&text)), "{name}");
        let mut wrong = json(&text);
        let first = wrong.as_object_mut().unwrap().values_mut().next().unwrap();
        *first = if first.is_object() { 7.into() } else { serde_json::json!({ "not_a_key": 1 }) };
        assert!(!validator.is_valid(&wrong), "{name}");
        // Neither file is overwritten.
        std::fs::remove_file(path.join(&file)).unwrap();
        expect_code(2, path, &arguments);
        assert!(!path.join(&file).exists());
        count += 1;
    }
    assert_eq!(count, EXAMPLES.len() - 1 + 3, "every kind but the table");
    let refused = expect_code(2, path, &["init", "configurations", "--schema", "--out", "table.csv"]);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("a CSV has no schema"));
    assert!(!path.join("table.csv").exists());
}

/// Values of every type, in and out of ranges, near the ends `low` and `high`.
fn values(low: f64, high: f64) -> impl Strategy<Value = TomlValue> {
    prop_oneof![
        (low - 1.0..=high + 1.0).prop_map(TomlValue::from),
        Just(low.into()),
        Just(high.into()),
        (-2_i64..400).prop_map(TomlValue::from),
        any::<bool>().prop_map(TomlValue::from),
        proptest::collection::vec(-1_i64..20, 0..4)
            .prop_map(|list| TomlValue::Array(list.into_iter().collect())),
        Just("mine".into()),
    ]
}

#[test]
fn the_schema_and_the_reader_agree() {
    let schema = validator("configuration");
    let accepted = std::cell::Cell::new([0; 2]);
    // Texts are not checked by the schema, and 3.0 is whole for JSON Schema and not for TOML.
    let parameters: Vec<_> = Configuration::PARAMETERS
        .iter()
        .filter(|p| !(p.get)(&Configuration::default()).is_str() || !(p.choices)().is_empty())
        .collect();
    let cases = (0..parameters.len()).prop_flat_map(|i| {
        let [low, high] = (parameters[i].ends)().unwrap_or([0.0, 9.0]);
        let choices = (parameters[i].choices)();
        let choice = (0..choices.len().max(1)).prop_map(move |k| choices.get(k).cloned().unwrap_or(3.into()));
        (Just(i), prop_oneof![3 => values(low, high), 1 => choice])
    });
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig::with_cases(2000));
    runner
        .run(&cases, |(i, value)| {
            let parameter = parameters[i];
            let is_whole_float = value.as_float().is_some_and(|v| v.fract() == 0.0);
            prop_assume!(!(is_whole_float && (parameter.get)(&Configuration::default()).is_integer()));
            let text = format!("[{}]\n{} = {value}\n", parameter.section, parameter.key);
            let reads = config::read(&text, "x.toml").is_ok();
            prop_assert_eq!(schema.is_valid(&json(&text)), reads, "{}", text);
            let mut count = accepted.get();
            count[usize::from(reads)] += 1;
            accepted.set(count);
            Ok(())
        })
        .unwrap();
    assert!(accepted.get().iter().all(|count| *count > 300), "{:?}", accepted.get());
}

#[test]
fn readings_and_their_schema_agree() {
    let schema = validator("measured");
    for text in [
        "hardness_shore_a = 46",
        "hardness_shore_a = [46, 47.5]",
        "hardness_shore_a = 4",
        "hardness_shore_a = []",
        "hardness_shore_a = [46, 99]",
        "hardness_shore_a = '46'",
        "hardness = 46",
        "",
    ] {
        assert_eq!(schema.is_valid(&json(text)), Measured::read(text, "x.toml").is_ok(), "{text}");
    }
}

/// Kinds of files with their readers and templates.
pub(crate) const KINDS: [(&str, &str, &[&str]); 8] = [
    ("effects", "effects", &["rig/effects.toml"]),
    ("import", "import_map", &["rig/import.toml"]),
    ("measured", "measured", &["rig/measured.toml"]),
    ("plan", "plan", &["rig/plan.toml"]),
    (
        "request",
        "request",
        &["requests/gripper.toml", "requests/small-joint.toml", "requests/impossible.toml"],
    ),
    (
        "rig",
        "rig",
        &["rig/rig.toml", "rig/rig-capstan.toml", "rig/rig-bowden.toml", "rig/rig-cable-machine.toml"],
    ),
    ("run", "run", &["rig/run.toml"]),
    ("sweep", "sweep", &["batch/sweep.toml"]),
];

/// A change of a file: an unknown key in a table, or a value of another type.
type Mutation = (toml::Table, String, bool);

/// Returns every change of one place of a table; `rebuild` puts the changed table into the file.
fn mutations(
    table: &toml::Table,
    place: &str,
    rebuild: &dyn Fn(toml::Table) -> toml::Table,
) -> Vec<Mutation> {
    let mut unknown = table.clone();
    unknown.insert("not_a_key".to_owned(), 1.into());
    let mut all = vec![(rebuild(unknown), format!("{place}.not_a_key"), true)];
    for (key, value) in table {
        let place = format!("{place}.{key}");
        let with = |new: toml::Value| {
            let mut changed = table.clone();
            changed.insert(key.clone(), new);
            rebuild(changed)
        };
        for other in [toml::Value::from(true), "word".into(), 7.into(), toml::Value::Array(Vec::new())] {
            // serde reads a table from a list of its values, too, which no one writes.
            let is_list_for_table = other.is_array() && value.is_table();
            if other.type_str() != value.type_str() && !is_list_for_table {
                all.push((with(other.clone()), format!("{place} = {other}"), false));
            }
        }
        match value {
            toml::Value::Table(inner) => all.extend(mutations(inner, &place, &|new| with(new.into()))),
            toml::Value::Array(items) => {
                for (i, item) in items.iter().enumerate() {
                    let toml::Value::Table(inner) = item else { continue };
                    let with_item = |new: toml::Table| {
                        let mut changed = items.clone();
                        changed[i] = new.into();
                        with(changed.into())
                    };
                    all.extend(mutations(inner, &format!("{place}[{i}]"), &with_item));
                }
            }
            _ => {}
        }
    }
    all
}

/// What a reader accepts, its schema accepts; keys that a reader does not know, its schema refuses.
#[test]
fn schemas_of_all_kinds_agree_with_their_readers() {
    for (kind, reader, templates) in KINDS {
        let schema = validator(kind);
        let reads = |text: &str| judge(reader, text.as_bytes()).unwrap() == Reading::Accepted;
        let (mut accepted, mut refused) = (0, 0);
        for template in templates {
            let text = std::fs::read_to_string(repository(&format!("templates/{template}"))).unwrap();
            assert!(reads(&text), "{template}");
            let table: toml::Table = toml::from_str(&text).unwrap();
            let errors: Vec<_> = schema.iter_errors(&json(&text)).map(|e| e.to_string()).collect();
            assert!(errors.is_empty(), "{template}: {errors:?}");
            for (changed, place, is_unknown) in mutations(&table, "", &|table| table) {
                let text = toml::to_string(&changed).unwrap();
                let (reads, is_valid) = (reads(&text), schema.is_valid(&json(&text)));
                if reads {
                    assert!(is_valid, "{template}: the reader accepts {place}");
                    accepted += 1;
                } else if is_unknown {
                    assert!(!is_valid, "{template}: the schema accepts {place}");
                }
                refused += usize::from(!is_valid);
            }
        }
        assert!(refused > 5 && accepted + refused > 10, "{kind}: {accepted} accepted, {refused} refused");
        for entry in std::fs::read_dir(repository(&format!("tests/corpus/{reader}"))).into_iter().flatten() {
            let path = entry.unwrap().path();
            let Ok(text) = std::fs::read_to_string(&path) else { continue };
            if toml::from_str::<toml::Table>(&text).is_ok() && reads(&text) {
                assert!(schema.is_valid(&json(&text)), "{}", path.display());
            }
        }
    }
}
