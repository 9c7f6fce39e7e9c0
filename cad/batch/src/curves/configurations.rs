//! A table of configurations, as CSV or as Parquet; its columns have the names of fields.

use std::ops::Range;

use bytes::Bytes;
use parquet::file::reader::FileReader;
use parquet::record::{Field, Row};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_switch::config::text;
use sha2::{Digest, Sha256};
use toml_edit::{Array, Value};

use crate::axis::{ParameterRef, Rows, cell_value, column_fields};
use crate::hexadecimal;
use crate::table_files::{BatchTableError, column_names, open_parquet, parquet_rows};

/// First bytes of a Parquet file.
const PARQUET_MAGIC: &[u8] = b"PAR1";

/// A table with one configuration per row.
pub struct ConfigurationTable {
    file: String,
    sha256: String,
    fields: Vec<ParameterRef>,
    count: u64,
    source: Source,
}

enum Source {
    Csv(Rows),
    Parquet(Bytes),
}

impl ConfigurationTable {
    /// Reads the columns of a table; `file` is its name in errors.
    ///
    /// # Errors
    /// A column that is not a field, a table without rows, and a damaged file.
    pub fn read(bytes: Vec<u8>, file: &str) -> Result<Self, Diagnostic> {
        let sha256 = hexadecimal(&Sha256::digest(&bytes));
        let (fields, count, source) = if bytes.starts_with(PARQUET_MAGIC) {
            let bytes = Bytes::from(bytes);
            let (fields, count) = parquet_fields(&bytes, file)?;
            (fields, count, Source::Parquet(bytes))
        } else {
            let rows = Rows::new(&text(bytes, file)?, file)?;
            (rows.fields.clone(), rows.count() as u64, Source::Csv(rows))
        };
        Ok(Self { file: file.to_owned(), sha256, fields, count, source })
    }

    /// Returns the names of the columns of any CSV or Parquet file; none if it is neither.
    ///
    /// ```
    /// use pinswitch_batch::ConfigurationTable;
    ///
    /// assert_eq!(ConfigurationTable::column_names(b"shell.width_mm, layout.pins\n"), ["shell.width_mm", "layout.pins"]);
    /// ```
    pub fn column_names(bytes: &[u8]) -> Vec<String> {
        if bytes.starts_with(PARQUET_MAGIC) {
            let reader = open_parquet(Bytes::copy_from_slice(bytes));
            return reader.map(|r| column_names(&r).map(str::to_owned).collect()).unwrap_or_default();
        }
        let mut reader = csv::ReaderBuilder::new();
        let mut reader = reader.trim(csv::Trim::All).comment(Some(b'#')).flexible(true).from_reader(bytes);
        reader.headers().map(|h| h.iter().map(str::to_owned).collect()).unwrap_or_default()
    }

    /// Returns the number of rows.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Returns the fields of the columns.
    pub fn fields(&self) -> &[ParameterRef] {
        &self.fields
    }

    /// Returns the values in the cells of the first rows, at most `most`.
    ///
    /// # Errors
    /// A malformed row.
    pub fn first_rows(&self, most: u64) -> Result<Vec<Vec<Value>>, Diagnostic> {
        self.reader()?.take(0..self.count.min(most))
    }

    /// Returns the SHA-256 of the file.
    pub(super) fn sha256(&self) -> &str {
        &self.sha256
    }

    /// Returns a reader that starts at the first row.
    ///
    /// # Errors
    /// A damaged file.
    pub(super) fn reader(&self) -> Result<RowReader<'_>, Diagnostic> {
        Ok(match &self.source {
            Source::Csv(rows) => RowReader::Csv(rows),
            Source::Parquet(bytes) => {
                let rows = open_parquet(bytes.clone()).and_then(parquet_rows);
                let rows = rows.map_err(|e| damaged(&e, &self.file))?;
                RowReader::Parquet { table: self, rows: Box::new(rows), next: 0 }
            }
        })
    }
}

/// Reads the rows in ascending order; of a Parquet file only the current row group is in memory.
pub(super) enum RowReader<'a> {
    Csv(&'a Rows),
    Parquet {
        table: &'a ConfigurationTable,
        rows: Box<dyn Iterator<Item = Result<Row, BatchTableError>>>,
        /// Index of the next row.
        next: u64,
    },
}

impl RowReader<'_> {
    /// Returns the values in the cells of these rows, which follow all rows of earlier calls.
    ///
    /// # Errors
    /// A malformed row.
    pub(super) fn take(&mut self, range: Range<u64>) -> Result<Vec<Vec<Value>>, Diagnostic> {
        match self {
            Self::Csv(rows) => {
                range.map(|index| rows.cells(usize::try_from(index).unwrap_or(usize::MAX))).collect()
            }
            Self::Parquet { table, rows, next } => {
                let mut all = Vec::new();
                while *next < range.end {
                    let row = rows.next().unwrap_or(Err(BatchTableError::Invalid("rows are missing")));
                    let row = row.map_err(|e| damaged(&e, &table.file))?;
                    if range.contains(next) {
                        all.push(row.get_column_iter().map(|(_, field)| value(field)).collect());
                    }
                    *next += 1;
                }
                Ok(all)
            }
        }
    }
}

