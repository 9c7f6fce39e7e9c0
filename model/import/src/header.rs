//! Where the names, the units and the data of a sheet begin.

use crate::clock::{self, DateOrder};
use crate::name::{self, NameReading};
use crate::number::{is_missing, sign_evidence};
use crate::quantity::Quantity;
use crate::sheet::Sheet;
use crate::trials::counts_trials;
use crate::unit::Unit;

/// Rows in which a header may begin: headers of testing machines have up to some hundred lines.
const MAX_PREAMBLE: usize = 2_000;
/// Data rows after a header that count in its favour.
const MAX_RUN: usize = 50;

/// Where the names, the units and the data of a sheet begin.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Header {
    /// Row of the names; `None` for a sheet without names.
    pub(crate) names_row: Option<usize>,
    /// Row of the units.
    pub(crate) units_row: Option<usize>,
    /// First row of data.
    pub(crate) first_data: usize,
    /// Name of each column.
    pub(crate) names: Vec<String>,
    /// Unit of each column in the row of units.
    pub(crate) units: Vec<Option<&'static Unit>>,
}

/// Whether a row is a comment.
pub(crate) fn is_comment(sheet: &Sheet, row: usize) -> bool {
    let first = sheet.cell(row, 0);
    first.starts_with(['#', '%', '!']) || first.starts_with("//") || is_rule(sheet, row)
}

/// What a cell shows about its row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CellKind {
    /// A number without a unit, a date or a time.
    Value,
    /// A number with a unit: a reading, or a load in a name.
    WithUnit,
    Other,
}

/// Whether a row is a horizontal line under the names, such as `----,----`.
fn is_rule(sheet: &Sheet, row: usize) -> bool {
    let is_line = |cell: &str| cell.chars().all(|c| matches!(c, '-' | '=' | '_' | ':' | '+'));
    sheet.row(row).all(is_line) && sheet.row(row).any(|cell| cell.len() >= 3)
}

fn cell_kind(cell: &str) -> CellKind {
    if clock::parse(cell, DateOrder::DayFirst).is_some() {
        return CellKind::Value;
    }
    match sign_evidence(cell) {
        None => CellKind::Other,
        Some(_) if cell.ends_with(|c: char| c.is_ascii_digit() || c == '.' || c == ',') => CellKind::Value,
        Some(_) => CellKind::WithUnit,
    }
}

/// Whether a row has a number or a time, and is not a comment.
pub(crate) fn is_data(sheet: &Sheet, row: usize) -> bool {
    let has = |row: usize, kind| sheet.row(row).any(|cell| cell_kind(cell) == kind);
    if is_comment(sheet, row) {
        return false;
    }
    // A single row of numbers with units has the loads of the columns below it.
    let neighbour = if row + 1 < sheet.len() { row + 1 } else { row.saturating_sub(1) };
    has(row, CellKind::Value)
        || (has(row, CellKind::WithUnit)
            && has(neighbour, CellKind::WithUnit)
            && !has(neighbour, CellKind::Value))
}

/// Whether a row has the units of the names above: most cells are known units, and none is the name
/// of a quantity.
pub(crate) fn is_units_row(sheet: &Sheet, row: usize) -> bool {
    let (mut has_known, mut units, mut others) = (false, 0, 0);
    for cell in sheet.row(row) {
        if Unit::parse(cell).is_some() {
            has_known = true;
            units += 1;
        } else if is_other_unit(cell) {
            units += 1;
        } else if !is_missing(cell.trim_matches(['(', ')', '[', ']'])) {
            others += 1;
            if name::read(cell, None).quantity.is_some() {
                return false;
            }
        }
    }
    has_known && units > others
}

/// Whether a cell of a row of units looks like a unit that is not known, such as `(m/s^2)` or
/// `degC`.
fn is_other_unit(cell: &str) -> bool {
    const WORDS: [&str; 20] = [
        "1", "c", "degc", "k", "bar", "pa", "kpa", "mpa", "hz", "khz", "rpm", "a", "ohm", "nm", "ncm",
        "text", "string", "a.u.", "date", "1/min",
    ];
    let is_bracketed = cell.starts_with(['(', '[']) && cell.ends_with([')', ']']);
    let lower = cell.to_lowercase();
    let is_format = lower.contains(':') && lower.chars().all(|c| "hmsdyf:./- 0".contains(c));
    is_bracketed
        || is_format
        || WORDS.contains(&lower.as_str())
        || (cell.chars().count() <= 6 && cell.contains(['/', '°', '^', '²']))
}

