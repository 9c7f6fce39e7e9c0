//! Excel and OpenDocument workbooks.

/// Reads a sheet of a workbook: the named one, or the first with numbers.
#[cfg(not(feature = "spreadsheets"))]
pub(crate) fn read(
    _: &[u8],
    _: Option<&str>,
) -> Result<crate::recording::Recording, pinswitch_diagnostic::Diagnostic> {
    Err(pinswitch_diagnostic::Diagnostic::new(
        pinswitch_diagnostic::codes::FEATURE_NOT_BUILT,
        "this program was built without Excel and OpenDocument files",
    )
    .with_help("export the sheet as CSV"))
}

#[cfg(feature = "spreadsheets")]
pub(crate) use reader::read;

#[cfg(feature = "spreadsheets")]
mod reader {
    use std::io::Cursor;

    use calamine::{Data, DataRef, Range, Reader, Sheets, open_workbook_auto_from_rs};
    use pinswitch_diagnostic::{Diagnostic, codes};

    use crate::number::DecimalSign;
    use crate::recording::Recording;
    use crate::sheet::Sheet;

    /// Most bytes of a workbook.
    const MAX_BYTES: usize = 64 << 20;
    /// Serial numbers below it are times, in days: no one measured in January 1900.
    const CLOCK_DAYS: f64 = 4.0;
    /// Longest elapsed time in days: its hours have two digits.
    const MAX_ELAPSED_DAYS: f64 = 4.16;
    /// Most bytes of its unpacked contents.
    const MAX_UNPACKED: u64 = 256 << 20;
    /// Most cells of the rectangle that a sheet covers, and most bytes of their texts.
    const MAX_CELLS: u64 = 4_000_000;
    const MAX_TEXT: u64 = 128 << 20;

    /// Reads a sheet of a workbook: the named one, or the first with numbers.
    ///
    /// # Errors
    /// A [`Diagnostic`] for a damaged workbook, and for a sheet that does not exist or has no
    /// numbers.
    pub(crate) fn read(bytes: &[u8], sheet: Option<&str>) -> Result<Recording, Diagnostic> {
        if bytes.len() > MAX_BYTES || unpacked_bytes(bytes) > MAX_UNPACKED {
            return Err(Diagnostic::new(codes::FILE_TOO_LARGE, "the workbook is too large")
                .with_help("export the sheet as CSV"));
        }
        let damaged = |error: calamine::Error| {
            Diagnostic::new(codes::DAMAGED_FILE, "cannot read the workbook")
                .with_help("open it and save it again, or export the sheet as CSV")
                .with_source(error)
        };
        let mut workbook = open_workbook_auto_from_rs(Cursor::new(bytes)).map_err(damaged)?;
        let names = workbook.sheet_names();
        let mut first = None;
        for name in &names {
            if sheet.is_some_and(|wanted| wanted != name) {
                continue;
            }
            require_bounded(&mut workbook, name)?;
            let range = workbook.worksheet_range(name).map_err(damaged)?;
            let has_numbers = range
                .used_cells()
                .any(|(.., cell)| matches!(cell, Data::Float(_) | Data::Int(_)) || is_number(cell));
            if has_numbers || sheet.is_some() {
                first = Some((name.clone(), range));
                break;
            }
        }
        let Some((name, range)) = first else {
            let problem = sheet
                .map_or_else(|| "no sheet has numbers".to_owned(), |sheet| format!("no sheet '{sheet}'"));
            return Err(Diagnostic::new(codes::UNKNOWN_COLUMN, problem)
                .with_help(format!("the sheets are: {}", names.join(", "))));
        };
        let others: Vec<&str> = names.iter().filter(|other| **other != name).map(String::as_str).collect();
        let mut notes = vec![format!("sheet '{name}'")];
        if !others.is_empty() {
            notes.push(format!("other sheets: {}; choose with --set sheet=NAME", others.join(", ")));
        }
        let errors: Vec<String> = range
            .used_cells()
            .filter_map(
                |(.., cell)| if let Data::Error(error) = cell { Some(error.to_string()) } else { None },
            )
            .collect();
        if let Some(first) = errors.first() {
            notes.push(format!("{} cells with an error, such as {first}, count as empty", errors.len()));
        }
        Ok(Recording {
            sheet: cells(&range)?,
            format: "workbook".to_owned(),
            encoding: None,
            delimiter: None,
            sign: Some(DecimalSign::Point),
            notes,
        })
    }

