//! Reading and writing plateau tables (`plateaus.csv`, `model/doc/file-formats.md`).

use std::collections::HashMap;
use std::io::Read;

use pinswitch_diagnostic::{Location, codes};
use pinswitch_friction::published::{self, GROOVES};
use pinswitch_friction::{Direction, Substrate};

use super::columns::{COLUMNS, LABELS, WRAP_ANGLE, column_name};
use super::csv_line::push_line;
use super::row::{Labels, PlateauRow, Sweep};
use super::row_cells::RowCells;
use super::substrate_word::{WORDS, substrate_word};
use super::table_error::TableError;
use super::unknown::{Optional, Unknown};

/// Largest load and reading in newtons: ten tonnes exceed any tendon.
pub const MAX_N: f64 = 1e5;
/// Highest speed in percent.
pub const MAX_PERCENT: f64 = 1e6;
/// Longest time in seconds: over thirty years, so that a clock may count from 1970.
const MAX_S: f64 = 1e10;

/// Smallest wrap angle in degrees.
pub const MIN_WRAP_DEG: f64 = 1.0;
/// Largest wrap angle in degrees: two revolutions.
pub const MAX_WRAP_DEG: f64 = 720.0;

/// A plateau table with its original cells, including those of unknown columns.
///
/// ```
/// use pinswitch_measurements::table::{PlateauTable, TableError};
///
/// let csv = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N
/// a,silicone,5;8;11,up,1003.2,10.451,50,3,eccentric,1,12.7,4.5,9.62
/// ";
/// let table = PlateauTable::read(csv.as_bytes(), "plateaus.csv")?;
/// assert_eq!(table.rows[0].pins, [5, 8, 11]);
/// let error = PlateauTable::read(csv.replace("10.451", "-1").as_bytes(), "plateaus.csv").unwrap_err();
/// assert_eq!(error.to_string(), "plateaus.csv:2:29: load_N = -1: below 0; give a value of at least 0");
/// # Ok::<(), TableError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PlateauTable {
    /// One entry per line, in file order.
    pub rows: Vec<PlateauRow>,
    pub(super) header: Vec<String>,
    pub(super) cells: Vec<RowCells>,
}

/// Treatment of the column `force_N`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Force {
    Needed,
    Ignored,
}

impl PlateauTable {
    /// Reads a table for a calibration. `file` is its name in errors.
    ///
    /// # Errors
    /// [`TableError`] at the first cell that cannot be used.
    pub fn read(source: impl Read, file: &str) -> Result<Self, TableError> {
        Self::parse(source, file, Force::Needed)
    }

    /// Reads the rows of a table to predict; `force_N` is not used and may be absent or empty.
    ///
    /// # Errors
    /// [`TableError`] at the first cell that cannot be used.
    pub fn read_conditions(source: impl Read, file: &str) -> Result<Self, TableError> {
        Self::parse(source, file, Force::Ignored)
    }