/// Finds the header. `line` is that of the names, if the user gave it; 0 for a sheet without names.
pub(crate) fn find(sheet: &Sheet, line: Option<usize>) -> Option<Header> {
    let last = sheet.len().min(MAX_PREAMBLE);
    if let Some(0) = line {
        let first_data = (0..last).find(|row| is_data(sheet, *row))?;
        let names = (1..=sheet.width(first_data)).map(|i| format!("column {i}")).collect();
        return Some(Header { first_data, names, ..Header::default() });
    }
    if let Some(line) = line {
        let row = (0..sheet.len()).find(|row| sheet.line(*row) == line)?;
        return candidate(sheet, row, &next_rows(sheet)).map(|(header, _)| header);
    }
    let next = next_rows(sheet);
    let mut best: Option<(Header, usize)> = None;
    for row in 0..last {
        if is_data(sheet, row) && !counts_trials(sheet, row) {
            continue;
        }
        if let Some((header, score)) = candidate(sheet, row, &next)
            && best.as_ref().is_none_or(|(_, most)| score > *most)
        {
            best = Some((header, score));
        }
    }
    best.map(|(header, _)| header)
}

/// Finds another row of names directly above data, in which the columns are not those of this header. Such a row names the
/// force and another quantity, and as many columns as not to be a line of text.
pub(crate) fn find_other(sheet: &Sheet, header: &Header) -> Option<(usize, Header)> {
    let next = next_rows(sheet);
    let named = |header: &Header| header.names.iter().filter(|name| !name.is_empty()).count();
    // What a column is: names and units may be written in several ways.
    let readings = |header: &Header| -> Vec<NameReading> {
        let units = |i: usize| header.units.get(i).copied().flatten();
        header.names.iter().enumerate().map(|(i, name)| name::read(name, units(i))).collect()
    };
    let first = readings(header);
    (0..sheet.len()).find_map(|row| {
        if Some(row) == header.names_row
            || is_data(sheet, row)
            || is_units_row(sheet, row)
            || is_comment(sheet, row)
        {
            return None;
        }
        let (other, _) = candidate(sheet, row, &next)?;
        // The upper line of a header of two lines.
        if other.first_data == header.first_data {
            return None;
        }
        let mut found = readings(&other);
        // A repeated header without its row of units has those of the first one.
        if other.units_row.is_none() && header.units_row.is_some() {
            let of_first = first.iter().map(|reading| reading.unit);
            found.iter_mut().zip(of_first).for_each(|(reading, unit)| reading.unit = reading.unit.or(unit));
        }
        let known = found.iter().filter(|reading| reading.quantity.is_some()).count();
        let has_force = found.iter().any(|reading| reading.quantity == Some(Quantity::Force));
        let is_header = known > 1 && has_force && 2 * named(&other) > named(header);
        (is_header && found != first).then_some((row, other))
    })
}

/// Returns for each row the first row from it on that is not a comment.
fn next_rows(sheet: &Sheet) -> Vec<Option<usize>> {
    let mut next = vec![None; sheet.len()];
    let mut last = None;
    for row in (0..sheet.len()).rev() {
        if !is_comment(sheet, row) {
            last = Some(row);
        }
        next[row] = last;
    }
    next
}

/// Reads a row as the names; returns the header and its score, or `None` if no data follow.
fn candidate(sheet: &Sheet, row: usize, next: &[Option<usize>]) -> Option<(Header, usize)> {
    let after = |from: usize| next.get(from).copied().flatten();
    let mut first_data = after(row + 1)?;
    let mut units_row = None;
    if !is_data(sheet, first_data) && is_units_row(sheet, first_data) {
        units_row = Some(first_data);
        first_data = after(first_data + 1)?;
    }
    let run = (first_data..sheet.len()).take(MAX_RUN).take_while(|row| is_data(sheet, *row)).count();
    if run == 0 {
        return None;
    }
    let width = sheet.width(first_data);
    let mut names = names(sheet, row, width);
    if names.iter().all(String::is_empty) {
        return None;
    }
    let units: Vec<_> = (0..names.len())
        .map(|column| units_row.and_then(|row| Unit::parse(sheet.cell(row, column))))
        .collect();
    let known_in = |names: &[String]| {
        let pairs = names.iter().zip(&units);
        pairs.filter(|(name, unit)| name::read(name, **unit).quantity.is_some()).count()
    };
    let mut known = known_in(&names);
    // Names of two lines: they are joined if the upper line has names of its own.
    if let Some(above) = full_line_above(sheet, row, names.len()) {
        let joined: Vec<String> = above
            .iter()
            .zip(&names)
            .map(|(upper, lower)| format!("{upper} {lower}").trim().to_owned())
            .collect();
        let known_joined = known_in(&joined);
        if known_in(&above).min(known_joined) >= known.max(1) {
            (names, known) = (joined, known_joined);
        }
    }
    let mismatch = names.len().abs_diff(width);
    // A title, above data without names.
    if known == 0 && names.len() < width {
        return None;
    }
    let score = (known * 100 + run + 1_000).saturating_sub(mismatch * 20);
    Some((Header { names_row: Some(row), units_row, first_data, names, units }, score))
}

