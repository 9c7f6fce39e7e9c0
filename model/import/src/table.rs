//! Plateau tables: one reading of the steady force in each row.

use std::collections::BTreeMap;

use pinswitch_diagnostic::codes;
use pinswitch_friction::Direction;
use pinswitch_measurements::table::push_line;

use crate::column::{Column, reference};
use crate::decimal::Decimal;
use crate::direction_words;
use crate::file::FileReading;
use crate::map::Map;
use crate::number;
use crate::quantity::Quantity;
use crate::question::Question;
use crate::times::times;
use crate::unit::{Dimension, NEWTON_PER_GRAM};

/// Columns of a plateau table in the order in which they are written.
const COLUMNS: [Quantity; 18] = [
    Quantity::Series,
    Quantity::Substrate,
    Quantity::Pins,
    Quantity::Sweep,
    Quantity::LoadMass,
    Quantity::Load,
    Quantity::Speed,
    Quantity::Dwell,
    Quantity::Direction,
    Quantity::Repetition,
    Quantity::Position,
    Quantity::Time,
    Quantity::Force,
    Quantity::WrapAngle,
    Quantity::Session,
    Quantity::Mount,
    Quantity::Operator,
    Quantity::Specimen,
];

/// Columns that a table has even if no row has a value.
const ALWAYS: [Quantity; 6] = [
    Quantity::Series,
    Quantity::Substrate,
    Quantity::Pins,
    Quantity::Load,
    Quantity::Direction,
    Quantity::Force,
];

/// Share of negative readings above which the sign of the cell may be reversed.
const REVERSED_SHARE: f64 = 0.9;

/// A plateau table, before it is written.
#[derive(Debug, Default)]
pub(crate) struct Table {
    rows: Vec<Row>,
    /// Names of the columns that are copied.
    copied: Vec<String>,
    /// Word of the file, its direction, and the number of its readings.
    pub(crate) directions: BTreeMap<String, (Direction, usize)>,
    /// Constants that were used, and whether the user gave them.
    pub(crate) constants: BTreeMap<&'static str, (String, bool)>,
    pub(crate) notes: Vec<String>,
}

#[derive(Clone, Debug)]
struct Row {
    cells: [String; COLUMNS.len()],
    copied: Vec<String>,
    load_n: f64,
    force_n: f64,
    direction: Direction,
    is_decided: bool,
}

fn position(quantity: Quantity) -> usize {
    COLUMNS.iter().position(|other| *other == quantity).unwrap_or_default()
}

impl Table {
    /// Whether a reading is on a plain contact, whose wrap angle has no default, without a wrap
    /// angle.
    pub(crate) fn lacks_wrap_angle(&self) -> bool {
        let is_plain = |row: &Row| row.cells[position(Quantity::Substrate)] == "plain";
        self.rows.iter().any(|row| is_plain(row) && row.cells[position(Quantity::WrapAngle)].is_empty())
    }

    /// Number of readings.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Writes the names and the first `count` readings as CSV.
    pub(crate) fn lines(&self, count: usize) -> String {
        let is_written =
            |i: usize| ALWAYS.contains(&COLUMNS[i]) || self.rows.iter().any(|row| !row.cells[i].is_empty());
        let written: Vec<usize> = (0..COLUMNS.len()).filter(|i| is_written(*i)).collect();
        let mut out = String::new();
        let names =
            written.iter().map(|i| COLUMNS[*i].column()).chain(self.copied.iter().map(String::as_str));
        push_line(&mut out, names);
        for row in self.rows.iter().take(count) {
            push_line(
                &mut out,
                written.iter().map(|i| row.cells[*i].as_str()).chain(row.copied.iter().map(String::as_str)),
            );
        }
        out
    }
}

