//! LabVIEW measurement files (LVM): header blocks, then columns for each segment.
//!
//! Source: National Instruments, "Specification for the LabVIEW Measurement File (.lvm)".

use pinswitch_diagnostic::{Diagnostic, Location, codes};

use crate::clock::{self, DateOrder};
use crate::decimal::Decimal;
use crate::number::{self, DecimalSign};
use crate::sheet::Sheet;

/// Line that ends a header block.
const END: &str = "***End_of_Header***";
/// Absolute times are seconds since 1904 and need no start of the segment; programs also write times within the segment under
/// the word Absolute. Those before 1936 are taken for the latter, s.
const SINCE_1904_S: f64 = 1e9;
/// Lines in which the separator is declared.
const MAX_HEADER_LINES: usize = 100;

/// Whether a text is an LVM file.
pub(crate) fn is_lvm(text: &str) -> bool {
    let first = text.lines().next().unwrap_or_default();
    first.starts_with("LabVIEW Measurement") || first.starts_with("LVM ")
}

/// What the header blocks declare.
struct Declared {
    separator: char,
    sign: DecimalSign,
    /// Values of the keys of a segment, one for each channel.
    segment: Vec<(String, Vec<String>)>,
}

impl Declared {
    fn values(&self, key: &str) -> Option<&[String]> {
        self.segment.iter().find(|(k, _)| k.eq_ignore_ascii_case(key)).map(|(_, values)| values.as_slice())
    }

    fn number(&self, key: &str, channel: usize) -> Option<Decimal> {
        let values = self.values(key)?;
        let value = values.get(channel).or(values.first())?;
        number::parse(value, self.sign).map(|(value, _)| value)
    }

    /// Start of the segment in seconds since 1970.
    fn start(&self) -> Option<Decimal> {
        let first = |key| self.values(key).and_then(<[String]>::first);
        let text = format!("{} {}", first("Date")?, first("Time")?.replace(',', "."));
        clock::parse(&text, DateOrder::DayFirst).map(clock::Moment::seconds)
    }
}

/// Which columns of a segment are times (`X_Columns`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Times {
    /// None: times follow from `X0` and `Delta_X`.
    Computed,
    /// The first column is the time of all channels.
    Shared,
    /// Each channel has its times in the column before it.
    Each,
}

impl Times {
    /// Column of the readings of a channel.
    const fn column(self, channel: usize) -> usize {
        match self {
            Self::Computed | Self::Shared => channel + 1,
            Self::Each => 2 * channel + 1,
        }
    }
}

/// Cells of an LVM file as a sheet with one row of names.
#[derive(Debug)]
pub(crate) struct LvmSheet {
    pub(crate) sheet: Sheet,
    pub(crate) sign: DecimalSign,
    pub(crate) separator: char,
    /// What was left out.
    pub(crate) notes: Vec<String>,
}

