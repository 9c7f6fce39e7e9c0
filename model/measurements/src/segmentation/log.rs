//! Raw logs: samples of time and force, and what else the logger recorded.

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::{Direction, published};

use super::clock::{LogTime, log_time, parse_stamp};
use super::finding::Finding;
use crate::median::median;

/// Samples of one log, in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Seconds since the log began, strictly ascending.
    pub time_s: Vec<f64>,
    /// Force in newtons.
    pub force_n: Vec<f64>,
    /// Actuator position in millimetres.
    pub position_mm: Option<Vec<f64>>,
    /// Actuator power in watts.
    pub power_w: Option<Vec<f64>>,
    /// Load in newtons, measured at the load's end of the tendon.
    pub load_n: Option<Vec<f64>>,
    /// Direction of the motion, as the log declares it.
    pub direction: Option<Vec<Option<Direction>>>,
    /// Parts of the log with different declared loads; empty for one load.
    pub parts: Vec<Part>,
    /// Indices at which another file begins.
    pub breaks: Vec<usize>,
    /// Number of lines without a time and a force, or with a time that steps back; they are
    /// skipped.
    pub unusable: usize,
    /// First stamp in seconds of the logger's clock.
    pub start_s: f64,
    /// Properties of the clock.
    pub clock: Vec<Finding>,
    /// Median sampling period in seconds.
    period_s: f64,
}

/// A part of a log with one declared load.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Sample indices, with the end excluded.
    pub samples: std::ops::Range<usize>,
    /// Declared load.
    pub load: DeclaredLoad,
}

/// A load that a log declares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeclaredLoad {
    /// Mass of the weight in grams, without the hook.
    MassG(f64),
    /// Load in newtons.
    N(f64),
}

/// Names of the columns of time with the length of a count in seconds.
const TIME_COLUMNS: [(&str, f64); 8] = [
    ("time_s", 1.0),
    ("time_ms", 1e-3),
    ("time_us", 1e-6),
    ("time_min", 60.0),
    ("time_h", 3_600.0),
    ("unix_s", 1.0),
    ("timestamp", 1.0),
    ("time", 1.0),
];
/// Names of the other columns.
const COLUMNS: [&str; 10] = [
    "force_N",
    "position_mm",
    "power_W",
    "load_measured_N",
    "direction",
    "load_N",
    "load_mass_g",
    "mark",
    "force_in_N",
    "force_out_N",
];
const FORCE: usize = 0;
const DIRECTION: usize = 4;
const MARK: usize = 7;
const FORCE_IN: usize = 8;
const FORCE_OUT: usize = 9;
/// Fewest usable samples of a log: three seconds at 10 Hz.
const MIN_SAMPLES: usize = 30;
/// Largest magnitude of a value: larger ones are not readings.
const MAX_VALUE: f64 = 1e9;
/// Fewest samples of a part with one declared load.
const MIN_PART: usize = 10;

/// Cells of a log by column; a cell that is not a number is NaN.
struct Cells {
    stamps: Vec<f64>,
    numbers: [Vec<f64>; COLUMNS.len()],
    directions: Vec<Option<Direction>>,
    marks: Vec<Option<DeclaredLoad>>,
}

impl Log {
    /// Creates a log from columns of equal length. `file` is its name in errors.
    ///
    /// # Errors
    /// If a column has another length than `time_s`, or there are fewer than 30 usable samples.
    pub fn new(
        time_s: Vec<f64>,
        force_n: Vec<f64>,
        position_mm: Option<Vec<f64>>,
        power_w: Option<Vec<f64>>,
        file: &str,
    ) -> Result<Self, Diagnostic> {
        let count = time_s.len();
        let mut cells =
            Cells { stamps: time_s, numbers: Default::default(), directions: Vec::new(), marks: Vec::new() };
        let columns = [Some(force_n), position_mm, power_w];
        for ((slot, column), name) in cells.numbers.iter_mut().zip(columns).zip(COLUMNS) {
            let Some(column) = column else { continue };
            if column.len() != count {
                let problem = format!("column '{name}' has {} values, 'time_s' has {count}", column.len());
                return Err(Diagnostic::new(codes::MALFORMED_TABLE, problem)
                    .with_location(Location::file(file))
                    .with_help("give columns of equal length"));
            }
            *slot = column;
        }
        Self::from_cells(&cells, ("time_s", 1.0), None, file)
    }

    /// Parses a log. `file` is its name in errors. Unusable lines are counted and skipped, since
    /// real logs have them.
    ///
    /// # Errors
    /// If the text is UTF-16, the column of time or force is missing, or there are fewer than 30
    /// usable samples.
    pub fn parse(text: &[u8], file: &str) -> Result<Self, Diagnostic> {
        Self::parse_at(text, file, None)
    }