/// Returns the question about a word that is not a known direction.
pub(crate) fn unknown_direction(word: &str, column: Option<&Column>) -> Question {
    if word.is_empty() {
        let above = column.map(|column| {
            ("the direction of the row above".to_owned(), format!("fill.{}=down", reference(column)))
        });
        let readings = vec![
            ("all such readings are concentric".to_owned(), "concentric=".to_owned()),
            ("all such readings are eccentric".to_owned(), "eccentric=".to_owned()),
        ];
        let readings = above.into_iter().chain(readings);
        return Question::new(codes::UNKNOWN_DIRECTION, "some readings have no direction", readings);
    }
    let readings = vec![
        ("the load is pulled, and the force is higher".to_owned(), format!("concentric={word}")),
        ("the load is released, and the force is lower".to_owned(), format!("eccentric={word}")),
    ];
    Question::new(codes::UNKNOWN_DIRECTION, format!("'{word}' is not a known direction"), readings)
}

/// Makes a table of the rows of files; what is missing or has two readings becomes a question.
pub(crate) fn build(files: &[FileReading], map: &Map, questions: &mut Vec<Question>) -> Table {
    let mut table = Table::default();
    if !has_sources(files, map, questions) {
        return table;
    }
    for file in files {
        ask_for_empty(&mut table, file, map, questions);
    }
    let words = direction_words(files, map, questions);
    for file in files {
        let copied = file.columns.iter().filter(|column| column.quantity == Quantity::Copy);
        for column in copied {
            if !table.copied.contains(&column.name) {
                table.copied.push(column.name.clone());
            }
        }
    }
    let mut origin = None;
    for file in files {
        add_rows(&mut table, file, map, &words, &mut origin, questions);
    }
    ask_for_sign(&table, map, questions);
    check_directions(&mut table, files, map, questions);
    table
}

/// Value of a constant: from the name of the file, or from the map.
fn constant<'a>(file: &'a FileReading, map: &'a Map, key: &str) -> Option<&'a str> {
    file.constants.get(key).or_else(|| map.constants.get(key)).map(String::as_str)
}

/// Returns the load of a constant in newtons, and in grams if it is a mass.
fn constant_load(file: &FileReading, map: &Map) -> Option<(Decimal, Option<Decimal>)> {
    let number = |key| constant(file, map, key).and_then(Decimal::parse);
    let grams = number("load_mass_g")
        .or_else(|| number("load_g"))
        .or_else(|| number("load_kg").map(|kg| kg.times(Decimal::new(1, 3))));
    let newtons = number("load_N").or_else(|| grams.map(|g| g.times(NEWTON_PER_GRAM)))?;
    Some((newtons, grams))
}

/// Adds a question about a load and a direction if the files have none; returns whether both are known.
fn has_sources(files: &[FileReading], map: &Map, questions: &mut Vec<Question>) -> bool {
    let before = questions.len();
    for file in files {
        let has = |quantity| file.column(quantity).is_some();
        let has_load = has(Quantity::Load)
            || has(Quantity::LoadMass)
            || constant_load(file, map).is_some()
            || file.forces().all(|c| c.load.is_some());
        if !has_load {
            let readings = vec![
                ("in newtons, the same in all rows".to_owned(), "load_N=10".to_owned()),
                ("a mass, the same in all rows".to_owned(), "load_kg=1".to_owned()),
            ];
            // A column of weights whose name is not known.
            let is_weight = |c: &&Column| {
                let known = c.unit.is_some_and(|unit| Quantity::Load.dimensions().contains(&unit.dimension));
                c.quantity == Quantity::Ignore && known
            };
            let weights = file.columns.iter().filter(is_weight).map(reference);
            let mut columns: Vec<String> = weights.collect();
            if columns.is_empty() {
                columns.push("NAME".to_owned());
            }
            let in_column =
                columns.iter().map(|name| (format!("in column {name}"), format!("column.{name}=load")));
            let readings = in_column.chain(readings);
            questions.push(Question::new(
                codes::UNKNOWN_LOAD,
                format!("{}: the load is not known", file.name),
                readings,
            ));
        }
        let is_angle = |c: &&Column| {
            c.quantity == Quantity::Ignore && c.unit.is_some_and(|unit| unit.dimension == Dimension::Angle)
        };
        let has_angle = has(Quantity::WrapAngle)
            || constant(file, map, "wrap_angle_deg").is_some()
            || file.forces().all(|c| c.angle.is_some());
        if let Some(column) =
            file.columns.iter().find(|c| is_angle(c) && !c.is_decided).filter(|_| !has_angle)
        {
            let name = reference(column);
            let readings = vec![
                ("the wrap angle of the tendon".to_owned(), format!("column.{name}=wrap_angle")),
                ("another angle, which does not matter".to_owned(), format!("column.{name}=ignore")),
            ];
            questions.push(Question::new(
                codes::AMBIGUOUS_COLUMN,
                format!("column '{}' is an angle", column.name),
                readings,
            ));
        }
        let has_direction = has(Quantity::Direction)
            || constant(file, map, "direction").is_some()
            || file.forces().all(|c| c.direction.is_some());
        if !has_direction {
            let readings = vec![
                ("all readings after the load was pulled".to_owned(), "direction=concentric".to_owned()),
                ("all readings after the load was released".to_owned(), "direction=eccentric".to_owned()),
                ("in a column".to_owned(), "column.NAME=direction".to_owned()),
            ];
            questions.push(Question::new(
                codes::UNKNOWN_DIRECTION,
                format!("{}: the direction is not known", file.name),
                readings,
            ));
        }
        if questions.len() > before {
            return false;
        }
    }
    true
}

