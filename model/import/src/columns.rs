//! The columns of a sheet: the quantity of each by its name and its cells; what has two readings becomes a question.

use crate::clock::{self, DateOrder};
use crate::column::{Column, NOT_NUMBERS, SAMPLE_ROWS, reference, shown};
use crate::computed::{remove_averages, remove_row_numbers, remove_statistics};
use crate::conversion::set_factor;
use crate::decimal::Decimal;
use crate::direction_words;
use crate::header::Header;
use crate::map::Map;
use crate::name;
use crate::number::{self, is_missing, sign_evidence};
use crate::quantity::Quantity;
use crate::question::Question;
use crate::sheet::Sheet;
use crate::trials::find_trials;
use crate::unit::{Dimension, Unit};
use crate::vocabulary;
use pinswitch_diagnostic::codes;

/// What the cells of a column are.
#[derive(Clone, Copy, Debug, Default)]
struct Cells {
    numbers: usize,
    moments: usize,
    times_of_day: usize,
    words: usize,
    directions: usize,
    suffix: Option<&'static Unit>,
}

fn cells(sheet: &Sheet, header: &Header, column: usize) -> Cells {
    let mut kinds = Cells::default();
    for row in (header.first_data..sheet.len()).take(SAMPLE_ROWS) {
        let cell = sheet.cell(row, column);
        if direction_words::direction(cell).is_some() {
            kinds.directions += 1;
        }
        if is_missing(cell) {
            continue;
        }
        if let Some(moment) = clock::parse(cell, DateOrder::DayFirst) {
            kinds.moments += 1;
            kinds.times_of_day += usize::from(moment.seconds.is_some());
        } else if sign_evidence(cell).is_some() {
            kinds.numbers += 1;
            let suffix = [number::DecimalSign::Point, number::DecimalSign::Comma]
                .iter()
                .find_map(|sign| number::parse(cell, *sign)?.1);
            kinds.suffix = kinds.suffix.or(suffix);
        } else {
            kinds.words += 1;
        }
    }
    kinds
}

/// Assigns a quantity, a unit and a factor to every column; what has two readings becomes a
/// question.
pub(crate) fn assign(
    sheet: &Sheet,
    header: &Header,
    map: &Map,
    questions: &mut Vec<Question>,
) -> Vec<Column> {
    let kinds: Vec<Cells> = (0..header.names.len()).map(|column| cells(sheet, header, column)).collect();
    let mut columns: Vec<Column> =
        header.names.iter().enumerate().map(|(i, name)| column(i, name, header, map, &kinds[i])).collect();
    remove_statistics(&mut columns);
    remove_row_numbers(&mut columns, sheet, header);
    find_directions(&mut columns, &kinds);
    find_clocks(&mut columns, &kinds);
    find_trials(&mut columns);
    split_load_and_force(&mut columns);
    for column in &mut columns {
        if column.quantity == Quantity::Load
            && column.unit.is_some_and(|unit| unit.dimension == Dimension::Mass)
        {
            column.quantity = Quantity::LoadMass;
        }
    }
    remove_averages(&mut columns);
    remove_duplicates(&mut columns, questions);
    ask_for_loads(&columns, map, questions);
    count_from_one(&mut columns);
    ask_for_numbers(&columns, map, questions);
    let forces = columns.iter().filter(|column| column.quantity == Quantity::Force).count();
    for column in &mut columns {
        // The number in a name counts trials only if there are several.
        if forces == 1 {
            column.repetition = None;
        }
        set_factor(column, sheet, header, map, questions);
    }
    columns
}

fn column(index: usize, name: &str, header: &Header, map: &Map, kinds: &Cells) -> Column {
    let empty = crate::map::ColumnChoice::default();
    let choice = map.column(name, index + 1).unwrap_or(&empty);
    let row_unit = header.units.get(index).copied().flatten();
    let mut reading = name::read(name, row_unit);
    if reading.unit.is_none() && kinds.suffix.is_some() {
        reading.unit = kinds.suffix;
        if reading.quantity.is_none() {
            reading = name::read(name, kinds.suffix);
        }
    }
    let mut column = Column {
        index,
        name: name.to_owned(),
        quantity: choice.quantity.or(reading.quantity).unwrap_or(Quantity::Ignore),
        unit: choice.unit.or(reading.unit),
        row_unit,
        factor: choice.factor.unwrap_or(Decimal::ONE),
        offset: choice.offset.unwrap_or(Decimal::ZERO),
        is_clock: false,
        direction: choice.direction.or(reading.direction),
        load: reading.load,
        angle: choice.angle.or(reading.angle),
        // The number in the name is the angle, if that was decided.
        repetition: choice.repetition.or(reading.repetition.filter(|_| choice.angle.is_none())),
        reason: if choice.quantity == Some(Quantity::Ignore) {
            "left out on request"
        } else {
            "not a quantity of a table or log"
        },
        is_named: reading.is_named || name.is_empty(),
        is_repeated: header.names.iter().filter(|other| *other == name).count() > 1,
        is_assumed: false,
        is_decided: choice.quantity.is_some(),
        has_factor: choice.factor.is_some(),
        is_filled: choice.is_filled,
    };
    if column.quantity == Quantity::Force && !column.is_decided && vocabulary::is_spread(name, &header.names)
    {
        column.ignore("the spread of readings");
    }
    if let Some(load) = &choice.load {
        column.load = name::load_in(load).or(column.load);
    }
    // A unit alone decides the quantity of a column without a known name.
    if column.quantity == Quantity::Ignore && choice.quantity.is_none() && choice.unit.is_some() {
        column.quantity = name::read(name, choice.unit).quantity.unwrap_or(Quantity::Ignore);
    }
    let is_empty = kinds.numbers + kinds.moments + kinds.words == 0;
    if is_empty
        && column.quantity != Quantity::Direction
        && !column.is_decided
        && column.quantity != Quantity::Pins
    {
        column.ignore("empty");
    } else if column.quantity.is_number() && !column.is_decided && kinds.words > kinds.numbers + kinds.moments
    {
        column.ignore(NOT_NUMBERS);
    }
    column
}

