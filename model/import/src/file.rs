//! One file: its header, its columns, its decimal sign, and which rows have readings.

use std::collections::{BTreeMap, BTreeSet};

use pinswitch_diagnostic::{Diagnostic, Location, codes};

use crate::clock::{self, DateOrder};
use crate::column::{self, Column};
use crate::columns;
use crate::decimal::Decimal;
use crate::direction_words;
use crate::header::{self, Header};
use crate::map::{Kind, Map};
use crate::number::{self, DecimalSign, SignEvidence, is_missing};
use crate::quantity::Quantity;
use crate::question::Question;
use crate::recording::Recording;
use crate::unit::NEWTON_PER_GRAM;
use crate::vocabulary;

/// Cells with the same evidence, after which only cells that may contradict it are examined.
const ENOUGH_EVIDENCE: usize = 1_000;
/// Rows in which the names of a column are looked for.
const NAME_ROWS: usize = 500;
/// Share by which a cell and a constant may differ from rounding in another unit.
const SAME_SHARE: f64 = 1e-6;
/// Share of the rows of a log that may be unusable.
const MAX_BAD_SHARE: f64 = 0.01;
/// Rows of a table with times above which it may be a log.
const MANY_ROWS: usize = 200;

/// A file that is understood as far as its cells show.
#[derive(Debug)]
pub(crate) struct FileReading {
    pub(crate) name: String,
    pub(crate) recording: Recording,
    pub(crate) header: Header,
    pub(crate) columns: Vec<Column>,
    pub(crate) sign: DecimalSign,
    pub(crate) date_order: DateOrder,
    /// Whether times of two parts are minutes and seconds.
    pub(crate) is_in_minutes: bool,
    pub(crate) kind: Kind,
    /// Why it is a table or a log.
    pub(crate) kind_reason: &'static str,
    /// Rows of the sheet with readings.
    pub(crate) rows: Vec<usize>,
    /// Rows that were left out: reason, number, and first line.
    pub(crate) skipped: Vec<(String, usize, usize)>,
    pub(crate) questions: Vec<Question>,
    /// Values from the name of the file.
    pub(crate) constants: BTreeMap<String, String>,
}

impl FileReading {
    /// Reads a file and finds out what it contains.
    ///
    /// # Errors
    /// A [`Diagnostic`] if it cannot be read, has no numbers or no names, or has a row that is
    /// neither used nor skipped.
    pub(crate) fn read(name: &str, bytes: &[u8], map: &Map) -> Result<Self, Diagnostic> {
        let mut recording = Recording::read(bytes, map).map_err(|d| d.or_in_file(name))?;
        let sheet = &recording.sheet;
        let mut header =
            header::find(sheet, map.header_line).ok_or_else(|| no_header(name, &recording, map))?;
        // A header block may have another length in another file of the same machine.
        let has_known_names = |header: &Header| {
            header.names.iter().any(|name| map.columns.iter().any(|(known, _)| known == name))
        };
        if !map.columns.is_empty()
            && !has_known_names(&header)
            && let Some(other) = header::find(sheet, None).filter(has_known_names)
        {
            header = other;
        }
        if let Some(names) = &map.names {
            header.names.clone_from(names);
            header.units.clear();
        }
        if let Some(diagnostic) = too_few_names(name, &recording, &header) {
            return Err(diagnostic);
        }
        for (i, column) in header.names.iter().enumerate() {
            if map.column(column, i + 1).is_some_and(|choice| choice.is_filled) {
                recording.sheet = recording.sheet.fill_down(i, header.first_data)?;
            }
        }
        let sheet = &recording.sheet;
        let mut questions = Vec::new();
        let columns = columns::assign(sheet, &header, map, &mut questions);
        let is_used = |choice: &crate::map::ColumnChoice| {
            choice.quantity == Some(Quantity::Ignore)
                || columns
                    .iter()
                    .any(|c| map.column(&c.name, c.index + 1).is_some_and(|used| std::ptr::eq(used, choice)))
        };
        if let Some((missing, _)) = map.columns.iter().find(|(_, choice)| !is_used(choice)) {
            let known: Vec<&str> = header.names.iter().map(String::as_str).collect();
            return Err(Diagnostic::new(codes::UNKNOWN_COLUMN, format!("no column '{missing}'"))
                .with_location(Location::file(name))
                .with_help(format!("the columns are: {}", known.join(", "))));
        }
        let mut file = Self {
            name: name.to_owned(),
            sign: DecimalSign::Point,
            date_order: map.date_order.unwrap_or(DateOrder::DayFirst),
            is_in_minutes: map.is_in_minutes == Some(true),
            kind: Kind::Log,
            kind_reason: "",
            rows: Vec::new(),
            skipped: Vec::new(),
            questions,
            constants: BTreeMap::new(),
            recording,
            header,
            columns,
        };
        file.sign = match map.decimal.or(file.recording.sign) {
            Some(sign) => sign,
            None => file.decide_sign(),
        };
        file.find_rows(map)?;
        Ok(file)
    }