/// Readings whose cell of the load or the wrap angle is empty, as merged cells of a spreadsheet are: each may have the value
/// above.
fn ask_for_empty(table: &mut Table, file: &FileReading, map: &Map, questions: &mut Vec<Question>) {
    let lacks_load = |row: &usize| {
        let mut forces = file.forces().filter(|force| file.value(*row, force).is_some());
        forces.any(|force| load(file, map, *row, force).is_none())
    };
    let columns = [
        (file.column(Quantity::Load).or_else(|| file.column(Quantity::LoadMass)), "load"),
        (file.column(Quantity::WrapAngle), "wrap angle"),
    ];
    for (column, what) in columns {
        let Some(column) = column else { continue };
        let is_empty = |row: &usize| match column.quantity {
            Quantity::WrapAngle => lacks_angle(file, map, *row),
            _ => lacks_load(row),
        };
        let empty: Vec<usize> = file.rows.iter().copied().filter(is_empty).collect();
        let Some(first) = empty.first() else { continue };
        let line = file.recording.sheet.line(*first);
        let found = match empty.len() {
            1 => format!("the reading in line {line} has no {what}"),
            count => format!("{count} readings have no {what}, the first in line {line}"),
        };
        if map.skip_bad_rows {
            table.notes.push(format!("{found}: left out"));
            continue;
        }
        let readings = [
            (format!("the {what} of the row above"), format!("fill.{}=down", reference(column))),
            ("left out".to_owned(), "bad_rows=skip".to_owned()),
        ];
        questions.push(Question::new(codes::UNKNOWN_LOAD, found, readings));
    }
}

/// Whether a reading on a plain contact has no wrap angle, although a column has those of others.
fn lacks_angle(file: &FileReading, map: &Map, row: usize) -> bool {
    let cell = |column: &Column| file.recording.sheet.cell(row, column.index);
    let is_plain = match file.column(Quantity::Substrate).map(cell) {
        Some(word) => matches!(word.to_lowercase().as_str(), "" | "-" | "plain"),
        None => constant(file, map, "substrate").is_none_or(|word| word == "plain"),
    };
    is_plain
        && file.column(Quantity::WrapAngle).is_some_and(|column| number::is_missing(cell(column)))
        && constant(file, map, "wrap_angle_deg").is_none()
        && file.forces().any(|force| force.angle.is_none() && file.value(row, force).is_some())
}