    fn parse(mut source: impl Read, file: &str, force: Force) -> Result<Self, TableError> {
        let mut text = Vec::new();
        source.read_to_end(&mut text).map_err(|e| TableError::Malformed {
            code: codes::CANNOT_READ,
            location: Box::new(Location::file(file)),
            problem: e.to_string(),
            help: "",
        })?;
        let record_at = |byte: u64| {
            let byte = usize::try_from(byte).unwrap_or(usize::MAX);
            Location::in_csv(file, &String::from_utf8_lossy(&text), byte, None)
        };
        let malformed = |error: csv::Error| {
            let (code, problem, help) = match error.kind() {
                csv::ErrorKind::UnequalLengths { expected_len, len, .. } => (
                    codes::MALFORMED_TABLE,
                    format!("{len} cells, but the header has {expected_len}"),
                    "give a cell for every column, empty without a value, and quote cells that contain a comma",
                ),
                csv::ErrorKind::Utf8 { .. } => {
                    (codes::NOT_UTF_8, "the text is not UTF-8".to_owned(), "save the table as CSV in UTF-8")
                }
                _ => (codes::MALFORMED_TABLE, error.to_string(), ""),
            };
            let location = error.position().map_or_else(|| Location::file(file), |p| record_at(p.byte()));
            TableError::Malformed { code, location: Box::new(location), problem, help }
        };
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_slice());
        let header: Vec<String> = reader
            .headers()
            .map_err(malformed)?
            .iter()
            .map(|name| name.trim_start_matches('\u{feff}').to_owned())
            .collect();
        if header.iter().all(String::is_empty) {
            return Err(TableError::Empty { file: file.to_owned() });
        }
        let mut at = [None; COLUMNS.len()];
        for (slot, &column) in at.iter_mut().zip(&COLUMNS) {
            *slot = header.iter().position(|name| name == column);
            let may_be_absent = Optional::ALL.iter().any(|quantity| quantity.column() == column)
                || (force == Force::Ignored && column == "force_N");
            if slot.is_none() && !may_be_absent {
                return Err(TableError::MissingColumn { location: Box::new(record_at(0)), column });
            }
        }
        let wrap_at = header.iter().position(|name| name == WRAP_ANGLE);
        let labels_at = LABELS.map(|column| header.iter().position(|name| name == column));
        let (mut rows, mut cells) = (Vec::new(), Vec::new());
        let mut lines = HashMap::new();
        for record in reader.records() {
            let record = record.map_err(malformed)?;
            let byte = record.position().map_or(0, csv::Position::byte);
            let place = |index: usize| at.get(index).copied().unwrap_or(wrap_at);
            let cell = |index: usize| place(index).and_then(|i| record.get(i)).unwrap_or("");
            let line = Cells { file, text: &text, byte, place: &place, cell: &cell, force };
            let [session, mount, operator, specimen] =
                labels_at.map(|at| at.and_then(|i| record.get(i)).unwrap_or("").to_owned());
            let row =
                PlateauRow { labels: Labels { session, mount, operator, specimen }, ..parse_row(&line)? };
            // A repeated reading would count twice, although the pair shows no scatter. Without
            // repetition and time, equal rows are repetitions.
            let is_numbered = [Optional::Repetition, Optional::Time]
                .iter()
                .any(|quantity| !row.unknown.contains(*quantity));
            let reading = (
                row.labels.session.clone(),
                row.series.clone(),
                row.direction.sign() > 0.0,
                row.repetition,
                row.time_s.to_bits(),
            );
            let first = lines.insert(reading, byte).filter(|_| is_numbered && force == Force::Needed);
            if let Some(first) = first {
                let first = line_at(&text, first);
                let problem = format!("the row repeats the series, direction and time of line {first}");
                return Err(line.refuse(9, problem, "keep one of the two, or number the repetitions"));
            }
            rows.push(row);
            cells.push(record.iter().collect());
        }
        if rows.is_empty() {
            return Err(TableError::Empty { file: file.to_owned() });
        }
        Ok(Self { rows, header, cells })
    }

    /// Whether the first line of a text names the required columns of a plateau table.
    pub fn has_header(text: &str) -> bool {
        let first = text.trim_start_matches('\u{feff}').lines().next().unwrap_or_default();
        let names: Vec<&str> = first.split(',').map(|name| name.trim().trim_matches('"')).collect();
        let is_optional = |column: &str| Optional::ALL.iter().any(|quantity| quantity.column() == column);
        COLUMNS.iter().all(|column| is_optional(column) || names.contains(column))
    }

    /// Returns the columns that no calibration reads, in file order.
    pub fn ignored_columns(&self) -> Vec<String> {
        let known = |name: &str| COLUMNS.contains(&name) || LABELS.contains(&name) || name == WRAP_ANGLE;
        self.header.iter().filter(|name| !known(name)).cloned().collect()
    }

    /// Keeps the rows for which `keep` returns true.
    pub fn retain(&mut self, keep: impl Fn(&PlateauRow) -> bool) {
        let kept: Vec<bool> = self.rows.iter().map(keep).collect();
        let mut flags = kept.iter();
        self.rows.retain(|_| flags.next().copied().unwrap_or(false));
        let mut flags = kept.iter();
        self.cells.retain(|_| flags.next().copied().unwrap_or(false));
    }

    /// Writes the table as CSV with columns added at its end; cells that were read are written
    /// unchanged.
    pub fn with_columns(&self, names: &[&str], columns: &[Vec<f64>], decimals: usize) -> String {
        let mut out = String::new();
        push_line(&mut out, self.header.iter().map(String::as_str).chain(names.iter().copied()));
        for (i, cells) in self.cells.iter().enumerate() {
            let added: Vec<String> = columns.iter().map(|c| format!("{:.decimals$}", c[i])).collect();
            push_line(&mut out, cells.iter().chain(added.iter().map(String::as_str)));
        }
        out
    }

    /// Writes rows as a plateau table in CSV. A quantity that no row has gets no column. The column `wrap_angle_deg` is written if any row
    /// departs from the paper's wrap angle; those of session, mount, operator and specimen if any
    /// row names one.
    pub fn write(rows: &[PlateauRow]) -> String {
        let mut out = String::new();
        let usual = rows.iter().all(|row| row.wrap_angle_deg == published::WRAP_ANGLE_DEG);
        let extra = (!usual).then_some(WRAP_ANGLE);
        let labels = LABELS
            .iter()
            .enumerate()
            .filter(|(i, _)| rows.iter().any(|row| !row.labels.all()[*i].is_empty()));
        let labels: Vec<(usize, &str)> = labels.map(|(i, name)| (i, *name)).collect();
        let known = |column: &str, row: &PlateauRow| {
            let quantity = Optional::ALL.into_iter().find(|quantity| quantity.column() == column);
            quantity.is_none_or(|quantity| !row.unknown.contains(quantity))
        };
        let written: Vec<bool> = COLUMNS
            .iter()
            .map(|column| rows.is_empty() || rows.iter().any(|row| known(column, row)))
            .collect();
        let columns =
            COLUMNS.iter().zip(&written).filter(|(_, written)| **written).map(|(column, _)| *column);
        push_line(&mut out, columns.chain(extra).chain(labels.iter().map(|(_, name)| *name)));
        for row in rows {
            let pins: Vec<String> = row.pins.iter().map(usize::to_string).collect();
            let cells = [
                row.series.clone(),
                substrate_word(row.substrate).to_owned(),
                pins.join(";"),
                row.sweep.as_str().to_owned(),
                format!("{}", row.load_mass_g),
                format!("{:.4}", row.load_n),
                format!("{}", row.speed_pct),
                format!("{}", row.dwell_s),
                row.direction.as_str().to_owned(),
                row.repetition.to_string(),
                format!("{:.2}", row.position_mm),
                format!("{:.2}", row.time_s),
                format!("{:.4}", row.force_n),
            ];
            let wrap = extra.map(|_| row.wrap_angle_deg.to_string());
            let names = labels.iter().map(|(i, _)| row.labels.all()[*i]);
            let cells = COLUMNS.iter().zip(&cells).zip(&written).filter(|(_, written)| **written);
            let cells = cells.map(|((column, cell), _)| if known(column, row) { cell.as_str() } else { "" });
            push_line(&mut out, cells.chain(wrap.as_deref()).chain(names));
        }
        out
    }
}

