//! The table as CSV and as Parquet: written row by row in bounded memory, and read from Parquet.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, ConvertedType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::properties::{WriterProperties, WriterPropertiesPtr};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::Field;
use parquet::record::reader::RowIter;
use parquet::schema::types::{Type, TypePtr};
use pinswitch_diagnostic::Diagnostic;

use super::diagnostics::diagnostic_error;
use super::table::{Cell, Column, ColumnType, Row, Schema};

/// Rows per group of the Parquet file, which are in memory together.
const GROUP_ROWS: usize = 4096;

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
        Diagnostic::new(match self {
            Self::Csv(error) => format!("cannot write the table as CSV: {error}"),
            Self::Parquet(error) => format!("cannot write or read the Parquet table: {error}"),
            Self::File(error) => format!("cannot write the table: {error}"),
            Self::Invalid(problem) => format!("invalid Parquet table: {problem}"),
        })
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
    schema: Schema,
    csv: csv::Writer<BufWriter<File>>,
    parquet: SerializedFileWriter<BufWriter<File>>,
    group: Vec<Row>,
}

impl TableWriter {
    /// Creates both files.
    ///
    /// # Errors
    /// A file that cannot be created.
    pub fn create(schema: &Schema, csv: &Path, parquet: &Path) -> Result<Self, BatchTableError> {
        let mut csv = csv::Writer::from_writer(BufWriter::new(File::create(csv)?));
        csv.write_record(schema.columns().iter().map(|c| c.name.as_str()))?;
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("pinswitch ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let parquet = SerializedFileWriter::new(
            BufWriter::new(File::create(parquet)?),
            parquet_schema(schema)?,
            WriterPropertiesPtr::new(properties),
        )?;
        Ok(Self { schema: schema.clone(), csv, parquet, group: Vec::new() })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A file that cannot be written, for example on a full disk.
    pub fn push(&mut self, row: Row) -> Result<(), BatchTableError> {
        self.csv.write_record(row.iter().map(ToString::to_string))?;
        self.group.push(row);
        if self.group.len() == GROUP_ROWS { self.write_group() } else { Ok(()) }
    }

    /// Completes both files.
    ///
    /// # Errors
    /// A file that cannot be written, for example on a full disk.
    pub fn finish(mut self) -> Result<(), BatchTableError> {
        self.write_group()?;
        self.csv.flush()?;
        self.parquet.close()?;
        Ok(())
    }

    fn write_group(&mut self) -> Result<(), BatchTableError> {
        let rows = std::mem::take(&mut self.group);
        if rows.is_empty() {
            return Ok(());
        }
        let mut group = self.parquet.next_row_group()?;
        for i in 0..self.schema.columns().len() {
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

fn parquet_schema(schema: &Schema) -> Result<TypePtr, ParquetError> {
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
    let fields = schema.columns().iter().map(field).collect::<Result<_, _>>()?;
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
    let length = bytes.len() as u64;
    let reader = catch_panic(|| SerializedFileReader::new(Bytes::from(bytes)))??;
    check_extents(reader.metadata(), length)?;
    let names: Vec<_> =
        reader.metadata().file_metadata().schema().get_fields().iter().map(|f| f.name().to_owned()).collect();
    if !names.iter().map(String::as_str).eq(schema.columns().iter().map(|c| c.name.as_str())) {
        return Err(BatchTableError::Invalid("the columns are not those of this sweep"));
    }
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
        Some(row.map(|row| row.get_column_iter().map(|(_, field)| cell(field)).collect()))
    };
    Ok(std::iter::from_fn(next))
}

/// Calls `read`, and turns a panic into an error: fuzzing (`fuzz/targets/shard_table.rs`) found
/// files that no program writes, on which the Parquet library panics.
fn catch_panic<T>(read: impl FnOnce() -> T) -> Result<T, BatchTableError> {
    catch_unwind(AssertUnwindSafe(read)).map_err(|_| BatchTableError::Invalid("damaged data"))
}

/// Checks that every column is within the file and has as many values as rows: the library trusts
/// these numbers.
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
            if unsigned(column.num_values())? != rows || end > length {
                return Err(BatchTableError::Invalid("a column exceeds the file or its rows"));
            }
        }
    }
    Ok(())
}

fn cell(field: &Field) -> Cell {
    match field {
        Field::Str(text) => Cell::Text(text.clone()),
        Field::Double(x) => Cell::Real(*x),
        Field::Long(i) => Cell::Integer(*i),
        Field::Bool(b) => Cell::Boolean(*b),
        _ => Cell::Empty,
    }
}