/// Returns the names in a row, without the sign of a comment and with the load of a row of groups
/// above.
fn names(sheet: &Sheet, row: usize, width: usize) -> Vec<String> {
    let mut names: Vec<String> =
        sheet.row(row).map(|cell| cell.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    if is_comment(sheet, row)
        && let Some(first) = names.first_mut()
    {
        *first = first.trim_start_matches(['#', '%', '!', '/']).trim().to_owned();
        if first.is_empty() && names.len() > width {
            names.remove(0);
        }
    }
    // Blanks as delimiter separate a name from its unit.
    if names.len() > width {
        let mut joined: Vec<String> = Vec::new();
        for name in &names {
            match joined.last_mut() {
                Some(last) if name.starts_with(['(', '[']) && !name.is_empty() => {
                    last.push(' ');
                    last.push_str(name);
                }
                _ => joined.push(name.clone()),
            }
        }
        if joined.len() == width {
            names = joined;
        }
    }
    while names.last().is_some_and(String::is_empty) {
        names.pop();
    }
    if let Some(groups) =
        row.checked_sub(1).filter(|above| !is_data(sheet, *above) || has_loads(sheet, *above))
    {
        add_groups(sheet, groups, &mut names);
    }
    names
}

/// Returns the cells of the row above, if it has a text for each of `width` columns.
fn full_line_above(sheet: &Sheet, row: usize, width: usize) -> Option<Vec<String>> {
    let above = row.checked_sub(1).filter(|above| !is_data(sheet, *above) && !is_comment(sheet, *above))?;
    let is_full = sheet.width(above) == width && sheet.row(above).all(|cell| !cell.is_empty());
    is_full.then(|| sheet.row(above).map(str::to_owned).collect())
}

fn has_loads(sheet: &Sheet, row: usize) -> bool {
    sheet.row(row).filter(|cell| has_load(cell)).count() >= 2
}

/// Puts the load of a group, whose cell covers several columns, before their names.
fn add_groups(sheet: &Sheet, row: usize, names: &mut [String]) {
    if is_comment(sheet, row) || !has_loads(sheet, row) {
        return;
    }
    let mut group = String::new();
    for (column, name) in names.iter_mut().enumerate() {
        let cell = sheet.cell(row, column);
        if !cell.is_empty() {
            group = cell.to_owned();
        }
        if !group.is_empty() && has_load(&group) {
            *name = format!("{group} {name}");
        }
    }
}

fn has_load(cell: &str) -> bool {
    name::load_in(cell).is_some() || name::either_load(cell).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialect::{Delimiter, cells};

    fn header(text: &str) -> Header {
        find(&cells(text, Delimiter::Sign(b','), 0).unwrap(), None).unwrap()
    }

    #[test]
    fn headers_of_machines_are_found() {
        let plain = header("time_s,force_N\n0,1\n1,2\n");
        assert_eq!((plain.names_row, plain.units_row, plain.first_data), (Some(0), None, 1));
        let machine = header("Results Table 1\nRate,20,Hz\nTime,Load\n(s),(kN)\n0.0,1.2\n0.1,1.3\n");
        assert_eq!((machine.names_row, machine.units_row, machine.first_data), (Some(2), Some(3), 4));
        assert_eq!(machine.units[1].map(|u| u.name), Some("kN"));
        let format = header(
            "Time,Force,Temp,Cell\nhh:mm:ss.f,N,degC,Wheatstone\n0:00:01.5,1.2,20,1\n0:00:01.6,1.3,20,1\n",
        );
        assert_eq!((format.names_row, format.units_row, format.first_data), (Some(0), Some(1), 2));
        let rule = header("load_N,force_N\n-----,-----\n10,12\n");
        assert_eq!((rule.names_row, rule.units_row, rule.first_data), (Some(0), None, 2));
        let comment = header("# rig 3\n# t,F\n0.0,1.2\n0.1,1.3\n");
        assert_eq!(
            (comment.names_row, comment.names.as_slice()),
            (Some(1), ["t".to_owned(), "F".to_owned()].as_slice())
        );
        let trailing = header("t,F,,\n0.0,1.2,,\n");
        assert_eq!(trailing.names.len(), 2);
        let two_lines =
            header("Time,Force,Position\nof test,of cell,of crosshead\n[s],[N],[mm]\n0.0,1.2,3\n0.1,1.3,3\n");
        assert_eq!((two_lines.units_row, two_lines.names[1].as_str()), (Some(2), "Force of cell"));
        let groups = header("trial,1 kg,,2 kg,\n,up,down,up,down\n1,12,8,24,16\n");
        assert_eq!(groups.names[4], "2 kg down");
    }

    #[test]
    fn a_sheet_without_names_has_no_header() {
        let sheet = cells("0.0,1.2\n0.1,1.3\n", Delimiter::Sign(b','), 0).unwrap();
        assert_eq!(find(&sheet, None), None);
        assert_eq!(find(&sheet, Some(0)).unwrap().names, ["column 1", "column 2"]);
    }
}