/// A column of direction words is the direction, whatever its name is.
fn find_directions(columns: &mut [Column], kinds: &[Cells]) {
    if columns.iter().any(|column| column.quantity == Quantity::Direction || column.direction.is_some()) {
        return;
    }
    let is_words =
        |kinds: &Cells| kinds.directions > 0 && kinds.words > 0 && kinds.numbers + kinds.moments == 0;
    let mut possible = columns.iter_mut().zip(kinds).filter(|(column, kinds)| {
        is_words(kinds)
            && kinds.directions >= kinds.words
            && !column.is_decided
            && column.quantity != Quantity::Sweep
    });
    if let Some((column, _)) = possible.next() {
        column.quantity = Quantity::Direction;
    }
}

/// Times of day and dates are the time; a date without a time of day belongs to the time of day in
/// another column.
fn find_clocks(columns: &mut [Column], kinds: &[Cells]) {
    let is_moment = |kinds: &Cells| kinds.moments > kinds.numbers && kinds.moments > kinds.words;
    for (column, kinds) in columns.iter_mut().zip(kinds) {
        if !matches!(column.quantity, Quantity::Time | Quantity::Date) {
            continue;
        }
        column.is_clock = is_moment(kinds);
        if column.is_clock {
            column.quantity = if kinds.times_of_day > 0 { Quantity::Time } else { Quantity::Date };
            column.unit = None;
        } else if column.quantity == Quantity::Date {
            column.ignore("not a date");
        }
    }
    let has_clock = columns.iter().any(|column| column.quantity == Quantity::Time && column.is_clock);
    if !has_clock {
        let dates = columns.iter_mut().filter(|column| column.quantity == Quantity::Date);
        dates.for_each(|column| column.ignore("a date without a time of day"));
    }
}

/// "Load" is the reading of a testing machine, or the declared load next to a reading.
fn split_load_and_force(columns: &mut [Column]) {
    let has = |quantity, columns: &[Column]| columns.iter().any(|column| column.quantity == quantity);
    if has(Quantity::Force, columns) {
        return;
    }
    let is_mass = |column: &Column| {
        column.unit.is_some_and(|unit| unit.dimension == Dimension::Mass)
            || column.quantity == Quantity::LoadMass
    };
    let is_load = |column: &Column| column.quantity == Quantity::Load && !column.is_decided;
    let has_mass = columns
        .iter()
        .any(|column| matches!(column.quantity, Quantity::Load | Quantity::LoadMass) && is_mass(column));
    let has_time = has(Quantity::Time, columns);
    let only_log = has_time && !has(Quantity::Direction, columns);
    let loads = columns.iter().filter(|column| is_load(column) && !is_mass(column)).count();
    if loads == 1 && (has_mass || only_log) {
        columns
            .iter_mut()
            .filter(|column| is_load(column) && !is_mass(column))
            .for_each(|column| column.quantity = Quantity::Force);
    } else if only_log && columns.iter().filter(|column| is_load(column)).count() == 1 {
        columns
            .iter_mut()
            .filter(|column| is_load(column))
            .for_each(|column| column.quantity = Quantity::Force);
    }
}

