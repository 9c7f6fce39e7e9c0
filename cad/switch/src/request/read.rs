//! Reading a request from TOML. Unknown fields are refused with the known ones.

use std::collections::BTreeMap;
use std::ops::Range;

use pinswitch_diagnostic::codes;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use toml::Value;
use toml_edit::Document;

use super::phrase::{is_share, not_a_share, positive};
use super::{
    DEFAULT_WITHIN, Limits, Materials, Parameter, Quantity, Request, Requirement, Target, Tolerances, Varied,
    Vary, parse_requirement,
};
use crate::config::{Diagnostic, Location, ValueError};

/// The unvalidated content of a file.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct File {
    targets: Targets,
    #[serde(default)]
    limits: Limits,
    #[serde(default)]
    #[schemars(schema_with = "vary_schema")]
    vary: Option<BTreeMap<String, Value>>,
    #[serde(default)]
    materials: Materials,
    #[serde(default)]
    tolerances: Tolerances,
}

/// Table `[targets]`.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Targets {
    #[serde(default)]
    #[schemars(schema_with = "requirement_schema")]
    threshold_n: Option<Value>,
    #[serde(default)]
    #[schemars(schema_with = "requirement_schema")]
    max_friction_n: Option<Value>,
    #[serde(default)]
    #[schemars(schema_with = "requirement_schema")]
    low_load_friction_n: Option<Value>,
    #[serde(default)]
    #[schemars(schema_with = "requirement_schema")]
    stiffness: Option<Value>,
    #[serde(default)]
    friction: Vec<FrictionEntry>,
    load_range_n: Option<(f64, f64)>,
    within: Option<f64>,
}

/// One entry of `friction`.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FrictionEntry {
    load_n: f64,
    at_most_n: Option<f64>,
    at_least_n: Option<f64>,
    about_n: Option<f64>,
    within: Option<f64>,
}

/// The schema of a requirement: a number (about), a phrase, or a table.
fn requirement_schema(_: &mut SchemaGenerator) -> Schema {
    let above_0 = serde_json::json!({ "type": "number", "exclusiveMinimum": 0 });
    json_schema!({
        "anyOf": [
            above_0,
            { "type": "string" },
            {
                "type": "object",
                "properties": { "at_most": above_0, "at_least": above_0, "about": above_0, "within": above_0 },
                "additionalProperties": false,
            },
        ],
    })
}