    /// Returns the column of a quantity.
    pub(crate) fn column(&self, quantity: Quantity) -> Option<&Column> {
        self.columns.iter().find(|column| column.quantity == quantity)
    }

    /// Returns the columns with readings of force.
    pub(crate) fn forces(&self) -> impl Iterator<Item = &Column> {
        self.columns.iter().filter(|column| column.quantity == Quantity::Force)
    }

    /// Returns the converted number of a cell; `None` for an empty cell and for one that is not a
    /// number.
    pub(crate) fn value(&self, row: usize, column: &Column) -> Option<Decimal> {
        let cell = self.recording.sheet.cell(row, column.index);
        if column.is_clock {
            return self.moment(cell).map(clock::Moment::seconds);
        }
        let (value, suffix) = number::parse(cell, self.sign)?;
        if suffix.is_some() && suffix != column.unit {
            return None;
        }
        Some(value.times(column.factor).plus(column.offset))
    }

    /// Returns the moment of a cell with a clock.
    pub(crate) fn moment(&self, cell: &str) -> Option<clock::Moment> {
        if self.is_in_minutes && clock::is_two_parts(cell) {
            return clock::parse(&format!("00:{}", cell.trim()), self.date_order);
        }
        clock::parse(cell, self.date_order)
    }

    fn is_semicolon(&self) -> bool {
        self.recording.delimiter == Some(crate::dialect::Delimiter::Sign(b';'))
    }

    /// Decides between decimal point and comma by all cells of the columns that are used.
    fn decide_sign(&mut self) -> DecimalSign {
        let sheet = &self.recording.sheet;
        let mut first: [Option<(usize, String)>; 4] = [None, None, None, None];
        let mut counts = [0_usize; 4];
        // Columns with four digits and more without a separator, and with a comma before three digits.
        let (mut long_whole, mut with_comma) = (BTreeSet::new(), BTreeSet::new());
        // Columns with one separator before three digits, and those with a number that shows what the separator is.
        let (mut unsure, mut sure) = ([BTreeMap::new(), BTreeMap::new()], BTreeSet::new());
        let used: Vec<&Column> =
            self.columns.iter().filter(|c| c.quantity.is_number() && !c.is_clock).collect();
        for row in self.header.first_data..sheet.len() {
            for column in &used {
                let cell = sheet.cell(row, column.index);
                let contradicts = |sign: char| cell.contains(sign);
                if counts[0] >= ENOUGH_EVIDENCE && !contradicts(',')
                    || counts[1] >= ENOUGH_EVIDENCE && !contradicts('.')
                {
                    continue;
                }
                let at = match number::sign_evidence(cell) {
                    Some(SignEvidence::Point) => 0,
                    Some(SignEvidence::Comma) => 1,
                    Some(SignEvidence::EitherPoint) => 2,
                    Some(SignEvidence::EitherComma) => 3,
                    Some(SignEvidence::Whole) => {
                        let is_long = cell.bytes().filter(u8::is_ascii_digit).count() >= 4
                            && cell.bytes().all(|b| b.is_ascii_digit() || b == b'-');
                        if is_long {
                            long_whole.insert(column.index);
                        } else {
                            // Less than 1000: as numbers around it have a separator for thousands, it has none.
                            sure.insert(column.index);
                        }
                        continue;
                    }
                    None => continue,
                };
                counts[at] += 1;
                if at == 3 {
                    with_comma.insert(column.index);
                }
                if at < 2 {
                    sure.insert(column.index);
                } else {
                    unsure[at - 2].entry(column.index).or_insert_with(|| (sheet.line(row), cell.to_owned()));
                }
                if first[at].is_none() {
                    first[at] = Some((sheet.line(row), cell.to_owned()));
                }
            }
        }
        let shown = |at: usize| {
            first[at].as_ref().map_or_else(String::new, |(line, cell)| format!("'{cell}' in line {line}"))
        };
        match (counts[0] > 0, counts[1] > 0, counts[3] > 0) {
            (true, true, _) => {
                let problem = format!(
                    "numbers with a decimal point ({}) and with a decimal comma ({})",
                    shown(0),
                    shown(1)
                );
                self.questions.push(Question::new(
                    codes::AMBIGUOUS_NUMBER,
                    problem,
                    sign_answers("decimal comma", "decimal point"),
                ));
                DecimalSign::Point
            }
            // The sign of one column is not that of another one, which has it before three digits in every number.
            (true, false, _) | (false, true, _) => {
                let is_point = counts[0] > 0;
                if let Some((_, number)) =
                    unsure[usize::from(is_point)].iter().find(|(column, _)| !sure.contains(*column))
                {
                    self.questions
                        .push(separator_question(Some(number), if is_point { "comma" } else { "point" }));
                }
                if is_point { DecimalSign::Point } else { DecimalSign::Comma }
            }
            // Whole numbers of four digits and more have no thousands separator, so the comma is
            // none either in the same column; a spreadsheet may format one column alone.
            (false, false, true) if counts[2] == 0 && with_comma.is_subset(&long_whole) => DecimalSign::Comma,
            (false, false, true) => {
                self.questions.push(separator_question(first[3].as_ref(), "comma"));
                DecimalSign::Comma
            }
            // Semicolons are the delimiter where commas are the decimal sign.
            (false, false, false) if counts[2] > 0 && long_whole.is_empty() && self.is_semicolon() => {
                self.questions.push(separator_question(first[2].as_ref(), "point"));
                DecimalSign::Point
            }
            (false, false, false) => DecimalSign::Point,
        }
    }

