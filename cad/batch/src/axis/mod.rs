//! Axes of a sweep: the values of one field, or of several fields together.
//!
//! A new notation for the values of a field is a file in `values` with a line there. A new table
//! with axes is a file here with a line in `axis_tables!`.

mod values;

use std::ops::Range;
use std::sync::Arc;

use pinswitch_diagnostic::{Diagnostic, codes};
use toml_edit::{Item, TableLike, Value};

use crate::diagnostics::field_error;
use crate::source::SweepSource;
use pinswitch_switch::config::Configuration;
use pinswitch_switch::config::parameter::Parameter;

pub(crate) use rows::{Rows, cell_value, column_fields};
pub(crate) use sample::METHODS;
pub use sample::{Method, unit_points};

/// A parameter of the configuration.
pub type ParameterRef = &'static Parameter<Configuration>;

/// One dimension of a sweep: fields, and the values that they take together, row by row.
///
/// Rows are computed on request: an axis of millions of rows takes no memory.
#[derive(Clone)]
pub struct SweepAxis {
    /// The fields that vary.
    pub fields: Vec<ParameterRef>,
    count: u64,
    row: Arc<dyn Fn(u64) -> Vec<Value> + Send + Sync>,
    /// Checks every row; deferred until the number of rows is known to be acceptable.
    check: Option<Arc<dyn Fn() -> Result<(), Diagnostic> + Send + Sync>>,
}

impl SweepAxis {
    fn new(
        fields: Vec<ParameterRef>,
        count: u64,
        row: impl Fn(u64) -> Vec<Value> + Send + Sync + 'static,
    ) -> Self {
        Self { fields, count, row: Arc::new(row), check: None }
    }

    /// The same axis with values that [`Self::check`] checks.
    fn with_check(self, check: impl Fn() -> Result<(), Diagnostic> + Send + Sync + 'static) -> Self {
        Self { check: Some(Arc::new(check)), ..self }
    }

    /// Checks every row, in time proportional to their number.
    ///
    /// # Errors
    /// The first value that its field does not accept.
    pub(super) fn check(&self) -> Result<(), Diagnostic> {
        self.check.as_ref().map_or(Ok(()), |check| check())
    }

    /// Returns the number of rows.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Returns one value per field; `index` is below [`Self::count`].
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

/// A table of a sweep that defines axes.
pub(super) struct AxisTable {
    /// Its name.
    pub(super) name: &'static str,
    /// Its keys; an empty list means that its keys are fields.
    pub(super) keys: &'static [&'static str],
    /// Its order among the axes: the table with the highest level varies fastest.
    level: u8,
    /// Reads its axes.
    read: fn(&SweepSource, &Item) -> Result<Vec<SweepAxis>, Diagnostic>,
}

/// Declares the files of the tables and their list.
macro_rules! axis_tables {
    ($($file:ident;)*) => {
        $(mod $file;)*

        /// Every table that defines axes, in the order of messages.
        pub(super) const AXIS_TABLES: &[AxisTable] = &[$($file::TABLE),*];
    };
}

axis_tables! {
    grid;
    sample;
    rows;
}

/// Reads the axes of a sweep, the slowest first.
///
/// # Errors
/// An invalid table, a field that varies twice, and a sweep without axes.
pub(super) fn axes(source: &SweepSource, sweep: &dyn TableLike) -> Result<Vec<SweepAxis>, Diagnostic> {
    let mut tables: Vec<&AxisTable> = AXIS_TABLES.iter().collect();
    tables.sort_by_key(|table| table.level);
    let mut axes = Vec::new();
    for table in tables {
        if let Some(item) = sweep.get(table.name) {
            axes.extend((table.read)(source, item)?);
        }
    }
    check_fields_differ(&axes).map_err(|e| source.locate(e, None))?;
    if axes.is_empty() {
        let problem = format!("the sweep has no axes ({})", table_names("or"));
        let error =
            Diagnostic::new(codes::INVALID_AXIS, problem).with_help("add at least one field with its values");
        return Err(source.locate(error, None));
    }
    Ok(axes)
}