    /// Parses a log whose declared sampling rate in hertz decides the unit of its time.
    ///
    /// # Errors
    /// As [`Log::parse`].
    pub fn parse_at(text: &[u8], file: &str, rate_hz: Option<f64>) -> Result<Self, Diagnostic> {
        // UTF-16 has a byte order mark, or a zero byte in every Latin letter.
        let has_mark = text.starts_with(b"\xff\xfe") || text.starts_with(b"\xfe\xff");
        if has_mark || matches!(text, [0, 1..=127, 0, 1..=127, ..] | [1..=127, 0, 1..=127, 0, ..]) {
            return Err(Diagnostic::new(codes::NOT_UTF_8, "the text is UTF-16")
                .with_location(Location::file(file))
                .with_help("save it as CSV in UTF-8"));
        }
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let mut reader = csv::ReaderBuilder::new().flexible(true).trim(csv::Trim::All).from_reader(text);
        let header = reader.byte_headers().cloned().unwrap_or_default();
        let names: Vec<String> = header.iter().map(|n| String::from_utf8_lossy(n).into_owned()).collect();
        let position = |name: &str| names.iter().position(|n| n == name);
        let missing = |column: &str, help: &str| {
            let line = String::from_utf8_lossy(text.split(|b| *b == b'\n').next().unwrap_or_default());
            Diagnostic::new(codes::MISSING_COLUMN, format!("column '{column}' is missing"))
                .with_location(Location::in_csv(file, &line, 0, None))
                .with_help(help)
        };
        let time = TIME_COLUMNS.iter().find_map(|(name, unit_s)| Some((position(name)?, *unit_s)));
        let (time, mut unit_s) =
            time.ok_or_else(|| missing("time_s", "name the columns time_s and force_N"))?;
        let columns = COLUMNS.map(position);
        if columns[FORCE].or(columns[FORCE_IN]).is_none() {
            return Err(missing("force_N", "name the columns time_s and force_N"));
        }
        let mut cells = Cells {
            stamps: Vec::new(),
            numbers: Default::default(),
            directions: Vec::new(),
            marks: Vec::new(),
        };
        let mut record = csv::ByteRecord::new();
        // A line that the reader refuses is skipped as unusable by its empty cells.
        while reader.read_byte_record(&mut record).unwrap_or(false) {
            let cell = |at: usize| record.get(at).and_then(|c| std::str::from_utf8(c).ok()).map(str::trim);
            let stamp = cell(time).and_then(parse_stamp);
            if stamp.is_some_and(|(_, is_date)| is_date) {
                unit_s = 1.0;
            }
            cells.stamps.push(stamp.map_or(f64::NAN, |(number, _)| number));
            for (at, (slot, column)) in cells.numbers.iter_mut().zip(columns).enumerate() {
                let Some(column) = column.filter(|_| at != DIRECTION && at != MARK) else { continue };
                let number = cell(column).and_then(|c| c.parse().ok()).unwrap_or(f64::NAN);
                slot.push(if number.abs() < MAX_VALUE { number } else { f64::NAN });
            }
            if let Some(column) = columns[DIRECTION] {
                cells.directions.push(cell(column).and_then(direction_from_word));
            }
            if let Some(column) = columns[MARK] {
                cells.marks.push(cell(column).and_then(load_from_mark));
            }
        }
        Self::from_cells(&cells, (&names[time], unit_s), rate_hz, file)
    }

