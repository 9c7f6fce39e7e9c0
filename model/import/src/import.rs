//! Import of files with a map.

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_measurements::table::PlateauTable;

use crate::column::Column;
use crate::file::FileReading;
use crate::log::{self, LogColumns};
use crate::map::{ColumnChoice, Kind, Map};
use crate::pattern::Pattern;
use crate::quantity::Quantity;
use crate::question::Question;
use crate::table::{self, Table};
use crate::understanding::{FileUnderstanding, Understanding};

/// Rows that are shown before a file is written.
const PREVIEW_ROWS: usize = 3;
/// Help for several readings of the same repetition.
const REPEATED_HELP: &str = "leave the repetition out, and the readings of a series are numbered in their order: write \
    {_} instead of {trial} in --pattern, or give --set 'column.NAME=ignore'";
/// Most names of files in an error.
const MAX_NAMES: usize = 3;
/// Most readings of a table.
const MAX_READINGS: usize = 1_000_000;

/// A file to import.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// Name, in messages and for the pattern.
    pub name: &'a str,
    /// Content.
    pub bytes: &'a [u8],
}

impl<'a> Source<'a> {
    /// Creates a source from a name and a content.
    pub fn new(name: &'a str, bytes: &'a [u8]) -> Self {
        Self { name, bytes }
    }
}

/// What an import writes.
#[derive(Clone, Debug, PartialEq)]
pub enum Output {
    /// A plateau table as CSV.
    Table(String),
    /// A log.
    Log(LogColumns),
}

impl Output {
    /// Returns the bytes of the file.
    pub fn to_csv(&self) -> String {
        match self {
            Self::Table(csv) => csv.clone(),
            Self::Log(log) => log.to_csv(),
        }
    }
}

/// The result of an import.
#[derive(Clone, Debug)]
pub struct Import {
    /// What was recognised, ignored and left open.
    pub understanding: Understanding,
    /// The table or log; `None` while a question is open.
    pub output: Option<Output>,
    /// Every decision: with it, the same files give the same output.
    pub map: Map,
}