    /// Finds the rows with readings; decides whether they are a table or a log.
    fn find_rows(&mut self, map: &Map) -> Result<(), Diagnostic> {
        self.refuse_another_header(map)?;
        let mut verdicts: Vec<RowVerdict> =
            (self.header.first_data..self.recording.sheet.len()).map(|row| self.judge(row)).collect();
        // Lines between the last reading and a repeated header belong to that header.
        let mut is_preamble = false;
        for verdict in verdicts.iter_mut().rev() {
            match verdict {
                RowVerdict::Skip("repeated header") => is_preamble = true,
                RowVerdict::Bad { .. } | RowVerdict::Skip("text") if is_preamble => {
                    *verdict = RowVerdict::Skip("lines before a repeated header")
                }
                RowVerdict::Use => is_preamble = false,
                _ => {}
            }
        }
        let first_row = self.header.first_data;
        self.rows = verdicts
            .iter()
            .enumerate()
            .filter(|(_, v)| matches!(v, RowVerdict::Use))
            .map(|(i, _)| first_row + i)
            .collect();
        self.refuse_unused_constants(map)?;
        self.decide_kind(map);
        self.ask_for_date_order(map);
        self.ask_for_minutes(map);
        let bad: Vec<(usize, &RowVerdict)> =
            verdicts.iter().enumerate().filter(|(_, v)| matches!(v, RowVerdict::Bad { .. })).collect();
        #[expect(clippy::cast_precision_loss, reason = "a share")]
        let share = bad.len() as f64 / verdicts.len().max(1) as f64;
        let may_skip = map.skip_bad_rows || (self.kind == Kind::Log && share <= MAX_BAD_SHARE);
        if let (false, Some((i, RowVerdict::Bad { column, cell, problem })), true) =
            (may_skip, bad.first(), self.questions.is_empty())
        {
            let line = self.recording.sheet.line(first_row + i);
            let count =
                if bad.len() > 1 { format!(" ({} rows are like this)", bad.len()) } else { String::new() };
            return Err(Diagnostic::new(codes::UNUSABLE_CELLS, format!("{problem}{count}"))
                .with_location(Location::line(&self.name, line).with_field(column.clone(), cell.clone()))
                .with_help("correct the cell, or leave out such rows with --set bad_rows=skip"));
        }
        let mut skipped: Vec<(String, usize, usize)> = Vec::new();
        for (i, verdict) in verdicts.iter().enumerate() {
            let reason = match verdict {
                RowVerdict::Use => continue,
                RowVerdict::Skip(reason) => *reason,
                RowVerdict::Bad { problem, .. } => problem,
            };
            let line = self.recording.sheet.line(first_row + i);
            match skipped.iter_mut().find(|(other, ..)| other == reason) {
                Some(entry) => entry.1 += 1,
                None => skipped.push((reason.to_owned(), 1, line)),
            }
        }
        self.skipped = skipped;
        if self.rows.is_empty() && self.questions.is_empty() {
            let names: Vec<String> = self.columns.iter().map(|column| format!("'{}'", column.name)).collect();
            let is_text = |column: &&Column| column.reason == column::NOT_NUMBERS;
            let problem = if self.forces().next().is_some() {
                "no row has a force".to_owned()
            } else if let Some(column) = self.columns.iter().find(is_text) {
                let rows = self.header.first_data..self.recording.sheet.len();
                let cells = rows.map(|row| self.recording.sheet.cell(row, column.index));
                let mut words =
                    cells.filter(|cell| !is_missing(cell) && number::sign_evidence(cell).is_none());
                format!(
                    "no column is the force: the cells of '{}' are not numbers, such as '{}'",
                    column.name,
                    words.next().unwrap_or_default()
                )
            } else {
                format!("no column is the force; the columns are {}", names.join(", "))
            };
            return Err(Diagnostic::new(codes::NO_FORCE_COLUMN, problem)
                .with_location(Location::file(&self.name))
                .with_help(
                    "name the column of the force, as in --set 'column.NAME=force' --set unit.NAME=N",
                ));
        }
        Ok(())
    }