    /// Selects the usable samples and computes their times.
    fn from_cells(
        cells: &Cells,
        (time_column, unit_s): (&str, f64),
        rate_hz: Option<f64>,
        file: &str,
    ) -> Result<Self, Diagnostic> {
        let is_present = |column: usize| cells.numbers[column].iter().any(|v| v.is_finite());
        let (force, load) = if is_present(FORCE) { (FORCE, 3) } else { (FORCE_IN, FORCE_OUT) };
        let forces = &cells.numbers[force];
        let usable = |i: usize| forces.get(i).is_some_and(|f| f.is_finite());
        // A stamp without a force is not a sample.
        let stamps: Vec<f64> =
            cells.stamps.iter().enumerate().map(|(i, t)| if usable(i) { *t } else { f64::NAN }).collect();
        let time = log_time(&stamps, unit_s, rate_hz);
        let count = time.time_s.len();
        let descending = stamps.windows(2).filter(|w| w[1] < w[0]).count();
        if 2 * descending > stamps.len() {
            return Err(Diagnostic::new(
                codes::IMPOSSIBLE_CLOCK,
                format!("column '{time_column}': the time decreases from line to line"),
            )
            .with_location(Location::file(file))
            .with_help("sort the lines by time"));
        }
        if count < MIN_SAMPLES {
            return Err(Diagnostic::new(
                codes::TOO_FEW_SAMPLES,
                format!("{count} usable samples, at least {MIN_SAMPLES} are needed"),
            )
            .with_location(Location::file(file))
            .with_help("give a log with a number for time and force in every line"));
        }
        if let Some(period_s) = time.impossible_period_s {
            return Err(Diagnostic::new(
                codes::IMPOSSIBLE_CLOCK,
                format!(
                    "column '{time_column}': the stamps are {period_s:.1e} s apart, at a rate of {:.3e} Hz",
                    1.0 / period_s
                ),
            )
            .with_location(Location::file(file))
            .with_help(
                "give the time in seconds, or name the column by its unit (time_ms, time_us) and declare \
                 rig.sample_rate_hz: logs have 10 Hz to 10 kHz",
            ));
        }
        if let Some(period_s) = either_unit(&time, rate_hz) {
            return Err(Diagnostic::new(codes::IMPOSSIBLE_CLOCK, format!(
                "column '{time_column}': the stamps are {period_s} s apart, or in another unit than its name"
            ))
            .with_location(Location::file(file))
            .with_help(
                "declare rig.sample_rate_hz, or name the column by its unit (time_s, time_ms, time_us)",
            ));
        }
        let column = |at: usize| {
            is_present(at)
                .then(|| with_held_values(time.samples.iter().map(|i| cells.numbers[at][*i]).collect()))
        };
        let load_column = if force == FORCE && !is_present(load) { FORCE_OUT } else { load };
        let mut log = Self {
            force_n: time.samples.iter().map(|i| forces[*i]).collect(),
            position_mm: column(1),
            power_w: column(2),
            load_n: column(load_column),
            direction: (cells.directions.iter().any(Option::is_some))
                .then(|| time.samples.iter().map(|i| cells.directions[*i]).collect()),
            parts: Vec::new(),
            breaks: Vec::new(),
            unusable: time.unusable,
            start_s: time.start_s,
            clock: time.findings,
            period_s: median_step(&time.time_s),
            time_s: time.time_s,
        };
        let number = |column: usize, i: usize| Some(cells.numbers[column][i]).filter(|v| v.is_finite());
        let load = |i: usize| match (is_present(5), is_present(6)) {
            (true, _) => number(5, i).map(DeclaredLoad::N),
            (_, true) => number(6, i).map(DeclaredLoad::MassG),
            _ => cells.marks.get(i).copied().flatten(),
        };
        let loads: Vec<Option<DeclaredLoad>> = time.samples.iter().map(|i| load(*i)).collect();
        log.parts = parts(&loads);
        Ok(log)
    }

    /// Returns a part of the log, with unchanged times.
    pub fn part(&self, samples: std::ops::Range<usize>) -> Self {
        let column = |values: &Option<Vec<f64>>| values.as_ref().map(|v| v[samples.clone()].to_vec());
        Self {
            time_s: self.time_s[samples.clone()].to_vec(),
            force_n: self.force_n[samples.clone()].to_vec(),
            position_mm: column(&self.position_mm),
            power_w: column(&self.power_w),
            load_n: column(&self.load_n),
            direction: self.direction.as_ref().map(|v| v[samples.clone()].to_vec()),
            parts: Vec::new(),
            breaks: (self.breaks.iter())
                .filter(|b| **b > samples.start && **b < samples.end)
                .map(|b| b - samples.start)
                .collect(),
            unusable: 0,
            start_s: self.start_s,
            clock: Vec::new(),
            period_s: self.period_s,
        }
    }

    /// Appends a log that starts `start_s` seconds after this one. A column that one of them lacks
    /// is dropped.
    pub fn append(&mut self, other: &Self, start_s: f64) {
        fn join<T: Clone>(a: &mut Option<Vec<T>>, b: Option<&Vec<T>>) {
            match (a.as_mut(), b) {
                (Some(a), Some(b)) => a.extend_from_slice(b),
                _ => *a = None,
            }
        }
        self.breaks.push(self.time_s.len());
        self.time_s.extend(other.time_s.iter().map(|t| t + start_s));
        self.force_n.extend_from_slice(&other.force_n);
        join(&mut self.position_mm, other.position_mm.as_ref());
        join(&mut self.power_w, other.power_w.as_ref());
        join(&mut self.load_n, other.load_n.as_ref());
        join(&mut self.direction, other.direction.as_ref());
        self.parts.clear();
        self.unusable += other.unusable;
        self.clock.extend(other.clock.iter().cloned());
    }

