//! Reading and writing plateau tables (`plateaus.csv`, `model/doc/file-formats.md`).

use std::collections::HashMap;
use std::io::Read;

use pinswitch_friction::published::{self, GROOVES};
use pinswitch_friction::{Direction, Substrate};

use super::columns::{COLUMNS, LABELS, WRAP_ANGLE, column_name};
use super::row::{Labels, PlateauRow, Sweep};
use super::row_cells::RowCells;
use super::substrate_word::{WORDS, substrate_word};
use super::table_error::TableError;

/// Largest load and reading in newtons: ten tonnes is beyond any tendon.
pub(crate) const MAX_N: f64 = 1e5;
/// Highest speed in percent.
pub(crate) const MAX_PERCENT: f64 = 1e6;
/// Longest time in seconds: thirty years, or a clock that counts from 1970.
const MAX_S: f64 = 1e10;

/// Smallest and largest wrap angle in degrees: two turns.
pub(crate) const MIN_WRAP_DEG: f64 = 1.0;
pub(crate) const MAX_WRAP_DEG: f64 = 720.0;

/// A plateau table with the cells as they were written, unknown columns included.
///
/// ```
/// use pinswitch_calibration::table::{PlateauTable, TableError};
///
/// let csv = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N
/// a,silicone,5;8;11,up,1003.2,10.451,50,3,eccentric,1,12.7,4.5,9.62
/// ";
/// let table = PlateauTable::read(csv.as_bytes(), "plateaus.csv")?;
/// assert_eq!(table.rows[0].pins, [5, 8, 11]);
/// let error = PlateauTable::read(csv.replace("10.451", "-1").as_bytes(), "plateaus.csv").unwrap_err();
/// assert!(error.to_string().starts_with("plateaus.csv, line 2, column 'load_N': '-1' is below 0"));
/// # Ok::<(), TableError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PlateauTable {
    /// One entry per line, in file order.
    pub rows: Vec<PlateauRow>,
    pub(super) header: Vec<String>,
    pub(super) cells: Vec<RowCells>,
}

/// What a reader may leave out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Force {
    Needed,
    Ignored,
}

impl PlateauTable {
    /// Reads a table for a calibration. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`TableError`] at the first cell that cannot be used.
    pub fn read(source: impl Read, file: &str) -> Result<Self, TableError> {
        Self::parse(source, file, Force::Needed)
    }

    /// Reads the rows of a table to predict: `force_N` may be absent or empty, it is not used.
    ///
    /// # Errors
    /// [`TableError`] at the first cell that cannot be used.
    pub fn read_conditions(source: impl Read, file: &str) -> Result<Self, TableError> {
        Self::parse(source, file, Force::Ignored)
    }

    fn parse(mut source: impl Read, file: &str, force: Force) -> Result<Self, TableError> {
        let mut text = Vec::new();
        source.read_to_end(&mut text).map_err(|e| TableError::Malformed {
            file: file.to_owned(),
            line: None,
            problem: e.to_string(),
        })?;
        let malformed = |error: csv::Error| TableError::Malformed {
            file: file.to_owned(),
            line: error.position().map(|p| line_at(&text, p.byte())),
            problem: match error.kind() {
                csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                    format!(
                        "{len} cells, the header has {expected_len}; give a cell for every column, an empty one where \
                         there is no value, and quotes around a cell with a comma"
                    )
                }
                csv::ErrorKind::Utf8 { .. } => "is not UTF-8 text; save the table as UTF-8 CSV".to_owned(),
                _ => error.to_string(),
            },
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
            if slot.is_none() && !(force == Force::Ignored && column == "force_N") {
                return Err(TableError::MissingColumn { file: file.to_owned(), column });
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
            let line = Cells { file, text: &text, byte, cell: &cell, force };
            let [session, mount, operator, specimen] =
                labels_at.map(|at| at.and_then(|i| record.get(i)).unwrap_or("").to_owned());
            let row =
                PlateauRow { labels: Labels { session, mount, operator, specimen }, ..parse_row(&line)? };
            // A reading that stands in the table twice counts twice, and no spread between the two says so.
            let reading = (
                row.labels.session.clone(),
                row.series.clone(),
                row.direction.sign() > 0.0,
                row.repetition,
                row.time_s.to_bits(),
            );
            if let (Force::Needed, Some(first)) = (force, lines.insert(reading, byte)) {
                let first = line_at(&text, first);
                let problem = format!(
                    "stands in line {first} too, with the same series, direction and time; keep one, or number the repetitions"
                );
                return Err(line.refuse(9, problem));
            }
            rows.push(row);
            cells.push(record.iter().collect());
        }
        if rows.is_empty() {
            return Err(TableError::Empty { file: file.to_owned() });
        }
        Ok(Self { rows, header, cells })
    }

    /// Columns of the file that no calibration reads, in its order.
    pub fn ignored_columns(&self) -> Vec<String> {
        let known = |name: &str| COLUMNS.contains(&name) || LABELS.contains(&name) || name == WRAP_ANGLE;
        self.header.iter().filter(|name| !known(name)).cloned().collect()
    }