/// The schema of `[vary]`: the known parameters, each in its default range or in one that the file gives.
fn vary_schema(_: &mut SchemaGenerator) -> Schema {
    let range = serde_json::json!({
        "anyOf": [
            { "type": "boolean" },
            { "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 },
        ],
    });
    let parameters = Parameter::ALL.iter().map(|parameter| (parameter.name().to_owned(), range.clone()));
    let mut properties: serde_json::Map<String, serde_json::Value> = parameters.collect();
    properties.insert("pattern".to_owned(), serde_json::json!({ "type": "boolean" }));
    json_schema!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// Returns the JSON Schema of a request.
pub fn request_schema() -> Schema {
    schemars::schema_for!(File)
}

impl Request {
    /// Reads a request; `file` names it in errors. Fields that are absent have the defaults of [`Request`].
    ///
    /// # Errors
    /// A [`Diagnostic`] with the place, the field, and the accepted values.
    ///
    /// ```
    /// use pinswitch_switch::request::Request;
    ///
    /// let text = "[targets]\nthreshold_n = 20\nmax_friction_n = 'at most 9'\n[vary]\nlayer_mm = [1, 3]\n";
    /// let request = Request::read(text, "my.toml")?;
    /// assert_eq!(request.targets[1].to_string(), "friction at the heaviest load at most 9 N");
    /// assert!(Request::read("[targets]\nthreshhold_n = 20\n", "my.toml").is_err());
    /// # Ok::<(), pinswitch_diagnostic::Diagnostic>(())
    /// ```
    pub fn read(text: &str, file: &str) -> Result<Self, Diagnostic> {
        let placed = |error: Diagnostic| {
            let field = error.location().and_then(|location| location.field.clone()).unwrap_or_default();
            error.or_at(&Location::in_text(file, text, span_of(&field, text)))
        };
        let parsed: File = toml::from_str(text).map_err(|e| {
            Diagnostic::new(codes::of_toml(e.message()), e.message().trim().replace('\n', ", "))
                .with_help("cad/doc/design.md shows the format")
                .with_location(Location::in_text(file, text, e.span().unwrap_or(0..0)))
        })?;
        let request = Self {
            targets: parsed.targets.targets().map_err(placed)?,
            load_range_n: parsed.targets.load_range_n,
            limits: parsed.limits,
            vary: parsed.vary.as_ref().map_or(Ok(Vary::default()), vary_of).map_err(placed)?,
            materials: parsed.materials,
            tolerances: parsed.tolerances,
        };
        request.check().map_err(placed)?;
        Ok(request)
    }
}

/// Returns the byte range of the field at a path, such as `targets.friction[0]`, or of the innermost
/// table on that path that the text contains.
fn span_of(path: &str, text: &str) -> Range<usize> {
    let span = text.parse::<Document<String>>().ok().and_then(|document| {
        let mut item = document.as_item().clone();
        let mut span = None;
        for key in path.split(['.', '[']) {
            let inner = match key.strip_suffix(']') {
                Some(index) => index.parse::<usize>().ok().and_then(|i| item.get(i)),
                None => item.get(key),
            };
            let Some(inner) = inner.cloned() else { break };
            span = inner.span().or(span);
            item = inner;
        }
        span
    });
    span.unwrap_or(0..0)
}

impl Targets {
    fn targets(&self) -> Result<Vec<Target>, Diagnostic> {
        let within = self.within.unwrap_or(DEFAULT_WITHIN);
        if !is_share(within) {
            return Err(not_a_share(&within.to_string()).in_field("targets.within", within.to_string()));
        }
        let single = [
            ("threshold_n", &self.threshold_n, Quantity::Threshold),
            ("max_friction_n", &self.max_friction_n, Quantity::MaxFriction),
            ("low_load_friction_n", &self.low_load_friction_n, Quantity::LowLoadFriction),
            ("stiffness", &self.stiffness, Quantity::Stiffness),
        ];
        let mut targets = Vec::new();
        for (field, value, quantity) in single {
            let Some(value) = value else { continue };
            let requirement = requirement_of(value, within)
                .map_err(|e| e.in_field(format!("targets.{field}"), value.to_string()))?;
            targets.push(Target { quantity, requirement });
        }
        for (i, entry) in self.friction.iter().enumerate() {
            let load = entry.load_n.to_string();
            let load_n = positive(entry.load_n)
                .map_err(|e| e.in_field(format!("targets.friction[{i}].load_n"), load))?;
            let bounds = [entry.at_most_n, entry.at_least_n, entry.about_n, entry.within];
            let requirement = requirement(bounds, within).map_err(|e| {
                e.in_field(format!("targets.friction[{i}]"), format!("load_n {}", entry.load_n))
            })?;
            targets.push(Target { quantity: Quantity::Friction { load_n }, requirement });
        }
        Ok(targets)
    }
}

/// A requirement as a number (about), a phrase or a table.
fn requirement_of(value: &Value, within: f64) -> Result<Requirement, ValueError> {
    match value {
        Value::String(text) => match parse_requirement(text, within)? {
            (requirement, None) => Ok(requirement),
            (_, Some(load)) => Err(ValueError::new(
                codes::INVALID_REQUIREMENT,
                format!("'at {load}' is only allowed in a friction"),
                "write it as an entry of targets.friction",
            )),
        },
        Value::Table(table) => {
            const KEYS: [&str; 4] = ["at_most", "at_least", "about", "within"];
            if let Some(key) = table.keys().find(|k| !KEYS.contains(&k.as_str())) {
                let help = format!("known are {}", KEYS.join(", "));
                return Err(ValueError::new(codes::UNKNOWN_FIELD, format!("unknown key {key}"), help));
            }
            let number = |key: &str| {
                let error = |v: &Value| {
                    ValueError::new(
                        codes::WRONG_TYPE,
                        format!("{key} = {v} is not a number"),
                        "give a number",
                    )
                };
                table.get(key).map(|v| float(v).ok_or_else(|| error(v))).transpose()
            };
            let [at_most, at_least, about, own_within] = KEYS.map(number);
            requirement([at_most?, at_least?, about?, own_within?], within)
        }
        other => {
            let error = || {
                ValueError::new(
                    codes::INVALID_REQUIREMENT,
                    "not a requirement",
                    "give a number, a phrase or a table",
                )
            };
            Ok(Requirement::About { value: positive(float(other).ok_or_else(error)?)?, within })
        }
    }
}

/// The requirement of upper bound, lower bound, nominal value, and the tolerance of the nominal value.
fn requirement(
    [at_most, at_least, about, own_within]: [Option<f64>; 4],
    within: f64,
) -> Result<Requirement, ValueError> {
    if own_within.is_some() && about.is_none() {
        return Err(ValueError::new(
            codes::CONFLICTING_SETTINGS,
            "within without about",
            "give both or neither",
        ));
    }
    match (at_most.map(positive).transpose()?, at_least.map(positive).transpose()?, about) {
        (Some(high), None, None) => Ok(Requirement::AtMost(high)),
        (None, Some(low), None) => Ok(Requirement::AtLeast(low)),
        (Some(high), Some(low), None) if low <= high => Ok(Requirement::Between(low, high)),
        (Some(high), Some(low), None) => Err(ValueError::new(
            codes::CONTRADICTORY_TARGETS,
            format!("at least {low} and at most {high} contradict each other"),
            "drop one, or widen it",
        )),
        (None, None, Some(value)) => {
            let within = own_within.unwrap_or(within);
            if !is_share(within) {
                return Err(not_a_share(&format!("within = {within}")));
            }
            Ok(Requirement::About { value: positive(value)?, within })
        }
        (None, None, None) => Err(ValueError::new(
            codes::INVALID_REQUIREMENT,
            "no requirement",
            "give at most, at least or about",
        )),
        _ => Err(ValueError::new(
            codes::CONFLICTING_SETTINGS,
            "about excludes at most and at least",
            "give about, or the other two",
        )),
    }
}

/// Table `[vary]`: `true` for a default range, a pair for a user-defined one.
fn vary_of(table: &BTreeMap<String, Value>) -> Result<Vary, Diagnostic> {
    let mut vary = Vary { pattern: true, parameters: Vec::new() };
    for (key, value) in table {
        let error = |problem: &str, help: &str| {
            ValueError::new(codes::WRONG_TYPE, problem, help)
                .in_field(format!("vary.{key}"), value.to_string())
        };
        if key == "pattern" {
            vary.pattern = value.as_bool().ok_or_else(|| error("not a boolean", "give true or false"))?;
            continue;
        }
        let parameter = Parameter::from_name(key).ok_or_else(|| {
            let known: Vec<_> = Parameter::ALL.iter().map(|p| p.name()).collect();
            error("unknown parameter", &format!("known are pattern, {}", known.join(", ")))
        })?;
        match value {
            Value::Boolean(true) => vary.parameters.push(Varied::by_default(parameter)),
            Value::Boolean(false) => {}
            Value::Array(pair) if pair.len() == 2 => {
                let ends: Option<Vec<f64>> = pair.iter().map(float).collect();
                let ends = ends.ok_or_else(|| error("not a range", "give two numbers"))?;
                vary.parameters.push(Varied { parameter, from: ends[0], to: ends[1] });
            }
            _ => return Err(error("not a range", "give true, false or a range such as [1.0, 3.0]")),
        }
    }
    Ok(vary)
}

#[allow(clippy::cast_precision_loss)]
fn float(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|i| i as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_complete_request_is_read() {
        let text = r#"
[targets]
threshold_n = { about = 20, within = 0.15 }
low_load_friction_n = "at most 0.2"
stiffness = { at_least = 1.8 }
friction = [ { load_n = 50, at_most_n = 8 }, { load_n = 30, about_n = 4 } ]
load_range_n = [3, 60]
[limits]
pins = [3, 6]
outer_radius_mm = 30
preset = "printer-fff-0.4"
[vary]
layer_mm = [1.0, 3.0]
pitch_deg = true
hardness_shore_a = false
[materials]
pin_diameter_mm = [0.8, 1.0]
tendon = [ { rope_diameter_mm = 1.0, coating_mm = 0.2 } ]
[tolerances]
groove_diameter_mm = 0.02
"#;
        let request = Request::read(text, "a.toml").unwrap();
        assert_eq!(request.targets.len(), 5);
        assert_eq!(request.targets[0].requirement, Requirement::About { value: 20.0, within: 0.15 });
        assert_eq!(request.targets[4].requirement, Requirement::About { value: 4.0, within: DEFAULT_WITHIN });
        assert_eq!(request.vary.parameters.len(), 2);
        assert_eq!(request.limits.pins, Some((3, 6)));
        assert_eq!(request.tolerances.layer_mm, Tolerances::default().layer_mm);
    }

    #[test]
    fn errors_name_place_and_accepted_values() {
        for (text, words) in [
            ("[targets]\nthreshhold_n = 20", &["threshhold_n", "threshold_n"][..]),
            ("[targets]\nthreshold_n = -3", &["a.toml:2:15: targets.threshold_n", "above 0"]),
            (
                "[targets]\nthreshold_n = 9\nfriction = [\n  { load_n = 5, at_most_n = 2 },\n  { load_n = 5 },\n]",
                &["a.toml:5:3: targets.friction[1]"],
            ),
            ("[targets]\nthreshold_n = 'roughly 3'", &["targets.threshold_n", "at most 8"]),
            ("[targets]\nthreshold_n = { around = 3 }", &["around", "at_most"]),
            ("[targets]\nthreshold_n = 20\n[vary]\nthickness = true", &["vary.thickness", "layer_mm"]),
            ("[targets]\nthreshold_n = 20\n[vary]\nlayer_mm = [3, 1]", &["vary.layer_mm", "reversed"]),
            ("[targets]\nfriction = [{ load_n = 5 }]", &["targets.friction[0]", "no requirement"]),
            (
                "[targets]\nfriction = [{ load_n = 5, at_most_n = 2, at_least_n = 3 }]",
                &["at least 3 and at most 2"],
            ),
            ("[targets]", &["no target"]),
            ("targets = 3", &["a.toml"]),
            ("[targets]\nthreshold_n = 20\n[materials]\nrods = [1]", &["rods", "pin_diameter_mm"]),
            ("[targets]\nthreshold_n = 20\n[tolerances]\nlayer_mm = -1", &["tolerances.layer_mm"]),
        ] {
            let error = Request::read(text, "a.toml").unwrap_err().to_string();
            assert!(words.iter().all(|w| error.contains(w)), "{text}: {error}");
            assert!(error.starts_with("a.toml:"), "{text}: {error}");
        }
    }
}