/// Reads an LVM file.
///
/// # Errors
/// A [`Diagnostic`] if no segment has data.
pub(crate) fn read(text: &str) -> Result<LvmSheet, Diagnostic> {
    let mut declared = Declared { separator: separator(text), sign: DecimalSign::Point, segment: Vec::new() };
    let mut times = Times::Computed;
    let (mut is_absolute, mut first_absolute) = (false, None);
    let mut sheet = Sheet::default();
    let mut notes = Vec::new();
    let (mut names, mut segments): (Vec<String>, usize) = (Vec::new(), 0);
    let (mut session_start, mut offset) = (None, Decimal::ZERO);
    let mut row_of_segment = 0_u64;
    let mut is_data = false;
    for (i, line) in text.lines().enumerate() {
        let cells: Vec<&str> = line.split(declared.separator).map(str::trim).collect();
        let key = cells.first().copied().unwrap_or_default();
        if is_data {
            if !line.trim().is_empty() && !key.starts_with("***") && is_row(&cells, declared.sign) {
                if times == Times::Each
                    && let Some(other) = (1..names.len())
                        .filter_map(|channel| cells.get(2 * channel))
                        .find(|cell| !cell.is_empty() && **cell != key)
                {
                    let problem = format!("channels with different times: {key} and {other}");
                    return Err(Diagnostic::new(codes::SEVERAL_TABLES, problem)
                        .with_location(Location { line: Some(i + 1), ..Location::default() })
                        .with_help("export the channels with one time column: X_Columns One"));
                }
                let time = segment_time(&declared, times, &cells, row_of_segment);
                if is_absolute && row_of_segment == 0 && time.to_f64() > SINCE_1904_S {
                    offset = first_absolute.get_or_insert(time).negated();
                }
                row_of_segment += 1;
                let text = time.plus(offset).to_string();
                sheet.push(&if declared.sign == DecimalSign::Comma { text.replace('.', ",") } else { text });
                for channel in 0..names.len() {
                    sheet.push(cells.get(times.column(channel)).copied().unwrap_or_default());
                }
                sheet.end_row(i + 1)?;
                continue;
            }
            if line.trim().is_empty() {
                continue;
            }
            // The header block of the next segment.
            is_data = false;
            declared.segment.clear();
        }
        match key {
            "Decimal_Separator" => {
                declared.sign = if line.trim_end().ends_with(',') && !line.trim_end().ends_with(".,") {
                    DecimalSign::Comma
                } else {
                    DecimalSign::Point
                };
            }
            "X_Columns" => {
                times = match cells.get(1).copied() {
                    Some("One") => Times::Shared,
                    Some("Multi") => Times::Each,
                    _ => Times::Computed,
                }
            }
            "Time_Pref" => is_absolute = cells.get(1) == Some(&"Absolute"),
            END => {}
            // The names of the columns follow the block of the segment.
            "X_Value" => {
                let channels = declared.values("Channels").and_then(|v| v.first()?.parse::<usize>().ok());
                let found = column_names(&cells, channels, times, &declared);
                if segments == 0 {
                    sheet.push("X_Value [s]");
                    found.iter().for_each(|name| sheet.push(name));
                    sheet.end_row(i + 1)?;
                    names = found;
                } else if found != names {
                    notes.push(format!("line {}: the segment has other columns than the first one", i + 1));
                }
                if let Some(start) = declared.start() {
                    let first = *session_start.get_or_insert(start);
                    offset = start.plus(first.negated());
                }
                segments += 1;
                row_of_segment = 0;
                is_data = true;
            }
            _ if !key.is_empty() => {
                let values =
                    cells.iter().skip(1).map(|c| (*c).to_owned()).filter(|c| !c.is_empty()).collect();
                declared.segment.retain(|(k, _)| k != key);
                declared.segment.push((key.to_owned(), values));
            }
            _ => {}
        }
    }
    if segments == 0 || sheet.len() < 2 {
        return Err(Diagnostic::new(codes::NO_TABLE_FOUND, "the LVM file has no data after its headers")
            .with_help("export the measurement again, with its column headers"));
    }
    if segments > 1 {
        notes.push(format!("{segments} segments, joined by their dates and times"));
    }
    Ok(LvmSheet { sheet, sign: declared.sign, separator: declared.separator, notes })
}

/// Returns the separator that the header declares.
fn separator(text: &str) -> char {
    let mut lines = text.lines().take(MAX_HEADER_LINES);
    let is_comma = lines.any(|line| line.starts_with("Separator") && line.to_lowercase().contains("comma"));
    if is_comma { ',' } else { '\t' }
}

/// Whether a line has samples: its first cell, the time, is a number or empty.
fn is_row(cells: &[&str], sign: DecimalSign) -> bool {
    let is_number = |cell: &str| number::parse(cell, sign).is_some();
    let first = cells.first().copied().unwrap_or_default();
    (first.is_empty() || is_number(first)) && cells.iter().take(2).any(|cell| is_number(cell))
}

/// Returns the time of a row within its segment.
fn segment_time(declared: &Declared, times: Times, cells: &[&str], row: u64) -> Decimal {
    let x = cells.first().and_then(|cell| number::parse(cell, declared.sign)).map(|(x, _)| x);
    x.filter(|_| times != Times::Computed).unwrap_or_else(|| {
        let start = declared.number("X0", 0).unwrap_or(Decimal::ZERO);
        let step = declared.number("Delta_X", 0).unwrap_or(Decimal::ONE);
        start.plus(step.times(Decimal::new(u128::from(row), 0)))
    })
}