    /// Keeps the rows for which `keep` holds.
    pub fn retain(&mut self, keep: impl Fn(&PlateauRow) -> bool) {
        let kept: Vec<bool> = self.rows.iter().map(keep).collect();
        let mut flags = kept.iter();
        self.rows.retain(|_| flags.next().copied().unwrap_or(false));
        let mut flags = kept.iter();
        self.cells.retain(|_| flags.next().copied().unwrap_or(false));
    }

    /// The table as CSV with columns added at its end; cells that were read are written as they were.
    pub fn with_columns(&self, names: &[&str], columns: &[Vec<f64>], decimals: usize) -> String {
        let mut out = String::new();
        push_line(&mut out, self.header.iter().map(String::as_str).chain(names.iter().copied()));
        for (i, cells) in self.cells.iter().enumerate() {
            let added: Vec<String> = columns.iter().map(|c| format!("{:.decimals$}", c[i])).collect();
            push_line(&mut out, cells.iter().chain(added.iter().map(String::as_str)));
        }
        out
    }

    /// Rows as a plateau table in CSV, with a column `wrap_angle_deg` if any row departs from the paper's wrap angle, and
    /// those of session, mount, operator and specimen that any row names.
    pub fn write(rows: &[PlateauRow]) -> String {
        let mut out = String::new();
        let usual = rows.iter().all(|row| row.wrap_angle_deg == published::WRAP_ANGLE_DEG);
        let extra = (!usual).then_some(WRAP_ANGLE);
        let told = LABELS
            .iter()
            .enumerate()
            .filter(|(i, _)| rows.iter().any(|row| !row.labels.all()[*i].is_empty()));
        let told: Vec<(usize, &str)> = told.map(|(i, name)| (i, *name)).collect();
        push_line(&mut out, COLUMNS.iter().copied().chain(extra).chain(told.iter().map(|(_, name)| *name)));
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
            let labels = told.iter().map(|(i, _)| row.labels.all()[*i]);
            push_line(&mut out, cells.iter().chain(&wrap).map(String::as_str).chain(labels));
        }
        out
    }
}

/// Appends one CSV line, quoting the cells that need it.
fn push_line<'a>(out: &mut String, cells: impl Iterator<Item = &'a str>) {
    for (i, cell) in cells.enumerate() {
        if i > 0 {
            out.push(',');
        }
        if cell.contains([',', '"', '\n', '\r']) {
            out.push('"');
            out.push_str(&cell.replace('"', "\"\""));
            out.push('"');
        } else {
            out.push_str(cell);
        }
    }
    out.push('\n');
}

/// Line of the record that starts at a byte, from 1. The csv crate's own count is one short on the first record
/// when cells are trimmed; line breaks that a record starts with belong to the line before.
fn line_at(text: &[u8], byte: u64) -> u64 {
    let byte = usize::try_from(byte).unwrap_or(usize::MAX).min(text.len());
    let breaks = text[byte..].iter().take_while(|b| **b == b'\n' || **b == b'\r').count();
    1 + text[..byte + breaks].iter().filter(|b| **b == b'\n').count() as u64
}

/// One line on its way to a row.
struct Cells<'a> {
    file: &'a str,
    text: &'a [u8],
    byte: u64,
    cell: &'a dyn Fn(usize) -> &'a str,
    force: Force,
}

impl Cells<'_> {
    fn refuse(&self, column: usize, problem: impl Into<String>) -> TableError {
        TableError::Cell {
            file: self.file.to_owned(),
            line: line_at(self.text, self.byte),
            column: column_name(column),
            value: (self.cell)(column).to_owned(),
            problem: problem.into(),
        }
    }

    /// The number in a cell, within what a rig for tendons can yield.
    fn number(&self, column: usize, least: f64, most: f64) -> Result<f64, TableError> {
        let value: f64 = (self.cell)(column)
            .parse()
            .map_err(|_| self.refuse(column, "is no number; write it like 12.5"))?;
        if !value.is_finite() {
            return Err(self.refuse(column, "is no finite number; leave the row out if the reading is lost"));
        }
        if value < least {
            return Err(self.refuse(column, format!("is below {least}; give a value of at least {least}")));
        }
        if value > most {
            return Err(self.refuse(
                column,
                format!("is above {most}; give a value of at most {most}, in the column's unit"),
            ));
        }
        Ok(value)
    }

    /// The wrap angle, or the paper's where the column or the cell is absent.
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
            self.refuse(column, format!("is unknown; use one of {}", known.join(", ")))
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
                        format!("is no list of grooves 1..{GROOVES}; write occupied grooves like 5;8;11"),
                    ));
                }
            }
        }
        pins.sort_unstable();
        if pins.windows(2).any(|w| w[0] == w[1]) {
            return Err(self.refuse(2, "names a groove twice; name each occupied groove once"));
        }
        Ok(pins)
    }
}