fn check_fields_differ(axes: &[SweepAxis]) -> Result<(), Diagnostic> {
    let all: Vec<_> = axes.iter().flat_map(|axis| axis.fields.iter().map(|f| f.path())).collect();
    match all.iter().enumerate().find(|(i, path)| all[..*i].contains(path)) {
        Some((_, path)) => {
            let help = format!("keep it in one of {}, and only once", table_names("and"));
            Err(field_error(codes::INVALID_AXIS, path, None, "the field varies twice", help))
        }
        None => Ok(()),
    }
}

/// Returns the tables as text, such as `[axes], [sample] and [rows]`.
fn table_names(conjunction: &str) -> String {
    let names: Vec<_> = AXIS_TABLES.iter().map(|table| format!("[{}]", table.name)).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} {conjunction} {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// A field of a table of a sweep, and its place in the file.
#[derive(Debug)]
pub(super) struct FieldEntry<'a> {
    pub(super) path: String,
    pub(super) item: &'a Item,
    /// Span of the key, for errors about the name.
    pub(super) key: Option<Range<usize>>,
}

impl FieldEntry<'_> {
    /// Returns the field with this name.
    ///
    /// # Errors
    /// As [`field`], at the key.
    pub(super) fn field(&self, source: &SweepSource) -> Result<ParameterRef, Diagnostic> {
        field(&self.path).map_err(|error| source.locate(error, self.key.clone().or(self.item.span())))
    }
}

/// Returns the fields of a table, whether written `"shell.width_mm" = ..` or as `[axes.shell]
/// width_mm = ..`.
pub(super) fn fields(table: Option<&dyn TableLike>) -> Vec<FieldEntry<'_>> {
    let mut all = Vec::new();
    for (name, item) in table.into_iter().flat_map(|t| t.iter()) {
        match item.as_table_like() {
            // A range is a table, too: its keys are not fields of a section.
            Some(inner) if !name.contains('.') && !values::is_range_or_list(item) => {
                all.extend(inner.iter().map(|(k, item)| FieldEntry {
                    path: format!("{name}.{k}"),
                    item,
                    key: key_span(inner, k),
                }));
            }
            _ => all.push(FieldEntry {
                path: name.to_owned(),
                item,
                key: table.and_then(|t| key_span(t, name)),
            }),
        }
    }
    all
}

/// Returns the span of a key in the file of the table.
pub(super) fn key_span(table: &dyn TableLike, key: &str) -> Option<Range<usize>> {
    table.key(key).and_then(toml_edit::Key::span)
}

/// Returns the field with this path.
///
/// # Errors
/// An unknown field, and a field that the batch sets itself.
pub(crate) fn field(path: &str) -> Result<ParameterRef, Diagnostic> {
    let all = Configuration::PARAMETERS;
    if path == "switch.name" {
        let problem = "a sweep cannot set the name (each variant's name is its id)";
        return Err(field_error(codes::INVALID_AXIS, path, None, problem, "remove it"));
    }
    all.iter().find(|p| p.path() == path).ok_or_else(|| {
        let near = all
            .iter()
            .map(|p| p.path())
            .max_by(|a, b| strsim::jaro_winkler(path, a).total_cmp(&strsim::jaro_winkler(path, b)));
        let near = near.unwrap_or_default();
        let help = format!("did you mean \"{near}\"? templates/reference.toml lists all fields");
        field_error(codes::UNKNOWN_FIELD, path, None, "unknown field", help)
    })
}

/// Returns whether the numbers of `field` are whole; `None` if it does not take numbers.
pub(super) fn is_whole(field: ParameterRef) -> Option<bool> {
    match (field.get)(&Configuration::default()) {
        Value::Integer(_) => Some(true),
        Value::Float(_) => Some(false),
        _ => None,
    }
}

/// Converts `value` to the type of the field.
///
/// # Errors
/// A value that the field does not accept, with the accepted range.
pub(crate) fn accepted(field: ParameterRef, value: &Value) -> Result<Value, Diagnostic> {
    let mut scratch = Configuration::default();
    (field.set)(&mut scratch, value).map_err(|error| {
        let value = value.clone().decorated("", "").to_string();
        error.in_field(field.path(), value.trim())
    })?;
    Ok((field.get)(&scratch))
}
