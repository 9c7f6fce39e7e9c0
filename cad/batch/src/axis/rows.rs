//! `[rows]`: a CSV of rows, one variant a row, its columns named after fields. Of each row only its place in the text is
//! kept; it is read when it is asked for.

use std::sync::Arc;

use csv::{Position, Reader, ReaderBuilder, StringRecord};
use toml_edit::{Item, Value};

use super::{AxisTable, ParameterRef, SweepAxis, config_error};
use crate::source::SweepSource;
use pinswitch_switch::config::{ConfigError, Location};

/// The table that names the file of rows, whose text the sweep's source holds.
pub(super) const TABLE: AxisTable = AxisTable { name: "rows", keys: &["file"], level: 0, read };

fn read(source: &SweepSource, _: &Item) -> Result<Vec<SweepAxis>, ConfigError> {
    source.rows.iter().map(|(file, text)| axis(text, file)).collect()
}

/// The rows of a text.
struct Rows {
    file: String,
    text: String,
    fields: Vec<ParameterRef>,
    /// Where each row begins, in bytes; comments before it belong to it.
    starts: Vec<usize>,
}

/// The axis of the rows in `text`; `file` names them in errors. Their cells are looked at by [`SweepAxis::check`].
///
/// # Errors
/// [`ConfigError`] with file and line for a column that is no field, a row that is too short, or no rows.
fn axis(text: &str, file: &str) -> Result<SweepAxis, ConfigError> {
    let rows = Arc::new(Rows::new(text, file)?);
    let (fields, count) = (rows.fields.clone(), rows.starts.len() as u64);
    let checked = Arc::clone(&rows);
    let row = move |index| usize::try_from(index).ok().and_then(|i| rows.row(i).ok()).unwrap_or_default();
    Ok(SweepAxis::new(fields, count, row).checked_by(move || checked.check()))
}

fn reader(text: &str, has_headers: bool) -> Reader<&[u8]> {
    let mut builder = ReaderBuilder::new();
    builder.trim(csv::Trim::All).comment(Some(b'#')).has_headers(has_headers).from_reader(text.as_bytes())
}

impl Rows {
    fn new(text: &str, file: &str) -> Result<Self, ConfigError> {
        let mut reader = reader(text, true);
        let broken = |e: csv::Error| {
            let at = usize::try_from(e.position().map_or(0, Position::byte)).unwrap_or_default();
            unreadable(&e).or_at(&place(file, text, at))
        };
        let header = reader.headers().map_err(broken)?.clone();
        let at_header = || place(file, text, 0);
        let fields: Vec<ParameterRef> = header
            .iter()
            .map(|name| super::field(name).map_err(|e| e.or_at(&at_header())))
            .collect::<Result<_, _>>()?;
        let twice =
            fields.iter().enumerate().find(|(i, f)| fields[..*i].iter().any(|g| g.path() == f.path()));
        if let Some((_, field)) = twice {
            let remedy = "name it in one column, and take the other out";
            return Err(
                config_error(&field.path(), None, "is named by two columns", remedy).or_at(&at_header())
            );
        }
        let (mut record, mut starts) = (csv::ByteRecord::new(), Vec::new());
        loop {
            let start = usize::try_from(reader.position().byte()).unwrap_or(usize::MAX);
            if !reader.read_byte_record(&mut record).map_err(broken)? {
                break;
            }
            starts.push(start);
        }
        if starts.is_empty() {
            let remedy = "write one variant a line under the header";
            return Err(config_error("rows", None, "holds no row", remedy).or_at(&at_header()));
        }
        Ok(Self { file: file.to_owned(), text: text.to_owned(), fields, starts })
    }

    /// The values of a row, each accepted by its field.
    fn row(&self, index: usize) -> Result<Vec<Value>, ConfigError> {
        let start = self.starts.get(index).copied().unwrap_or_default();
        let mut record = StringRecord::new();
        let at = || place(&self.file, &self.text, start);
        reader(self.text.get(start..).unwrap_or_default(), false)
            .read_record(&mut record)
            .map_err(|e| unreadable(&e).or_at(&at()))?;
        let cells = self.fields.iter().zip(record.iter());
        cells
            .map(|(field, cell)| {
                // A bare word is taken as text, as with --set.
                let value = cell.parse::<Value>().unwrap_or_else(|_| Value::from(cell));
                super::accepted(field, &value).map_err(|e| e.or_at(&at()))
            })
            .collect()
    }

    fn check(&self) -> Result<(), ConfigError> {
        (0..self.starts.len()).try_for_each(|index| self.row(index).map(drop))
    }
}

/// The error of a row that is no CSV of the header's width.
fn unreadable(error: &csv::Error) -> ConfigError {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => config_error(
            "row",
            None,
            &format!("has {len} cells, and the header names {expected_len} columns"),
            "give one cell for each column, with quotes around a cell that has a comma, such as \"[5, 8]\"",
        ),
        _ => config_error("row", None, &format!("is no CSV: {error}"), "save the rows as CSV in UTF-8"),
    }
}

/// The line of the first row at or after byte `start`, which is no comment and not empty.
fn place(file: &str, text: &str, start: usize) -> Location {
    let mut offset = start.min(text.len());
    for line in text.get(offset..).unwrap_or_default().split_inclusive('\n') {
        if !line.trim().is_empty() && !line.starts_with('#') {
            break;
        }
        offset += line.len();
    }
    let line = text.get(..offset).unwrap_or_default().matches('\n').count() + 1;
    Location::line(file, line)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_take_any_field() {
        let level = axis(
            "layout.pins, shell.width_mm,support.slots\n# two\n\"[5, 8]\",12,all\n\n[4],13.5,occupied\n",
            "a.csv",
        );
        let level = level.unwrap();
        let texts: Vec<_> = level.row(0).iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["[5, 8]", "12.0", "\"all\""]);
        let texts: Vec<_> = level.row(1).iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["[4]", "13.5", "\"occupied\""]);
        assert_eq!(level.count(), 2);
    }

    #[test]
    fn complaints_name_the_line() {
        for (text, expected) in [
            ("shell.with_mm\n3\n", "a.csv:1: shell.with_mm is no known field"),
            ("shell.width_mm\n12\n-3\n", "a.csv:3: shell.width_mm = -3 is not accepted"),
            ("shell.width_mm\n12\n# a\n\n-3\n", "a.csv:5: shell.width_mm = -3 is not accepted"),
            (
                "shell.width_mm,shell.wall_mm\n12\n",
                "a.csv:2: row has 1 cells, and the header names 2 columns; give one cell",
            ),
            ("shell.width_mm,shell.wall_mm\n# a\n12\n", "a.csv:3: row has 1 cells"),
            ("shell.width_mm\n", "a.csv:1: rows holds no row"),
            ("shell.width_mm,shell.width_mm\n12,13\n", "a.csv:1: shell.width_mm is named by two columns"),
        ] {
            let error = axis(text, "a.csv").and_then(|level| level.check()).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
