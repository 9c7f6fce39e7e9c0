//! The table as CSV and as Parquet: written row by row in bounded memory, and read from Parquet.

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, ConvertedType, Repetition, Type as Physical};
use parquet::column::writer::{ColumnCloseResult, ColumnWriter};
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::properties::{WriterProperties, WriterPropertiesPtr};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::reader::RowIter;
use parquet::record::{Field, Row as ParquetRow};
use parquet::schema::types::{Type, TypePtr};
use pinswitch_diagnostic::{Diagnostic, codes};

use super::diagnostics::diagnostic_error;
use super::table::{Cell, Column, ColumnType, Row, Schema};

/// Rows per group of the Parquet file, which are in memory together.
const GROUP_ROWS: usize = 4096;

/// Most values of a list in a cell, such as the pins of a layout.
const MAX_LIST: u64 = 1000;
/// Most values in the lists of a column and row group: the library has them in memory.
const MAX_LIST_VALUES: u64 = 4 << 20;

/// Why a table cannot be written or read.
#[derive(Debug)]
pub enum BatchTableError {
    /// The CSV cannot be written.
    Csv(csv::Error),
    /// The Parquet file cannot be written or read.
    Parquet(ParquetError),
    /// A file cannot be written.
    File(std::io::Error),
    /// The Parquet file is damaged, or not a table of this sweep.
    Invalid(&'static str),
}

impl BatchTableError {
    pub(super) fn diagnostic(&self) -> Diagnostic {
        let (code, problem) = match self {
            Self::Csv(error) => (codes::CANNOT_WRITE, format!("cannot write the table as CSV: {error}")),
            Self::Parquet(error) => {
                (codes::DAMAGED_FILE, format!("cannot write or read the Parquet table: {error}"))
            }
            Self::File(error) => (codes::CANNOT_WRITE, format!("cannot write the table: {error}")),
            Self::Invalid(problem) => (codes::DAMAGED_FILE, format!("invalid Parquet table: {problem}")),
        };
        Diagnostic::new(code, problem)
    }

    fn cause(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Csv(error) => Some(error),
            Self::Parquet(error) => Some(error),
            Self::File(error) => Some(error),
            Self::Invalid(_) => None,
        }
    }
}

diagnostic_error!(BatchTableError);

impl From<csv::Error> for BatchTableError {
    fn from(error: csv::Error) -> Self {
        Self::Csv(error)
    }
}

impl From<ParquetError> for BatchTableError {
    fn from(error: ParquetError) -> Self {
        Self::Parquet(error)
    }
}

impl From<std::io::Error> for BatchTableError {
    fn from(error: std::io::Error) -> Self {
        Self::File(error)
    }
}

/// Writer of both files of a table.
pub struct TableWriter {
    csv: CsvTable<BufWriter<File>>,
    parquet: ParquetTable<BufWriter<File>>,
}

impl TableWriter {
    /// Creates both files.
    ///
    /// # Errors
    /// A file that cannot be created.
    pub fn create(schema: &Schema, csv: &Path, parquet: &Path) -> Result<Self, BatchTableError> {
        Ok(Self {
            csv: CsvTable::with_header(BufWriter::new(File::create(csv)?), schema.columns())?,
            parquet: ParquetTable::new(BufWriter::new(File::create(parquet)?), schema.columns())?,
        })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A file that cannot be written, for example on a full disk.
    pub fn push(&mut self, row: Row) -> Result<(), BatchTableError> {
        self.csv.push(&row)?;
        self.parquet.push(row)
    }

    /// Completes both files.
    ///
    /// # Errors
    /// A file that cannot be written, for example on a full disk.
    pub fn finish(self) -> Result<(), BatchTableError> {
        self.csv.finish()?;
        self.parquet.finish().map(drop)
    }
}

/// Writer of a CSV.
pub(crate) struct CsvTable<W: Write>(csv::Writer<W>);

impl<W: Write> CsvTable<W> {
    /// A table without a header, which continues another one.
    pub(crate) fn new(output: W) -> Self {
        Self(csv::Writer::from_writer(output))
    }

    /// A table with the names of its columns.
    ///
    /// # Errors
    /// An output that cannot be written.
    pub(crate) fn with_header(output: W, columns: &[Column]) -> Result<Self, BatchTableError> {
        let mut table = Self::new(output);
        table.0.write_record(columns.iter().map(|c| c.name.as_str()))?;
        Ok(table)
    }

    /// Adds a row.
    ///
    /// # Errors
    /// An output that cannot be written.
    pub(crate) fn push(&mut self, row: &Row) -> Result<(), BatchTableError> {
        Ok(self.0.write_record(row.iter().map(ToString::to_string))?)
    }

