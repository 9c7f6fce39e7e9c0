//! Reading a configuration from TOML: every error names file, line, field, value, bound and remedy.

use std::ops::Range;

use toml_edit::{Document, Item, TableLike, Value};

use super::parameter::Parameter;
use super::parameters::Configuration;
use super::{ConfigError, Place};

/// Reads `text`; `file` names it in errors.
///
/// # Errors
/// [`ConfigError`] for text that is no TOML, an unknown key, or a value out of its range.
pub fn read(text: &str, file: &str) -> Result<(Configuration, Places), ConfigError> {
    read_over(Configuration::default(), text, file)
}

/// Reads `text` over `base`, such as a preset: every value that the text sets wins, also one that is the default.
///
/// # Errors
/// As [`read`].
pub fn read_over(
    base: Configuration,
    text: &str,
    file: &str,
) -> Result<(Configuration, Places), ConfigError> {
    let at = |span: Option<Range<usize>>| Place::new(file, text, span.map_or(0, |s| s.start));
    let document: Document<String> =
        text.parse().map_err(|e: toml_edit::TomlError| ConfigError::syntax(at(e.span()), e.message()))?;
    let mut configuration = base;
    let mut places = Places::default();
    for (table, item) in document.as_table().iter() {
        let place = at(key_span(document.as_table(), table));
        let entries = item.as_table_like().filter(|_| sections().contains(&table)).ok_or_else(|| {
            another_kind(document.as_table(), &place).unwrap_or_else(|| no_table(table, item, place.clone()))
        })?;
        for (key, item) in entries.iter() {
            let place = at(item.span().or_else(|| key_span(entries, key)));
            let parameter = find(table, key, at(key_span(entries, key)))?;
            let value = item.as_value().ok_or_else(|| {
                ConfigError::new(parameter.path(), display(item), "give a single value".to_owned())
                    .at(place.clone())
            })?;
            set(&mut configuration, parameter, value).map_err(|e| e.at(place.clone()))?;
            places.0.push((parameter.path(), place));
        }
    }
    Ok((configuration, places))
}

/// Sets `section.key=value` in `configuration`, as `--set` does.
///
/// # Errors
/// [`ConfigError`] for an unknown key or a value out of its range.
pub fn assign(configuration: &mut Configuration, assignment: &str) -> Result<(), ConfigError> {
    let place = Place { file: "--set".to_owned(), line: None };
    let (path, value) = assignment.split_once('=').ok_or_else(|| {
        ConfigError::syntax(place.clone(), &format!("{assignment:?} is no assignment; write table.key=value"))
    })?;
    let (table, key) =
        path.trim().split_once('.').ok_or_else(|| no_field(path.trim(), value.trim(), place.clone()))?;
    if !sections().contains(&table) {
        return Err(unknown(table, &sections(), "table", place));
    }
    let parameter = find(table, key, place.clone())?;
    // A bare word is taken as text, so that --set support.slots=occupied works without quotes in quotes.
    let value = value.trim().parse::<Value>().unwrap_or_else(|_| Value::from(value.trim()));
    set(configuration, parameter, &value).map_err(|e| e.at(place))
}

/// The error of an assignment to a name without a table, or to a table.
fn no_field(name: &str, value: &str, place: Place) -> ConfigError {
    let of = |is_meant: &dyn Fn(&Parameter<Configuration>) -> bool| {
        Configuration::PARAMETERS.iter().find(|p| is_meant(p)).map(Parameter::path)
    };
    let remedy = match (of(&|p| p.section == name), of(&|p| p.key == name)) {
        (Some(path), _) => format!("it is a table: set one of its values, as in --set {path}={value}"),
        (None, Some(path)) => format!("write it with its table, as in --set {path}={value}"),
        (None, None) => format!("write TABLE.KEY=VALUE; tables are {}", sections().join(", ")),
    };
    ConfigError {
        field: if name.is_empty() { "the name before '='".to_owned() } else { name.to_owned() },
        value: None,
        problem: if name.is_empty() { "is missing" } else { "is no field" }.to_owned(),
        remedy,
        changes: Vec::new(),
        place: Some(place),
    }
}

impl Configuration {
    /// The value of the parameter called `path`, as a person would write it; `None` for no parameter.
    pub fn shown(&self, path: &str) -> Option<String> {
        let parameter = Self::PARAMETERS.iter().find(|p| p.path() == path)?;
        Some(match (parameter.get)(self) {
            Value::Float(number) => number.value().to_string(),
            other => other.decorated("", "").to_string(),
        })
    }
}

/// The place of each value that a file sets.
#[derive(Clone, Debug, Default)]
pub struct Places(Vec<(String, Place)>);

impl Places {
    /// Whether the file sets `field`.
    pub fn sets(&self, field: &str) -> bool {
        self.of(field).is_some()
    }

    /// The place of `field`, if the file sets it.
    pub fn of(&self, field: &str) -> Option<&Place> {
        self.0.iter().find(|(path, _)| path == field).map(|(_, place)| place)
    }
}