    /// Data below another header are other columns, or the same in other units: one header cannot read both.
    fn refuse_another_header(&self, map: &Map) -> Result<(), Diagnostic> {
        // Names that the user gave are for all rows.
        if map.names.is_some() || self.header.names_row.is_none() {
            return Ok(());
        }
        let sheet = &self.recording.sheet;
        let Some((row, other)) = header::find_other(sheet, &self.header) else { return Ok(()) };
        let shown = |header: &Header| {
            let unit = |i: usize| header.units.get(i).copied().flatten();
            let names = header.names.iter().enumerate().filter(|(_, name)| !name.is_empty());
            let named = names.map(|(i, name)| match unit(i) {
                Some(unit) => format!("{name} [{}]", unit.name),
                None => name.clone(),
            });
            named.collect::<Vec<_>>().join(", ")
        };
        let problem =
            format!("another header ({}) than the first one ({})", shown(&other), shown(&self.header));
        Err(Diagnostic::new(codes::SEVERAL_TABLES, problem)
            .with_location(Location::line(&self.name, sheet.line(row)))
            .with_help("give each block of columns in a file of its own; `import` takes several files"))
    }

    /// A constant that the user gave, and a column with a value in every row: one of them is wrong.
    fn refuse_unused_constants(&self, map: &Map) -> Result<(), Diagnostic> {
        for (key, value) in &map.constants {
            let quantities = match key.as_str() {
                "load_N" | "load_kg" | "load_g" | "load_mass_g" => vec![Quantity::Load, Quantity::LoadMass],
                _ => Quantity::of_table_column(key).into_iter().collect(),
            };
            let full = self.columns.iter().find(|column| {
                let is_cell_missing = |row: &usize| is_missing(self.recording.sheet.cell(*row, column.index));
                quantities.contains(&column.quantity)
                    && !self.rows.is_empty()
                    && !self.rows.iter().any(is_cell_missing)
                    && !self.rows.iter().all(|row| self.is_constant(*row, column, key, value))
            });
            if let Some(column) = full {
                let help = format!(
                    "leave out --set {key}, or the column with --set 'column.{}=ignore'",
                    column::reference(column)
                );
                return Err(Diagnostic::new(
                    codes::UNUSABLE_CELLS,
                    format!("the column '{}' has other values", column.name),
                )
                .with_location(Location::field(key.clone(), value.clone()))
                .with_help(help));
            }
        }
        Ok(())
    }

