//! The cells of a file of any format.

use pinswitch_diagnostic::{Diagnostic, codes};

use crate::dialect::{self, Delimiter};
use crate::encoding;
use crate::lvm;
use crate::map::Map;
use crate::number::DecimalSign;
use crate::sheet::Sheet;

/// Most bytes of a file: a log of a day at 200 Hz has 430 MB.
const MAX_BYTES: usize = 1 << 29;

/// The cells of a file, and what its format shows about them.
#[derive(Debug)]
pub(crate) struct Recording {
    pub(crate) sheet: Sheet,
    /// Format in words, such as `text`.
    pub(crate) format: String,
    pub(crate) encoding: Option<String>,
    pub(crate) delimiter: Option<Delimiter>,
    /// Decimal sign, if the format declares it.
    pub(crate) sign: Option<DecimalSign>,
    pub(crate) notes: Vec<String>,
}

impl Recording {
    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// A [`Diagnostic`] for a format that is not read, and for a file that is damaged or too large.
    pub(crate) fn read(bytes: &[u8], map: &Map) -> Result<Self, Diagnostic> {
        if bytes.len() > MAX_BYTES {
            return Err(Diagnostic::new(
                codes::FILE_TOO_LARGE,
                format!("{} bytes, at most {MAX_BYTES} are read", bytes.len()),
            )
            .with_help("divide the file, or leave out columns"));
        }
        if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xd0\xcf\x11\xe0") {
            return crate::workbook::read(bytes, map.sheet.as_deref());
        }
        if bytes.starts_with(b"PAR1") {
            return crate::parquet_file::read(bytes);
        }
        for (begin, name) in [
            (b"TDSm".as_slice(), "a LabVIEW TDMS file"),
            (b"\x89HDF", "an HDF5 file"),
            (b"MATLAB 5", "a MATLAB file"),
            (b"%PDF", "a PDF document"),
            (b"\x1f\x8b", "a gzip archive"),
        ] {
            if bytes.starts_with(begin) {
                return Err(Diagnostic::new(codes::NOT_A_TEXT, format!("{name} cannot be read"))
                    .with_help("export the data as CSV"));
            }
        }
        Self::read_text(bytes, map)
    }

    fn read_text(bytes: &[u8], map: &Map) -> Result<Self, Diagnostic> {
        let (text, encoding) = encoding::decode(bytes, map.encoding.as_deref())?;
        if lvm::is_lvm(&text) {
            let lvm = lvm::read(&text)?;
            return Ok(Self {
                sheet: lvm.sheet,
                format: "LabVIEW measurement (LVM)".to_owned(),
                encoding: Some(encoding),
                delimiter: Delimiter::parse(if lvm.separator == '\t' { "tab" } else { "," }),
                sign: Some(lvm.sign),
                notes: lvm.notes,
            });
        }
        let (declared, body, skipped) = dialect::declared(&text);
        let delimiter = map.delimiter.or(declared).unwrap_or_else(|| dialect::detect(body));
        let notes = declared.iter().map(|_| "line 1: declares the delimiter".to_owned()).collect();
        let sheet = dialect::cells(body, delimiter, skipped)?;
        if sheet.len() == 0 {
            return Err(Diagnostic::new(codes::DAMAGED_FILE, "the file is empty")
                .with_help("give a file with a line of names and lines of numbers"));
        }
        Ok(Self {
            sheet,
            format: "text".to_owned(),
            encoding: Some(encoding),
            delimiter: Some(delimiter),
            sign: None,
            notes,
        })
    }
}
