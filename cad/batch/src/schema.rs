//! JSON Schema of a sweep.

use serde_json::{Map, Value, json};

use crate::axis::{METHODS, field};
use crate::sweep::{part_names, tables};
use pinswitch_switch::config;
use pinswitch_switch::config::{Configuration, closed_object};

/// Returns the JSON Schema (2020-12) of a sweep.
pub fn json_schema() -> Value {
    let tables: Map<String, Value> =
        tables().map(|(name, keys)| (name.to_owned(), table(name, keys))).collect();
    let mut schema = closed_object(tables);
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("Sweep of friction switches (pinswitch)");
    schema
}

fn table(name: &str, keys: &[&str]) -> Value {
    match name {
        "set" => fields(&|value| value),
        "axes" => fields(&axis),
        "constraints" => {
            let mut entry = closed_object(properties(keys));
            entry["required"] = json!(["require"]);
            json!({ "type": "array", "items": entry })
        }
        _ => closed_object(properties(keys)),
    }
}

fn properties(keys: &[&str]) -> Map<String, Value> {
    keys.iter().map(|key| ((*key).to_owned(), property(key))).collect()
}

/// The schema of a key; all keys of the tables have different names.
fn property(key: &str) -> Value {
    match key {
        "name" => json!({ "type": "string", "description": "Name; by default the stem of the file." }),
        "base" => {
            json!({ "type": "string", "description": "Template, or configuration in the folder of the sweep." })
        }
        "preset" => {
            json!({ "type": "string", "description": "Template or file; values of the base take precedence." })
        }
        "parts" => json!({
            "type": "array",
            "items": { "enum": part_names() },
            "description": "Parts of each variant; by default all, none for curves alone.",
        }),
        "plots" => json!({ "type": "boolean", "description": "A plot of friction for each variant." }),
        "method" => json!({ "enum": METHODS.map(|(word, _)| word) }),
        "count" => json!({ "type": "integer", "minimum": 1 }),
        "seed" => json!({ "type": "integer", "minimum": 0 }),
        "axes" => fields(&axis),
        "file" => {
            json!({ "type": "string", "description": "CSV with a column for each field, in the folder of the sweep." })
        }
        "require" => json!({ "type": "string", "description": "Condition, such as `shell.width_mm >= 12`." }),
        "because" => json!({ "type": "string", "description": "Reason for the condition." }),
        _ => json!({}),
    }
}

/// The schema of a table of fields, written `"shell.width_mm" = ..` or as `[axes.shell]`; `of` makes the schema of a field from
/// that of its value.
fn fields(of: &dyn Fn(Value) -> Value) -> Value {
    let configuration = config::json_schema();
    let value =
        |section: &str, key: &str| of(configuration["properties"][section]["properties"][key].clone());
    let mut all: Map<String, Value> = Map::new();
    for parameter in Configuration::PARAMETERS.iter().filter(|p| field(&p.path()).is_ok()) {
        all.insert(parameter.path(), value(parameter.section, parameter.key));
        let section = all.entry(parameter.section).or_insert_with(|| closed_object(Map::new()));
        section["properties"][parameter.key] = value(parameter.section, parameter.key);
    }
    closed_object(all)
}

/// The schema of an axis: a list of values, or a range.
fn axis(value: Value) -> Value {
    let number = json!({ "type": "number" });
    json!({
        "description": value["description"],
        "anyOf": [
            { "type": "array", "items": value },
            {
                "type": "object",
                "properties": {
                    "from": number,
                    "to": number,
                    "step": { "type": "number", "exclusiveMinimum": 0 },
                    "count": { "type": "integer", "minimum": 1 },
                    "spacing": { "enum": ["linear", "log"] },
                },
                "required": ["from", "to"],
                "additionalProperties": false,
            },
        ],
    })
}