    /// Whether a cell is a constant that the user gave, in whatever unit or word it is written.
    fn is_constant(&self, row: usize, column: &Column, key: &str, value: &str) -> bool {
        let cell = self.recording.sheet.cell(row, column.index);
        if column.quantity == Quantity::Direction {
            let direction =
                |word: &str| direction_words::direction(word).map(pinswitch_friction::Direction::as_str);
            return direction(cell).is_some() && direction(cell) == direction(value);
        }
        let newtons =
            |value: Decimal, is_mass: bool| if is_mass { value.times(NEWTON_PER_GRAM) } else { value };
        let numbers = self.value(row, column).zip(Decimal::parse(value)).map(|(found, given)| match key {
            "load_kg" => (found, given.times(Decimal::new(1, 3)), true),
            "load_g" | "load_mass_g" => (found, given, true),
            _ => (found, given, false),
        });
        match numbers {
            None => cell.eq_ignore_ascii_case(value),
            Some((found, given, is_mass)) => {
                let found = newtons(found, column.quantity == Quantity::LoadMass).to_f64();
                let given = newtons(given, is_mass).to_f64();
                (found - given).abs() <= SAME_SHARE * given.abs()
            }
        }
    }

    /// Decides whether a row has a reading.
    fn judge(&self, row: usize) -> RowVerdict {
        let sheet = &self.recording.sheet;
        let (mut has_force, mut has_number) = (false, false);
        let mut bad = None;
        for column in self.columns.iter().filter(|column| column.quantity.is_number()) {
            let cell = sheet.cell(row, column.index);
            if is_missing(cell) {
                continue;
            }
            if self.value(row, column).is_some_and(|value| value.to_f64().is_finite()) {
                has_number = true;
                has_force |= column.quantity == Quantity::Force;
            } else if bad.is_none() {
                bad = Some(column);
            }
        }
        // With blanks as delimiter, an empty cell shifts those after it.
        let is_blanks = self.recording.delimiter == Some(crate::dialect::Delimiter::Blanks);
        let is_used = |column: &Column| column.quantity != Quantity::Ignore;
        let lacks = |column: &Column| column.index >= sheet.width(row) && is_used(column);
        if is_blanks && header::is_data(sheet, row) && self.columns.iter().any(lacks) {
            if let Some(reason) = self.reason_to_skip(row) {
                return RowVerdict::Skip(reason);
            }
            let cell = sheet.row(row).collect::<Vec<_>>().join(" ");
            let problem = "fewer cells than names, and blanks do not show which one is empty";
            return RowVerdict::Bad { column: "row".to_owned(), cell, problem };
        }
        // Most rows of a log begin with a number.
        let begins_with_number = sheet.cell(row, 0).starts_with(|c: char| c.is_ascii_digit() || c == '-');
        if bad.is_none() && has_force && begins_with_number {
            return RowVerdict::Use;
        }
        if let Some(reason) = self.reason_to_skip(row) {
            return RowVerdict::Skip(reason);
        }
        match bad {
            Some(_) if !has_number => RowVerdict::Skip("text"),
            Some(column) => {
                let cell = sheet.cell(row, column.index);
                let problem = self.problem(cell, column);
                RowVerdict::Bad { column: column.name.clone(), cell: cell.to_owned(), problem }
            }
            None if has_force => RowVerdict::Use,
            None => RowVerdict::Skip("no force"),
        }
    }