/// Returns the names of the channels with their units.
fn column_names(cells: &[&str], channels: Option<usize>, times: Times, declared: &Declared) -> Vec<String> {
    let columns = cells.len().saturating_sub(1);
    let count = channels.unwrap_or(if times == Times::Each { columns.div_ceil(2) } else { columns });
    let units = declared.values("Y_Unit_Label").unwrap_or_default();
    let name = |channel: usize| cells.get(times.column(channel)).copied().filter(|n| !n.is_empty());
    (0..count.min(1_000))
        .map(|channel| {
            let name = name(channel).map_or_else(|| format!("channel {}", channel + 1), str::to_owned);
            match units.get(channel) {
                Some(unit) => format!("{name} [{unit}]"),
                None => name,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\tNo\n\
        ***End_of_Header***\t\n\t\nChannels\t2\t\t\nDate\t2024/03/05\t2024/03/05\t\nTime\t10:00:00,5\t10:00:00,5\t\n\
        Y_Unit_Label\tNewtons\tMillimeters\t\nX0\t0,0E+0\t0,0E+0\t\nDelta_X\t2,5E-3\t2,5E-3\t\n***End_of_Header***\t\t\t\n\
        X_Value\tCell\tDrive\tComment\n\t0,5\t1,5\n\t0,6\t1,6\n\n";

    #[test]
    fn times_follow_from_the_step() {
        let lvm = read(FILE).unwrap();
        let row = |row| lvm.sheet.row(row).map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(row(0), ["X_Value [s]", "Cell [Newtons]", "Drive [Millimeters]"]);
        assert_eq!(row(2), ["0,0025", "0,6", "1,6"]);
        assert_eq!(lvm.sign, DecimalSign::Comma);
    }

    #[test]
    fn segments_are_joined_by_their_clocks() {
        let second = FILE.split_once("Channels").unwrap().1.replace("10:00:00,5", "10:00:02,0");
        let lvm = read(&format!("{FILE}Channels{second}")).unwrap();
        assert_eq!(lvm.sheet.len(), 5);
        assert_eq!(lvm.sheet.cell(3, 0), "1,5");
        assert_eq!(lvm.sheet.cell(4, 0), "1,5025");
    }

    #[test]
    fn every_channel_may_have_its_times() {
        let multi = |second: &str| {
            format!(
                "LabVIEW Measurement\t\nX_Columns\tMulti\n***End_of_Header***\t\n\t\nChannels\t2\t\t\n\
                 Y_Unit_Label\tMillimeters\tNewtons\n***End_of_Header***\t\n\
                 X_Value\tDrive\tX_Value\tCell\tComment\n0.0\t1.5\t{second}\t10\n0.1\t1.6\t0.1\t11\n"
            )
        };
        let lvm = read(&multi("0.0")).unwrap();
        let row = |row| lvm.sheet.row(row).map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(row(0), ["X_Value [s]", "Drive [Millimeters]", "Cell [Newtons]"]);
        assert_eq!(row(2), ["0.1", "1.6", "11"]);
        assert_eq!(
            read(&multi("0.05")).unwrap_err().problem(),
            "channels with different times: 0.0 and 0.05"
        );
    }

    #[test]
    fn absolute_times_are_counted_once() {
        let segment = |clock: &str, x: &str| {
            format!(
                "Channels\t1\nDate\t2024/03/05\nTime\t{clock}\nY_Unit_Label\tNewtons\n***End_of_Header***\n\
                 X_Value\tCell\n{x}\t1.5\n"
            )
        };
        let text = format!(
            "LabVIEW Measurement\t\nX_Columns\tOne\nTime_Pref\tAbsolute\n***End_of_Header***\n\n{}\n{}",
            segment("10:00:00", "3792477600.5"),
            segment("10:01:00", "3792477660.5")
        );
        let lvm = read(&text).unwrap();
        assert_eq!([lvm.sheet.cell(1, 0), lvm.sheet.cell(2, 0)], ["0", "60"]);
    }

    #[test]
    fn a_header_without_data_is_refused() {
        assert!(read("LabVIEW Measurement\t\n***End_of_Header***\t\n").is_err());
    }
}
