//! Axes of a sweep: the values that one field takes, or that several take together.
//!
//! A new way to write the values of a field is a file in `values` and its line there; a new table that lays axes is a file
//! here and its line in `axis_tables!`.

mod values;

use std::sync::Arc;

use toml_edit::{Item, TableLike, Value};

use super::source::SweepSource;
use pinswitch_switch::config::parameter::Parameter;
use pinswitch_switch::config::{ConfigError, Configuration, Location};

pub use sample::{Method, unit_points};

/// A parameter of the configuration.
pub type ParameterRef = &'static Parameter<Configuration>;

/// One dimension of a sweep: fields, and the values that they take together, row by row. Rows are put together when they
/// are asked for: an axis of millions takes no memory.
#[derive(Clone)]
pub struct SweepAxis {
    /// The fields that vary.
    pub fields: Vec<ParameterRef>,
    count: u64,
    row: Arc<dyn Fn(u64) -> Vec<Value> + Send + Sync>,
    /// What is left to check, row by row, once it is known that there are not too many.
    check: Option<Arc<dyn Fn() -> Result<(), ConfigError> + Send + Sync>>,
}

impl SweepAxis {
    fn new(
        fields: Vec<ParameterRef>,
        count: u64,
        row: impl Fn(u64) -> Vec<Value> + Send + Sync + 'static,
    ) -> Self {
        Self { fields, count, row: Arc::new(row), check: None }
    }

    /// The same, with values that are still to be checked.
    fn checked_by(self, check: impl Fn() -> Result<(), ConfigError> + Send + Sync + 'static) -> Self {
        Self { check: Some(Arc::new(check)), ..self }
    }

    /// Whether every row can be used. Takes time in proportion to their number.
    ///
    /// # Errors
    /// [`ConfigError`] names the first value that its field does not accept.
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        self.check.as_ref().map_or(Ok(()), |check| check())
    }

    /// Number of rows.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// One value per field; `index` is below [`Self::count`].
    pub fn row(&self, index: u64) -> Vec<Value> {
        (self.row)(index)
    }
}

impl std::fmt::Debug for SweepAxis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let fields: Vec<_> = self.fields.iter().map(|p| p.path()).collect();
        write!(f, "{} rows of {}", self.count, fields.join(", "))
    }
}

/// A table of a sweep that lays axes.
pub(super) struct AxisTable {
    /// Its name.
    pub(super) name: &'static str,
    /// Its keys; an empty list takes fields.
    pub(super) keys: &'static [&'static str],
    /// Its place among the axes: the table of the highest level varies fastest.
    level: u8,
    /// The axes that it lays.
    read: fn(&SweepSource, &Item) -> Result<Vec<SweepAxis>, ConfigError>,
}

/// Declares the files of the tables and their list.
macro_rules! axis_tables {
    ($($file:ident;)*) => {
        $(mod $file;)*

        /// Every table that lays axes, in the order in which messages name them.
        pub(super) const AXIS_TABLES: &[AxisTable] = &[$($file::TABLE),*];
    };
}

axis_tables! {
    grid;
    sample;
    rows;
}

/// The axes of a sweep, the slowest first.
///
/// # Errors
/// [`ConfigError`] for what is wrong in a table, a field that varies twice, or no axis.
pub(super) fn axes(source: &SweepSource, sweep: &dyn TableLike) -> Result<Vec<SweepAxis>, ConfigError> {
    let mut tables: Vec<&AxisTable> = AXIS_TABLES.iter().collect();
    tables.sort_by_key(|table| table.level);
    let mut axes = Vec::new();
    for table in tables {
        if let Some(item) = sweep.get(table.name) {
            axes.extend((table.read)(source, item)?);
        }
    }
    no_field_twice(&axes).map_err(|e| e.or_at(&source.place(None)))?;
    if axes.is_empty() {
        let problem = format!("is empty: no {}", table_names("or"));
        return Err(config_error("sweep", None, &problem, "name at least one field with its values")
            .or_at(&source.place(None)));
    }
    Ok(axes)
}

fn no_field_twice(axes: &[SweepAxis]) -> Result<(), ConfigError> {
    let all: Vec<_> = axes.iter().flat_map(|l| l.fields.iter().map(|f| f.path())).collect();
    match all.iter().enumerate().find(|(i, path)| all[..*i].contains(path)) {
        Some((_, path)) => {
            let remedy = format!("keep it in one of {}, and name it once", table_names("and"));
            Err(config_error(path, None, "varies twice", &remedy))
        }
        None => Ok(()),
    }
}

/// The tables in words, such as `[axes], [sample] and [rows]`.
fn table_names(conjunction: &str) -> String {
    let names: Vec<_> = AXIS_TABLES.iter().map(|table| format!("[{}]", table.name)).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} {conjunction} {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// Fields of a table, whether written `"shell.width_mm" = ..` or as `[axes.shell] width_mm = ..`.
pub(super) fn fields(table: Option<&dyn TableLike>) -> Vec<(String, &Item)> {
    let mut all = Vec::new();
    for (key, item) in table.into_iter().flat_map(|t| t.iter()) {
        match item.as_table_like() {
            // A range is a table too: its keys are no fields of a section.
            Some(inner) if !key.contains('.') && !values::is_written(item) => {
                all.extend(inner.iter().map(|(k, item)| (format!("{key}.{k}"), item)));
            }
            _ => all.push((key.to_owned(), item)),
        }
    }
    all
}

/// The field called `path`.
///
/// # Errors
/// [`ConfigError`] for a field that does not exist, or that a batch sets itself.
pub(super) fn field(path: &str) -> Result<ParameterRef, ConfigError> {
    let all = Configuration::PARAMETERS;
    if path == "switch.name" {
        return Err(config_error(
            path,
            None,
            "is set by the batch itself, to each variant's id",
            "leave it out",
        ));
    }
    all.iter().find(|p| p.path() == path).ok_or_else(|| {
        let near = all
            .iter()
            .map(|p| p.path())
            .max_by(|a, b| strsim::jaro_winkler(path, a).total_cmp(&strsim::jaro_winkler(path, b)));
        let near = near.unwrap_or_default();
        config_error(
            path,
            None,
            "is no known field",
            &format!("did you mean \"{near}\"? templates/reference.toml lists all"),
        )
    })
}

/// Whether `field` takes numbers, and if so whether they are whole.
pub(super) fn numeric(field: ParameterRef) -> Option<bool> {
    match (field.get)(&Configuration::default()) {
        Value::Integer(_) => Some(true),
        Value::Float(_) => Some(false),
        _ => None,
    }
}

/// `value`, if `field` accepts it; in the field's own type.
///
/// # Errors
/// [`ConfigError`] with the accepted range.
pub(super) fn accepted(field: ParameterRef, value: &Value) -> Result<Value, ConfigError> {
    let mut scratch = Configuration::default();
    let text = || value.clone().decorated("", "").to_string();
    (field.set)(&mut scratch, value).map_err(|e| e.in_field(field.path(), text()))?;
    Ok((field.get)(&scratch))
}

/// An error in an axis.
pub(super) fn config_error(field: &str, value: Option<&str>, problem: &str, remedy: &str) -> ConfigError {
    let value = value.map(|v| v.trim().to_owned());
    let location = Location { field: Some(field.to_owned()), value, ..Location::default() };
    ConfigError::new(problem).with_location(location).with_help(remedy)
}
