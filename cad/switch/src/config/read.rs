//! Reading a configuration from TOML. Every error names the field, and its place in the text.

use std::ops::Range;

use pinswitch_diagnostic::{Change, Diagnostic, Location, codes};
use toml_edit::{Document, Item, TableLike, Value};

use super::error::{ValueError, field_location, syntax_error};
use super::parameter::{Parameter, number};
use super::parameters::Configuration;

/// Similarity (Jaro-Winkler) from which a known word is suggested for an unknown one.
const SIMILAR: f64 = 0.7;

/// Reads `text`; `file` names it in errors.
///
/// # Errors
/// A [`Diagnostic`] for invalid TOML, an unknown key, or a value that its field does not accept.
pub fn read(text: &str, file: &str) -> Result<(Configuration, FieldLocations), Diagnostic> {
    read_over(Configuration::default(), text, file)
}

/// Reads `text` over `base`, such as a preset: every value in the text replaces that of `base`, defaults too.
///
/// # Errors
/// As [`read`].
pub fn read_over(
    base: Configuration,
    text: &str,
    file: &str,
) -> Result<(Configuration, FieldLocations), Diagnostic> {
    let reading = read_clamped(base, text, file)?;
    match reading.out_of_range.into_iter().next() {
        Some(error) => Err(error),
        None => Ok((reading.configuration, reading.locations)),
    }
}

/// A text read as a configuration, with each number outside the range of its field replaced by the nearest end of the
/// range.
#[derive(Clone, Debug)]
pub struct ClampedReading {
    /// The configuration; all values are within their ranges.
    pub configuration: Configuration,
    /// Locations of the values in the text.
    pub locations: FieldLocations,
    /// Errors of the numbers that were replaced, in the order of the text.
    pub out_of_range: Vec<Diagnostic>,
}

/// Reads `text` over `base` as [`read_over`] does, and clamps numbers to the ranges of their fields.
///
/// # Errors
/// As [`read`], apart from numbers out of range.
pub fn read_clamped(base: Configuration, text: &str, file: &str) -> Result<ClampedReading, Diagnostic> {
    let mut reading = ClampedReading {
        configuration: base,
        locations: FieldLocations::default(),
        out_of_range: Vec::new(),
    };
    match read_into(&mut reading, text, file) {
        // The first error of the text comes first, whatever its kind.
        Err(error) => Err(reading.out_of_range.into_iter().next().unwrap_or(error)),
        Ok(()) => Ok(reading),
    }
}

fn read_into(reading: &mut ClampedReading, text: &str, file: &str) -> Result<(), Diagnostic> {
    let at = |span: Option<Range<usize>>| Location::in_text(file, text, span.unwrap_or(0..0));
    let document: Document<String> =
        text.parse().map_err(|e: toml_edit::TomlError| syntax_error(at(e.span()), e.message()))?;
    for (table, item) in document.as_table().iter() {
        let location = at(key_span(document.as_table(), table));
        let is_ours = sections().contains(&table) && !is_of_a_run(document.as_table(), table);
        let entries = item.as_table_like().filter(|_| is_ours).ok_or_else(|| {
            other_kind_of_file(document.as_table(), file)
                .unwrap_or_else(|| not_a_table(table, item))
                .or_at(&location)
        })?;
        for (key, item) in entries.iter() {
            let parameter = find(table, key).map_err(|e| e.or_at(&at(key_span(entries, key))))?;
            let location = at(item.span().or_else(|| key_span(entries, key)));
            let value = item.as_value().ok_or_else(|| {
                Diagnostic::new(codes::WRONG_TYPE, "not a single value")
                    .with_help(format!("give {}", (parameter.range)()))
                    .with_location(Location::field(parameter.path(), item.type_name()))
                    .or_at(&location)
            })?;
            if let Err(error) = set(&mut reading.configuration, parameter, value) {
                let error = error.or_at(&location);
                match error.changes().first().and_then(|change| change.value.parse::<Value>().ok()) {
                    Some(nearest) if (parameter.set)(&mut reading.configuration, &nearest).is_ok() => {
                        reading.out_of_range.push(error);
                    }
                    _ => return Err(error),
                }
            }
            reading.locations.0.push((parameter.path(), location));
        }
    }
    Ok(())
}