/// Returns the line of the record that starts at a byte, from 1. The csv crate's own count is one
/// too low for the first record when cells are trimmed; line breaks at the start of a record belong
/// to the previous line.
fn line_at(text: &[u8], byte: u64) -> usize {
    let byte = usize::try_from(byte).unwrap_or(usize::MAX).min(text.len());
    let breaks = text[byte..].iter().take_while(|b| **b == b'\n' || **b == b'\r').count();
    1 + text[..byte + breaks].iter().filter(|b| **b == b'\n').count()
}

/// Cells of one line during conversion to a row.
struct Cells<'a> {
    file: &'a str,
    text: &'a [u8],
    byte: u64,
    /// Index of a column in the file.
    place: &'a dyn Fn(usize) -> Option<usize>,
    cell: &'a dyn Fn(usize) -> &'a str,
    force: Force,
}

impl Cells<'_> {
    fn refuse(&self, column: usize, problem: impl Into<String>, help: impl Into<String>) -> TableError {
        let byte = usize::try_from(self.byte).unwrap_or(usize::MAX);
        // The records up to this one are UTF-8.
        let text = String::from_utf8_lossy(self.text);
        let value = Some((self.cell)(column).to_owned()).filter(|value| !value.is_empty());
        let location = Location {
            field: Some(column_name(column).to_owned()),
            value,
            ..Location::in_csv(self.file, &text, byte, (self.place)(column))
        };
        TableError::Cell { location: Box::new(location), problem: problem.into(), help: help.into() }
    }

    /// Parses a number within bounds.
    fn number(&self, column: usize, least: f64, most: f64) -> Result<f64, TableError> {
        let value: f64 = (self.cell)(column)
            .parse()
            .map_err(|_| self.refuse(column, "not a number", "write it like 12.5"))?;
        if !value.is_finite() {
            return Err(self.refuse(column, "not finite", "leave out the row if the reading is lost"));
        }
        if value < least {
            let help = format!("give a value of at least {least}");
            return Err(self.refuse(column, format!("below {least}"), help));
        }
        if value > most {
            let help = format!("give a value of at most {most}, in the column's unit");
            return Err(self.refuse(column, format!("above {most}"), help));
        }
        Ok(value)
    }

    /// Whether the cell of an optional column is empty.
    fn is_empty(&self, column: usize) -> bool {
        (self.cell)(column).is_empty()
    }

    /// Parses a number within bounds; zero where the cell is empty.
    fn optional(&self, column: usize, least: f64, most: f64) -> Result<f64, TableError> {
        if self.is_empty(column) { Ok(0.0) } else { self.number(column, least, most) }
    }

    /// Returns the quantities whose cells are empty.
    fn unknown(&self) -> Unknown {
        Optional::ALL.into_iter().fold(Unknown::default(), |unknown, quantity| {
            let column = COLUMNS.iter().position(|column| *column == quantity.column());
            if column.is_some_and(|column| self.is_empty(column)) { unknown.with(quantity) } else { unknown }
        })
    }

    /// Returns the wrap angle in degrees; the paper's where the column or the cell is absent.
    fn wrap_angle_deg(&self) -> Result<f64, TableError> {
        let column = COLUMNS.len();
        if (self.cell)(column).is_empty() {
            return Ok(published::WRAP_ANGLE_DEG);
        }
        self.number(column, MIN_WRAP_DEG, MAX_WRAP_DEG)
    }

    fn word<T: Copy>(&self, column: usize, words: &[(&str, T)]) -> Result<T, TableError> {
        let text = (self.cell)(column);
        words.iter().find(|(word, _)| *word == text).map(|(_, value)| *value).ok_or_else(|| {
            let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            let problem = format!("unknown {}", column_name(column));
            self.refuse(column, problem, format!("use one of {}", known.join(", ")))
        })
    }

    fn pins(&self) -> Result<Vec<usize>, TableError> {
        let mut pins = Vec::new();
        for part in (self.cell)(2).split(';').map(str::trim).filter(|p| !p.is_empty()) {
            match part.parse::<usize>() {
                Ok(groove) if (1..=GROOVES).contains(&groove) => pins.push(groove),
                _ => {
                    return Err(self.refuse(
                        2,
                        format!("not a list of grooves 1..{GROOVES}"),
                        "list the occupied grooves, such as 5;8;11",
                    ));
                }
            }
        }
        pins.sort_unstable();
        if pins.windows(2).any(|w| w[0] == w[1]) {
            return Err(self.refuse(2, "a groove is listed twice", "list each occupied groove once"));
        }
        Ok(pins)
    }
}

