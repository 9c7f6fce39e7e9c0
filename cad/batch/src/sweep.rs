//! A sweep: a base configuration, the axes over it, and the constraints that every variant must
//! meet.

use pinswitch_diagnostic::{Code, Diagnostic, Location, codes};
use toml_edit::{Document, Item, TableLike};

use super::axis::{self, AXIS_TABLES, ParameterRef, SweepAxis, fields, key_span};
use super::constraint::Constraint;
use super::diagnostics::field_error;
use super::source::SweepSource;
use pinswitch_switch::config::{Configuration, Name, read};
use pinswitch_switch::parts::PRINTED_PARTS;

/// A valid sweep.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Its name.
    pub name: Name,
    /// The configuration that the axes change.
    pub base: Configuration,
    /// The parts of every variant, in the order of [`PRINTED_PARTS`].
    pub parts: Vec<&'static str>,
    /// Whether every variant gets its own `friction.svg`.
    pub plots: bool,
    /// Whether a slicer estimates the print time of every variant.
    pub slice: bool,
    /// The axes; the last one varies fastest.
    pub axes: Vec<SweepAxis>,
    /// The conditions that every variant must meet.
    pub constraints: Vec<Constraint>,
}

/// A sweep whose rows are not checked yet, so that its variants can be counted in no time, however
/// many there are.
#[derive(Clone, Debug)]
pub struct UncheckedSweep(Sweep);

impl UncheckedSweep {
    /// Reads a sweep, except for checks that take time in proportion to its variants.
    ///
    /// # Errors
    /// As [`Sweep::new`].
    pub fn new(source: &SweepSource) -> Result<Self, Diagnostic> {
        Sweep::unchecked(source).map(Self)
    }

    /// Returns the number of variants, as [`Sweep::count`].
    pub fn count(&self) -> Option<u64> {
        self.0.count()
    }

    /// Checks every row.
    ///
    /// # Errors
    /// The first invalid row.
    pub fn check(self) -> Result<Sweep, Diagnostic> {
        self.0.axes.iter().try_for_each(SweepAxis::check)?;
        Ok(self.0)
    }
}

/// Returns the tables of a sweep with their keys; an empty list means that the keys are fields.
pub(crate) fn tables() -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
    let general: [(&str, &[&str]); 2] =
        [("sweep", &["name", "base", "preset", "parts", "plots"]), ("set", &[])];
    let constraints: (&str, &[&str]) = ("constraints", &["require", "because"]);
    general.into_iter().chain(AXIS_TABLES.iter().map(|table| (table.name, table.keys))).chain([constraints])
}

impl Sweep {
    /// Reads and checks a sweep.
    ///
    /// # Errors
    /// The first error, with file, line, field, value and remedy.
    pub fn new(source: &SweepSource) -> Result<Self, Diagnostic> {
        UncheckedSweep::new(source)?.check()
    }

    fn unchecked(source: &SweepSource) -> Result<Self, Diagnostic> {
        let document = source.document()?;
        check_keys(source, document.as_table())?;
        let table = |name: &str| document.get(name).and_then(Item::as_table_like);
        let (mut base, _) = read(&source.base, "base")?;
        for entry in fields(table("set")) {
            let field = entry.field(source)?;
            set_field(&mut base, field, entry.item).map_err(|e| source.locate(e, entry.item.span()))?;
        }
        let axes = axis::axes(source, document.as_table())?;
        let sweep = table("sweep");
        let at_key = |key: &str| {
            let item = sweep.and_then(|t| t.get(key)).or(document.get("sweep"));
            let span = item.and_then(Item::span);
            move |e: Diagnostic| source.locate(e, span.clone())
        };
        Ok(Self {
            name: checked_name(&source.name).map_err(at_key("name"))?,
            base,
            parts: parts(sweep).map_err(at_key("parts"))?,
            plots: sweep.and_then(|t| t.get("plots")).and_then(Item::as_bool).unwrap_or(false),
            slice: source.slice,
            axes,
            constraints: constraints(source, &document)?,
        })
    }

    /// Returns the number of variants; `None` if it exceeds 64 bits.
    pub fn count(&self) -> Option<u64> {
        self.axes.iter().try_fold(1u64, |n, axis| n.checked_mul(axis.count()))
    }
}

/// Sets one field of the base configuration.
fn set_field(base: &mut Configuration, field: ParameterRef, item: &Item) -> Result<(), Diagnostic> {
    let path = field.path();
    let value = item.as_value().ok_or_else(|| {
        field_error(codes::WRONG_TYPE, &path, None, "not a single value", "write \"table.key\" = value")
    })?;
    let value = axis::accepted(field, value)?;
    (field.set)(base, &value).map_err(|error| error.in_field(&path, ""))
}

/// Returns the names of all parts that a configuration can have, in the order in which they are
/// made.
pub(crate) fn part_names() -> Vec<&'static str> {
    PRINTED_PARTS.iter().map(|p| p.name).collect()
}

/// Whether an item is of a kind.
type IsKind = fn(&Item) -> bool;