/// Returns the direction of each word in the columns of directions.
fn direction_words(
    files: &[FileReading],
    map: &Map,
    questions: &mut Vec<Question>,
) -> BTreeMap<String, (Direction, bool)> {
    let mut words: BTreeMap<String, Option<(Direction, bool)>> = BTreeMap::new();
    for file in files {
        if let Some(column) = file.column(Quantity::Direction) {
            for row in &file.rows {
                let word = file.recording.sheet.cell(*row, column.index);
                if !words.contains_key(word) && words.len() < 50 {
                    words.insert(word.to_owned(), None);
                }
            }
        }
        if let Some(word) = constant(file, map, "direction") {
            words.entry(word.to_owned()).or_default();
        }
    }
    let decided = |word: &str| {
        let same = |other: &String| other.eq_ignore_ascii_case(word);
        map.directions.iter().find(|(other, _)| same(other)).map(|(_, direction)| *direction)
    };
    for (word, direction) in &mut words {
        *direction =
            decided(word).map(|d| (d, true)).or_else(|| direction_words::direction(word).map(|d| (d, false)));
    }
    // Of two words, the other one has the other direction; the forces must agree with it.
    if words.len() == 2 {
        let all: Vec<_> = words.values().copied().collect();
        for (i, direction) in words.values_mut().enumerate() {
            match (all[i], all[1 - i]) {
                (None, Some((other, is_decided))) => *direction = Some((opposite(other), is_decided)),
                (Some((_, false)), Some((other, true))) => *direction = Some((opposite(other), true)),
                _ => {}
            }
        }
    }
    let unknown: Vec<&String> = words.iter().filter(|(_, d)| d.is_none()).map(|(word, _)| word).collect();
    match unknown.as_slice() {
        [a, b] if words.len() == 2 => questions.push(opposite_words(a, b, files)),
        _ => {
            let column = files.iter().find_map(|file| file.column(Quantity::Direction));
            questions.extend(unknown.iter().take(4).map(|word| unknown_direction(word, column)));
        }
    }
    words.into_iter().filter_map(|(word, direction)| Some((word, direction?))).collect()
}

/// Returns the question which of two words is the concentric direction, with the forces as a hint.
fn opposite_words(a: &str, b: &str, files: &[FileReading]) -> Question {
    let mean = |word: &str| {
        let (mut sum, mut count) = (0.0, 0.0);
        for file in files {
            let Some((column, force)) = file.column(Quantity::Direction).zip(file.forces().next()) else {
                continue;
            };
            let sheet = &file.recording.sheet;
            let rows = file.rows.iter().filter(|row| sheet.cell(**row, column.index) == word);
            for force in rows.filter_map(|row| file.value(*row, force)) {
                sum += force.to_f64();
                count += 1.0;
            }
        }
        sum / count
    };
    let (mean_a, mean_b) = (mean(a), mean(b));
    let reading = |word: &str, mean: f64| {
        (format!("the mean force is {mean:.3} N with '{word}'"), format!("concentric={word}"))
    };
    Question::new(
        codes::UNKNOWN_DIRECTION,
        format!("the directions '{a}' and '{b}' are not known; the concentric one pulls the load"),
        vec![reading(a, mean_a), reading(b, mean_b)],
    )
}