    /// Returns the median sampling period in seconds.
    pub fn period_s(&self) -> f64 {
        self.period_s
    }
}

/// Sampling periods in seconds that some loggers have, but no log whose moves are visible: a unit by
/// which the rate is higher may be as right.
const SLOW_PERIODS_S: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// Returns the sampling period in seconds by the name of the column, if another unit was chosen
/// although a slow logger has it.
fn either_unit(time: &LogTime, rate_hz: Option<f64>) -> Option<f64> {
    let period_s = time.findings.iter().find_map(|finding| match finding {
        Finding::TimeUnit { declared_s, measured_s } => {
            Some(median_step(&time.time_s) * declared_s / measured_s)
        }
        _ => None,
    })?;
    (rate_hz.is_none() && SLOW_PERIODS_S.contains(&period_s)).then_some((1e6 * period_s).round() / 1e6)
}

/// Returns the median step of times.
fn median_step(time_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
    median(&mut steps)
}

/// Replaces values that are not numbers with the previous number, or the first one.
fn with_held_values(mut values: Vec<f64>) -> Vec<f64> {
    let mut held = values.iter().copied().find(|v| v.is_finite()).unwrap_or(0.0);
    for value in &mut values {
        if value.is_finite() {
            held = *value;
        }
        *value = held;
    }
    values
}

/// Returns the direction of a word, or `None` for an unknown one.
fn direction_from_word(word: &str) -> Option<Direction> {
    match word.to_ascii_lowercase().as_str() {
        "eccentric" | "ecc" | "release" | "lower" | "down" => Some(Direction::Eccentric),
        "concentric" | "con" | "pull" | "lift" | "up" => Some(Direction::Concentric),
        _ => None,
    }
}

/// Returns the load of a mark such as `1003.2 g`, `load = 1 kg` or `9.8N`.
fn load_from_mark(mark: &str) -> Option<DeclaredLoad> {
    let from = mark.find(|c: char| c.is_ascii_digit())?;
    let text = &mark[from..];
    let to = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
    let number: f64 = text[..to].parse().ok()?;
    match text[to..].trim() {
        "g" => Some(DeclaredLoad::MassG(number)),
        "kg" => Some(DeclaredLoad::MassG(1e3 * number)),
        "N" => Some(DeclaredLoad::N(number)),
        _ => None,
    }
}

/// Splits a log where its declared load changes. A sample without a load has that of the previous
/// one.
fn parts(loads: &[Option<DeclaredLoad>]) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    for (i, load) in loads.iter().enumerate() {
        match (parts.last_mut(), load) {
            (Some(part), None) => part.samples.end = i + 1,
            (Some(part), Some(load)) if part.load == *load => part.samples.end = i + 1,
            (_, Some(load)) => parts.push(Part { samples: i..i + 1, load: *load }),
            (None, None) => {}
        }
    }
    parts.retain(|part| part.samples.len() >= MIN_PART);
    parts
}