fn set(
    c: &mut Configuration,
    parameter: &Parameter<Configuration>,
    value: &Value,
) -> Result<(), ConfigError> {
    (parameter.set)(c, value).map_err(|remedy| ConfigError {
        changes: nearest(parameter, value).into_iter().collect(),
        ..ConfigError::new(parameter.path(), value.clone().decorated("", "").to_string(), remedy)
    })
}

/// The nearest number that `parameter` takes, as the change that mends a number beyond its ends.
fn nearest(parameter: &Parameter<Configuration>, value: &Value) -> Option<(String, String)> {
    #[allow(clippy::cast_precision_loss)]
    let number = value.as_float().or_else(|| value.as_integer().map(|i| i as f64))?;
    let [low, high] = (parameter.ends)()?;
    let taken = if number.is_nan() { return None } else { number.clamp(low, high) };
    // What lies between them and is refused nevertheless, such as 3.5 grooves, words alone mend.
    (taken != number).then(|| (parameter.path(), taken.to_string()))
}

/// The error of a name at the top that is none of a table, or holds none.
fn no_table(name: &str, item: &Item, place: Place) -> ConfigError {
    if !sections().contains(&name) {
        return unknown(name, &sections(), "table", place);
    }
    ConfigError::new(name, display(item), format!("write it as a table: [{name}]")).at(place)
}

/// Tables and keys that only another kind of file has, with what it is and which command reads it (FILE stands for it).
const OTHER_KINDS: [(&[&str], &str, &str); 7] = [
    (&["sweep", "axes", "constraints", "set"], "a sweep", "`pinswitch batch FILE` makes its variants"),
    (&["ask"], "an ask for a design", "`pinswitch design --ask FILE` reads it"),
    (&["effect"], "a file of effects", "`pinswitch calibrate TABLE --effects FILE` reads it"),
    (
        &["effects", "noise", "protocol", "weights_g", "repetitions", "constants"],
        "a rig to simulate",
        "`pinswitch simulate FILE` reads it",
    ),
    (&["series", "rig"], "a run with its logs", "`pinswitch segment FILE` reads it"),
    (
        &["loads_g", "minutes_per_load_change", "minutes_per_mount_change"],
        "what a rig can do",
        "`pinswitch experiment DIR --rig FILE` reads it",
    ),
    (
        &["schema"],
        "a file that pinswitch wrote",
        "a model.toml goes with `--model FILE`, discovered.toml with `calibrate TABLE --effects FILE`",
    ),
];

/// Says so where a whole file is of another kind. One that has a table of a configuration is a configuration, with a word in it that
/// is none.
fn another_kind(document: &dyn TableLike, place: &Place) -> Option<ConfigError> {
    let has_table = |section: &&str| document.get(section).is_some_and(Item::is_table_like);
    if sections().iter().any(has_table) {
        return None;
    }
    let (key, kind, remedy) = OTHER_KINDS.iter().find_map(|(keys, kind, remedy)| {
        keys.iter().find(|key| document.contains_key(key)).map(|key| (key, kind, remedy))
    })?;
    Some(ConfigError {
        field: (*key).to_owned(),
        value: None,
        problem: format!("is of no configuration: this is {kind}"),
        remedy: remedy.replace("FILE", &place.file),
        changes: Vec::new(),
        place: Some(place.clone()),
    })
}

fn sections() -> Vec<&'static str> {
    let mut all: Vec<_> = Configuration::PARAMETERS.iter().map(|p| p.section).collect();
    all.dedup();
    all
}

fn find(table: &str, key: &str, place: Place) -> Result<&'static Parameter<Configuration>, ConfigError> {
    let in_table = || Configuration::PARAMETERS.iter().filter(|p| p.section == table);
    in_table().find(|p| p.key == key).ok_or_else(|| {
        let keys: Vec<_> = in_table().map(|p| p.key).collect();
        let mut error = unknown(key, &keys, "key", place);
        error.field = format!("{table}.{key}");
        error
    })
}

/// An unknown word, with the nearest known one.
fn unknown(word: &str, known: &[&str], what: &str, place: Place) -> ConfigError {
    let nearest =
        known.iter().max_by(|a, b| strsim::jaro_winkler(word, a).total_cmp(&strsim::jaro_winkler(word, b)));
    let remedy = match nearest {
        Some(near) if strsim::jaro_winkler(word, near) > 0.7 => {
            format!("did you mean {near:?}? templates/reference.toml lists all")
        }
        _ => format!("known are {}", known.join(", ")),
    };
    ConfigError {
        field: word.to_owned(),
        value: None,
        problem: format!("is no known {what}"),
        remedy,
        changes: Vec::new(),
        place: Some(place),
    }
}

fn key_span(table: &dyn TableLike, key: &str) -> Option<Range<usize>> {
    table.get_key_value(key).and_then(|(key, item)| key.span().or_else(|| item.span()))
}

fn display(item: &Item) -> String {
    item.type_name().to_owned()
}
