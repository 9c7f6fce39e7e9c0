//! The columns of a sheet: what each contains, in which unit, and with which factor.

use pinswitch_friction::Direction;

use crate::clock::{self, DateOrder};
use crate::decimal::Decimal;
use crate::direction_words;
use crate::header::Header;
use crate::map::{ColumnChoice, Map};
use crate::name;
use crate::number::{self, is_missing, sign_evidence};
use crate::quantity::Quantity;
use crate::question::Question;
use crate::sheet::Sheet;
use crate::trials::find_trials;
use crate::unit::{Dimension, NEWTON_PER_GRAM, Unit};
use crate::vocabulary;

/// Rows in which the kind of a column's cells is examined.
const SAMPLE_ROWS: usize = 500;
/// Shortest usual time between two samples that is assumed to be in seconds: that of 10 kHz, less rounding. Days, as spreadsheets
/// count them, have shorter ones.
const SHORTEST_STEP_S: f64 = 0.99e-4;
/// Largest speed as a share of the full speed, with overspeed.
const MAX_SHARE: f64 = 2.0;
/// Largest wrap angle in radians: two revolutions.
const MAX_RADIANS: f64 = 12.6;

/// Why a column of texts is not read.
pub(crate) const NOT_NUMBERS: &str = "its cells are not numbers";

/// A column of a sheet.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    pub(crate) index: usize,
    pub(crate) name: String,
    pub(crate) quantity: Quantity,
    pub(crate) unit: Option<&'static Unit>,
    /// Unit in the row of units.
    pub(crate) row_unit: Option<&'static Unit>,
    /// Factor to the unit of the column that is written.
    pub(crate) factor: Decimal,
    pub(crate) offset: Decimal,
    /// Whether the cells are dates or times of day.
    pub(crate) is_clock: bool,
    /// Direction, load, wrap angle in degrees and trial of a column of a wide table.
    pub(crate) direction: Option<Direction>,
    pub(crate) load: Option<(Decimal, &'static Unit)>,
    pub(crate) angle: Option<Decimal>,
    pub(crate) repetition: Option<u32>,
    /// Why the column is not read.
    pub(crate) reason: &'static str,
    /// Whether a word of the name names the quantity.
    is_named: bool,
    /// Whether another column has the same name.
    is_repeated: bool,
    /// Whether the unit follows from the values.
    pub(crate) is_assumed: bool,
    /// Whether the user decided the quantity.
    pub(crate) is_decided: bool,
    /// Whether the user gave the factor.
    has_factor: bool,
    /// Whether an empty cell has the value of the one above.
    pub(crate) is_filled: bool,
}

impl Column {
    /// Text of what distinguishes the readings of one column from those of another.
    fn key(&self) -> String {
        let direction = self.direction.map(Direction::as_str);
        let load = self.load.map(|(value, unit)| value.times(unit.factor).to_f64());
        format!("{direction:?} {load:?} {:?} {:?}", self.angle.map(Decimal::to_f64), self.repetition)
    }

    /// Whether the column has the readings of one direction, load, angle or trial of a wide table.
    pub(crate) fn is_wide(&self) -> bool {
        self.direction.is_some() || self.load.is_some() || self.angle.is_some() || self.repetition.is_some()
    }

    /// Whether the column is what a drive was commanded, not what was measured.
    fn is_set_value(&self) -> bool {
        const WORDS: [&str; 7] =
            ["target", "setpoint", "command", "commanded", "demand", "desired", "reference"];
        let words = vocabulary::words(&self.name);
        words.iter().any(|word| WORDS.contains(&word.as_str()) || word.starts_with("soll"))
    }

    fn is_wide_by_words(&self) -> bool {
        self.direction.is_some() || self.load.is_some() || self.angle.is_some()
    }

    fn ignore(&mut self, reason: &'static str) {
        self.quantity = Quantity::Ignore;
        self.reason = reason;
    }
}

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

/// Figures computed from the readings next to them, such as `SD (N)`, are no readings. `STD` is the German abbreviation of
/// hours in a log.
fn remove_statistics(columns: &mut [Column]) {
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
    // A force that is named as one, or a column that may be a trial.
    let has_reading = columns.iter().any(|c| {
        let may_be = matches!(c.quantity, Quantity::Force | Quantity::Repetition | Quantity::Ignore);
        may_be && !is_statistic(c) && !vocabulary::is_statistic(&c.name) || vocabulary::is_average(&c.name)
    });
    if has_reading {
        columns.iter_mut().filter(|c| is_statistic(c)).for_each(|c| c.ignore("computed from other columns"));
    }
}