impl DeclaredLoad {
    /// Returns the mass in grams, without the hook, and the load in newtons, with the hook.
    pub fn with_hook(self, hook_mass_g: f64) -> (f64, f64) {
        let weight_n = |mass_g: f64| mass_g * 1e-3 * published::GRAVITY_M_S2;
        match self {
            Self::MassG(mass_g) => (mass_g, weight_n(mass_g + hook_mass_g)),
            Self::N(load_n) => ((load_n / weight_n(1.0) - hook_mass_g).max(0.0), load_n),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unusable_lines_are_counted_and_skipped() {
        let mut text = "power_W,time_s,force_N,position_mm\n".to_owned();
        for i in 0..120 {
            text.push_str(&format!("0,{},1.5,2\n", f64::from(i) * 0.005));
        }
        text.push_str("0,oops,1,2\n0,0.1,1,2\n0,9\n\n");
        let log = Log::parse(text.as_bytes(), "a.csv").unwrap();
        assert_eq!((log.time_s.len(), log.unusable), (120, 3));
        assert_eq!(log.force_n[0], 1.5);
    }

    #[test]
    fn quoted_cells_are_read() {
        let mut text = "\u{feff}\"time_ms\",\"force_N\"\r\n".to_owned();
        for i in 0..30 {
            text.push_str(&format!("\"{}\",\"1.5\"\r\n", 5 * i));
        }
        let log = Log::parse(text.as_bytes(), "a.csv").unwrap();
        assert_eq!((log.time_s.len(), log.unusable, &log.position_mm), (30, 0, &None));
        assert!((log.time_s[29] - 0.145).abs() < 1e-9);
    }

    #[test]
    fn loads_split_a_log() {
        let mut text = "time_s,force_N,mark\n".to_owned();
        for i in 0..60 {
            let mark = [(0, "load 500 g"), (30, "2.5N")].iter().find(|m| m.0 == i).map_or("", |m| m.1);
            text.push_str(&format!("{},1.5,{mark}\n", f64::from(i) * 0.1));
        }
        let log = Log::parse(text.as_bytes(), "a.csv").unwrap();
        let loads: Vec<_> = log.parts.iter().map(|p| (p.samples.clone(), p.load)).collect();
        assert_eq!(loads, [(0..30, DeclaredLoad::MassG(500.0)), (30..60, DeclaredLoad::N(2.5))]);
    }

    #[test]
    fn columns_make_a_log() {
        let time_s: Vec<f64> = (0..50).map(|i| f64::from(i) * 0.1).collect();
        let log = Log::new(time_s.clone(), vec![2.0; 50], None, None, "a").unwrap();
        assert_eq!((log.time_s, log.force_n.len()), (time_s.clone(), 50));
        let error = Log::new(time_s, vec![2.0; 50], None, Some(vec![0.0; 3]), "a").unwrap_err();
        assert_eq!(error.problem(), "column 'power_W' has 3 values, 'time_s' has 50");
    }

    #[test]
    fn impossible_rates_are_refused() {
        let text = |step: f64| {
            (0..60)
                .fold("timestamp,force_N\n".to_owned(), |t, i| t + &format!("{},1.5\n", step * f64::from(i)))
        };
        let error = Log::parse(text(1e-12).as_bytes(), "a.csv").unwrap_err();
        assert!(error.problem().starts_with("column 'timestamp': the stamps are 1.0e-12 s apart"), "{error}");
        assert!(Log::parse(text(1.0 / 86_400.0 / 100.0).as_bytes(), "a.csv").is_ok());
    }

    fn stamped(name: &str, stamp: impl Fn(u32) -> f64) -> Vec<u8> {
        let lines: String = (0..60).map(|i| format!("{},1.5\n", stamp(i))).collect();
        format!("{name},force_N\n{lines}").into_bytes()
    }

    /// A logger at 1 Hz, or one at 1 kHz whose milliseconds are called seconds.
    #[test]
    fn slow_stamps_have_two_readings() {
        let seconds = stamped("time_s", f64::from);
        let error = Log::parse(&seconds, "a.csv").unwrap_err().to_string();
        assert!(error.contains("the stamps are 1 s apart"), "{error}");
        let length_s = |rate| Log::parse_at(&seconds, "a.csv", Some(rate)).unwrap().time_s[59];
        assert!((length_s(1.0) - 59.0).abs() < 1e-9 && (length_s(1000.0) - 0.059).abs() < 1e-9);
    }

    #[test]
    fn minutes_and_hours_are_read() {
        for (name, unit_s) in [("time_min", 60.0), ("time_h", 3600.0)] {
            let log = Log::parse(&stamped(name, |i| f64::from(i) * 0.01 / unit_s), "a.csv").unwrap();
            assert!((log.time_s[59] - 0.59).abs() < 1e-9 && log.clock.is_empty(), "{:?}", log.clock);
        }
    }

    #[test]
    fn descending_times_are_refused() {
        let text = stamped("time_s", |i| 9.0 - 0.01 * f64::from(i));
        let error = Log::parse(&text, "a.csv").unwrap_err().to_string();
        assert!(error.contains("the time decreases"), "{error}");
    }

    #[test]
    fn utf16_is_named() {
        let little: Vec<u8> = "time_s,force_N\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = "\u{feff}time_s\n".encode_utf16().flat_map(u16::to_be_bytes).collect();
        let marked = [b"\xff\xfe".to_vec(), little.clone()].concat();
        for text in [little, big, marked] {
            let error = Log::parse(&text, "a.csv").unwrap_err().to_string();
            assert_eq!(error, "a.csv: the text is UTF-16; save it as CSV in UTF-8");
        }
    }

    #[test]
    fn incomplete_logs_are_refused() {
        let error = Log::parse(b"time_s,power_W\n", "a").unwrap_err();
        assert_eq!(error.problem(), "column 'force_N' is missing");
        assert!(
            error
                .render("error")
                .contains("a:1: column 'force_N' is missing [missing-column]\n  1 | time_s,power_W\n")
        );
        let empty = Log::parse(b"time_s,force_N,position_mm,power_W\n", "a").unwrap_err();
        assert_eq!(empty.problem(), "0 usable samples, at least 30 are needed");
    }
}
