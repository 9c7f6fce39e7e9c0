//! The fields of a configuration, as the page shows and reads them.

use std::collections::BTreeMap;

use serde::Serialize;
use toml_edit::Value;

use crate::config::parameter::Parameter;
use crate::config::{Configuration, Origin};
use crate::documents::toml_to_json;

/// Values that differ from the defaults, by `table.key`.
pub type Values = BTreeMap<String, serde_json::Value>;

/// One field of a configuration.
#[derive(Debug, Serialize)]
pub struct Field {
    path: String,
    section: &'static str,
    key: &'static str,
    unit: &'static str,
    kind: &'static str,
    ends: Option<[f64; 2]>,
    choices: Option<Vec<String>>,
    range: String,
    default: serde_json::Value,
    origin: Origin,
    reason: &'static str,
}

/// Returns the values in which a configuration differs from the defaults.
#[must_use]
pub fn changed_values(configuration: &Configuration) -> Values {
    let defaults = Configuration::default();
    let value = |p: &Parameter<Configuration>, c: &Configuration| (p.get)(c);
    Configuration::PARAMETERS
        .iter()
        .filter(|p| value(p, configuration).to_string() != value(p, &defaults).to_string())
        .map(|p| (p.path(), toml_to_json(&value(p, configuration))))
        .collect()
}

/// Returns every field, in the order of the tables.
#[must_use]
pub fn fields() -> Vec<Field> {
    let defaults = Configuration::default();
    Configuration::PARAMETERS
        .iter()
        .map(|parameter| {
            let (value, range) = ((parameter.get)(&defaults), (parameter.range)());
            let choices = choices(&value, &range);
            Field {
                path: parameter.path(),
                section: parameter.section,
                key: parameter.key,
                unit: parameter.unit(),
                kind: match &value {
                    Value::Float(_) => "number",
                    Value::Integer(_) => "whole",
                    Value::Boolean(_) => "flag",
                    Value::Array(_) => "list",
                    _ if choices.is_some() => "choice",
                    _ => "text",
                },
                ends: (parameter.ends)(),
                choices,
                range,
                default: toml_to_json(&value),
                origin: parameter.origin,
                reason: parameter.reason,
            }
        })
        .collect()
}

/// Returns the words of a choice, whose range is `"one" or "another"`; `None` for another range.
fn choices(value: &Value, range: &str) -> Option<Vec<String>> {
    value.as_str()?;
    let words = range.split(" or ").map(|word| word.strip_prefix('"')?.strip_suffix('"'));
    words.map(|word| word.map(str::to_owned)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The page reads numbers with a unit: it has a table of each unit of a field.
    #[test]
    fn every_unit_can_be_typed() {
        let script = include_str!("../../../page/quantity.js");
        let (_, table) = script.split_once("const QUANTITY_UNITS = {").unwrap();
        let (table, _) = table.split_once("\n};").unwrap();
        for field in fields().iter().filter(|field| !field.unit.is_empty()) {
            let unit = field.unit;
            let is_there =
                table.contains(&format!("\n  {unit}: {{")) || table.contains(&format!("\n  '{unit}': {{"));
            assert!(is_there, "{}: {unit}", field.path);
        }
    }

    #[test]
    fn every_parameter_has_a_control() {
        let fields = fields();
        assert_eq!(fields.len(), Configuration::PARAMETERS.len());
        let field = |path: &str| fields.iter().find(|f| f.path == path).unwrap();
        assert_eq!(
            field("fasteners.kind").choices,
            Some(["screw", "nut-trap", "insert"].map(str::to_owned).to_vec())
        );
        assert_eq!((field("switch.name").kind, field("layout.pins").kind), ("text", "list"));
        assert_eq!(
            (field("segment.grooves").kind, field("segment.grooves").ends),
            ("whole", Some([1.0, 60.0]))
        );
        for field in &fields {
            assert_eq!(field.ends.is_some(), matches!(field.kind, "number" | "whole"), "{}", field.path);
        }
    }
}
