//! The JSON Schema of a configuration, with which editors complete and check its TOML.

use serde_json::{Map, Value, json};
use toml_edit::Value as TomlValue;

use super::parameter::Parameter;
use super::parameters::Configuration;

/// Dialect of the schemas.
pub(crate) const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Returns the JSON Schema (2020-12) of a configuration: every parameter with its type, range, choices, default and reason.
/// It accepts what [`super::read`] accepts, apart from the characters of texts, which it does not check.
///
/// ```
/// let schema = pinswitch_switch::config::json_schema();
/// assert_eq!(schema["properties"]["shell"]["properties"]["width_mm"]["type"], "number");
/// ```
pub fn json_schema() -> Value {
    let mut tables: Vec<(&str, Map<String, Value>)> = Vec::new();
    for parameter in Configuration::PARAMETERS {
        match tables.last_mut() {
            Some((section, table)) if *section == parameter.section => {
                table.insert(parameter.key.to_owned(), property(parameter));
            }
            _ => tables
                .push((parameter.section, Map::from_iter([(parameter.key.to_owned(), property(parameter))]))),
        }
    }
    let tables: Map<String, Value> =
        tables.into_iter().map(|(section, table)| (section.to_owned(), closed_object(table))).collect();
    let mut schema = closed_object(tables);
    schema["$schema"] = json!(DIALECT);
    schema["title"] = json!("Configuration of a friction switch (pinswitch)");
    schema
}

/// The schema of an object without further keys.
pub fn closed_object(properties: Map<String, Value>) -> Value {
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}

fn property(parameter: &Parameter<Configuration>) -> Value {
    let default = (parameter.get)(&Configuration::default());
    let unit = parameter.unit();
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let mut property = json!({
        "description":
            format!("{}. {}{unit}, {}.", parameter.reason, (parameter.range)(), parameter.origin),
        "default": json(&default),
    });
    let choices = (parameter.choices)();
    match &default {
        TomlValue::Boolean(_) => property["type"] = json!("boolean"),
        TomlValue::Array(_) => {
            property["type"] = json!("array");
            property["items"] = json!({ "type": "integer", "minimum": 0 });
        }
        TomlValue::Integer(_) => property["type"] = json!("integer"),
        TomlValue::Float(_) => property["type"] = json!("number"),
        _ if choices.is_empty() => property["type"] = json!("string"),
        _ => property["enum"] = choices.iter().map(json).collect(),
    }
    if let Some([least, most]) = (parameter.ends)() {
        // The ends of a whole number are whole.
        let end = |end: f64| match &default {
            TomlValue::Integer(_) => json!(end as i64),
            _ => json!(end),
        };
        property["minimum"] = end(least);
        property["maximum"] = end(most);
    }
    property
}

/// A TOML value as JSON. Dates do not occur.
fn json(value: &TomlValue) -> Value {
    match value {
        TomlValue::Boolean(v) => json!(v.value()),
        TomlValue::Integer(v) => json!(v.value()),
        TomlValue::Float(v) => json!(v.value()),
        TomlValue::Array(list) => list.iter().map(json).collect(),
        other => json!(other.as_str()),
    }
}
