//! Apache Parquet files with plain columns.

/// Reads the columns of a Parquet file.
#[cfg(not(feature = "parquet"))]
pub(crate) fn read(_: &[u8]) -> Result<crate::recording::Recording, pinswitch_diagnostic::Diagnostic> {
    Err(pinswitch_diagnostic::Diagnostic::new(
        pinswitch_diagnostic::codes::FEATURE_NOT_BUILT,
        "this program was built without Parquet files",
    )
    .with_help("export the table as CSV"))
}

#[cfg(feature = "parquet")]
pub(crate) use reader::read;

#[cfg(feature = "parquet")]
mod reader {
    use bytes::Bytes;
    use parquet::errors::ParquetError;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;
    use pinswitch_diagnostic::{Diagnostic, codes};

    use crate::number::DecimalSign;
    use crate::recording::Recording;
    use crate::sheet::Sheet;

    /// Most cells of a file, and most bytes of their texts.
    const MAX_CELLS: u64 = 4_000_000;
    const MAX_TEXT: usize = 128 << 20;

    /// Reads the columns of a Parquet file.
    ///
    /// # Errors
    /// A [`Diagnostic`] for a damaged file and for a compression that this program does not have.
    pub(crate) fn read(bytes: &[u8]) -> Result<Recording, Diagnostic> {
        let damaged = |error: ParquetError| {
            Diagnostic::new(codes::DAMAGED_FILE, "cannot read the Parquet file")
                .with_help("write it without compression or with Snappy, or export the table as CSV")
                .with_source(error)
        };
        let reader = SerializedFileReader::new(Bytes::copy_from_slice(bytes)).map_err(damaged)?;
        // Before the work: a few bytes may repeat one value many times.
        let file = reader.metadata().file_metadata();
        let columns = file.schema().get_fields().len() as u64;
        let rows = u64::try_from(file.num_rows()).unwrap_or(u64::MAX);
        require_bounded(rows.saturating_mul(columns), 0)?;
        let (mut cells, mut text_bytes) = (0_u64, 0_usize);
        let mut sheet = Sheet::default();
        for field in reader.metadata().file_metadata().schema().get_fields() {
            sheet.push(field.name());
        }
        sheet.end_row(1)?;
        for (i, row) in reader.get_row_iter(None).map_err(damaged)?.enumerate() {
            for (_, field) in row.map_err(damaged)?.get_column_iter() {
                let text = text(field);
                (cells, text_bytes) = (cells + 1, text_bytes + text.len());
                require_bounded(cells, text_bytes)?;
                sheet.push(&text);
            }
            sheet.end_row(i + 2)?;
        }
        Ok(Recording {
            sheet,
            format: "Parquet".to_owned(),
            encoding: None,
            delimiter: None,
            sign: Some(DecimalSign::Point),
            notes: Vec::new(),
        })
    }

    fn text(field: &Field) -> String {
        match field {
            Field::Null => String::new(),
            Field::Str(text) => text.clone(),
            Field::Double(value) => value.to_string(),
            Field::Float(value) => value.to_string(),
            // Milliseconds and microseconds since 1970, as seconds.
            Field::TimestampMillis(value) => format!("{value}e-3"),
            Field::TimestampMicros(value) => format!("{value}e-6"),
            other => other.to_string(),
        }
    }

    /// Refuses more than [`MAX_CELLS`] cells, or more than [`MAX_TEXT`] bytes of text.
    fn require_bounded(cells: u64, text_bytes: usize) -> Result<(), Diagnostic> {
        if cells <= MAX_CELLS && text_bytes <= MAX_TEXT {
            return Ok(());
        }
        Err(Diagnostic::new(codes::FILE_TOO_LARGE, "the Parquet file is too large")
            .with_help(format!("write at most {MAX_CELLS} cells with {} MB of text", MAX_TEXT >> 20)))
    }

    #[cfg(test)]
    mod tests {
        use std::sync::Arc;

        use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
        use parquet::file::writer::SerializedFileWriter;
        use parquet::schema::parser::parse_message_type;

        use super::*;

        #[test]
        fn repeated_values_are_refused_unread() {
            let schema = Arc::new(parse_message_type("message m { REQUIRED BINARY a (UTF8); }").unwrap());
            let file = |count: usize, length: usize| {
                let mut bytes = Vec::new();
                let mut file = SerializedFileWriter::new(&mut bytes, schema.clone(), Arc::default()).unwrap();
                let mut group = file.next_row_group().unwrap();
                let mut column = group.next_column().unwrap().unwrap();
                let texts = vec![ByteArray::from("x".repeat(length).as_str()); count];
                column.typed::<ByteArrayType>().write_batch(&texts, None, None).unwrap();
                column.close().unwrap();
                group.close().unwrap();
                file.close().unwrap();
                bytes
            };
            assert!(read(&file(10, 10)).is_ok());
            // A long text is stored once.
            let long = file(10_000, 15_000);
            assert!(long.len() < 1 << 20, "{}", long.len());
            for bytes in [long, file(4_000_001, 1)] {
                assert!(read(&bytes).unwrap_err().to_string().contains("too large"));
            }
        }

        #[test]
        fn plain_columns_are_read() {
            let schema = "message m { REQUIRED DOUBLE load_kg; REQUIRED BINARY direction (UTF8); REQUIRED DOUBLE force_N; }";
            let schema = Arc::new(parse_message_type(schema).unwrap());
            let mut bytes = Vec::new();
            let mut file = SerializedFileWriter::new(&mut bytes, schema, Arc::default()).unwrap();
            let mut group = file.next_row_group().unwrap();
            for number in 0..3 {
                let mut column = group.next_column().unwrap().unwrap();
                let words = [ByteArray::from("up"), ByteArray::from("down")];
                let written = match number {
                    0 => column.typed::<DoubleType>().write_batch(&[1.0, 1.0], None, None),
                    1 => column.typed::<ByteArrayType>().write_batch(&words, None, None),
                    _ => column.typed::<DoubleType>().write_batch(&[12.5, 0.1 + 0.2], None, None),
                };
                assert_eq!(written.unwrap(), 2);
                column.close().unwrap();
            }
            group.close().unwrap();
            file.close().unwrap();
            let sheet = read(&bytes).unwrap().sheet;
            let row = |row| sheet.row(row).collect::<Vec<_>>();
            assert_eq!(row(0), ["load_kg", "direction", "force_N"]);
            assert_eq!(row(2), ["1", "down", "0.30000000000000004"]);
            bytes.truncate(bytes.len() / 2);
            assert!(read(&bytes).is_err() && read(b"PAR1PAR1").is_err());
        }
    }
}
