//! `[rows]`: a CSV with one variant a row; its columns have the names of fields. Only the offset of
//! each row in the text is kept; a row is parsed on request.

use std::sync::Arc;

use csv::{Position, Reader, ReaderBuilder, StringRecord};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use toml_edit::{Item, Value};

use super::{AxisTable, ParameterRef, SweepAxis};
use crate::diagnostics::field_error;
use crate::source::SweepSource;

/// The table with the file of rows; the sweep's source contains its text.
pub(super) const TABLE: AxisTable = AxisTable { name: "rows", keys: &["file"], level: 0, read };

fn read(source: &SweepSource, _: &Item) -> Result<Vec<SweepAxis>, Diagnostic> {
    source.rows.iter().map(|(file, text)| axis(text, file)).collect()
}

/// The rows of a text.
pub(crate) struct Rows {
    file: String,
    text: String,
    /// The fields of the columns.
    pub(crate) fields: Vec<ParameterRef>,
    /// Byte offset of each row, including the comments before it.
    starts: Vec<usize>,
}

/// Reads the axis of the rows in `text`; `file` is its name in errors. [`SweepAxis::check`] checks
/// the cells.
///
/// # Errors
/// A column that is not a field, a row of the wrong length, and a text without rows, each with file
/// and line.
fn axis(text: &str, file: &str) -> Result<SweepAxis, Diagnostic> {
    let rows = Arc::new(Rows::new(text, file)?);
    let (fields, count) = (rows.fields.clone(), rows.starts.len() as u64);
    let shared = Arc::clone(&rows);
    let row = move |index| usize::try_from(index).ok().and_then(|i| rows.row(i).ok()).unwrap_or_default();
    Ok(SweepAxis::new(fields, count, row).with_check(move || shared.check()))
}

fn reader(text: &str, has_headers: bool) -> Reader<&[u8]> {
    let mut builder = ReaderBuilder::new();
    builder.trim(csv::Trim::All).comment(Some(b'#')).has_headers(has_headers).from_reader(text.as_bytes())
}

impl Rows {
    /// Reads the header and the places of the rows in `text`; `file` is its name in errors.
    ///
    /// # Errors
    /// A column that is not a field, a row of the wrong length, and a text without rows.
    pub(crate) fn new(text: &str, file: &str) -> Result<Self, Diagnostic> {
        let mut reader = reader(text, true);
        let malformed = |e: csv::Error| {
            let offset = usize::try_from(e.position().map_or(0, Position::byte)).unwrap_or_default();
            at_row(malformed_row(e), file, text, offset)
        };
        let header = reader.headers().map_err(malformed)?.clone();
        let fields = column_fields(header.iter(), |e, column| at_cell(e, file, text, 0, column))?;
        let (mut record, mut starts) = (csv::ByteRecord::new(), Vec::new());
        loop {
            let start = usize::try_from(reader.position().byte()).unwrap_or(usize::MAX);
            if !reader.read_byte_record(&mut record).map_err(malformed)? {
                break;
            }
            starts.push(start);
        }
        if starts.is_empty() {
            let error = Diagnostic::new(codes::TABLE_WITHOUT_ROWS, "the table has no rows");
            let error = error.with_help("write at least one row below the header");
            return Err(at_row(error, file, text, 0));
        }
        Ok(Self { file: file.to_owned(), text: text.to_owned(), fields, starts })
    }

    /// Returns the number of rows.
    pub(crate) fn count(&self) -> usize {
        self.starts.len()
    }

    /// Returns the values in the cells of a row.
    ///
    /// # Errors
    /// A malformed row.
    pub(crate) fn cells(&self, index: usize) -> Result<Vec<Value>, Diagnostic> {
        let start = self.starts.get(index).copied().unwrap_or_default();
        let mut record = StringRecord::new();
        reader(self.text.get(start..).unwrap_or_default(), false)
            .read_record(&mut record)
            .map_err(|e| at_row(malformed_row(e), &self.file, &self.text, start))?;
        Ok(record.iter().map(cell_value).collect())
    }

    /// Returns the values of a row.
    ///
    /// # Errors
    /// A malformed row, and a value that its field does not accept.
    fn row(&self, index: usize) -> Result<Vec<Value>, Diagnostic> {
        let start = self.starts.get(index).copied().unwrap_or_default();
        let cells = self.cells(index)?;
        let cells = self.fields.iter().zip(&cells).enumerate();
        cells
            .map(|(column, (field, value))| {
                let refused = |e| at_cell(e, &self.file, &self.text, start, column);
                super::accepted(field, value).map_err(refused)
            })
            .collect()
    }