/// Imports files with a map.
///
/// # Errors
/// A [`Diagnostic`] for a file that cannot be read. What has two readings is not an error but a
/// [`Question`].
pub fn import(sources: &[Source<'_>], map: &Map) -> Result<Import, Diagnostic> {
    import_with_pattern(sources, map, None)
}

/// Imports files whose names have values, such as the load.
///
/// # Errors
/// As [`import`], and for a file that does not match the pattern.
pub fn import_with_pattern(
    sources: &[Source<'_>],
    map: &Map,
    pattern: Option<&Pattern>,
) -> Result<Import, Diagnostic> {
    let mut files = Vec::new();
    for source in sources {
        files.push(read_file(source, map, pattern)?);
    }
    let Some(first) = files.first() else {
        return Err(Diagnostic::new(codes::FILES_DO_NOT_JOIN, "no file to import")
            .with_help("name a file, or a folder with files"));
    };
    let kind = first.kind;
    let mut questions: Vec<Question> = Vec::new();
    for question in files.iter().flat_map(|file| &file.questions) {
        if !questions.contains(question) {
            questions.push(question.clone());
        }
    }
    if let Some(other) = files.iter().find(|file| file.kind != kind).filter(|_| questions.is_empty()) {
        let problem = format!("{} is a {}, and this is a {}", first.name, kind.as_str(), other.kind.as_str());
        return Err(Diagnostic::new(codes::FILES_DO_NOT_JOIN, problem)
            .with_location(Location::file(&other.name))
            .with_help("import the two separately"));
    }
    let mut understanding = Understanding {
        kind: kind.as_str(),
        files: files.iter().map(FileUnderstanding::new).collect(),
        ..Understanding::default()
    };
    let output = if questions.is_empty() {
        match kind {
            Kind::Table => Some(build_table(&files, map, &mut understanding, &mut questions)?),
            Kind::Log => Some(build_log(&files, map, &mut understanding, &mut questions)?),
        }
    } else {
        understanding.rows = files.iter().map(|file| file.rows.len()).sum();
        None
    };
    let map = complete_map(&files, map, &understanding);
    let output = output.filter(|_| questions.is_empty());
    understanding.questions = questions;
    Ok(Import { understanding, output, map })
}

fn read_file(source: &Source<'_>, map: &Map, pattern: Option<&Pattern>) -> Result<FileReading, Diagnostic> {
    let base = source.name.rsplit(['/', '\\']).next().unwrap_or(source.name);
    let constants = match pattern.map(|pattern| pattern.values(base)) {
        Some(None) => {
            return Err(Diagnostic::new(codes::PATTERN_MISMATCH, "the name does not match the pattern")
                .with_location(Location::file(source.name))
                .with_help("leave the file out, or change --pattern"));
        }
        Some(Some(values)) => values,
        None => Default::default(),
    };
    let mut file = FileReading::read(source.name, source.bytes, map)
        .map_err(|diagnostic| diagnostic.or_in_file(source.name))?;
    let names_load = ["load_mass_g", "load_N", "direction"].iter().any(|key| constants.contains_key(*key));
    // A file with one load in its name and a few readings is a part of a table.
    if map.kind.is_none() && names_load && file.column(Quantity::Time).is_none() {
        file.kind = Kind::Table;
        file.kind_reason = "a load or a direction in the name of each file";
    }
    file.constants = constants;
    Ok(file)
}

fn build_table(
    files: &[FileReading],
    map: &Map,
    understanding: &mut Understanding,
    questions: &mut Vec<Question>,
) -> Result<Output, Diagnostic> {
    let mut table: Table = table::build(files, map, questions);
    let name = files.first().map_or("", |file| file.name.as_str());
    if table.len() > MAX_READINGS {
        return Err(Diagnostic::new(
            codes::FILE_TOO_LARGE,
            format!("{} readings, at most {MAX_READINGS} are a table", table.len()),
        )
        .with_location(Location::file(name))
        .with_help("read the file as a log with --set kind=log"));
    }
    understanding.rows = table.len();
    understanding.preview = table.lines(PREVIEW_ROWS).lines().map(str::to_owned).collect();
    let directions =
        table.directions.iter().map(|(word, (direction, count))| (word.clone(), direction.as_str(), *count));
    understanding.directions = directions.collect();
    let constants = table
        .constants
        .iter()
        .map(|(name, (value, is_given))| ((*name).to_owned(), value.clone(), *is_given));
    understanding.constants = constants.collect();
    understanding.notes.append(&mut table.notes);
    let csv = table.lines(usize::MAX);
    if table.lacks_wrap_angle() {
        understanding
            .notes
            .push("the wrap angle is not known: give it with --set wrap_angle_deg=180".to_owned());
    }
    if questions.is_empty() && table.len() == 0 {
        return Err(Diagnostic::new(codes::TABLE_WITHOUT_ROWS, "no row has a load, a direction and a force")
            .with_location(Location::file(name)));
    }
    // Values outside the bounds of a plateau table, and repeated readings.
    if questions.is_empty() {
        PlateauTable::read(csv.as_bytes(), "the imported table").map_err(Diagnostic::from).map_err(
            |error| {
                let is_repeated = error.location().and_then(|at| at.field.as_deref()) == Some("repetition");
                if is_repeated { error.with_help(REPEATED_HELP) } else { error }
            },
        )?;
    }
    Ok(Output::Table(csv))
}

fn build_log(
    files: &[FileReading],
    map: &Map,
    understanding: &mut Understanding,
    questions: &mut Vec<Question>,
) -> Result<Output, Diagnostic> {
    let [file] = files else {
        let names: Vec<&str> = files.iter().take(MAX_NAMES).map(|file| file.name.as_str()).collect();
        let more = if files.len() > MAX_NAMES { " and others" } else { "" };
        return Err(Diagnostic::new(codes::FILES_DO_NOT_JOIN, format!("{} logs: {}{more}", files.len(), names.join(", ")))
            .with_help(
                "import each log separately, and list the results in run.toml; for tables whose names have the load, give \
                 --pattern, such as --pattern '{load_g}g_{trial}.csv'",
            ));
    };
    let log = log::build(file, map, questions)?;
    for name in map.constants.keys() {
        let note = format!("{name} is not used: a log has no such column; its run file has loads and pins");
        understanding.notes.push(note);
    }
    understanding.rows = log.time_s.len();
    understanding.preview = log.lines(PREVIEW_ROWS).lines().map(str::to_owned).collect();
    let restarts = log.time_s.windows(2).filter(|w| w[1] < w[0]).count();
    if restarts > 0 {
        understanding.notes.push(format!("the time steps back {restarts} times"));
    }
    Ok(Output::Log(log))
}

/// Returns a map with every decision that was taken.
fn complete_map(files: &[FileReading], map: &Map, understanding: &Understanding) -> Map {
    let mut complete = map.clone();
    let Some(first) = files.first() else { return complete };
    let same =
        |value: &dyn Fn(&FileReading) -> Option<String>| files.iter().all(|file| value(file) == value(first));
    complete.kind = Some(first.kind);
    if same(&|file| file.recording.encoding.clone()) {
        let encoding = first.recording.encoding.as_deref().and_then(|encoding| encoding.split(' ').next());
        complete.encoding = encoding.map(str::to_owned);
    }
    if same(&|file| file.recording.delimiter.map(|d| d.as_str())) && !first.recording.format.contains("LVM") {
        complete.delimiter = first.recording.delimiter;
    }
    if same(&|file| Some(file.sign.as_str().to_owned())) {
        complete.decimal = Some(first.sign);
    }
    let line = |file: &FileReading| file.header.names_row.map(|row| file.recording.sheet.line(row));
    if map.header_line.is_none() && same(&|file| line(file).map(|line| line.to_string())) {
        complete.header_line = line(first);
    }
    for (name, value, _) in &understanding.constants {
        let is_of_name = files.iter().any(|file| file.constants.contains_key(name));
        if !is_of_name {
            complete.constants.insert(name.clone(), value.clone());
        }
    }
    if first.column(Quantity::Direction).is_some() || map.constants.contains_key("direction") {
        for (word, direction, _) in &understanding.directions {
            let direction = if *direction == "concentric" {
                pinswitch_friction::Direction::Concentric
            } else {
                pinswitch_friction::Direction::Eccentric
            };
            complete.directions.insert(word.clone(), direction);
        }
    }
    complete.columns = columns_of_map(files, understanding);
    complete.is_swapped = None;
    complete
}

/// Returns the decisions about each column of the files.
fn columns_of_map(files: &[FileReading], understanding: &Understanding) -> Vec<(String, ColumnChoice)> {
    let mut columns: Vec<(String, ColumnChoice)> = Vec::new();
    for file in files {
        for column in &file.columns {
            let is_repeated = file.columns.iter().filter(|other| other.name == column.name).count() > 1;
            let name = if column.name.is_empty() || is_repeated {
                (column.index + 1).to_string()
            } else {
                column.name.clone()
            };
            let is_read = column.quantity != Quantity::Ignore;
            if columns.iter().any(|(other, _)| *other == name) || (column.name.is_empty() && !is_read) {
                continue;
            }
            columns.push((name, choice(column, understanding)));
        }
    }
    columns
}

fn choice(column: &Column, understanding: &Understanding) -> ColumnChoice {
    let is_read = column.quantity != Quantity::Ignore;
    let has_factor = is_read && !column.quantity.dimensions().is_empty() && !column.is_clock;
    // The direction with which the readings are written, also if it was swapped.
    let written = understanding
        .directions
        .iter()
        .find(|(word, ..)| *word == column.name)
        .map(|(_, direction, _)| *direction);
    let direction = column.direction.map(|direction| match written {
        Some("concentric") => pinswitch_friction::Direction::Concentric,
        Some("eccentric") => pinswitch_friction::Direction::Eccentric,
        _ => direction,
    });
    ColumnChoice {
        quantity: Some(column.quantity),
        unit: column.unit.filter(|_| has_factor),
        is_unit_decided: false,
        is_factor_decided: false,
        is_filled: column.is_filled,
        row_unit: column.row_unit.filter(|_| has_factor),
        factor: Some(column.factor).filter(|_| has_factor),
        offset: Some(column.offset).filter(|offset| has_factor && !offset.is_zero()),
        direction: direction.filter(|_| is_read),
        load: column.load.filter(|_| is_read).map(|(value, unit)| format!("{value} {}", unit.name)),
        angle: column.angle.filter(|_| is_read),
        repetition: column.repetition.filter(|_| is_read),
    }
}

impl Map {
    /// Reads a raw log with this map. `name` is that of the file in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] for a file that cannot be read, has no force or time, or leaves a question
    /// open.
    pub fn read_log(&self, bytes: &[u8], name: &str) -> Result<LogColumns, Diagnostic> {
        let map = Self { kind: Some(Kind::Log), ..self.clone() };
        let file = FileReading::read(name, bytes, &map).map_err(|diagnostic| diagnostic.or_in_file(name))?;
        let mut questions = file.questions.clone();
        let log = if questions.is_empty() { Some(log::build(&file, &map, &mut questions)?) } else { None };
        match (questions.first(), log) {
            (None, Some(log)) => Ok(log),
            (Some(question), _) => Err(question.to_diagnostic().with_location(Location::file(name))),
            (None, None) => Ok(LogColumns::default()),
        }
    }
}
