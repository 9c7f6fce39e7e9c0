//! `[rows]`: a CSV of rows, one variant a row, its columns named after fields.

use toml_edit::{Item, Value};

use super::{AxisTable, ParameterRef, SweepAxis, config_error};
use crate::source::SweepSource;
use pinswitch_switch::config::{ConfigError, Place};

/// The table that names the file of rows, whose text the sweep's source holds.
pub(super) const TABLE: AxisTable = AxisTable { name: "rows", keys: &["file"], level: 0, read };

fn read(source: &SweepSource, _: &Item) -> Result<Vec<SweepAxis>, ConfigError> {
    source.rows.iter().map(|(file, text)| rows(text, file)).collect()
}

/// Reads the rows in `text`; `file` names them in errors.
///
/// # Errors
/// [`ConfigError`] with file and line for a column that is no field, a value that it does not accept, a row that is
/// too short, or no rows.
fn rows(text: &str, file: &str) -> Result<SweepAxis, ConfigError> {
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let at = |line: u64| Place { file: file.to_owned(), line: usize::try_from(line).ok() };
    let broken = |e: csv::Error| {
        let line = e.position().map_or(1, csv::Position::line);
        ConfigError::syntax(at(line), &e.to_string())
    };
    let header = reader.headers().map_err(broken)?.clone();
    let fields: Vec<ParameterRef> =
        header.iter().map(|name| super::field(name).map_err(|e| e.at(at(1)))).collect::<Result<_, _>>()?;
    let mut rows: Vec<Vec<Value>> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(broken)?;
        let line = record.position().map_or(0, csv::Position::line);
        let cells = fields.iter().zip(record.iter());
        let row: Vec<_> = cells
            .map(|(field, cell)| {
                // A bare word is taken as text, as with --set.
                let value = cell.parse::<Value>().unwrap_or_else(|_| Value::from(cell));
                super::accepted(field, &value).map_err(|e| e.at(at(line)))
            })
            .collect::<Result<_, _>>()?;
        rows.push(row);
    }
    if rows.is_empty() {
        return Err(
            config_error("rows", None, "holds no row", "write one variant a line under the header").at(at(1))
        );
    }
    let count = rows.len() as u64;
    let row = move |index| usize::try_from(index).ok().and_then(|i| rows.get(i).cloned()).unwrap_or_default();
    Ok(SweepAxis::new(fields, count, row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_take_any_field() {
        let level = rows(
            "layout.pins, shell.width_mm,support.slots\n\"[5, 8]\",12,all\n[4],13.5,occupied\n",
            "a.csv",
        );
        let level = level.unwrap();
        let texts: Vec<_> = level.row(0).iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["[5, 8]", "12.0", "\"all\""]);
        assert_eq!(level.count(), 2);
    }

    #[test]
    fn complaints_name_the_line() {
        for (text, expected) in [
            ("shell.with_mm\n3\n", "a.csv:1: shell.with_mm is no known field"),
            ("shell.width_mm\n12\n-3\n", "a.csv:3: shell.width_mm = -3 is not accepted"),
            ("shell.width_mm,shell.wall_mm\n12\n", "a.csv:2: syntax"),
            ("shell.width_mm\n", "a.csv:1: rows holds no row"),
        ] {
            let error = rows(text, "a.csv").unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