fn parquet_fields(bytes: &Bytes, file: &str) -> Result<(Vec<ParameterRef>, u64), Diagnostic> {
    let reader = open_parquet(bytes.clone()).map_err(|e| damaged(&e, file))?;
    let fields = column_fields(column_names(&reader), |e, _| e.or_in_file(file))?;
    let groups = reader.metadata().row_groups().iter();
    let count = groups.map(|group| u64::try_from(group.num_rows()).unwrap_or_default()).sum();
    if count == 0 || fields.is_empty() {
        let error = Diagnostic::new(codes::TABLE_WITHOUT_ROWS, "the table has no rows")
            .with_location(Location::file(file));
        return Err(error.with_help("write at least one row"));
    }
    Ok((fields, count))
}

fn damaged(error: &BatchTableError, file: &str) -> Diagnostic {
    error
        .diagnostic()
        .with_location(Location::file(file))
        .with_help("write the table again, uncompressed or compressed with Snappy, or as CSV")
}

/// Returns the value in a cell of a Parquet file. Text is read as in a CSV.
fn value(field: &Field) -> Value {
    match field {
        Field::Null => cell_value(""),
        Field::Bool(b) => Value::from(*b),
        Field::Byte(i) => Value::from(i64::from(*i)),
        Field::Short(i) => Value::from(i64::from(*i)),
        Field::Int(i) => Value::from(i64::from(*i)),
        Field::Long(i) => Value::from(*i),
        Field::UByte(i) => Value::from(i64::from(*i)),
        Field::UShort(i) => Value::from(i64::from(*i)),
        Field::UInt(i) => Value::from(i64::from(*i)),
        // The shortest decimal number, which is the one that was meant: 0.1, not 0.10000000149.
        Field::Float(x) => Value::from(x.to_string().parse::<f64>().unwrap_or_else(|_| f64::from(*x))),
        Field::Double(x) => Value::from(*x),
        Field::Str(text) => cell_value(text),
        Field::ListInternal(list) => Value::from(list.elements().iter().map(value).collect::<Array>()),
        other => cell_value(&other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{Cell, Column, ColumnType};
    use crate::table_files::ParquetTable;

    const CSV: &str = "layout.pins,shell.width_mm,segment.grooves,label.engrave\n\
                       \"[5, 8]\",12.5,15,true\n[4],13,,false\n\"[3]\",14,17,true\n";

    fn parquet() -> Vec<u8> {
        let kinds = [ColumnType::Text, ColumnType::Real, ColumnType::Integer, ColumnType::Boolean];
        let columns: Vec<Column> = ConfigurationTable::column_names(CSV.as_bytes())
            .into_iter()
            .zip(kinds)
            .map(|(name, kind)| Column { name, kind })
            .collect();
        let mut table = ParquetTable::new(Vec::new(), &columns).unwrap();
        let text = |t: &str| Cell::Text(t.to_owned());
        for row in [
            [text("[5, 8]"), Cell::Real(12.5), Cell::Integer(15), Cell::Boolean(true)],
            [text("[4]"), Cell::Real(13.0), Cell::Empty, Cell::Boolean(false)],
            [text("[3]"), Cell::Real(14.0), Cell::Integer(17), Cell::Boolean(true)],
        ] {
            table.push(row.to_vec()).unwrap();
        }
        table.finish().unwrap()
    }

    #[test]
    fn parquet_and_csv_have_equal_cells() {
        let accepted = |bytes: Vec<u8>| {
            let table = ConfigurationTable::read(bytes, "t").unwrap();
            assert_eq!(table.count(), 3);
            let mut reader = table.reader().unwrap();
            // Rows of finished blocks are passed over.
            let rows = [reader.take(0..1).unwrap(), reader.take(2..3).unwrap()].concat();
            let shown = |row: Vec<Value>| -> Vec<String> {
                let cells = table.fields().iter().zip(&row);
                cells.map(|(f, v)| crate::axis::accepted(f, v).unwrap().to_string()).collect()
            };
            rows.into_iter().map(shown).collect::<Vec<_>>()
        };
        let rows = accepted(CSV.as_bytes().to_vec());
        assert_eq!(rows, [["[5, 8]", "12.5", "15", "true"], ["[3]", "14.0", "17", "true"]]);
        assert_eq!(accepted(parquet()), rows);
    }

    #[test]
    fn damaged_parquet_is_refused() {
        let bytes = parquet();
        for length in [4, 40, bytes.len() - 9, bytes.len() - 1] {
            let error = ConfigurationTable::read(bytes[..length].to_vec(), "t.parquet").err().unwrap();
            assert!(error.to_string().starts_with("t.parquet: "), "{error}");
        }
    }
}