    fn check(&self) -> Result<(), Diagnostic> {
        (0..self.starts.len()).try_for_each(|index| self.row(index).map(drop))
    }
}

/// Returns the fields of columns with these names; `locate` gives an error its place in the header.
///
/// # Errors
/// A column that is not a field, and two columns of one field.
pub(crate) fn column_fields<'a>(
    names: impl Iterator<Item = &'a str>,
    locate: impl Fn(Diagnostic, usize) -> Diagnostic,
) -> Result<Vec<ParameterRef>, Diagnostic> {
    let mut fields: Vec<ParameterRef> = Vec::new();
    for (column, name) in names.enumerate() {
        let field = super::field(name).map_err(|e| locate(e, column))?;
        if fields.iter().any(|other| other.path() == field.path()) {
            let error = field_error(
                codes::DUPLICATE_ENTRY,
                &field.path(),
                None,
                "two columns have this name",
                "remove one of them",
            );
            return Err(locate(error, column));
        }
        fields.push(field);
    }
    Ok(fields)
}

/// Returns the value in a cell. A bare word is text, as with --set.
pub(crate) fn cell_value(cell: &str) -> Value {
    cell.parse::<Value>().unwrap_or_else(|_| Value::from(cell))
}

/// The error for a row that is not CSV, or does not have the header's number of cells.
fn malformed_row(error: csv::Error) -> Diagnostic {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            let problem = format!("expected {expected_len} cells, found {len}");
            let help = "give one cell per column, and quote a cell with a comma, such as \"[5, 8]\"";
            Diagnostic::new(codes::TABLE_OF_ROWS_MALFORMED, problem).with_help(help)
        }
        _ => {
            let problem = format!("malformed CSV: {error}");
            Diagnostic::new(codes::TABLE_OF_ROWS_MALFORMED, problem)
                .with_help("save the rows as CSV in UTF-8")
                .with_source(error)
        }
    }
}

/// The same error at the line of the first row at or after byte `start`.
fn at_row(error: Diagnostic, file: &str, text: &str, start: usize) -> Diagnostic {
    error.or_at(&Location::in_csv(file, text, row_start(text, start), None))
}

/// The same error at a cell of the first row at or after byte `start`.
fn at_cell(error: Diagnostic, file: &str, text: &str, start: usize, column: usize) -> Diagnostic {
    error.or_at(&Location::in_csv(file, text, row_start(text, start), Some(column)))
}

/// Returns the byte of the first row at or after byte `start`: comments and empty lines are skipped.
fn row_start(text: &str, start: usize) -> usize {
    let mut offset = start.min(text.len());
    for line in text.get(offset..).unwrap_or_default().split_inclusive('\n') {
        if !line.trim().is_empty() && !line.starts_with('#') {
            break;
        }
        offset += line.len();
    }
    offset
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_take_any_field() {
        let axis = axis(
            "layout.pins, shell.width_mm,support.slots\n# two\n\"[5, 8]\",12,all\n\n[4],13.5,occupied\n",
            "a.csv",
        );
        let axis = axis.unwrap();
        let texts: Vec<_> = axis.row(0).iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["[5, 8]", "12.0", "\"all\""]);
        let texts: Vec<_> = axis.row(1).iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["[4]", "13.5", "\"occupied\""]);
        assert_eq!(axis.count(), 2);
    }

    #[test]
    fn invalid_rows_are_located() {
        for (text, expected) in [
            ("shell.with_mm\n3\n", "a.csv:1:1: shell.with_mm: unknown field; did you mean"),
            ("shell.width_mm\n12\n-3\n", "a.csv:3:1: shell.width_mm = -3: outside 2 to 100"),
            ("shell.width_mm\n12\n# a\n\n-3\n", "a.csv:5:1: shell.width_mm = -3: outside 2 to 100"),
            ("shell.width_mm,shell.wall_mm\n12\n", "a.csv:2: expected 2 cells, found 1; give one cell"),
            ("shell.width_mm,shell.wall_mm\n# a\n12\n", "a.csv:3: expected 2 cells, found 1"),
            ("shell.width_mm\n", "a.csv:1: the table has no rows"),
            (
                "shell.width_mm,shell.width_mm\n12,13\n",
                "a.csv:1:16: shell.width_mm: two columns have this name",
            ),
        ] {
            let error = axis(text, "a.csv").and_then(|axis| axis.check()).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
