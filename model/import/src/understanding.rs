//! What was recognised in the files, for a person and for a program.

use std::fmt::{self, Write};

use pinswitch_diagnostic::{excerpt, neutral_line};
use schemars::JsonSchema;
use serde::Serialize;

use crate::column::Column;
use crate::file::FileReading;
use crate::quantity::Quantity;
use crate::question::Question;

/// Most characters of a name in the table of columns.
const MAX_NAME: usize = 32;
/// Most notes that are shown.
const MAX_NOTES: usize = 12;

/// What was recognised in the files.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Understanding {
    /// `table` or `log`.
    pub kind: &'static str,
    /// Each file.
    pub files: Vec<FileUnderstanding>,
    /// Word of each direction, its direction, and the number of its readings.
    pub directions: Vec<(String, &'static str, usize)>,
    /// Values of columns that the files lack, and whether the user gave them.
    pub constants: Vec<(String, String, bool)>,
    /// Number of rows that are written.
    pub rows: usize,
    /// The names and the first three rows, as they are written.
    pub preview: Vec<String>,
    /// What is worth knowing.
    pub notes: Vec<String>,
    /// What is uncertain.
    pub questions: Vec<Question>,
}

/// What was recognised in one file.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct FileUnderstanding {
    /// Name of the file.
    pub name: String,
    /// Format, such as `text`.
    pub format: String,
    /// Encoding of a text.
    pub encoding: Option<String>,
    /// Delimiter of a text, as a word.
    pub delimiter: Option<String>,
    /// `point` or `comma`.
    pub decimal: &'static str,
    /// Line of the column names; absent in a file without names.
    pub header_line: Option<usize>,
    /// Line of the units.
    pub units_line: Option<usize>,
    /// Why it is a table or a log.
    pub kind_reason: &'static str,
    /// Each column.
    pub columns: Vec<ColumnUnderstanding>,
    /// Rows that were left out: reason, number, and first line.
    pub ignored_rows: Vec<(String, usize, usize)>,
    /// What its format shows.
    pub notes: Vec<String>,
}

/// What was recognised in one column.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct ColumnUnderstanding {
    /// Name in the file.
    pub name: String,
    /// Quantity, as the word of a map.
    pub quantity: &'static str,
    /// Unit in the file.
    pub unit: &'static str,
    /// Whether the unit follows from the values, because the file names none.
    pub assumed: bool,
    /// Factor to the unit that is written.
    pub factor: f64,
    /// Reading at zero, in the unit that is written.
    pub offset: f64,
    /// Unit that is written.
    pub written_unit: &'static str,
    /// Direction, load or trial of all its readings.
    pub readings: String,
    /// Why it is not read; empty for a column that is read.
    pub ignored: &'static str,
}

impl FileUnderstanding {
    pub(crate) fn new(file: &FileReading) -> Self {
        let sheet = &file.recording.sheet;
        Self {
            name: file.name.clone(),
            format: file.recording.format.clone(),
            encoding: file.recording.encoding.clone(),
            delimiter: file.recording.delimiter.map(crate::dialect::Delimiter::as_str),
            decimal: file.sign.as_str(),
            header_line: file.header.names_row.map(|row| sheet.line(row)),
            units_line: file.header.units_row.map(|row| sheet.line(row)),
            kind_reason: file.kind_reason,
            columns: file.columns.iter().map(ColumnUnderstanding::new).collect(),
            ignored_rows: file.skipped.clone(),
            notes: file.recording.notes.iter().cloned().chain(before_names(file)).collect(),
        }
    }
}

/// A note of lines with text before the names, which may have loads or angles.
fn before_names(file: &FileReading) -> Option<String> {
    let sheet = &file.recording.sheet;
    let before = file.header.names_row.unwrap_or(0);
    let text = |row: usize| sheet.row(row).filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join(" ");
    let first = (0..before).map(text).find(|text| !text.is_empty())?;
    let shown = excerpt(&first, MAX_NAME);
    Some(format!("{} before the names are not used, such as '{shown}'", counted(before, "line")))
}

impl ColumnUnderstanding {
    fn new(column: &Column) -> Self {
        let is_read = column.quantity != Quantity::Ignore;
        let mut readings = Vec::new();
        readings.extend(column.direction.map(|direction| direction.as_str().to_owned()));
        readings.extend(column.load.map(|(value, unit)| format!("at {value} {}", unit.name)));
        readings.extend(column.angle.map(|angle| format!("at {angle} deg")));
        readings.extend(column.repetition.map(|number| format!("trial {number}")));
        Self {
            name: column.name.clone(),
            quantity: column.quantity.as_str(),
            unit: if column.is_clock {
                "clock"
            } else {
                column.unit.filter(|_| is_read).map_or("", |unit| unit.name)
            },
            assumed: column.is_assumed && column.unit.is_some() && is_read,
            factor: column.factor.to_f64(),
            offset: column.offset.to_f64(),
            written_unit: column.quantity.base_unit(),
            readings: readings.join(", "),
            ignored: if is_read { "" } else { column.reason },
        }
    }
}