/// A column that counts the rows, such as `Sample`, names no specimens.
fn remove_row_numbers(columns: &mut [Column], sheet: &Sheet, header: &Header) {
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
fn remove_averages(columns: &mut [Column]) {
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
            questions.push(Question::new(problem, readings));
        }
    }
}

/// Name of a column in a message; its number if another column has the same name.
fn shown(column: &Column) -> String {
    if column.is_repeated { format!("column {}", column.index + 1) } else { format!("'{}'", column.name) }
}

/// Name of a column in an option; its number if it has none.
pub(crate) fn reference(column: &Column) -> String {
    if column.name.is_empty() || column.is_repeated || column.name.contains(['=', '\'', '\n']) {
        (column.index + 1).to_string()
    } else {
        column.name.clone()
    }
}

/// Sets the factor from the unit; a unit that is not known becomes a question.
fn set_factor(column: &mut Column, sheet: &Sheet, header: &Header, map: &Map, questions: &mut Vec<Question>) {
    let quantity = column.quantity;
    // A map without the unit of its row is for files in its own units.
    let choice = map.column(&column.name, column.index + 1).filter(|choice| !choice.is_unit_decided);
    let mapped = choice.and_then(|choice| choice.row_unit.or(choice.unit).zip(choice.unit));
    if let (Some((known, unit)), Some(row)) = (mapped, column.row_unit)
        && known != row
    {
        let name = reference(column);
        let problem = format!(
            "column '{}' is in {} here, and was in {} where the map was made",
            column.name, row.name, known.name
        );
        let readings = vec![
            (format!("it is in {}", row.name), format!("unit.{name}={}", row.name)),
            (format!("it is in {}, as in the map", unit.name), format!("unit.{name}={}", unit.name)),
        ];
        questions.push(Question::new(problem, readings));
        return;
    }
    if quantity.dimensions().is_empty() || column.is_clock {
        return;
    }
    let decided = map.column(&column.name, column.index + 1);
    if column.has_factor {
        questions.extend(decided.and_then(|choice| unit_and_factor(column, choice)));
        return;
    }
    let given = map.force_unit.filter(|_| quantity == Quantity::Force);
    let named = column.unit.or(given);
    column.is_assumed = named.is_none();
    let Some(unit) = named.or_else(|| assumed_unit(column, sheet, header)) else {
        let question = unknown_unit(column);
        if !questions.contains(&question) {
            questions.push(question);
        }
        return;
    };
    column.unit = Some(unit);
    if !quantity.dimensions().contains(&unit.dimension) {
        let problem = format!("column '{}': {} in {}", column.name, quantity.as_str(), unit.name);
        let readings = vec![
            (
                "the unit is another one".to_owned(),
                format!("unit.{}={}", reference(column), quantity.base_unit()),
            ),
            ("the column is not needed".to_owned(), format!("column.{}=ignore", reference(column))),
        ];
        questions.push(Question::new(problem, readings));
        return;
    }
    match (quantity, unit.dimension) {
        (_, Dimension::Signal) => {
            let base = quantity.base_unit();
            let problem = format!(
                "column '{}' in {} needs a calibration line: {base} = factor x {} + offset",
                column.name, unit.name, unit.name
            );
            let readings = vec![
                (
                    format!("{base} per {}, and the reading in {base} at 0", unit.name),
                    format!("factor.{0}=0.001\noffset.{0}=0", reference(column)),
                ),
                ("the column is not needed".to_owned(), format!("column.{}=ignore", reference(column))),
            ];
            questions.push(Question::new(problem, readings));
        }
        (Quantity::Position, Dimension::Angle) => {
            column.ignore("an angle: its millimetres per degree are the option factor.NAME")
        }
        (Quantity::Speed, Dimension::Speed) => match map.full_speed_mm_s {
            Some(full) => {
                let percent = Decimal::from_f64(100.0 / full.to_f64()).unwrap_or(Decimal::ONE);
                column.factor = unit.factor.times(percent);
            }
            None => {
                column.ignore("a speed in length per time: the option full_speed_mm_s makes it a percentage")
            }
        },
        // A workbook stores 50 % as 0.5, and shows 50 %.
        (Quantity::Speed, Dimension::Share)
            if decided.is_none_or(|c| c.unit.is_none()) && {
                let values = sampled(column, sheet, header);
                values.iter().any(|v| *v > 0.0) && values.iter().all(|v| (0.0..=MAX_SHARE).contains(v))
            } =>
        {
            let name = reference(column);
            let problem = format!("column '{}' in {} has no value above {MAX_SHARE}", column.name, unit.name);
            let readings = vec![
                ("they are shares: 1 is the full speed".to_owned(), format!("factor.{name}=100")),
                ("they are percent: 1 is a hundredth of the full speed".to_owned(), format!("unit.{name}=%")),
            ];
            questions.push(Question::new(problem, readings));
        }
        (Quantity::Force, Dimension::Mass) => column.factor = unit.factor.times(NEWTON_PER_GRAM),
        _ => column.factor = unit.factor,
    }
}