    /// Refuses a sheet whose rectangle has too many cells, or too much text: a file of a kilobyte may have a cell in the
    /// last row, and one text in every cell. Older formats and OpenDocument have smaller sheets.
    fn require_bounded(workbook: &mut Sheets<Cursor<&[u8]>>, name: &str) -> Result<(), Diagnostic> {
        let mut extent = Extent::default();
        // A damaged sheet is reported when it is read.
        match workbook {
            Sheets::Xlsx(book) => {
                let Ok(mut cells) = book.worksheet_cells_reader(name) else { return Ok(()) };
                while let Ok(Some(cell)) = cells.next_cell() {
                    extent.add(cell.get_position(), cell.get_value())?;
                }
            }
            Sheets::Xlsb(book) => {
                let Ok(mut cells) = book.worksheet_cells_reader(name) else { return Ok(()) };
                while let Ok(Some(cell)) = cells.next_cell() {
                    extent.add(cell.get_position(), cell.get_value())?;
                }
            }
            Sheets::Xls(_) | Sheets::Ods(_) => {}
        }
        Ok(())
    }

    /// The rectangle of the cells so far, and the bytes of their texts.
    #[derive(Default)]
    struct Extent {
        rows: Option<(u32, u32)>,
        columns: Option<(u32, u32)>,
        text: u64,
    }

    impl Extent {
        fn add(&mut self, (row, column): (u32, u32), value: &DataRef<'_>) -> Result<(), Diagnostic> {
            let with = |span: Option<(u32, u32)>, at: u32| {
                span.map_or((at, at), |(first, last)| (first.min(at), last.max(at)))
            };
            let (rows, columns) = (with(self.rows, row), with(self.columns, column));
            (self.rows, self.columns) = (Some(rows), Some(columns));
            self.text += match value {
                DataRef::String(text) => text.len() as u64,
                DataRef::SharedString(text) => text.len() as u64,
                _ => 0,
            };
            let count = |(first, last): (u32, u32)| u64::from(last - first) + 1;
            if count(rows) * count(columns) > MAX_CELLS || self.text > MAX_TEXT {
                let problem = format!(
                    "the sheet is too large: cell {column} of row {row} extends it to more than {MAX_CELLS} cells",
                    column = column + 1,
                    row = row + 1
                );
                return Err(Diagnostic::new(codes::FILE_TOO_LARGE, problem)
                    .with_help("remove cells far from the table, or export it as CSV"));
            }
            Ok(())
        }
    }

    /// A time of up to four days as hours, minutes and seconds: dates of the year 1900 are such times.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the time is bounded")]
    fn elapsed(days: f64) -> String {
        let milliseconds = (days.clamp(0.0, MAX_ELAPSED_DAYS) * 86_400_000.0).round() as u64;
        let (seconds, rest) = (milliseconds / 1000, milliseconds % 1000);
        format!("{:02}:{:02}:{:02}.{rest:03}", seconds / 3600, seconds / 60 % 60, seconds % 60)
    }

    fn is_number(cell: &Data) -> bool {
        matches!(cell, Data::String(text) if crate::number::sign_evidence(text).is_some())
    }

    fn cells(range: &Range<Data>) -> Result<Sheet, Diagnostic> {
        let first = range.start().map_or(1, |(row, _)| row as usize + 1);
        let mut sheet = Sheet::default();
        for (i, row) in range.rows().enumerate() {
            if row.iter().all(|cell| matches!(cell, Data::Empty)) {
                continue;
            }
            for cell in row {
                sheet.push(&text(cell));
            }
            sheet.end_row(first + i)?;
        }
        Ok(sheet)
    }

    fn text(cell: &Data) -> String {
        match cell {
            Data::Empty | Data::Error(_) => String::new(),
            Data::DateTime(moment) => {
                let (year, month, day, hour, minute, second, millisecond) = moment.to_ymd_hms_milli();
                let time = format!("{hour:02}:{minute:02}:{second:02}.{millisecond:03}");
                // A clock that runs on after midnight, and an elapsed time, have more than 24 hours.
                if moment.as_f64() < CLOCK_DAYS || moment.is_duration() {
                    elapsed(moment.as_f64())
                } else if moment.as_f64().fract() == 0.0 {
                    format!("{year}-{month:02}-{day:02}")
                } else {
                    format!("{year}-{month:02}-{day:02} {time}")
                }
            }
            other => other.to_string(),
        }
    }