impl fmt::Display for Understanding {
    /// Writes the text for a person.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, file) in self.files.iter().enumerate() {
            let repeats = i > 0 && self.files.first().is_some_and(|first| same_columns(first, file));
            if repeats {
                writeln!(f, "{}: as {}", shown(&file.name), shown(&self.files[0].name))?;
                continue;
            }
            write_file(f, file)?;
        }
        let reason = self.files.first().map_or("", |file| file.kind_reason);
        if self.questions.is_empty() {
            writeln!(f, "result     {} with {} ({reason})", self.kind, counted(self.rows, "row"))?;
        } else {
            writeln!(f, "result     open: a question below decides")?;
        }
        for (word, direction, count) in &self.directions {
            writeln!(f, "direction  {} = {direction} ({})", shown(word), counted(*count, "reading"))?;
        }
        for (name, value, is_given) in &self.constants {
            writeln!(f, "constant   {name} = {}{}", shown(value), if *is_given { "" } else { " (default)" })?;
        }
        if self.preview.len() > 1 {
            writeln!(f, "first rows")?;
            for line in &self.preview {
                writeln!(f, "  {}", shown(&excerpt(line, 200)))?;
            }
        }
        for note in self.notes.iter().take(MAX_NOTES) {
            writeln!(f, "note       {}", shown(note))?;
        }
        if self.notes.len() > MAX_NOTES {
            writeln!(f, "note       and {} more", self.notes.len() - MAX_NOTES)?;
        }
        Ok(())
    }
}

fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

fn same_columns(a: &FileUnderstanding, b: &FileUnderstanding) -> bool {
    let key = |file: &FileUnderstanding| -> Vec<(String, &'static str, &'static str)> {
        file.columns.iter().map(|column| (column.name.clone(), column.quantity, column.unit)).collect()
    };
    key(a) == key(b) && a.decimal == b.decimal && b.ignored_rows.is_empty()
}

fn shown(text: &str) -> String {
    neutral_line(text).into_owned()
}

fn write_file(f: &mut fmt::Formatter<'_>, file: &FileUnderstanding) -> fmt::Result {
    let encoding = file.encoding.as_ref().map_or_else(String::new, |encoding| format!(" in {encoding}"));
    writeln!(f, "file       {}: {}{encoding}", shown(&file.name), file.format)?;
    if let Some(delimiter) = &file.delimiter {
        writeln!(f, "delimiter  {delimiter}")?;
    }
    writeln!(f, "decimal    {}", file.decimal)?;
    let line = |line: Option<usize>| line.map_or_else(|| "none".to_owned(), |line| format!("line {line}"));
    writeln!(f, "names      {}", line(file.header_line))?;
    writeln!(f, "units row  {}", line(file.units_line))?;
    let mut table =
        vec![["column".to_owned(), "quantity".to_owned(), "unit".to_owned(), "conversion".to_owned()]];
    for column in file.columns.iter().filter(|column| column.ignored.is_empty()) {
        table.push([
            excerpt(&shown(&column.name), MAX_NAME),
            match column.readings.as_str() {
                "" => column.quantity.replace('_', " "),
                readings => format!("{}, {readings}", column.quantity),
            },
            if column.assumed { format!("{} (assumed)", column.unit) } else { column.unit.to_owned() },
            conversion(column),
        ]);
    }
    let width = |i: usize| table.iter().map(|row| row[i].chars().count()).max().unwrap_or_default();
    let widths = [width(0), width(1), width(2)];
    for row in &table {
        let mut text = String::new();
        for (cell, width) in row.iter().zip(widths) {
            write!(text, "{cell:width$}  ")?;
        }
        writeln!(f, "  {}", format!("{text}{}", row[3]).trim_end())?;
    }
    for column in file.columns.iter().filter(|column| !column.ignored.is_empty() && !column.name.is_empty()) {
        writeln!(f, "ignored    column '{}': {}", excerpt(&shown(&column.name), MAX_NAME), column.ignored)?;
    }
    for (reason, count, first) in &file.ignored_rows {
        writeln!(f, "ignored    {}: {reason} (first in line {first})", counted(*count, "row"))?;
    }
    for note in &file.notes {
        writeln!(f, "note       {}", shown(note))?;
    }
    Ok(())
}

fn conversion(column: &ColumnUnderstanding) -> String {
    if column.unit == "clock" {
        return "seconds since the first row".to_owned();
    }
    if column.written_unit.is_empty() {
        return String::new();
    }
    let offset = if column.offset == 0.0 { String::new() } else { format!(" + {}", column.offset) };
    if column.factor == 1.0 && offset.is_empty() {
        return column.written_unit.to_owned();
    }
    format!("x {}{offset} -> {}", column.factor, column.written_unit)
}
