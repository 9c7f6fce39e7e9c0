//! An ask from its file, TOML. Unknown fields are refused with the known ones.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Value;
use toml_edit::Document;

use super::phrase::positive;
use super::{
    Ask, AskError, DEFAULT_WITHIN, Limits, Materials, Parameter, Quantity, Target, Tolerances, Varied, Vary,
    Wish, parse_wish,
};
use crate::config::Place;

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    ask: Targets,
    #[serde(default)]
    limits: Limits,
    vary: Option<BTreeMap<String, Value>>,
    #[serde(default)]
    materials: Materials,
    #[serde(default)]
    tolerances: Tolerances,
}

/// Table `[ask]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Targets {
    threshold_n: Option<Value>,
    max_friction_n: Option<Value>,
    low_load_friction_n: Option<Value>,
    stiffness: Option<Value>,
    #[serde(default)]
    friction: Vec<FrictionEntry>,
    load_range_n: Option<(f64, f64)>,
    within: Option<f64>,
}

/// One entry of `friction`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FrictionEntry {
    load_n: f64,
    at_most_n: Option<f64>,
    at_least_n: Option<f64>,
    about_n: Option<f64>,
    within: Option<f64>,
}

impl Ask {
    /// Reads an ask; `file` is the name used in errors. What the file leaves out has the defaults of [`Ask`].
    ///
    /// # Errors
    /// [`AskError`] names file and field, and what would be accepted.
    ///
    /// ```
    /// use pinswitch_switch::ask::Ask;
    ///
    /// let ask = Ask::read("[ask]\nthreshold_n = 20\nmax_friction_n = 'at most 9'\n[vary]\nlayer_mm = [1, 3]\n", "my.toml")?;
    /// assert_eq!(ask.targets[1].to_string(), "friction at the heaviest load at most 9 N");
    /// assert!(Ask::read("[ask]\nthreshhold_n = 20\n", "my.toml").is_err());
    /// # Ok::<(), pinswitch_switch::ask::AskError>(())
    /// ```
    pub fn read(text: &str, file: &str) -> Result<Self, AskError> {
        let named = |e: String| AskError(format!("{}: {e}", place_of(&e, text, file)));
        let parsed: File = toml::from_str(text).map_err(|e| {
            let place = Place::new(file, text, e.span().map_or(0, |span| span.start));
            AskError(format!(
                "{place}: {}; cad/doc/design.md shows the form",
                e.message().trim().replace('\n', ", ")
            ))
        })?;
        let ask = Self {
            targets: parsed.ask.targets().map_err(named)?,
            load_range_n: parsed.ask.load_range_n,
            limits: parsed.limits,
            vary: parsed.vary.as_ref().map_or(Ok(Vary::default()), vary_of).map_err(named)?,
            materials: parsed.materials,
            tolerances: parsed.tolerances,
        };
        ask.check().map_err(|e| named(e.0))?;
        Ok(ask)
    }
}

/// The place of the field that an error begins with, such as `ask.friction[0]`; of the innermost table that is there, if
/// the field itself is not.
fn place_of(error: &str, text: &str, file: &str) -> Place {
    let is_of_a_path = |c: char| c.is_ascii_alphanumeric() || "_.[]".contains(c);
    let path = error.split(|c| !is_of_a_path(c)).next().unwrap_or_default();
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
    Place::new(file, text, span.map_or(0, |span| span.start))
}

impl Targets {
    fn targets(&self) -> Result<Vec<Target>, String> {
        let within = self.within.unwrap_or(DEFAULT_WITHIN);
        if !(within > 0.0 && within < 1.0) {
            return Err(format!(
                "ask.within = {within} is no share; give one above 0 and below 1, such as 0.1"
            ));
        }
        let single = [
            ("threshold_n", &self.threshold_n, Quantity::Threshold),
            ("max_friction_n", &self.max_friction_n, Quantity::MaxFriction),
            ("low_load_friction_n", &self.low_load_friction_n, Quantity::LowLoadFriction),
            ("stiffness", &self.stiffness, Quantity::Stiffness),
        ];
        let mut targets = Vec::new();
        for (field, value, quantity) in single {
            if let Some(value) = value {
                let wish = wish_of(value, within).map_err(|e| format!("ask.{field} = {value}: {e}"))?;
                targets.push(Target { quantity, wish });
            }
        }
        for (i, entry) in self.friction.iter().enumerate() {
            let named = |e: String| format!("ask.friction[{i}]: {e}");
            let load_n = positive(entry.load_n).map_err(|e| named(format!("load_n: {e}")))?;
            let wish = wish(entry.at_most_n, entry.at_least_n, entry.about_n, entry.within, within)
                .map_err(|e| named(e.replace("about ", "about_n ")))?;
            targets.push(Target { quantity: Quantity::Friction { load_n }, wish });
        }
        Ok(targets)
    }
}

/// A wish as a number (about), a sentence or a table.
fn wish_of(value: &Value, within: f64) -> Result<Wish, String> {
    match value {
        Value::String(text) => match parse_wish(text, within)? {
            (wish, None) => Ok(wish),
            (_, Some(load)) => {
                Err(format!("'at {load}' belongs to a friction; write it as an entry of ask.friction"))
            }
        },
        Value::Table(table) => {
            const KEYS: [&str; 4] = ["at_most", "at_least", "about", "within"];
            if let Some(key) = table.keys().find(|k| !KEYS.contains(&k.as_str())) {
                return Err(format!("{key} is unknown here; known are {}", KEYS.join(", ")));
            }
            let number = |key: &str| {
                table
                    .get(key)
                    .map(|v| float(v).ok_or_else(|| format!("{key} = {v} is no number")))
                    .transpose()
            };
            wish(number("at_most")?, number("at_least")?, number("about")?, number("within")?, within)
        }
        other => {
            let number = float(other).ok_or("give a number, a sentence or a table")?;
            Ok(Wish::About { value: positive(number)?, within })
        }
    }
}