/// Adds the readings of a file.
fn add_rows(
    table: &mut Table,
    file: &FileReading,
    map: &Map,
    words: &BTreeMap<String, (Direction, bool)>,
    origin: &mut Option<Decimal>,
    questions: &mut Vec<Question>,
) {
    let times = times(file, map);
    for (i, row) in file.rows.iter().enumerate() {
        if map.skip_bad_rows && lacks_angle(file, map, *row) {
            continue;
        }
        let mut cells: [String; COLUMNS.len()] = Default::default();
        add_words(&mut cells, table, file, map, *row, questions);
        if let Some((times, is_clock)) = &times
            && let Some(time) = times.get(i).copied().flatten()
        {
            let start = if *is_clock { *origin.get_or_insert(time) } else { Decimal::ZERO };
            cells[position(Quantity::Time)] = time.plus(start.negated()).to_string();
        }
        let copied: Vec<String> = table
            .copied
            .iter()
            .map(|name| {
                file.columns
                    .iter()
                    .find(|column| column.name == *name)
                    .map_or_else(String::new, |c| file.recording.sheet.cell(*row, c.index).to_owned())
            })
            .collect();
        for column in file.forces() {
            let Some(force) = file.value(*row, column) else { continue };
            let Some((direction, word, is_decided)) = direction(file, map, *row, column, words) else {
                continue;
            };
            let Some((load, mass, load_text)) = load(file, map, *row, column) else { continue };
            let direction =
                if map.is_swapped == Some(true) && !is_decided { opposite(direction) } else { direction };
            let force = if map.force_sign == Some(true) { force.negated() } else { force };
            let mut cells = cells.clone();
            let mut set = |quantity, text: String| cells[position(quantity)] = text;
            set(Quantity::Load, load.to_string());
            set(Quantity::LoadMass, mass.map_or_else(String::new, |mass| mass.to_string()));
            set(Quantity::Direction, direction.as_str().to_owned());
            set(Quantity::Force, force.to_string());
            if let Some(angle) = column.angle {
                set(Quantity::WrapAngle, angle.to_string());
            }
            if let Some(repetition) = column.repetition {
                set(Quantity::Repetition, repetition.to_string());
            }
            // In a table with a column for each load, the rows are trials.
            if column.load.is_some() && !cells[position(Quantity::Series)].is_empty() {
                let row_name = std::mem::take(&mut cells[position(Quantity::Series)]);
                let has_repetition = !cells[position(Quantity::Repetition)].is_empty();
                match row_name.parse::<u32>() {
                    Ok(_) if !has_repetition => cells[position(Quantity::Repetition)] = row_name,
                    _ => cells[position(Quantity::Series)] = format!("{row_name}, {load_text}"),
                }
            }
            if cells[position(Quantity::Series)].is_empty() {
                cells[position(Quantity::Series)] = series_name(file, &cells, &load_text);
            }
            let entry = table.directions.entry(word).or_insert((direction, 0));
            entry.1 += 1;
            table.rows.push(Row {
                cells,
                copied: copied.clone(),
                load_n: load.to_f64(),
                force_n: force.to_f64(),
                direction,
                is_decided,
            });
        }
    }
}

fn opposite(direction: Direction) -> Direction {
    if direction == Direction::Concentric { Direction::Eccentric } else { Direction::Concentric }
}

/// Sets the cells that all readings of a row share.
fn add_words(
    cells: &mut [String; COLUMNS.len()],
    table: &mut Table,
    file: &FileReading,
    map: &Map,
    row: usize,
    questions: &mut Vec<Question>,
) {
    for (i, quantity) in COLUMNS.iter().enumerate() {
        if matches!(
            quantity,
            Quantity::Load | Quantity::LoadMass | Quantity::Force | Quantity::Direction | Quantity::Time
        ) {
            continue;
        }
        let column = file.column(*quantity);
        let raw = column.map_or("", |column| file.recording.sheet.cell(row, column.index));
        let text = match (quantity, column) {
            (_, None) => String::new(),
            (Quantity::Substrate, _) => substrate(raw, questions),
            (Quantity::Pins, _) => pins(raw),
            (Quantity::Sweep, _) => sweep(raw).to_owned(),
            (quantity, Some(column)) if quantity.is_number() => {
                file.value(row, column).map_or_else(String::new, |v| v.to_string())
            }
            _ => raw.to_owned(),
        };
        let default = if *quantity == Quantity::Substrate { "plain" } else { "" };
        cells[i] = text;
        if cells[i].is_empty() {
            let given = constant(file, map, quantity.column());
            let value = given.unwrap_or(default);
            if !value.is_empty() {
                cells[i] = value.to_owned();
                if !file.constants.contains_key(quantity.column()) {
                    table.constants.insert(quantity.column(), (value.to_owned(), given.is_some()));
                }
            }
        }
    }
}

