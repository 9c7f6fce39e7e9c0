//! A sweep: a base configuration, the axes over it, and the constraints that every variant must fulfil.

use std::ops::Range;

use toml_edit::{Document, Item, TableLike};

use super::axis::{self, SweepAxis, config_error};
use super::constraint::Constraint;
use super::rows::rows;
use super::sampling::{Method, sample};
use super::source::SweepSource;
use pinswitch_switch::config::{ConfigError, Configuration, Place, read};
use pinswitch_switch::parts::PRINTED_PARTS;

/// What a sweep asks for, checked.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Its name.
    pub name: String,
    /// What every variant starts from.
    pub base: Configuration,
    /// The parts to make, in the order of [`PRINTED_PARTS`].
    pub parts: Vec<&'static str>,
    /// Whether every variant gets its own `friction.svg`.
    pub plots: bool,
    /// The dimensions; the last varies fastest.
    pub axes: Vec<SweepAxis>,
    /// What every variant must fulfil.
    pub constraints: Vec<Constraint>,
}

/// Tables of a sweep and their keys; an empty list takes fields.
const TABLES: [(&str, &[&str]); 6] = [
    ("sweep", &["name", "base", "preset", "parts", "plots"]),
    ("set", &[]),
    ("axes", &[]),
    ("sample", &["method", "count", "seed", "axes"]),
    ("rows", &["file"]),
    ("constraints", &["require", "because"]),
];

impl Sweep {
    /// Reads and checks a sweep.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line, field, value, and what to change.
    pub fn new(source: &SweepSource) -> Result<Self, ConfigError> {
        let document: Document<String> = source
            .sweep
            .parse()
            .map_err(|e: toml_edit::TomlError| ConfigError::syntax(place(source, e.span()), e.message()))?;
        check_keys(source, document.as_table())?;
        let table = |name: &str| document.get(name).and_then(Item::as_table_like);
        let located = |item: &Item| {
            let place = place(source, item.span());
            move |e: ConfigError| e.at(place.clone())
        };
        let (mut base, _) = read(&source.base, "base")?;
        for (path, item) in fields(table("set")) {
            let field = axis::field(&path).map_err(located(item))?;
            let value = item.as_value().ok_or_else(|| {
                located(item)(config_error(&path, None, "is no single value", "write \"table.key\" = value"))
            })?;
            let value = axis::accepted(field, value).map_err(located(item))?;
            (field.set)(&mut base, &value).map_err(|r| located(item)(ConfigError::new(&path, "", r)))?;
        }
        let mut axes = Vec::new();
        if let Some((name, text)) = &source.rows {
            axes.push(rows(text, name)?);
        }
        for (path, item) in fields(table("axes")) {
            axes.push(axis::axis(&path, item).map_err(located(item))?);
        }
        if let Some(table) = table("sample") {
            let item = document.get("sample").unwrap_or(&Item::None);
            axes.push(sampled(table).map_err(located(item))?);
        }
        no_field_twice(&axes)?;
        if axes.is_empty() {
            let problem = "is empty: no [axes], [sample] or [rows]";
            return Err(config_error("sweep", None, problem, "name at least one field with its values")
                .at(place(source, None)));
        }
        let sweep = table("sweep");
        let item = document.get("sweep").unwrap_or(&Item::None);
        Ok(Self {
            name: checked_name(&source.name).map_err(located(item))?,
            base,
            parts: parts(sweep).map_err(located(item))?,
            plots: sweep.and_then(|t| t.get("plots")).and_then(Item::as_bool).unwrap_or(false),
            axes,
            constraints: constraints(source, &document)?,
        })
    }

    /// The number of variants; `None` if it is beyond counting.
    pub fn count(&self) -> Option<u64> {
        self.axes.iter().try_fold(1u64, |n, level| n.checked_mul(level.rows.len() as u64))
    }
}

/// Every part that a configuration can ask for, in the order in which they are made.
fn part_names() -> Vec<&'static str> {
    PRINTED_PARTS.iter().map(|p| p.name).collect()
}

fn place(source: &SweepSource, span: Option<Range<usize>>) -> Place {
    Place::new(&source.file, &source.sweep, span.map_or(0, |s| s.start))
}

/// Fields of a table, whether written `"shell.width_mm" = ..` or as `[axes.shell] width_mm = ..`.
fn fields(table: Option<&dyn TableLike>) -> Vec<(String, &Item)> {
    let mut all = Vec::new();
    for (key, item) in table.into_iter().flat_map(|t| t.iter()) {
        match item.as_table_like() {
            // A range is a table too: its keys are no fields of a section.
            Some(inner) if !key.contains('.') && !inner.contains_key("from") => {
                all.extend(inner.iter().map(|(k, item)| (format!("{key}.{k}"), item)));
            }
            _ => all.push((key.to_owned(), item)),
        }
    }
    all
}