fn parse_row(cells: &Cells<'_>) -> Result<PlateauRow, TableError> {
    let substrate = cells.word(1, &WORDS)?;
    let pins = cells.pins()?;
    if substrate == Some(Substrate::Abs) && pins.is_empty() {
        return Err(cells.refuse(2, "is empty on abs, where only pins carry the tendon; name the grooves"));
    }
    let repetition = cells.number(9, 1.0, 1e6)?;
    if repetition.fract() != 0.0 {
        return Err(cells.refuse(9, "is no whole number; count the repetitions 1, 2, ..."));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number in 1..=1e6")]
    let repetition = repetition as u32;
    Ok(PlateauRow {
        series: (cells.cell)(0).to_owned(),
        substrate,
        pins,
        sweep: cells.word(3, &[("up", Sweep::Up), ("down", Sweep::Down)])?,
        load_mass_g: cells.number(4, 0.0, 1e7)?,
        load_n: cells.number(5, 0.0, MAX_N)?,
        speed_pct: cells.number(6, 0.0, MAX_PERCENT)?,
        dwell_s: cells.number(7, 0.0, 1e6)?,
        direction: cells
            .word(8, &[("eccentric", Direction::Eccentric), ("concentric", Direction::Concentric)])?,
        repetition,
        position_mm: cells.number(10, -1e6, 1e6)?,
        time_s: cells.number(11, -MAX_S, MAX_S)?,
        force_n: match cells.force {
            Force::Needed => cells.number(12, -MAX_N, MAX_N)?,
            Force::Ignored => 0.0,
        },
        wrap_angle_deg: cells.wrap_angle_deg()?,
        labels: Labels::default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N";
    const LINE: &str = "0,silicone,,up,251.2,3.0766,47,3,eccentric,1,6.93,3.5,2.3157";

    fn read(text: &str) -> Result<PlateauTable, TableError> {
        PlateauTable::read(text.as_bytes(), "t.csv")
    }

    #[test]
    fn columns_may_come_in_any_order_and_unknown_ones_are_kept() {
        let table = read("note,force_N,series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s\nhi,2.5,a,abs,5;8;11,down,1,3,50,1,concentric,2,7,9\n").unwrap();
        assert_eq!(table.rows[0].pins, [5, 8, 11]);
        assert_eq!(table.rows[0].force_n, 2.5);
        let text = table.with_columns(&["predicted_N"], &[vec![1.0]], 3);
        assert!(text.starts_with("note,force_N,") && text.ends_with(",7,9,1.000\n"), "{text}");
    }

    #[test]
    fn what_is_written_reads_back() {
        let table = read(&format!("{HEADER}\n{LINE}\n")).unwrap();
        let again = read(&PlateauTable::write(&table.rows)).unwrap();
        assert_eq!(again.rows, table.rows);
    }

    #[test]
    fn each_unusable_cell_is_named_with_line_and_column() {
        let cases = [
            ("silicone", "rubber", "line 2, column 'substrate': 'rubber' is unknown"),
            ("3.0766", "-3", "line 2, column 'load_N': '-3' is below 0"),
            ("2.3157", "abc", "line 2, column 'force_N': 'abc' is no number"),
            ("2.3157", "NaN", "line 2, column 'force_N': 'NaN' is no finite number"),
            ("eccentric", "sideways", "column 'direction': 'sideways' is unknown"),
            ("silicone,,", "silicone,5;5,", "names a groove twice"),
            ("silicone,,", "silicone,16,", "grooves 1..15"),
            ("silicone,,", "abs,,", "only pins carry"),
            ("2.3157", "1e300", "line 2, column 'force_N': '1e300' is above 100000"),
            ("eccentric,1,", "eccentric,1.5,", "no whole number"),
        ];
        for (from, to, expected) in cases {
            let error = read(&format!("{HEADER}\n{}\n", LINE.replacen(from, to, 1))).unwrap_err().to_string();
            assert!(error.contains(expected) && error.starts_with("t.csv"), "{error}");
        }
    }

    #[test]
    fn another_wrap_angle_is_read_and_written_and_the_papers_is_left_out() {
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
        assert!(error.starts_with("t.csv, line 2, column 'wrap_angle_deg': '-5' is below 1"), "{error}");
    }

    #[test]
    fn a_reading_that_stands_twice_is_refused_but_may_be_predicted_twice() {
        let text = format!("{HEADER}\n{LINE}\n{LINE}\n");
        let error = read(&text).unwrap_err().to_string();
        assert!(error.starts_with("t.csv, line 3, column 'repetition': '1' stands in line 2 too"), "{error}");
        assert_eq!(PlateauTable::read_conditions(text.as_bytes(), "t.csv").unwrap().rows.len(), 2);
    }

    #[test]
    fn empty_files_and_missing_columns_are_refused() {
        assert!(matches!(read(""), Err(TableError::Empty { .. })));
        assert!(matches!(read(&format!("{HEADER}\n")), Err(TableError::Empty { .. })));
        let error = read(&HEADER.replace("dwell_s,", "")).unwrap_err();
        assert!(matches!(error, TableError::MissingColumn { column: "dwell_s", .. }));
        let short = read(&format!("{HEADER}\n0,silicone\n")).unwrap_err().to_string();
        assert!(short.contains("line 2") && short.contains("2 cells"), "{short}");
    }
}
