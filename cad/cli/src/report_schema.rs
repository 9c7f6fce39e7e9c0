//! JSON Schemas of what the program writes: reports on standard output, and JSON files.

use schemars::generate::SchemaSettings;
use schemars::transform::{Transform, transform_subschemas};
use schemars::{JsonSchema, Schema};
use serde_json::{Value, json};

/// Keywords whose subschemas describe the same object as the schema itself.
const PARTS: [&str; 3] = ["allOf", "anyOf", "oneOf"];

/// Returns the schema of `T` as the program writes it, with a title.
///
/// The program writes every required key, and no key without a name in the schema. A number that is not finite is null
/// in JSON; any other optional value is either always written, or absent where there is none.
pub(super) fn written<T: JsonSchema>(title: &str) -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize().with_transform(Written);
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    schema.insert("title".to_owned(), format!("{title} (pinswitch)").into());
    schema
}

/// Returns the schema of a file that ends with the checksum of its text.
pub(super) fn written_with_checksum<T: JsonSchema>(title: &str) -> Schema {
    let mut schema = perhaps_with_checksum::<T>(title);
    if let Some(Value::Array(required)) = schema.get_mut("required") {
        required.push("checksum".into());
    }
    schema
}

/// Returns the schema of a file that may end with the checksum of its text.
pub(super) fn perhaps_with_checksum<T: JsonSchema>(title: &str) -> Schema {
    const CONTENT: &str = "SHA-256 of the text before this key, in hexadecimal digits.";
    let mut schema = written::<T>(title);
    if let Some(properties) = schema.get_mut("properties") {
        properties["checksum"] = json!({ "type": "string", "description": CONTENT });
    }
    schema
}

/// Makes the schema of a type that of its JSON.
#[derive(Clone)]
struct Written;

impl Transform for Written {
    fn transform(&mut self, schema: &mut Schema) {
        transform_subschemas(self, schema);
        if schema.get("type").is_some_and(|kind| kind == "number") {
            schema.insert("type".to_owned(), json!(["number", "null"]));
        }
        if let Some(Value::String(text)) = schema.get_mut("description") {
            *text = described(text);
        }
        if schema.get("properties").is_some() {
            refuse_null(schema);
            close(schema);
        }
    }
}

/// Refuses null for the keys that are absent where there is no value.
fn refuse_null(schema: &mut Schema) {
    let required = schema.get("required").cloned().unwrap_or_default();
    let Some(Value::Object(properties)) = schema.get_mut("properties") else { return };
    let is_required = |key: &str| required.as_array().is_some_and(|all| all.iter().any(|name| name == key));
    for (_, value) in properties.iter_mut().filter(|(key, _)| !is_required(key)) {
        let Value::Object(value) = value else { continue };
        if value.get("type").and_then(Value::as_array).is_some_and(|types| types[0] != "number") {
            value["type"] = value["type"][0].take();
        }
        if let Some(Value::Array(mut choices)) = value.remove("anyOf") {
            choices.retain(|choice| *choice != json!({ "type": "null" }));
            match choices.pop() {
                Some(Value::Object(only)) if choices.is_empty() => value.extend(only),
                last => drop(value.insert("anyOf".to_owned(), choices.into_iter().chain(last).collect())),
            }
        }
    }
}

/// Refuses every key that the schema of an object does not name.
fn close(schema: &mut Schema) {
    if schema.get("additionalProperties").is_some() {
        return;
    }
    let mut is_whole = true;
    for parts in PARTS {
        if let Some(Value::Array(parts)) = schema.get_mut(parts) {
            is_whole = false;
            parts.iter_mut().for_each(open);
        }
    }
    // `additionalProperties` does not see the keys of the parts.
    let keyword = if is_whole { "additionalProperties" } else { "unevaluatedProperties" };
    schema.insert(keyword.to_owned(), false.into());
}

/// Accepts further keys in a part of an object, and in the parts of that part.
fn open(part: &mut Value) {
    let Value::Object(part) = part else { return };
    for keyword in ["additionalProperties", "unevaluatedProperties"] {
        part.retain(|key, value| key != keyword || *value != false);
    }
    for parts in PARTS {
        if let Some(Value::Array(parts)) = part.get_mut(parts) {
            parts.iter_mut().for_each(open);
        }
    }
}

/// Returns the text of a comment without its examples of code and the brackets of its links.
fn described(comment: &str) -> String {
    let mut rest = comment.split("```").next().unwrap_or_default().trim_end();
    let mut text = String::new();
    while let Some((before, link)) = rest.split_once("[`") {
        let (name, after) = link.split_once("`]").unwrap_or((link, ""));
        text.push_str(&format!("{before}`{name}`"));
        rest =
            after.strip_prefix('(').and_then(|target| target.split_once(')')).map_or(after, |(_, rest)| rest);
    }
    text + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A measured value. See [`f64`] and [`String`](std::string::String).
    ///
    /// ```
    /// let x = 1.0;
    /// ```
    #[derive(JsonSchema, serde::Serialize)]
    struct Reading {
        #[serde(flatten)]
        kind: Kind,
        value: f64,
        note: Option<String>,
        #[serde(skip_serializing_if = "Option::is_none")]
        count: Option<u64>,
    }

    #[derive(JsonSchema, serde::Serialize)]
    #[serde(tag = "kind", rename_all = "lowercase")]
    enum Kind {
        Force,
        Time { unit: String },
    }

    #[test]
    fn a_schema_is_as_strict_as_the_writer() {
        let schema = written_with_checksum::<Reading>("A reading").to_value();
        assert_eq!(schema["title"], "A reading (pinswitch)");
        assert_eq!(schema["description"], "A measured value. See `f64` and `String`.");
        let validator = jsonschema::validator_for(&schema).unwrap();
        let reading = |kind: Kind| {
            let reading = Reading { kind, value: f64::NAN, note: None, count: None };
            let mut value = serde_json::to_value(reading).unwrap();
            value["checksum"] = "0a".into();
            value
        };
        for written in [reading(Kind::Force), reading(Kind::Time { unit: "s".to_owned() })] {
            assert!(validator.is_valid(&written), "{written}");
            for (key, value) in
                [("other", json!(1)), ("value", json!("1")), ("kind", json!("mass")), ("count", Value::Null)]
            {
                let mut wrong = written.clone();
                wrong[key] = value;
                assert!(!validator.is_valid(&wrong), "{wrong}");
            }
            for key in ["kind", "value", "note", "checksum"] {
                let mut wrong = written.clone();
                wrong.as_object_mut().unwrap().remove(key);
                assert!(!validator.is_valid(&wrong), "{wrong}");
            }
        }
    }
}