/// A load in a name with a separator before three digits, such as `1,000 g`.
fn ask_for_loads(columns: &[Column], map: &Map, questions: &mut Vec<Question>) {
    let either: Vec<_> = columns
        .iter()
        .filter(|c| c.quantity == Quantity::Force)
        .filter(|c| map.column(&c.name, c.index + 1).is_none_or(|choice| choice.load.is_none()))
        .filter_map(|c| Some((c, name::either_load(&c.name)?)))
        .collect();
    let Some((first, _)) = either.first() else { return };
    let answer = |large: usize| {
        let option = |(column, readings): &(&Column, [(Decimal, &'static Unit); 2])| {
            let (value, unit) = readings[large];
            format!("load.{}={value} {}", reference(column), unit.name)
        };
        either.iter().map(option).collect::<Vec<_>>().join("\n")
    };
    questions.push(Question::new(
        codes::AMBIGUOUS_NUMBER,
        format!("the load in the name '{}'", first.name),
        [("a decimal separator".to_owned(), answer(0)), ("thousands".to_owned(), answer(1))],
    ));
}

/// Trials that are numbered from 0 on without a gap are the first, the second, and so on.
fn count_from_one(columns: &mut [Column]) {
    let is_numbered = |c: &&mut Column| c.quantity == Quantity::Force && c.repetition.is_some();
    let numbers: std::collections::BTreeSet<u32> =
        columns.iter_mut().filter(is_numbered).filter_map(|c| c.repetition).collect();
    if numbers.iter().zip(0..).all(|(number, expected)| *number == expected) {
        columns.iter_mut().filter(is_numbered).for_each(|c| c.repetition = c.repetition.map(|n| n + 1));
    }
}

/// The numbers in the names of the columns of a wide table count trials from 1 on; others may be wrap angles.
fn ask_for_numbers(columns: &[Column], map: &Map, questions: &mut Vec<Question>) {
    let numbered: Vec<(&Column, u32)> = columns
        .iter()
        .filter(|c| c.quantity == Quantity::Force)
        .filter(|c| {
            map.column(&c.name, c.index + 1)
                .is_none_or(|choice| choice.repetition.is_none() && choice.angle.is_none())
        })
        .filter_map(|c| Some((c, c.repetition?)))
        .collect();
    let numbers: std::collections::BTreeSet<u32> = numbered.iter().map(|(_, number)| *number).collect();
    let is_counted = numbers.iter().zip(1..).all(|(number, expected)| *number == expected);
    if numbers.len() < 2 || is_counted {
        return;
    }
    let shown: Vec<String> = numbers.iter().map(u32::to_string).collect();
    let options = |key: &str, value: &dyn Fn(u32) -> usize| {
        let each =
            numbered.iter().map(|(column, number)| format!("{key}.{}={}", reference(column), value(*number)));
        each.collect::<Vec<_>>().join("\n")
    };
    // Trials count from 1.
    let rank = |number: u32| 1 + numbers.iter().filter(|other| **other < number).count();
    questions.push(Question::new(
        codes::AMBIGUOUS_COLUMN,
        format!("the numbers {} in the names of columns", shown.join(", ")),
        [
            (
                "they are wrap angles in degrees".to_owned(),
                options("wrap_angle_deg", &|number| number as usize),
            ),
            ("they are trials".to_owned(), options("repetition", &rank)),
        ],
    ));
}

/// Keeps one column of each quantity, and the columns of a wide table.
fn remove_duplicates(columns: &mut [Column], questions: &mut Vec<Question>) {
    let quantities: std::collections::BTreeSet<Quantity> =
        columns.iter().map(|column| column.quantity).collect();
    for quantity in quantities.into_iter().filter(|q| !matches!(q, Quantity::Ignore | Quantity::Copy)) {
        let all: Vec<usize> = (0..columns.len()).filter(|i| columns[*i].quantity == quantity).collect();
        let is_wide = quantity == Quantity::Force && {
            let keys: std::collections::BTreeSet<_> = all.iter().map(|i| columns[*i].key()).collect();
            // Numbered forces over time are several load cells, not trials.
            let has_trials = columns
                .iter()
                .any(|c| matches!(c.quantity, Quantity::Load | Quantity::LoadMass | Quantity::Direction));
            keys.len() == all.len() && (has_trials || all.iter().any(|i| columns[*i].is_wide_by_words()))
        };
        if all.len() < 2 || is_wide {
            continue;
        }
        for rank in [
            |c: &Column| c.is_decided,
            |c: &Column| !c.is_set_value(),
            |c: &Column| Quantity::of_table_column(&c.name).is_some(),
            |c: &Column| c.is_named,
        ] {
            let all: Vec<usize> = (0..columns.len()).filter(|i| columns[*i].quantity == quantity).collect();
            if all.iter().any(|i| rank(&columns[*i])) {
                for i in all {
                    if !rank(&columns[i]) {
                        columns[i].ignore("another column is named so more clearly");
                    }
                }
            }
        }
        let all: Vec<&Column> = columns.iter().filter(|column| column.quantity == quantity).collect();
        if all.len() > 1 {
            let names: Vec<String> = all.iter().map(|column| shown(column)).collect();
            let problem = format!(
                "{} columns may be the {}: {}",
                all.len(),
                quantity.as_str().replace('_', " "),
                names.join(", ")
            );
            let readings = all.iter().map(|column| {
                let others = all.iter().filter(|other| other.index != column.index);
                let option: Vec<String> =
                    others.map(|other| format!("column.{}=ignore", reference(other))).collect();
                (format!("{} is it", shown(column)), option.join("\n"))
            });
            questions.push(Question::new(codes::AMBIGUOUS_COLUMN, problem, readings));
        }
    }
}