/// A unit and a factor that a person gave for the same column have two readings: the factor is that of the written values, or
/// one in addition to the unit.
fn unit_and_factor(column: &Column, choice: &ColumnChoice) -> Option<Question> {
    let unit = choice.unit.filter(|unit| choice.is_factor_decided && unit.dimension != Dimension::Signal)?;
    let of_unit = match (column.quantity, unit.dimension) {
        (Quantity::Force, Dimension::Mass) => unit.factor.times(NEWTON_PER_GRAM),
        _ => unit.factor,
    };
    let (factor, base) = (column.factor, column.quantity.base_unit());
    if of_unit == factor || of_unit == Decimal::ONE {
        return None;
    }
    let name = reference(column);
    Some(Question::new(
        format!("column '{}' has the unit {} and the factor {factor}", column.name, unit.name),
        [
            (
                format!("{factor} {base} for a written 1"),
                format!("unit.{name}={base}\nfactor.{name}={factor}"),
            ),
            (
                format!("{factor} {} for a written 1", unit.name),
                format!("unit.{name}={base}\nfactor.{name}={}", factor.times(of_unit)),
            ),
        ],
    ))
}

/// Returns the numbers in the first rows of a column.
fn sampled(column: &Column, sheet: &Sheet, header: &Header) -> Vec<f64> {
    let sign = if (header.first_data..sheet.len())
        .take(SAMPLE_ROWS)
        .any(|row| sheet.cell(row, column.index).contains('.'))
    {
        number::DecimalSign::Point
    } else {
        number::DecimalSign::Comma
    };
    let rows = (header.first_data..sheet.len()).take(SAMPLE_ROWS);
    rows.filter_map(|row| number::parse(sheet.cell(row, column.index), sign))
        .map(|(v, _)| v.to_f64())
        .collect()
}

/// Returns the unit that the values of a column without a unit show.
fn assumed_unit(column: &Column, sheet: &Sheet, header: &Header) -> Option<&'static Unit> {
    let values = sampled(column, sheet, header);
    match column.quantity {
        Quantity::WrapAngle if values.iter().any(|angle| *angle > MAX_RADIANS) => Unit::parse("deg"),
        // No load cell has a sample every 0.1 ms and writes fractions of milliseconds.
        Quantity::Time => {
            let steps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 0.0).collect();
            let mut sorted = steps.clone();
            sorted.sort_by(f64::total_cmp);
            let usual = sorted.get(sorted.len() / 2);
            let is_seconds =
                usual.is_some_and(|step| *step >= SHORTEST_STEP_S) && steps.iter().all(|step| *step < 1.0);
            if is_seconds { Unit::parse("s") } else { None }
        }
        _ => None,
    }
}

fn unknown_unit(column: &Column) -> Question {
    let units: &[&str] = match column.quantity {
        Quantity::Load => &["N", "kg", "g", "lbf"],
        Quantity::LoadMass => &["g", "kg"],
        Quantity::Force => &["N", "kN", "kgf", "lbf", "counts"],
        Quantity::Time => &["s", "ms", "d"],
        Quantity::Dwell => &["s", "ms"],
        Quantity::Position => &["mm", "m", "in"],
        Quantity::WrapAngle => &["deg", "rad", "pi rad", "turns"],
        Quantity::Speed => &["%", "mm/s"],
        _ => &["W", "mW"],
    };
    if column.quantity == Quantity::Force && column.is_wide() {
        let readings = units.iter().map(|unit| ((*unit).to_owned(), format!("force_unit={unit}")));
        return Question::new("the columns of forces have no unit", readings);
    }
    let problem = format!("column '{}' has no unit", column.name);
    let mut readings: Vec<_> =
        units.iter().map(|unit| ((*unit).to_owned(), format!("unit.{}={unit}", reference(column)))).collect();
    if column.quantity == Quantity::Speed {
        readings
            .push(("shares: 1 is the full speed".to_owned(), format!("factor.{}=100", reference(column))));
    }
    if !matches!(column.quantity, Quantity::Load | Quantity::Force) {
        readings.push(("leave it out".to_owned(), format!("column.{}=ignore", reference(column))));
    }
    Question::new(problem, readings)
}