/// The kind of the value of a key, in words; `None` for a table or a list.
fn kind_of(key: &str) -> Option<(&'static str, IsKind)> {
    match key {
        "name" | "base" | "preset" | "method" | "file" | "require" | "because" => {
            Some(("a string in quotes", Item::is_str))
        }
        "plots" => Some(("true or false", Item::is_bool)),
        "count" | "seed" => Some(("a whole number", Item::is_integer)),
        _ => None,
    }
}

fn check_keys(source: &SweepSource, document: &dyn TableLike) -> Result<(), Diagnostic> {
    for (name, item) in document.iter() {
        let refused = |code: Code, problem: &str, help: String| {
            Err(source.locate(field_error(code, name, None, problem, help), item.span()))
        };
        let Some((_, keys)) = tables().find(|(table, _)| *table == name) else {
            let known = tables().map(|(table, _)| table).collect::<Vec<_>>().join(", ");
            let error =
                field_error(codes::UNKNOWN_FIELD, name, None, "unknown table", format!("known are {known}"));
            return Err(source.locate(error, key_span(document, name).or(item.span())));
        };
        let tables: Vec<&dyn TableLike> = match item.as_array_of_tables() {
            Some(tables) => tables.iter().map(|t| t as &dyn TableLike).collect(),
            None => item.as_table_like().into_iter().collect(),
        };
        if tables.is_empty() {
            let (kind, header) = match name {
                "constraints" => ("not a list of tables", "[[constraints]] before each".to_owned()),
                _ => ("not a table", format!("[{name}]")),
            };
            return refused(codes::WRONG_TYPE, kind, format!("write {header}"));
        }
        for table in tables.iter().filter(|_| !keys.is_empty()) {
            if let Some((key, item)) = table.iter().find(|(key, _)| !keys.contains(key)) {
                let help = format!("known are {}", keys.join(", "));
                let error =
                    field_error(codes::UNKNOWN_FIELD, &format!("{name}.{key}"), None, "unknown key", help);
                return Err(source.locate(error, key_span(*table, key).or(item.span())));
            }
            for (key, item) in table.iter() {
                let Some((kind, _)) = kind_of(key).filter(|(_, is_kind)| !is_kind(item)) else { continue };
                let problem = format!("not {kind}");
                let error = field_error(
                    codes::WRONG_TYPE,
                    &format!("{name}.{key}"),
                    Some(&item.to_string()),
                    problem,
                    format!("give {kind}"),
                );
                return Err(source.locate(error, item.span()));
            }
        }
    }
    Ok(())
}

/// Returns the sweep's name, which becomes part of folders and figures.
fn checked_name(name: &str) -> Result<Name, Diagnostic> {
    Name::new(name).map_err(|error| error.in_field("sweep.name", format!("{name:?}")))
}

fn parts(sweep: Option<&dyn TableLike>) -> Result<Vec<&'static str>, Diagnostic> {
    let Some(item) = sweep.and_then(|t| t.get("parts")) else { return Ok(part_names()) };
    let quoted: Vec<_> = part_names().iter().map(|name| format!("{name:?}")).collect();
    let help = format!("give a list of {}", quoted.join(", "));
    let names: Option<Vec<&str>> = item.as_array().and_then(|list| list.iter().map(|v| v.as_str()).collect());
    let names = names
        .ok_or_else(|| field_error(codes::WRONG_TYPE, "sweep.parts", None, "not a list of names", &help))?;
    if let Some(unknown) = names.iter().find(|name| !part_names().contains(name)) {
        return Err(field_error(
            codes::UNKNOWN_WORD,
            "sweep.parts",
            Some(&format!("{unknown:?}")),
            "unknown part",
            help,
        ));
    }
    Ok(part_names().into_iter().filter(|name| names.contains(name)).collect())
}

fn constraints(source: &SweepSource, document: &Document<String>) -> Result<Vec<Constraint>, Diagnostic> {
    let Some(tables) = document.get("constraints") else { return Ok(Vec::new()) };
    let tables = tables.as_array_of_tables().ok_or_else(|| {
        let help = "write [[constraints]] before each";
        source.locate(
            field_error(codes::WRONG_TYPE, "constraints", None, "not a list of tables", help),
            tables.span(),
        )
    })?;
    tables
        .iter()
        .map(|table| {
            let because = table.get("because").and_then(Item::as_str).map(str::to_owned);
            let require = table.get("require");
            let Some(text) = require.and_then(Item::as_str) else {
                let help = "write a condition in quotes, such as require = \"shell.width_mm >= 12\"";
                let error = field_error(
                    codes::MISSING_FIELD,
                    "constraints.require",
                    None,
                    "missing, or not a string",
                    help,
                );
                return Err(source.locate(error, require.map_or(table.span(), Item::span)));
            };
            Constraint::new(text, because).map_err(|error| {
                let string = require.and_then(Item::span).unwrap_or_default();
                let diagnostic = error.to_diagnostic_in_toml(&source.file, &source.sweep, string);
                let location = diagnostic.location().cloned().unwrap_or_else(|| Location::file(&source.file));
                diagnostic.with_location(location.with_field("constraints.require", format!("{text:?}")))
            })
        })
        .collect()
}
