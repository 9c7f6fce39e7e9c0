//! What the page needs once: every field with its control, templates, formats.

use pinswitch_switch::config::{Configuration, Origin, read};
use pinswitch_switch::documents::toml_to_json;
use pinswitch_switch::formats::{FORMATS, Inclusion};
use pinswitch_switch::templates::{TEMPLATES, TemplateKind};
use serde::Serialize;
use toml_edit::Value;

use crate::calibration::MAX_TABLE_MB;
use crate::request::Values;
use crate::values::changed_values;

/// The answer to `facts`.
#[derive(Debug, Serialize)]
pub(crate) struct Facts {
    generator: String,
    fields: Vec<Field>,
    templates: Vec<TemplateFact>,
    formats: Vec<FormatFact>,
    /// Largest accepted table of plateaus, in megabytes.
    largest_table_mb: usize,
}

/// One field of a configuration.
#[derive(Debug, Serialize)]
struct Field {
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

#[derive(Debug, Serialize)]
struct TemplateFact {
    name: &'static str,
    kind: &'static str,
    about: &'static str,
    values: Values,
}

#[derive(Debug, Serialize)]
struct FormatFact {
    name: &'static str,
    about: &'static str,
    /// Whether a set contains it by default.
    default: bool,
}

/// Collects the facts from the tables of parameters, templates and formats.
pub(crate) fn facts() -> Facts {
    Facts {
        generator: concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned(),
        fields: fields(),
        templates: TEMPLATES
            .iter()
            .filter_map(|template| {
                let (configuration, _) = read(template.text, template.name).ok()?;
                Some(TemplateFact {
                    name: template.name,
                    kind: match template.kind {
                        TemplateKind::Published => "published",
                        TemplateKind::Printer => "printer",
                    },
                    about: template.description(),
                    values: changed_values(&configuration),
                })
            })
            .collect(),
        formats: FORMATS
            .iter()
            .filter(|format| format.inclusion != Inclusion::Always)
            .map(|format| FormatFact {
                name: format.name,
                about: format.about,
                default: format.inclusion == Inclusion::Default,
            })
            .collect(),
        largest_table_mb: MAX_TABLE_MB,
    }
}

fn fields() -> Vec<Field> {
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
        let script = include_str!("../page/quantity.js");
        let (_, table) = script.split_once("const QUANTITY_UNITS = {").unwrap();
        let (table, _) = table.split_once("\n};").unwrap();
        for field in facts().fields.iter().filter(|field| !field.unit.is_empty()) {
            let unit = field.unit;
            let is_there =
                table.contains(&format!("\n  {unit}: {{")) || table.contains(&format!("\n  '{unit}': {{"));
            assert!(is_there, "{}: {unit}", field.path);
        }
    }

    #[test]
    fn every_parameter_has_a_control() {
        let facts = facts();
        assert_eq!(facts.fields.len(), Configuration::PARAMETERS.len());
        let field = |path: &str| facts.fields.iter().find(|f| f.path == path).unwrap();
        assert_eq!(
            field("fasteners.kind").choices,
            Some(["screw", "nut-trap", "insert"].map(str::to_owned).to_vec())
        );
        assert_eq!((field("switch.name").kind, field("layout.pins").kind), ("text", "list"));
        assert_eq!(
            (field("segment.grooves").kind, field("segment.grooves").ends),
            ("whole", Some([1.0, 60.0]))
        );
        for field in &facts.fields {
            assert_eq!(field.ends.is_some(), matches!(field.kind, "number" | "whole"), "{}", field.path);
        }
        assert_eq!(facts.templates.len(), TEMPLATES.len());
        assert!(facts.formats.iter().any(|f| f.name == "step" && !f.default));
    }
}