fn check_keys(source: &SweepSource, document: &dyn TableLike) -> Result<(), ConfigError> {
    for (name, item) in document.iter() {
        let place = place(source, item.span());
        let Some((_, keys)) = TABLES.iter().find(|(table, _)| *table == name) else {
            let known = TABLES.map(|(table, _)| table).join(", ");
            return Err(
                config_error(name, None, "is no table of a sweep", &format!("known are {known}")).at(place)
            );
        };
        let tables: Vec<&dyn TableLike> = match item.as_array_of_tables() {
            Some(tables) => tables.iter().map(|t| t as &dyn TableLike).collect(),
            None => item.as_table_like().into_iter().collect(),
        };
        if tables.is_empty() {
            return Err(config_error(name, None, "is no table", &format!("write [{name}]")).at(place));
        }
        for (key, item) in tables.iter().flat_map(|t| t.iter()).filter(|_| !keys.is_empty()) {
            if !keys.contains(&key) {
                let place = self::place(source, item.span());
                let known = format!("known are {}", keys.join(", "));
                return Err(config_error(&format!("{name}.{key}"), None, "is no known key", &known).at(place));
            }
        }
    }
    Ok(())
}

fn sampled(table: &dyn TableLike) -> Result<SweepAxis, ConfigError> {
    let whole = |key: &str| table.get(key).and_then(Item::as_integer);
    let method = match table.get("method").and_then(Item::as_str) {
        Some("latin-hypercube") | None => Method::LatinHypercube,
        Some("random") => Method::Random,
        Some(other) => {
            let value = format!("{other:?}");
            let remedy = "give \"latin-hypercube\" or \"random\"";
            return Err(config_error("sample.method", Some(&value), "is no method", remedy));
        }
    };
    let count = whole("count").and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
    if count > 10_000_000 {
        return Err(config_error(
            "sample.count",
            Some(&count.to_string()),
            "is over ten million",
            "lower it",
        ));
    }
    let seed = whole("seed").unwrap_or(0).unsigned_abs();
    let axes = fields(table.get("axes").and_then(Item::as_table_like));
    sample(method, count, seed, axes.iter().map(|(path, item)| (path.as_str(), *item)))
}

fn no_field_twice(axes: &[SweepAxis]) -> Result<(), ConfigError> {
    let all: Vec<_> = axes.iter().flat_map(|l| l.fields.iter().map(|f| f.path())).collect();
    match all.iter().enumerate().find(|(i, path)| all[..*i].contains(path)) {
        Some((_, path)) => Err(config_error(
            path,
            None,
            "varies twice",
            "keep it in one of [axes], [sample] and [rows], and name it once",
        )),
        None => Ok(()),
    }
}

/// The name goes into folders and figures.
fn checked_name(name: &str) -> Result<String, ConfigError> {
    let good = |c: char| c.is_ascii_alphanumeric() || "-_. ".contains(c);
    if !name.is_empty() && name.len() <= 60 && name.chars().all(good) {
        return Ok(name.to_owned());
    }
    Err(config_error(
        "sweep.name",
        Some(&format!("{name:?}")),
        "is no name",
        "use up to 60 letters, digits, - and _",
    ))
}

fn parts(sweep: Option<&dyn TableLike>) -> Result<Vec<&'static str>, ConfigError> {
    let Some(item) = sweep.and_then(|t| t.get("parts")) else { return Ok(part_names()) };
    let asked: Option<Vec<&str>> = item.as_array().and_then(|list| list.iter().map(|v| v.as_str()).collect());
    let known = format!(
        "give a list of {}",
        part_names().iter().map(|n| format!("{n:?}")).collect::<Vec<_>>().join(", ")
    );
    let asked = asked.ok_or_else(|| config_error("sweep.parts", None, "is no list of names", &known))?;
    if let Some(unknown) = asked.iter().find(|name| !part_names().contains(name)) {
        return Err(config_error("sweep.parts", Some(&format!("{unknown:?}")), "is no part", &known));
    }
    Ok(part_names().into_iter().filter(|name| asked.contains(name)).collect())
}

fn constraints(source: &SweepSource, document: &Document<String>) -> Result<Vec<Constraint>, ConfigError> {
    let Some(tables) = document.get("constraints") else { return Ok(Vec::new()) };
    let tables = tables.as_array_of_tables().ok_or_else(|| {
        config_error("constraints", None, "is no list of tables", "write [[constraints]] before each")
            .at(place(source, tables.span()))
    })?;
    tables
        .iter()
        .map(|table| {
            let text = table.get("require").and_then(Item::as_str).unwrap_or_default();
            let because = table.get("because").and_then(Item::as_str).map(str::to_owned);
            Constraint::new(text, because).map_err(|e| e.at(place(source, table.span())))
        })
        .collect()
}
