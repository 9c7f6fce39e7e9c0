//! Columns that are computed from others or count the rows, and are therefore not read.

use crate::column::Column;
use crate::header::Header;
use crate::quantity::Quantity;
use crate::sheet::Sheet;
use crate::trials::trial;
use crate::vocabulary;

/// Figures computed from the readings next to them, such as `SD (N)`, are not read. `STD` is the German abbreviation of
/// hours in a log.
pub(crate) fn remove_statistics(columns: &mut [Column]) {
    let has = |quantity| columns.iter().any(|column| column.quantity == quantity);
    let has_rows = has(Quantity::Load) || has(Quantity::LoadMass) || has(Quantity::Direction);
    let is_statistic = |c: &Column| {
        let is_one = match c.quantity {
            Quantity::Force => true,
            Quantity::Time => has_rows,
            _ => false,
        };
        is_one && !c.is_decided && vocabulary::is_statistic(&c.name) && !vocabulary::is_average(&c.name)
    };
    let has_reading = columns.iter().any(|c| match c.quantity {
        Quantity::Force => !is_statistic(c),
        Quantity::Repetition | Quantity::Ignore => {
            trial(&c.name).is_some() || vocabulary::is_average(&c.name)
        }
        _ => false,
    });
    if has_reading {
        columns.iter_mut().filter(|c| is_statistic(c)).for_each(|c| c.ignore("computed from other columns"));
    }
}

/// A column that counts the rows, such as `Sample`, names no specimens.
pub(crate) fn remove_row_numbers(columns: &mut [Column], sheet: &Sheet, header: &Header) {
    let rows = header.first_data..sheet.len();
    let counts = |column: &Column| {
        let mut numbered = rows.clone().zip(1_usize..);
        rows.len() > 1 && numbered.all(|(row, number)| sheet.cell(row, column.index) == number.to_string())
    };
    for column in columns.iter_mut().filter(|c| c.quantity == Quantity::Specimen && !c.is_decided) {
        if counts(column) {
            column.ignore("counts the rows");
        }
    }
}

/// A mean next to the readings that it is computed from is not another reading.
pub(crate) fn remove_averages(columns: &mut [Column]) {
    let place = |c: &Column| {
        (
            c.direction,
            c.load.map(|(value, unit)| value.times(unit.factor).to_string()),
            c.angle.map(|a| a.to_string()),
        )
    };
    let is_average = |c: &Column| vocabulary::is_average(&c.name);
    let singles: Vec<_> = columns
        .iter()
        .filter(|c| c.quantity == Quantity::Force && c.repetition.is_some() && !is_average(c))
        .map(place)
        .collect();
    let averages =
        columns.iter_mut().filter(|c| c.quantity == Quantity::Force && !c.is_decided && is_average(c));
    averages.filter(|c| singles.contains(&place(c))).for_each(|c| c.ignore("computed from other columns"));
}
