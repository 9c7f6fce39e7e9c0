//! The columns of a table of curves, and its lines: one per row and load.

use pinswitch_diagnostic::Diagnostic;
use pinswitch_friction::{FrictionCurve, Transition};
use pinswitch_switch::config::Configuration;
use pinswitch_switch::documents::toml_to_json;
use toml_edit::Value;

use crate::axis::ParameterRef;
use crate::table::{Cell, Column, ColumnType, Row, cell, kind_of};

/// Columns that describe the whole curve of a row.
const CURVE: [(&str, ColumnType); 5] = [
    ("status", ColumnType::Text),
    ("reason", ColumnType::Text),
    ("law", ColumnType::Text),
    ("trust", ColumnType::Text),
    ("threshold_N", ColumnType::Real),
];

/// Columns of one load, as in `friction.csv`.
const LOAD: [&str; 7] =
    ["load_N", "eccentric_N", "concentric_N", "friction_N", "band_low_N", "band_high_N", "silicone_share"];

/// The outcome of a row.
#[derive(Clone, Debug)]
pub enum RowOutcome {
    /// Its curve.
    Predicted(FrictionCurve),
    /// Its configuration is invalid, or the law does not apply to it.
    Refused(Diagnostic),
    /// An internal error.
    Failed(Diagnostic),
}

/// Returns the columns for a table with these fields.
pub(super) fn columns(fields: &[ParameterRef]) -> Vec<Column> {
    let mut columns = vec![Column { name: "row".to_owned(), kind: ColumnType::Integer }];
    columns.extend(fields.iter().map(|field| Column { name: field.path(), kind: kind(field) }));
    columns.extend(CURVE.map(|(name, kind)| Column { name: name.to_owned(), kind }));
    columns.extend(LOAD.map(|name| Column { name: name.to_owned(), kind: ColumnType::Real }));
    columns
}

fn kind(field: ParameterRef) -> ColumnType {
    kind_of(&(field.get)(&Configuration::default()))
}

/// Returns the cells of a row's own columns; empty where the type of the field cannot represent the value.
pub(super) fn own_cells(fields: &[ParameterRef], values: &[Value]) -> Vec<Cell> {
    fields.iter().zip(values).map(|(field, value)| cell(&toml_to_json(value), kind(field))).collect()
}

/// Returns the lines of the row with this index: one per load, or one with the reason why there is no curve.
pub(super) fn lines(
    index: u64,
    own: Vec<Cell>,
    outcome: RowOutcome,
    mut push: impl FnMut(Row) -> Result<(), crate::BatchTableError>,
) -> Result<(), crate::BatchTableError> {
    let text = |t: &str| Cell::Text(t.to_owned());
    let mut start = vec![Cell::Integer(i64::try_from(index + 1).unwrap_or(i64::MAX))];
    start.extend(own);
    let (status, error) = match outcome {
        RowOutcome::Predicted(curve) => {
            let threshold_n = Transition::threshold_n(&curve.load_n, &curve.silicone_share);
            start.extend([text("predicted"), Cell::Empty, text(curve.law.as_str())]);
            start.push(text(curve.status.as_str()));
            start.push(threshold_n.map_or(Cell::Empty, Cell::Real));
            let series = [
                &curve.load_n,
                &curve.eccentric_n,
                &curve.concentric_n,
                &curve.friction_n,
                &curve.band_low_n,
                &curve.band_high_n,
                &curve.silicone_share,
            ];
            for load in 0..curve.load_n.len() {
                let at_load = |values: &&Vec<f64>| values.get(load).map_or(Cell::Empty, |x| Cell::Real(*x));
                push(start.iter().cloned().chain(series.iter().map(at_load)).collect())?;
            }
            return Ok(());
        }
        RowOutcome::Refused(error) => ("refused", error),
        RowOutcome::Failed(error) => ("failed", error),
    };
    let length = start.len() + CURVE.len() + LOAD.len();
    start.extend([text(status), text(&error.to_string())]);
    start.resize(length, Cell::Empty);
    push(start)
}