    /// Returns the sum of the unpacked sizes that the directory of a ZIP archive declares
    /// (APPNOTE.TXT 4.3.12).
    fn unpacked_bytes(bytes: &[u8]) -> u64 {
        const ENTRY: &[u8] = b"PK\x01\x02";
        let mut sum = 0_u64;
        let mut at = 0;
        while let Some(found) = bytes.get(at..).and_then(|rest| rest.windows(4).position(|w| w == ENTRY)) {
            let entry = at + found;
            let size = bytes
                .get(entry + 24..entry + 28)
                .and_then(|b| b.try_into().ok())
                .map_or(0, u32::from_le_bytes);
            sum = sum.saturating_add(u64::from(size));
            at = entry + 46;
        }
        sum
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        /// A workbook with one sheet of these cells, as XML, and one shared text.
        fn workbook(cells: &str, shared: &str) -> Vec<u8> {
            use std::io::Write;
            use zip::write::SimpleFileOptions;
            const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
            const OF: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
            let sheet = format!("<worksheet xmlns=\"{MAIN}\"><sheetData>{cells}</sheetData></worksheet>");
            let texts = format!("<sst xmlns=\"{MAIN}\"><si><t>{shared}</t></si></sst>");
            let book = format!(
                "<workbook xmlns=\"{MAIN}\" xmlns:r=\"{OF}\"><sheets>\
                 <sheet name=\"a\" sheetId=\"1\" r:id=\"rId1\"/></sheets></workbook>"
            );
            let link = |id: &str, kind: &str, target: &str| {
                format!("<Relationship Id=\"{id}\" Type=\"{OF}/{kind}\" Target=\"{target}\"/>")
            };
            let links_of = |links: &str| {
                format!(
                    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">{links}</Relationships>"
                )
            };
            let links = links_of(
                &(link("rId1", "worksheet", "worksheets/sheet1.xml")
                    + &link("rId2", "sharedStrings", "sharedStrings.xml")),
            );
            let root = links_of(&link("rId1", "officeDocument", "xl/workbook.xml"));
            let types = "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
                         <Default Extension=\"xml\" ContentType=\"application/xml\"/></Types>"
                .to_owned();
            let mut file = zip::ZipWriter::new(Cursor::new(Vec::new()));
            for (name, text) in [
                ("[Content_Types].xml", &types),
                ("_rels/.rels", &root),
                ("xl/workbook.xml", &book),
                ("xl/_rels/workbook.xml.rels", &links),
                ("xl/worksheets/sheet1.xml", &sheet),
                ("xl/sharedStrings.xml", &texts),
            ] {
                file.start_file(name, SimpleFileOptions::default()).unwrap();
                file.write_all(text.as_bytes()).unwrap();
            }
            file.finish().unwrap().into_inner()
        }

        #[test]
        fn large_sheets_are_refused_unread() {
            let cell = |at: &str| {
                format!(
                    "<row r=\"{}\"><c r=\"{at}\"><v>1</v></c></row>",
                    at.trim_matches(char::is_alphabetic)
                )
            };
            let near = read(&workbook(&(cell("A1") + &cell("B2")), "x"), None).unwrap();
            assert_eq!(near.sheet.cell(0, 0), "1");
            // Two cells at the ends of a sheet would take 400 GB.
            let error = read(&workbook(&(cell("A1") + &cell("XFD1048576")), "x"), None).unwrap_err();
            assert!(error.to_string().contains("cell 16384 of row 1048576"), "{error}");
            // One text in many cells.
            let texts: String = (1..=2_000)
                .map(|row| format!("<row r=\"{row}\"><c r=\"A{row}\" t=\"s\"><v>0</v></c></row>"))
                .collect();
            let error = read(&workbook(&texts, &"x".repeat(100_000)), None).unwrap_err();
            assert!(error.to_string().contains("too large"), "{error}");
        }

        #[test]
        fn elapsed_times_have_any_hours() {
            assert_eq!(elapsed(0.5 + 1.0 / 86_400.0), "12:00:01.000");
            assert_eq!(elapsed(1.0 + 1.5 / 86_400.0), "24:00:01.500");
            assert_eq!(elapsed(0.999_999_999_9), "24:00:00.000");
        }

        #[test]
        fn damaged_workbooks_are_refused() {
            for bytes in [
                b"PK\x03\x04".as_slice(),
                b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
                b"PK\x03\x04\0\0\0\0[Content_Types].xml",
            ] {
                assert!(read(bytes, None).is_err());
            }
        }
    }
}