/// Sets a value from `section.key=value`, as `--set` does.
///
/// # Errors
/// A [`Diagnostic`] without a file for an unknown key or a value that the field does not accept.
pub fn assign(configuration: &mut Configuration, assignment: &str) -> Result<(), Diagnostic> {
    let Some((path, value)) = assignment.split_once('=') else {
        let problem = format!("{assignment:?} is not an assignment");
        return Err(Diagnostic::new(codes::MALFORMED_VALUE, problem).with_help("write TABLE.KEY=VALUE"));
    };
    let (path, value) = (path.trim(), value.trim());
    let (table, key) = path.split_once('.').ok_or_else(|| incomplete_path(path, value))?;
    if !sections().contains(&table) {
        return Err(unknown(table, &sections(), "table"));
    }
    let parameter = find(table, key)?;
    // A bare word is a text: --set support.slots=occupied needs no quotes within quotes.
    let value = value.parse::<Value>().unwrap_or_else(|_| Value::from(value));
    set(configuration, parameter, &value)
}

/// The error of an assignment to a table, or to a key without its table.
fn incomplete_path(name: &str, value: &str) -> Diagnostic {
    let path_of = |is_meant: &dyn Fn(&Parameter<Configuration>) -> bool| {
        Configuration::PARAMETERS.iter().find(|p| is_meant(p)).map(Parameter::path)
    };
    let (code, problem, help) = match (path_of(&|p| p.section == name), path_of(&|p| p.key == name)) {
        (Some(path), _) => (
            codes::WRONG_TYPE,
            "a table, not a value",
            format!("set one of its values: --set {path}={value}"),
        ),
        (None, Some(path)) => {
            (codes::UNKNOWN_FIELD, "key without its table", format!("write --set {path}={value}"))
        }
        (None, None) => {
            let (code, problem) = match name {
                "" => (codes::MALFORMED_VALUE, "no field before '='"),
                _ => (codes::UNKNOWN_FIELD, "unknown field"),
            };
            (code, problem, format!("write TABLE.KEY=VALUE; the tables are {}", sections().join(", ")))
        }
    };
    let error = Diagnostic::new(code, problem).with_help(help);
    if name.is_empty() { error } else { error.with_location(field_location(name)) }
}

impl Configuration {
    /// Returns the value of the parameter called `path` as a person would write it; `None` for an unknown parameter.
    pub fn shown(&self, path: &str) -> Option<String> {
        let parameter = Self::PARAMETERS.iter().find(|p| p.path() == path)?;
        Some(shown(&(parameter.get)(self)))
    }
}

/// A TOML value as a person would write it: `8.5`, `15`, `"screw"`; whole floats without a decimal point.
pub(crate) fn shown(value: &Value) -> String {
    match value {
        Value::Float(number) => number.value().to_string(),
        other => other.clone().decorated("", "").to_string(),
    }
}

/// Locations of the values that a file sets.
#[derive(Clone, Debug, Default)]
pub struct FieldLocations(Vec<(String, Location)>);

impl FieldLocations {
    /// Whether the file sets `field`.
    pub fn contains(&self, field: &str) -> bool {
        self.get(field).is_some()
    }

    /// Returns the location of the value of `field`, if the file sets it.
    pub fn get(&self, field: &str) -> Option<&Location> {
        self.0.iter().find(|(path, _)| path == field).map(|(_, location)| location)
    }
}

/// Words that a newer one replaces: the field, the word, and the help.
const REPLACED: [(&str, &str, &str); 1] =
    [("mount.kind", "finger-link", "give \"joint\": two links on an axle on the pulley's axis")];

/// The error of a word that a newer one replaces; `error` for any other value.
fn replaced(parameter: &Parameter<Configuration>, value: &Value, error: ValueError) -> ValueError {
    let is_same =
        |(field, word, _): &&(&str, &str, &str)| *field == parameter.path() && value.as_str() == Some(*word);
    REPLACED
        .iter()
        .find(is_same)
        .map_or(error, |(_, _, help)| ValueError::new(codes::UNKNOWN_WORD, "no longer a kind", *help))
}

fn set(c: &mut Configuration, parameter: &Parameter<Configuration>, value: &Value) -> Result<(), Diagnostic> {
    (parameter.set)(c, value).map_err(|error| {
        replaced(parameter, value, error)
            .in_field(parameter.path(), value.clone().decorated("", "").to_string())
            .with_changes(nearest(parameter, value).into_iter().collect())
    })
}