    /// Completes the table and returns its output.
    ///
    /// # Errors
    /// An output that cannot be written.
    pub(crate) fn finish(self) -> Result<W, BatchTableError> {
        self.0.into_inner().map_err(|e| e.into_error().into())
    }
}

/// Writer of a Parquet file, group by group.
pub(crate) struct ParquetTable<W: Write + Send> {
    columns: usize,
    writer: SerializedFileWriter<W>,
    group: Vec<Row>,
}

impl<W: Write + Send> ParquetTable<W> {
    /// A table with these columns.
    ///
    /// # Errors
    /// An output that cannot be written.
    pub(crate) fn new(output: W, columns: &[Column]) -> Result<Self, BatchTableError> {
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let properties = WriterPropertiesPtr::new(properties);
        let writer = SerializedFileWriter::new(output, parquet_schema(columns)?, properties)?;
        Ok(Self { columns: columns.len(), writer, group: Vec::new() })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// An output that cannot be written.
    pub(crate) fn push(&mut self, row: Row) -> Result<(), BatchTableError> {
        self.group.push(row);
        if self.group.len() == GROUP_ROWS { self.write_group() } else { Ok(()) }
    }

    /// Adds the groups of a file that [`ParquetTable`] wrote with the same columns, without decoding them.
    ///
    /// # Errors
    /// A damaged file, and an output that cannot be written.
    pub(crate) fn append(&mut self, file: Bytes) -> Result<(), BatchTableError> {
        self.write_group()?;
        let reader = open_parquet(file.clone())?;
        for group in reader.metadata().row_groups() {
            let mut copy = self.writer.next_row_group()?;
            for column in group.columns() {
                let unsigned = |n: i64| u64::try_from(n).unwrap_or_default();
                let chunk = ColumnCloseResult {
                    bytes_written: unsigned(column.compressed_size()),
                    rows_written: unsigned(group.num_rows()),
                    metadata: column.clone(),
                    bloom_filter: None,
                    column_index: None,
                    offset_index: None,
                };
                copy.append_column(&file, chunk)?;
            }
            copy.close()?;
        }
        Ok(())
    }

    /// Completes the file and returns its output.
    ///
    /// # Errors
    /// An output that cannot be written.
    pub(crate) fn finish(mut self) -> Result<W, BatchTableError> {
        self.write_group()?;
        Ok(self.writer.into_inner()?)
    }

    fn write_group(&mut self) -> Result<(), BatchTableError> {
        let rows = std::mem::take(&mut self.group);
        if rows.is_empty() {
            return Ok(());
        }
        let mut group = self.writer.next_row_group()?;
        for i in 0..self.columns {
            let Some(mut column) = group.next_column()? else { break };
            let present: Vec<_> = rows.iter().map(|row| &row[i]).collect();
            let levels: Vec<i16> = present.iter().map(|c| i16::from(**c != Cell::Empty)).collect();
            match column.untyped() {
                ColumnWriter::DoubleColumnWriter(typed) => {
                    let values: Vec<_> = present
                        .iter()
                        .filter_map(|c| if let Cell::Real(x) = c { Some(*x) } else { None })
                        .collect();
                    typed.write_batch(&values, Some(&levels), None)?;
                }
                ColumnWriter::Int64ColumnWriter(typed) => {
                    let values: Vec<_> = present
                        .iter()
                        .filter_map(|c| if let Cell::Integer(x) = c { Some(*x) } else { None })
                        .collect();
                    typed.write_batch(&values, Some(&levels), None)?;
                }
                ColumnWriter::BoolColumnWriter(typed) => {
                    let values: Vec<_> = present
                        .iter()
                        .filter_map(|c| if let Cell::Boolean(x) = c { Some(*x) } else { None })
                        .collect();
                    typed.write_batch(&values, Some(&levels), None)?;
                }
                ColumnWriter::ByteArrayColumnWriter(typed) => {
                    let values: Vec<ByteArray> =
                        present.iter().filter_map(|c| c.text().map(ByteArray::from)).collect();
                    typed.write_batch(&values, Some(&levels), None)?;
                }
                _ => {}
            }
            column.close()?;
        }
        group.close()?;
        Ok(())
    }
}

fn parquet_schema(columns: &[Column]) -> Result<TypePtr, ParquetError> {
    let field = |column: &Column| {
        let (physical, converted) = match column.kind {
            ColumnType::Text => (Physical::BYTE_ARRAY, ConvertedType::UTF8),
            ColumnType::Real => (Physical::DOUBLE, ConvertedType::NONE),
            ColumnType::Integer => (Physical::INT64, ConvertedType::NONE),
            ColumnType::Boolean => (Physical::BOOLEAN, ConvertedType::NONE),
        };
        Type::primitive_type_builder(&column.name, physical)
            .with_converted_type(converted)
            .with_repetition(Repetition::OPTIONAL)
            .build()
            .map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder("variants").with_fields(fields).build().map(Arc::new)
}

/// Reads the rows of a Parquet table with the columns of `schema`, one by one.
///
/// # Errors
/// A damaged table, and a table with other columns.
pub fn read_rows(
    bytes: Vec<u8>,
    schema: &Schema,
) -> Result<impl Iterator<Item = Result<Row, BatchTableError>> + use<>, BatchTableError> {
    let reader = open_parquet(Bytes::from(bytes))?;
    if !column_names(&reader).eq(schema.columns().iter().map(|c| c.name.as_str())) {
        return Err(BatchTableError::Invalid("the columns are not those of this sweep"));
    }
    let cells = |row: ParquetRow| row.get_column_iter().map(|(_, field)| cell(field)).collect();
    Ok(parquet_rows(reader)?.map(move |row| row.map(cells)))
}

/// Opens a Parquet file of any program.
///
/// # Errors
/// A damaged file.
pub(crate) fn open_parquet(bytes: Bytes) -> Result<SerializedFileReader<Bytes>, BatchTableError> {
    let length = bytes.len() as u64;
    let reader = catch_panic(|| SerializedFileReader::new(bytes))??;
    check_extents(reader.metadata(), length)?;
    Ok(reader)
}

/// Returns the names of the columns.
pub(crate) fn column_names(reader: &SerializedFileReader<Bytes>) -> impl Iterator<Item = &str> {
    reader.metadata().file_metadata().schema().get_fields().iter().map(|f| f.name())
}

/// Reads the rows one by one; an error is the last item.
///
/// # Errors
/// A damaged file.
pub(crate) fn parquet_rows(
    reader: SerializedFileReader<Bytes>,
) -> Result<impl Iterator<Item = Result<ParquetRow, BatchTableError>> + use<>, BatchTableError> {
    let mut rows = Some(catch_panic(|| RowIter::from_file_into(Box::new(reader)))?);
    let next = move || {
        let row = catch_panic(|| rows.as_mut().and_then(Iterator::next));
        let row = match row {
            Ok(row) => row?.map_err(BatchTableError::from),
            Err(e) => Err(e),
        };
        if row.is_err() {
            rows = None;
        }
        Some(row)
    };
    Ok(std::iter::from_fn(next))
}

/// Calls `read`, and turns a panic into an error: fuzzing (`fuzz/targets/shard_table.rs`) found
/// files that no program writes, on which the Parquet library panics.
fn catch_panic<T>(read: impl FnOnce() -> T) -> Result<T, BatchTableError> {
    catch_unwind(AssertUnwindSafe(read)).map_err(|_| BatchTableError::Invalid("damaged data"))
}

/// Checks that every column is within the file and has as many values as rows, or a bounded number of
/// them in lists: the library trusts these numbers.
fn check_extents(metadata: &ParquetMetaData, length: u64) -> Result<(), BatchTableError> {
    let unsigned =
        |n: i64| u64::try_from(n).map_err(|_| BatchTableError::Invalid("negative offset or length"));
    for group in metadata.row_groups() {
        let rows = unsigned(group.num_rows())?;
        for column in group.columns() {
            let offsets = [Some(column.data_page_offset()), column.dictionary_page_offset()];
            let start = offsets.into_iter().flatten().map(unsigned).collect::<Result<Vec<_>, _>>()?;
            let start = start.into_iter().min().unwrap_or_default();
            let end = start.saturating_add(unsigned(column.compressed_size())?);
            unsigned(column.uncompressed_size())?;
            let values = unsigned(column.num_values())?;
            let is_list = column.column_descr().max_rep_level() > 0;
            let most = if is_list { rows.saturating_mul(MAX_LIST).min(MAX_LIST_VALUES) } else { rows };
            if values < rows || values > most || end > length {
                return Err(BatchTableError::Invalid("a column exceeds the file or its rows"));
            }
        }
    }
    Ok(())
}

pub(crate) fn cell(field: &Field) -> Cell {
    match field {
        Field::Str(text) => Cell::Text(text.clone()),
        Field::Double(x) => Cell::Real(*x),
        Field::Long(i) => Cell::Integer(*i),
        Field::Bool(b) => Cell::Boolean(*b),
        _ => Cell::Empty,
    }
}