    /// Returns why a row is not one of readings, whatever its numbers are.
    fn reason_to_skip(&self, row: usize) -> Option<&'static str> {
        let sheet = &self.recording.sheet;
        if header::is_comment(sheet, row) {
            return Some("comment");
        }
        let named = || self.columns.iter().filter(|column| !column.name.is_empty());
        let repeated =
            named().filter(|column| sheet.cell(row, column.index).eq_ignore_ascii_case(&column.name)).count();
        if repeated > 0 && repeated * 2 > named().count() {
            return Some("repeated header");
        }
        if header::is_units_row(sheet, row) && !header::is_data(sheet, row) {
            return Some("repeated units");
        }
        let (at, label) = sheet.row(row).enumerate().find(|(_, cell)| !cell.is_empty())?;
        let quantity = self.columns.iter().find(|column| column.index == at).map(|column| column.quantity);
        let is_group = matches!(
            quantity,
            Some(
                Quantity::Operator
                    | Quantity::Specimen
                    | Quantity::Session
                    | Quantity::Mount
                    | Quantity::Substrate
                    | Quantity::Direction
            )
        );
        // Initials among other names are a name; next to numbers they are not.
        let is_other_name = |cell: &str| {
            !vocabulary::is_summary(cell, false) && cell.chars().next().is_some_and(char::is_alphabetic)
        };
        let is_name = || {
            let rows = (self.header.first_data..sheet.len()).take(NAME_ROWS);
            quantity == Some(Quantity::Series) && rows.map(|row| sheet.cell(row, at)).any(is_other_name)
        };
        let is_summary = !is_group && vocabulary::is_summary(label, false);
        (is_summary && (vocabulary::is_summary(label, true) || !is_name())).then_some("summary")
    }

    fn problem(&self, cell: &str, column: &Column) -> &'static str {
        if column.is_clock {
            return "not a time";
        }
        match number::parse(cell, self.sign) {
            Some((_, Some(_))) => "another unit than that of the column",
            _ => "not a number",
        }
    }

    fn decide_kind(&mut self, map: &Map) {
        let has = |quantity| self.column(quantity).is_some();
        let is_wide = self.forces().any(Column::is_wide);
        let has_load = has(Quantity::Load) || has(Quantity::LoadMass);
        let has_time = has(Quantity::Time) || map.sample_rate_hz.is_some();
        let is_given = |quantity: Quantity| map.constants.contains_key(quantity.column());
        let is_given = [Quantity::Load, Quantity::LoadMass, Quantity::Direction].into_iter().any(is_given);
        let is_table = is_wide || has(Quantity::Direction) || has_load || (is_given && !has_time);
        (self.kind, self.kind_reason) = match (is_table, is_wide) {
            (_, true) => (Kind::Table, "several readings in a row"),
            (true, _) => (Kind::Table, "a load or a direction in each row"),
            _ if has_time => (Kind::Log, "force over time"),
            _ => (Kind::Log, "only forces"),
        };
        if let Some(kind) = map.kind {
            (self.kind, self.kind_reason) = (kind, "on request");
        } else if is_table && !is_wide && self.rows.len() > MANY_ROWS && self.has_short_steps() {
            let problem =
                format!("{} rows with a load or a direction, less than a second apart", self.rows.len());
            let readings = vec![
                ("samples of a log".to_owned(), "kind=log".to_owned()),
                ("a steady reading in each row".to_owned(), "kind=table".to_owned()),
            ];
            self.questions.push(Question::new(codes::AMBIGUOUS_COLUMN, problem, readings));
        }
    }

    fn has_short_steps(&self) -> bool {
        let Some(time) = self.column(Quantity::Time) else { return false };
        let times: Vec<f64> = self
            .rows
            .iter()
            .take(MANY_ROWS)
            .filter_map(|row| self.value(*row, time))
            .map(Decimal::to_f64)
            .collect();
        let mut steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).is_some_and(|step| (0.0..1.0).contains(step))
    }

    /// Times of two parts are hours and minutes, or minutes and seconds; with a date, of a day.
    fn ask_for_minutes(&mut self, map: &Map) {
        let has_date = self.columns.iter().any(|column| column.quantity == Quantity::Date);
        let clock = self.columns.iter().find(|column| column.is_clock && column.quantity == Quantity::Time);
        let Some(column) = clock.filter(|_| map.is_in_minutes.is_none() && !has_date) else { return };
        let cells = || self.rows.iter().map(|row| self.recording.sheet.cell(*row, column.index));
        let Some(cell) = cells().next().filter(|_| cells().all(clock::is_two_parts)) else { return };
        let readings = vec![
            ("hours and minutes".to_owned(), "clock=hh:mm".to_owned()),
            ("minutes and seconds".to_owned(), "clock=mm:ss".to_owned()),
        ];
        let problem = format!("column '{}': '{cell}' has two parts", column.name);
        self.questions.push(Question::new(codes::AMBIGUOUS_NUMBER, problem, readings));
    }

    /// The order of day and month matters only if the date changes within the file.
    fn ask_for_date_order(&mut self, map: &Map) {
        if map.date_order.is_some() {
            return;
        }
        let sheet = &self.recording.sheet;
        for column in self.columns.iter().filter(|c| c.is_clock || c.quantity == Quantity::Date) {
            let cells = || self.rows.iter().map(|row| sheet.cell(*row, column.index));
            let day = |cell: &str| clock::parse(cell, DateOrder::DayFirst).and_then(|moment| moment.day);
            let first = cells().find_map(day);
            if !cells().any(|cell| day(cell) != first) || !cells().all(clock::depends_on_order) {
                continue;
            }
            let cell = cells().next().unwrap_or_default().to_owned();
            let readings = vec![
                ("the day is first".to_owned(), "date=dmy".to_owned()),
                ("the month is first".to_owned(), "date=mdy".to_owned()),
            ];
            self.questions.push(Question::new(
                codes::AMBIGUOUS_NUMBER,
                format!("column '{}': the order of day and month in '{cell}'", column.name),
                readings,
            ));
            return;
        }
    }
}