/// The change of a number outside its range to the nearest end of the range.
fn nearest(parameter: &Parameter<Configuration>, value: &Value) -> Option<Change> {
    let number = number(value).filter(|number| !number.is_nan())?;
    let [low, high] = (parameter.ends)()?;
    let clamped = number.clamp(low, high);
    // A number within the range is refused for its type, such as 3.5 grooves.
    (clamped != number).then(|| Change { field: parameter.path(), value: clamped.to_string() })
}

/// The error of a name at the top level that is not a table of a configuration.
fn not_a_table(name: &str, item: &Item) -> Diagnostic {
    if !sections().contains(&name) {
        return unknown(name, &sections(), "table");
    }
    Diagnostic::new(codes::WRONG_TYPE, "not a table")
        .with_location(Location::field(name, item.type_name()))
        .with_help(format!("write it as a table: [{name}]"))
}

/// The list of logs of a run, which has another table `rig`.
const SERIES: &str = "series";
/// Names that only another kind of file has at its top level, the kind, and the command that reads it.
const OTHER_KINDS: [(&[&str], &str, &str); 8] = [
    (&["column", "directions"], "a map of an import", "run `pinswitch import SOURCE --map FILE`"),
    (&["sweep", "axes", "constraints", "set"], "a sweep", "run `pinswitch batch FILE`"),
    (&["targets"], "a request for a design", "run `pinswitch design --request FILE`"),
    (&["effect"], "a file of effects", "run `pinswitch calibrate TABLE --effects FILE`"),
    (
        &["effects", "noise", "protocol", "weights_g", "repetitions", "constants"],
        "a rig to simulate",
        "run `pinswitch simulate FILE`",
    ),
    (&[SERIES], "a run with its logs", "run `pinswitch segment FILE`"),
    (
        &["loads_g", "minutes_per_load_change", "minutes_per_mount_change"],
        "the description of a rig",
        "run `pinswitch experiment DIR --rig FILE`",
    ),
    (
        &["schema"],
        "a file that pinswitch wrote",
        "give a model.toml to `--model FILE`, a discovered.toml to `calibrate TABLE --effects FILE`",
    ),
];

/// Whether a table is that of a run with logs, which has the name of a table of configurations.
fn is_of_a_run(document: &dyn TableLike, table: &str) -> bool {
    table == "rig" && document.contains_key(SERIES)
}

/// The error of a file of another kind; `None` for a file with a table of a configuration, where a single name is wrong.
fn other_kind_of_file(document: &dyn TableLike, file: &str) -> Option<Diagnostic> {
    let has_table = |section: &&str| {
        !is_of_a_run(document, section) && document.get(section).is_some_and(Item::is_table_like)
    };
    if sections().iter().any(has_table) {
        return None;
    }
    let (key, kind, help) = OTHER_KINDS.iter().find_map(|(keys, kind, help)| {
        keys.iter().find(|key| document.contains_key(key)).map(|key| (key, kind, help))
    })?;
    let error = Diagnostic::new(codes::OTHER_KIND_OF_FILE, format!("not a configuration: this is {kind}"));
    Some(error.with_location(field_location(*key)).with_help(help.replace("FILE", file)))
}

fn sections() -> Vec<&'static str> {
    let mut all: Vec<_> = Configuration::PARAMETERS.iter().map(|p| p.section).collect();
    all.dedup();
    all
}

fn find(table: &str, key: &str) -> Result<&'static Parameter<Configuration>, Diagnostic> {
    let in_table = || Configuration::PARAMETERS.iter().filter(|p| p.section == table);
    in_table().find(|p| p.key == key).ok_or_else(|| {
        let keys: Vec<_> = in_table().map(|p| p.key).collect();
        unknown(key, &keys, "key").with_location(field_location(format!("{table}.{key}")))
    })
}

/// The error of an unknown word, with the most similar known one.
fn unknown(word: &str, known: &[&str], what: &str) -> Diagnostic {
    let similarity = |known: &str| strsim::jaro_winkler(word, known);
    let nearest = known.iter().max_by(|a, b| similarity(a).total_cmp(&similarity(b)));
    let help = match nearest.filter(|near| similarity(near) > SIMILAR) {
        Some(near) => format!("did you mean {near:?}? templates/reference.toml lists all"),
        None => format!("known are {}", known.join(", ")),
    };
    Diagnostic::new(codes::UNKNOWN_FIELD, format!("unknown {what}"))
        .with_location(field_location(word))
        .with_help(help)
}

fn key_span(table: &dyn TableLike, key: &str) -> Option<Range<usize>> {
    table.get_key_value(key).and_then(|(key, item)| key.span().or_else(|| item.span()))
}