fn substrate(raw: &str, questions: &mut Vec<Question>) -> String {
    let word = raw.to_lowercase();
    match word.as_str() {
        "" | "-" => String::new(),
        "silicone" | "silikon" | "silicon" => "silicone".to_owned(),
        "abs" => "abs".to_owned(),
        "plain" => "plain".to_owned(),
        _ => {
            let problem = format!("'{raw}' is not a known substrate");
            if !questions.iter().any(|question| question.problem == problem) && questions.len() < 5 {
                let readings = vec![(
                    "one contact of a given material".to_owned(),
                    "column.substrate=ignore\nsubstrate=plain".to_owned(),
                )];
                questions.push(Question::new(codes::UNKNOWN_WORD, problem, readings));
            }
            String::new()
        }
    }
}

fn pins(raw: &str) -> String {
    let numbers = raw.split(|c: char| !c.is_ascii_digit()).filter(|part| !part.is_empty());
    numbers.collect::<Vec<_>>().join(";")
}

fn sweep(raw: &str) -> &'static str {
    match raw.to_lowercase().as_str() {
        "up" | "increasing" | "ascending" | "auf" | "aufwärts" | "steigend" => "up",
        "down" | "decreasing" | "descending" | "ab" | "abwärts" | "fallend" => "down",
        _ => "",
    }
}

/// Returns the direction of a reading, the word for it, and whether the user decided it.
fn direction(
    file: &FileReading,
    map: &Map,
    row: usize,
    force: &Column,
    words: &BTreeMap<String, (Direction, bool)>,
) -> Option<(Direction, String, bool)> {
    if let Some(direction) = force.direction {
        let is_decided =
            map.column(&force.name, force.index + 1).is_some_and(|choice| choice.direction.is_some());
        return Some((direction, force.name.clone(), is_decided));
    }
    let word = match file.column(Quantity::Direction) {
        Some(column) => file.recording.sheet.cell(row, column.index),
        None => constant(file, map, "direction")?,
    };
    words.get(word).map(|(direction, is_decided)| (*direction, word.to_owned(), *is_decided))
}

/// Returns the load of a reading in newtons and, if it is a mass, in grams, with its text in the
/// unit of the file.
fn load(
    file: &FileReading,
    map: &Map,
    row: usize,
    force: &Column,
) -> Option<(Decimal, Option<Decimal>, String)> {
    if let Some((value, unit)) = force.load {
        let text = format!("{value} {}", unit.name);
        let base = value.times(unit.factor);
        let is_mass = unit.dimension == Dimension::Mass;
        return Some(if is_mass {
            (base.times(NEWTON_PER_GRAM), Some(base), text)
        } else {
            (base, None, text)
        });
    }
    let value = |quantity| file.column(quantity).and_then(|column| file.value(row, column));
    let mass = value(Quantity::LoadMass);
    let newtons = value(Quantity::Load).or_else(|| mass.map(|mass| mass.times(NEWTON_PER_GRAM)));
    let Some(newtons) = newtons else {
        let (newtons, mass) = constant_load(file, map)?;
        let text = mass.map_or_else(|| format!("{newtons} N"), |mass| format!("{mass} g"));
        return Some((newtons, mass, text));
    };
    let column = file.column(Quantity::Load).or_else(|| file.column(Quantity::LoadMass))?;
    let raw = number::parse(file.recording.sheet.cell(row, column.index), file.sign)?.0;
    let text = format!("{raw} {}", column.unit.map_or("N", |unit| unit.name));
    Some((newtons, mass, text))
}

/// Names a series by what distinguishes its rows.
fn series_name(file: &FileReading, cells: &[String; COLUMNS.len()], load: &str) -> String {
    let cell = |quantity| cells[position(quantity)].as_str();
    let mut name = String::new();
    if file.column(Quantity::Substrate).is_some() || file.constants.contains_key("substrate") {
        name.push_str(&format!("{} ", cell(Quantity::Substrate)));
    }
    if !cell(Quantity::Pins).is_empty() {
        name.push_str(&format!("{} ", cell(Quantity::Pins)));
    }
    name.push_str(load);
    if !cell(Quantity::WrapAngle).is_empty() {
        name.push_str(&format!(" at {} deg", cell(Quantity::WrapAngle)));
    }
    if !cell(Quantity::Mount).is_empty() {
        name.push_str(&format!(", mount {}", cell(Quantity::Mount)));
    }
    name
}