fn parse_row(cells: &Cells<'_>) -> Result<PlateauRow, TableError> {
    let substrate = cells.word(1, &WORDS)?;
    let pins = cells.pins()?;
    if substrate == Some(Substrate::Abs) && pins.is_empty() {
        let problem = "no grooves on abs, where only pins carry the tendon";
        return Err(cells.refuse(2, problem, "list the occupied grooves"));
    }
    let repetition = if cells.is_empty(9) { 1.0 } else { cells.number(9, 1.0, 1e6)? };
    if repetition.fract() != 0.0 {
        return Err(cells.refuse(9, "not a whole number", "count the repetitions 1, 2, ..."));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number in 1..=1e6")]
    let repetition = repetition as u32;
    Ok(PlateauRow {
        series: (cells.cell)(0).to_owned(),
        substrate,
        pins,
        sweep: match cells.is_empty(3) {
            true => Sweep::Up,
            false => cells.word(3, &[("up", Sweep::Up), ("down", Sweep::Down)])?,
        },
        load_mass_g: cells.optional(4, 0.0, 1e7)?,
        load_n: cells.number(5, 0.0, MAX_N)?,
        speed_pct: cells.optional(6, 0.0, MAX_PERCENT)?,
        dwell_s: cells.optional(7, 0.0, 1e6)?,
        direction: cells
            .word(8, &[("eccentric", Direction::Eccentric), ("concentric", Direction::Concentric)])?,
        repetition,
        position_mm: cells.optional(10, -1e6, 1e6)?,
        time_s: cells.optional(11, -MAX_S, MAX_S)?,
        force_n: match cells.force {
            Force::Needed => cells.number(12, -MAX_N, MAX_N)?,
            Force::Ignored => 0.0,
        },
        wrap_angle_deg: cells.wrap_angle_deg()?,
        labels: Labels::default(),
        unknown: cells.unknown(),
    })
}

#[cfg(test)]
mod tests {
    use pinswitch_diagnostic::Diagnostic;

    use super::*;

    const HEADER: &str = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N";
    const LINE: &str = "0,silicone,,up,251.2,3.0766,47,3,eccentric,1,6.93,3.5,2.3157";

    fn read(text: &str) -> Result<PlateauTable, TableError> {
        PlateauTable::read(text.as_bytes(), "t.csv")
    }

    #[test]
    fn columns_may_have_any_order() {
        let table = read("note,force_N,series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s\nhi,2.5,a,abs,5;8;11,down,1,3,50,1,concentric,2,7,9\n").unwrap();
        assert_eq!(table.rows[0].pins, [5, 8, 11]);
        assert_eq!(table.rows[0].force_n, 2.5);
        let text = table.with_columns(&["predicted_N"], &[vec![1.0]], 3);
        assert!(text.starts_with("note,force_N,") && text.ends_with(",7,9,1.000\n"), "{text}");
    }

    #[test]
    fn a_written_table_reads_back() {
        let table = read(&format!("{HEADER}\n{LINE}\n")).unwrap();
        let again = read(&PlateauTable::write(&table.rows)).unwrap();
        assert_eq!(again.rows, table.rows);
    }

    #[test]
    fn errors_locate_unusable_cells() {
        let cases = [
            ("silicone", "rubber", "substrate", "rubber", "unknown substrate"),
            ("3.0766", "-3", "load_N", "-3", "below 0"),
            ("2.3157", "abc", "force_N", "abc", "not a number"),
            ("2.3157", "NaN", "force_N", "NaN", "not finite"),
            ("eccentric", "sideways", "direction", "sideways", "unknown direction"),
            ("silicone,,", "silicone,5;5,", "pins", "5;5", "a groove is listed twice"),
            ("silicone,,", "silicone,16,", "pins", "16", "not a list of grooves 1..15"),
            ("silicone,,", "abs,,", "pins", "", "no grooves on abs, where only pins carry the tendon"),
            ("2.3157", "1e300", "force_N", "1e300", "above 100000"),
            ("eccentric,1,", "eccentric,1.5,", "repetition", "1.5", "not a whole number"),
        ];
        for (from, to, column, value, problem) in cases {
            let error = read(&format!("{HEADER}\n{}\n", LINE.replacen(from, to, 1))).unwrap_err();
            let diagnostic = Diagnostic::from(error);
            assert_eq!(diagnostic.problem(), problem, "{to}");
            let location = diagnostic.location().unwrap();
            assert_eq!((location.file.as_deref(), location.line), (Some("t.csv"), Some(2)), "{to}");
            assert_eq!(location.field.as_deref(), Some(column), "{to}");
            assert_eq!(location.value.as_deref().unwrap_or_default(), value, "{to}");
            // The caret marks the cell, or the place of an empty one.
            let snippet = location.snippet.clone().unwrap();
            let marked: String =
                snippet.text.chars().skip(snippet.marked.start).take(snippet.marked.len()).collect();
            assert_eq!(marked, if value.is_empty() { "," } else { value }, "{to}");
            assert!(diagnostic.help().is_some(), "{to}");
        }
    }

    #[test]
    fn only_other_wrap_angles_are_written() {
        let mut table = read(&format!("{HEADER},wrap_angle_deg\n{LINE},90\n")).unwrap();
        assert_eq!(table.rows[0].wrap_angle_deg, 90.0);
        let text = PlateauTable::write(&table.rows);
        assert!(text.ends_with(",2.3157,90\n"), "{text}");
        assert_eq!(read(&text).unwrap().rows, table.rows);
        for usual in ["", "63.89"] {
            table = read(&format!("{HEADER},wrap_angle_deg\n{LINE},{usual}\n")).unwrap();
            assert_eq!(table.rows[0].wrap_angle_deg, published::WRAP_ANGLE_DEG);
        }
        assert!(!PlateauTable::write(&table.rows).contains("wrap_angle_deg"));
        let error = read(&format!("{HEADER},wrap_angle_deg\n{LINE},-5\n")).unwrap_err().to_string();
        assert!(error.starts_with("t.csv:2:62: wrap_angle_deg = -5: below 1"), "{error}");
    }

    #[test]
    fn repeated_readings_are_refused() {
        let text = format!("{HEADER}\n{LINE}\n{LINE}\n");
        let error = read(&text).unwrap_err().to_string();
        assert!(
            error.starts_with(
                "t.csv:3:44: repetition = 1: the row repeats the series, direction and time of line 2"
            ),
            "{error}"
        );
        assert_eq!(PlateauTable::read_conditions(text.as_bytes(), "t.csv").unwrap().rows.len(), 2);
    }

    #[test]
    fn incomplete_tables_are_refused() {
        assert!(matches!(read(""), Err(TableError::Empty { .. })));
        assert!(matches!(read(&format!("{HEADER}\n")), Err(TableError::Empty { .. })));
        let error = read(&HEADER.replace("direction,", "")).unwrap_err();
        assert!(matches!(error, TableError::MissingColumn { column: "direction", .. }));
        let shown = Diagnostic::from(error).render("error");
        assert!(
            shown
                .contains("t.csv:1: column 'direction' is missing [missing-column]\n  1 | series,substrate,"),
            "{shown}"
        );
        let short = read(&format!("{HEADER}\n0,silicone\n")).unwrap_err().to_string();
        assert!(short.starts_with("t.csv:2: 2 cells, but the header has 13"), "{short}");
    }
}