fn sign_answers(comma: &str, point: &str) -> [(String, String); 2] {
    [(comma.to_owned(), "decimal=comma".to_owned()), (point.to_owned(), "decimal=point".to_owned())]
}

/// Returns the question about a number with one separator before three digits.
fn separator_question(first: Option<&(usize, String)>, separator: &str) -> Question {
    let (line, cell) = first.map_or((0, ""), |(line, cell)| (*line, cell.as_str()));
    let value = |sign| {
        let value = number::parse(cell, sign).map_or_else(String::new, |(value, _)| value.to_string());
        format!("it is {value}")
    };
    let problem = format!("'{cell}' in line {line} has a decimal {separator} or a thousands separator");
    Question::new(
        codes::AMBIGUOUS_NUMBER,
        problem,
        sign_answers(&value(DecimalSign::Comma), &value(DecimalSign::Point)),
    )
}

/// What a row is.
#[derive(Clone, Debug, PartialEq, Eq)]
enum RowVerdict {
    Use,
    Skip(&'static str),
    Bad { column: String, cell: String, problem: &'static str },
}

fn no_header(name: &str, recording: &Recording, map: &Map) -> Diagnostic {
    let sheet = &recording.sheet;
    let location = Location::file(name);
    if let Some(line) = map.header_line {
        return Diagnostic::new(
            codes::NO_TABLE_FOUND,
            format!("no names followed by numbers in line {line}"),
        )
        .with_location(location)
        .with_help("give the line of the column names");
    }
    let has_data = (0..sheet.len()).take(1_000).any(|row| header::is_data(sheet, row));
    if has_data {
        let width =
            (0..sheet.len()).find(|row| header::is_data(sheet, *row)).map_or(0, |row| sheet.width(row));
        return Diagnostic::new(codes::NO_TABLE_FOUND, format!("the {width} columns have no names"))
            .with_location(location)
            .with_help("name them in their order, as in --set names=time_s,force_N");
    }
    Diagnostic::new(codes::NO_TABLE_FOUND, "no line with numbers")
        .with_location(location)
        .with_help("give a file with a line of names and lines of numbers")
}

/// Returns an error if rows have more cells than names: the names may then belong to other cells.
fn too_few_names(name: &str, recording: &Recording, header: &Header) -> Option<Diagnostic> {
    let sheet = &recording.sheet;
    let count = header.names.len();
    let row = (header.first_data..sheet.len().min(header.first_data + 200)).find(|row| {
        (count..sheet.width(*row)).any(|column| !sheet.cell(*row, column).is_empty())
            && header::is_data(sheet, *row)
    })?;
    let width = (0..sheet.width(row)).rev().find(|column| !sheet.cell(row, *column).is_empty())? + 1;
    let is_comma = recording.delimiter == Some(crate::dialect::Delimiter::Sign(b','));
    let help = if is_comma && width == 2 * count {
        "export with semicolons as delimiter, or with decimal points: a decimal comma looks like a delimiter here"
    } else {
        "name every cell, as in --set names=index,time_s,force_N"
    };
    let problem = format!("{width} cells, but {count} columns have names");
    Some(
        Diagnostic::new(codes::NO_TABLE_FOUND, problem)
            .with_location(Location::line(name, sheet.line(row)))
            .with_help(help),
    )
}
