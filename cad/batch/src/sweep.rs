//! A sweep: a base configuration, the axes over it, and the constraints that every variant must fulfil.

use toml_edit::{Document, Item, TableLike};

use super::axis::{self, AXIS_TABLES, SweepAxis, config_error, fields};
use super::constraint::Constraint;
use super::source::SweepSource;
use pinswitch_switch::config::{ConfigError, Configuration, Name, read, syntax_error};
use pinswitch_switch::parts::PRINTED_PARTS;

/// What a sweep asks for, checked.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Its name.
    pub name: Name,
    /// What every variant starts from.
    pub base: Configuration,
    /// The parts to make, in the order of [`PRINTED_PARTS`].
    pub parts: Vec<&'static str>,
    /// Whether every variant gets its own `friction.svg`.
    pub plots: bool,
    /// Whether a slicer is asked of every variant.
    pub slice: bool,
    /// The dimensions; the last varies fastest.
    pub axes: Vec<SweepAxis>,
    /// What every variant must fulfil.
    pub constraints: Vec<Constraint>,
}

/// A sweep whose variants are counted, and not looked at one by one: how many there are is known at once, whatever it
/// asks for.
#[derive(Clone, Debug)]
pub struct CountedSweep(Sweep);

impl CountedSweep {
    /// Reads a sweep and all of it that does not take time in proportion to its variants.
    ///
    /// # Errors
    /// As [`Sweep::new`].
    pub fn new(source: &SweepSource) -> Result<Self, ConfigError> {
        Sweep::unchecked(source).map(Self)
    }

    /// As [`Sweep::count`].
    pub fn count(&self) -> Option<u64> {
        self.0.count()
    }

    /// The sweep, once every row of it is checked.
    ///
    /// # Errors
    /// [`ConfigError`] names the first row that cannot be used.
    pub fn checked(self) -> Result<Sweep, ConfigError> {
        self.0.axes.iter().try_for_each(SweepAxis::check)?;
        Ok(self.0)
    }
}

/// Tables of a sweep and their keys; an empty list takes fields.
fn tables() -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
    let own: [(&str, &[&str]); 2] = [("sweep", &["name", "base", "preset", "parts", "plots"]), ("set", &[])];
    let constraints: (&str, &[&str]) = ("constraints", &["require", "because"]);
    own.into_iter().chain(AXIS_TABLES.iter().map(|table| (table.name, table.keys))).chain([constraints])
}

impl Sweep {
    /// Reads and checks a sweep.
    ///
    /// # Errors
    /// [`ConfigError`] names file, line, field, value, and what to change.
    pub fn new(source: &SweepSource) -> Result<Self, ConfigError> {
        CountedSweep::new(source)?.checked()
    }

    fn unchecked(source: &SweepSource) -> Result<Self, ConfigError> {
        let document: Document<String> = source
            .sweep
            .parse()
            .map_err(|e: toml_edit::TomlError| syntax_error(source.place(e.span()), e.message()))?;
        check_keys(source, document.as_table())?;
        let table = |name: &str| document.get(name).and_then(Item::as_table_like);
        let located = |item: &Item| {
            let place = source.place(item.span());
            move |e: ConfigError| e.or_at(&place)
        };
        let (mut base, _) = read(&source.base, "base")?;
        for (path, item) in fields(table("set")) {
            let field = axis::field(&path).map_err(located(item))?;
            let value = item.as_value().ok_or_else(|| {
                located(item)(config_error(&path, None, "is no single value", "write \"table.key\" = value"))
            })?;
            let value = axis::accepted(field, value).map_err(located(item))?;
            (field.set)(&mut base, &value).map_err(|e| located(item)(e.in_field(&path, "")))?;
        }
        let axes = axis::axes(source, document.as_table())?;
        let sweep = table("sweep");
        let written =
            |key: &str| sweep.and_then(|t| t.get(key)).or(document.get("sweep")).unwrap_or(&Item::None);
        Ok(Self {
            name: checked_name(&source.name).map_err(located(written("name")))?,
            base,
            parts: parts(sweep).map_err(located(written("parts")))?,
            plots: sweep.and_then(|t| t.get("plots")).and_then(Item::as_bool).unwrap_or(false),
            slice: source.slice,
            axes,
            constraints: constraints(source, &document)?,
        })
    }

    /// The number of variants; `None` if it is beyond counting.
    pub fn count(&self) -> Option<u64> {
        self.axes.iter().try_fold(1u64, |n, level| n.checked_mul(level.count()))
    }
}

/// Every part that a configuration can ask for, in the order in which they are made.
fn part_names() -> Vec<&'static str> {
    PRINTED_PARTS.iter().map(|p| p.name).collect()
}

fn check_keys(source: &SweepSource, document: &dyn TableLike) -> Result<(), ConfigError> {
    for (name, item) in document.iter() {
        let place = source.place(item.span());
        let Some((_, keys)) = tables().find(|(table, _)| *table == name) else {
            let known = tables().map(|(table, _)| table).collect::<Vec<_>>().join(", ");
            return Err(config_error(name, None, "is no table of a sweep", &format!("known are {known}"))
                .or_at(&place));
        };
        let tables: Vec<&dyn TableLike> = match item.as_array_of_tables() {
            Some(tables) => tables.iter().map(|t| t as &dyn TableLike).collect(),
            None => item.as_table_like().into_iter().collect(),
        };
        if tables.is_empty() {
            return Err(config_error(name, None, "is no table", &format!("write [{name}]")).or_at(&place));
        }
        for (key, item) in tables.iter().flat_map(|t| t.iter()).filter(|_| !keys.is_empty()) {
            if !keys.contains(&key) {
                let place = source.place(item.span());
                let known = format!("known are {}", keys.join(", "));
                return Err(
                    config_error(&format!("{name}.{key}"), None, "is no known key", &known).or_at(&place)
                );
            }
        }
    }
    Ok(())
}

/// The name goes into folders and figures.
fn checked_name(name: &str) -> Result<Name, ConfigError> {
    Name::new(name).map_err(|e| e.in_field("sweep.name", shortened(name)))
}

/// The beginning of a text that may be of any length, in quotes.
fn shortened(text: &str) -> String {
    const SHOWN: usize = 80;
    let short: String = text.chars().take(SHOWN).collect();
    if short.len() < text.len() { format!("{short:?}...") } else { format!("{text:?}") }
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
            .or_at(&source.place(tables.span()))
    })?;
    tables
        .iter()
        .map(|table| {
            let text = table.get("require").and_then(Item::as_str).unwrap_or_default();
            let because = table.get("because").and_then(Item::as_str).map(str::to_owned);
            Constraint::new(text, because).map_err(|e| e.or_at(&source.place(table.span())))
        })
        .collect()
}