fn wish(
    at_most: Option<f64>,
    at_least: Option<f64>,
    about: Option<f64>,
    own_within: Option<f64>,
    within: f64,
) -> Result<Wish, String> {
    if own_within.is_some() && about.is_none() {
        return Err("within belongs to about; give both or neither".to_owned());
    }
    match (at_most.map(positive).transpose()?, at_least.map(positive).transpose()?, about) {
        (Some(high), None, None) => Ok(Wish::AtMost(high)),
        (None, Some(low), None) => Ok(Wish::AtLeast(low)),
        (Some(high), Some(low), None) if low <= high => Ok(Wish::Between(low, high)),
        (Some(high), Some(low), None) => {
            Err(format!("at least {low} and at most {high} cannot both hold; drop one, or widen it"))
        }
        (None, None, Some(value)) => {
            let within = own_within.unwrap_or(within);
            if within > 0.0 && within < 1.0 {
                Ok(Wish::About { value: positive(value)?, within })
            } else {
                Err(format!("within = {within} is no share; give one above 0 and below 1, such as 0.1"))
            }
        }
        (None, None, None) => Err("nothing is wanted; give at most, at least or about".to_owned()),
        _ => Err("about stands alone; drop at most and at least".to_owned()),
    }
}

/// Table `[vary]`: `true` for a default range, a pair for a range of one's own.
fn vary_of(table: &BTreeMap<String, Value>) -> Result<Vary, String> {
    let mut vary = Vary { pattern: true, parameters: Vec::new() };
    for (key, value) in table {
        if key == "pattern" {
            vary.pattern =
                value.as_bool().ok_or_else(|| format!("vary.pattern = {value}: give true or false"))?;
            continue;
        }
        let parameter = Parameter::named(key).ok_or_else(|| {
            let known: Vec<_> = Parameter::ALL.iter().map(|p| p.name()).collect();
            format!("vary.{key} is unknown; known are pattern, {}", known.join(", "))
        })?;
        match value {
            Value::Boolean(true) => vary.parameters.push(Varied::by_default(parameter)),
            Value::Boolean(false) => {}
            Value::Array(pair) if pair.len() == 2 => {
                let ends: Option<Vec<f64>> = pair.iter().map(float).collect();
                let ends = ends.ok_or_else(|| format!("vary.{key} = {value}: give two numbers"))?;
                vary.parameters.push(Varied { parameter, from: ends[0], to: ends[1] });
            }
            other => {
                return Err(format!("vary.{key} = {other}: give true, false or a range such as [1.0, 3.0]"));
            }
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
    fn a_whole_ask_is_read() {
        let text = r#"
[ask]
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
        let ask = Ask::read(text, "a.toml").unwrap();
        assert_eq!(ask.targets.len(), 5);
        assert_eq!(ask.targets[0].wish, Wish::About { value: 20.0, within: 0.15 });
        assert_eq!(ask.targets[4].wish, Wish::About { value: 4.0, within: DEFAULT_WITHIN });
        assert_eq!(ask.vary.parameters.len(), 2);
        assert_eq!(ask.limits.pins, Some((3, 6)));
        assert_eq!(ask.tolerances.layer_mm, Tolerances::default().layer_mm);
    }

    #[test]
    fn what_cannot_be_read_says_what_would_be() {
        for (text, words) in [
            ("[ask]\nthreshhold_n = 20", &["threshhold_n", "threshold_n"][..]),
            ("[ask]\nthreshold_n = -3", &["a.toml:2: ask.threshold_n", "above 0"]),
            (
                "[ask]\nthreshold_n = 9\nfriction = [\n  { load_n = 5, at_most_n = 2 },\n  { load_n = 5 },\n]",
                &["a.toml:5: ask.friction[1]"],
            ),
            ("[ask]\nthreshold_n = 'roughly 3'", &["ask.threshold_n", "at most 8"]),
            ("[ask]\nthreshold_n = { around = 3 }", &["around", "at_most"]),
            ("[ask]\nthreshold_n = 20\n[vary]\nthickness = true", &["vary.thickness", "layer_mm"]),
            ("[ask]\nthreshold_n = 20\n[vary]\nlayer_mm = [3, 1]", &["vary.layer_mm", "backwards"]),
            ("[ask]\nfriction = [{ load_n = 5 }]", &["ask.friction[0]", "nothing is wanted"]),
            (
                "[ask]\nfriction = [{ load_n = 5, at_most_n = 2, at_least_n = 3 }]",
                &["at least 3 and at most 2"],
            ),
            ("[ask]", &["nothing is asked"]),
            ("ask = 3", &["a.toml"]),
            ("[ask]\nthreshold_n = 20\n[materials]\nrods = [1]", &["rods", "pin_diameter_mm"]),
            ("[ask]\nthreshold_n = 20\n[tolerances]\nlayer_mm = -1", &["tolerances.layer_mm"]),
        ] {
            let error = Ask::read(text, "a.toml").unwrap_err().to_string();
            assert!(words.iter().all(|w| error.contains(w)), "{text}: {error}");
            assert!(error.starts_with("a.toml:"), "{text}: {error}");
        }
    }
}