/// Returns the share of negative readings.
fn negative_share(table: &Table) -> f64 {
    let negative = table.rows.iter().filter(|row| row.force_n < 0.0).count();
    #[expect(clippy::cast_precision_loss, reason = "a share")]
    let share = negative as f64 / table.rows.len().max(1) as f64;
    share
}

/// Adds a question whether the sign of the cell is reversed, if nearly all readings are negative.
fn ask_for_sign(table: &Table, map: &Map, questions: &mut Vec<Question>) {
    if map.force_sign.is_none() && negative_share(table) > REVERSED_SHARE {
        let readings = vec![
            ("the cell reads a tension as negative".to_owned(), "force_sign=-1".to_owned()),
            ("the forces are negative".to_owned(), "force_sign=1".to_owned()),
        ];
        questions.push(Question::new(codes::NEGATIVE_FORCES, "nearly all forces are negative", readings));
    }
}

/// Compares the words with the forces: at the same load, the force is higher while the load is
/// pulled.
fn check_directions(table: &mut Table, files: &[FileReading], map: &Map, questions: &mut Vec<Question>) {
    let is_sign_open = map.force_sign.is_none() && negative_share(table) > REVERSED_SHARE;
    if is_sign_open {
        return;
    }
    let mut groups: BTreeMap<String, [Vec<f64>; 2]> = BTreeMap::new();
    for row in &table.rows {
        let same = [
            Quantity::Substrate,
            Quantity::Pins,
            Quantity::WrapAngle,
            Quantity::Session,
            Quantity::Mount,
            Quantity::Specimen,
        ];
        let mut key = row.load_n.to_string();
        same.iter().for_each(|quantity| key.push_str(&format!("|{}", row.cells[position(*quantity)])));
        let side = usize::from(row.direction == Direction::Concentric);
        groups.entry(key).or_default()[side].push(row.force_n);
    }
    let (mut agreeing, mut contradicting) = (0, 0);
    for [eccentric, concentric] in groups.values_mut() {
        if let (Some(low), Some(high)) = (median(eccentric), median(concentric)) {
            agreeing += usize::from(high > low);
            contradicting += usize::from(high < low);
        }
    }
    let is_decided = map.is_swapped.is_some() || table.rows.iter().all(|row| row.is_decided);
    if is_decided || contradicting <= agreeing {
        if contradicting > 0 {
            table.notes.push(format!(
                "at {contradicting} of {} loads the concentric force is below the eccentric one",
                agreeing + contradicting
            ));
        }
        return;
    }
    let names: Vec<String> = table
        .directions
        .iter()
        .map(|(word, (direction, _))| format!("'{word}' = {}", direction.as_str()))
        .collect();
    let mut readings = Vec::new();
    let is_wide = files.iter().any(|file| file.forces().any(|column| column.direction.is_some()));
    let swapped = match table.directions.iter().find(|(_, (direction, _))| *direction == Direction::Eccentric)
    {
        Some((word, _)) if !is_wide && table.directions.len() == 2 => format!("concentric={word}"),
        _ => "directions=swapped".to_owned(),
    };
    readings.push(("the words mean the opposite here".to_owned(), swapped));
    readings.push((
        "the words are right, and the forces are as they should be".to_owned(),
        "directions=as-named".to_owned(),
    ));
    let problem = format!(
        "at {contradicting} of {} loads the concentric force is below the eccentric one, with {}",
        agreeing + contradicting,
        names.join(" and ")
    );
    questions.push(Question::new(codes::DIRECTION_AGAINST_FORCE, problem, readings));
}

fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values {
        [] => None,
        _ if values.len() % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}
