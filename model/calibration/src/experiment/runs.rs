//! Planned runs (`next-runs.csv`): the series to record, in order, and the rows that they will
//! give.

use std::collections::HashMap;

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::{Direction, Substrate, published};

use super::rig::{Contact, MAX_SPEED_PCT, MIN_SPEED_PCT, RigLimits, WRAPS};
use crate::table::{Labels, MAX_WRAP_DEG, MIN_WRAP_DEG, PlateauRow, Sweep, Unknown, substrate_word};

/// One series to record.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedRun {
    /// What the tendon touches; `None` for `plain`.
    pub substrate: Option<Substrate>,
    /// Occupied grooves, ascending.
    pub pins: Vec<usize>,
    /// Order of the loads.
    pub sweep: Sweep,
    /// Mass of the weight in grams.
    pub load_mass_g: f64,
    /// Speed in percent.
    pub speed_pct: f64,
    /// Pause before a reading in seconds.
    pub dwell_s: f64,
    /// Number of eccentric and of concentric repetitions.
    pub repetitions: [u32; 2],
    /// Number of the mount, from 1.
    pub mount: usize,
    /// Duration in minutes, including the changes before it.
    pub minutes: f64,
    /// Question that it is recorded for.
    pub asks: String,
    /// Wrap angle in degrees, where it differs from that of the rig or the paper.
    pub wrap_angle_deg: Option<f64>,
}

impl PlannedRun {
    /// Returns a run with one repetition at the middle speed and the paper's dwell.
    pub(super) fn usual(contact: &Contact, load_mass_g: f64, rig: &RigLimits) -> Self {
        Self {
            substrate: contact.substrate,
            pins: contact.pins.clone(),
            sweep: Sweep::Up,
            load_mass_g,
            speed_pct: rig.speeds_pct[0].midpoint(rig.speeds_pct[1]),
            dwell_s: published::DWELL_S.clamp(rig.dwells_s[0], rig.dwells_s[1]),
            repetitions: [0, 1],
            mount: 1,
            minutes: 0.0,
            asks: String::new(),
            wrap_angle_deg: contact.wrap_angle_deg,
        }
    }

    /// Returns the duration of the repetitions in minutes.
    pub(super) fn recording_minutes(&self, rig: &RigLimits) -> f64 {
        f64::from(self.repetitions[0] + self.repetitions[1]) * (rig.seconds_per_repetition + self.dwell_s)
            / 60.0
    }

    /// Returns its contact.
    pub(super) fn contact(&self) -> Contact {
        Contact { substrate: self.substrate, pins: self.pins.clone(), wrap_angle_deg: self.wrap_angle_deg }
    }

    /// Returns whether another run has the same contact.
    pub(super) fn is_mounted_as(&self, other: &Self) -> bool {
        self.contact() == other.contact()
    }
}

/// The columns of `next-runs.csv`.
const COLUMNS: [&str; 12] = [
    "series",
    "substrate",
    "pins",
    "sweep",
    "load_mass_g",
    "speed_pct",
    "dwell_s",
    "repetitions_eccentric",
    "repetitions_concentric",
    "mount",
    "minutes",
    "asks",
];

/// Additional column where a run has another wrap than the paper's.
const WRAP: &str = "wrap_angle_deg";

/// Advice for every invalid file.
const HELP: &str = "use the file as `experiment` wrote it";
/// Most series of a plan, and most repetitions of a series; more indicate a typing error.
const MOST_RUNS: usize = 10_000;
const MOST_REPETITIONS: u32 = 1000;

/// Writes runs as CSV.
pub fn write_runs(runs: &[PlannedRun]) -> String {
    let is_wrapped = runs.iter().any(|run| run.wrap_angle_deg.is_some());
    let mut text = COLUMNS.join(",") + if is_wrapped { ",wrap_angle_deg\n" } else { "\n" };
    for (i, run) in runs.iter().enumerate() {
        let pins: Vec<String> = run.pins.iter().map(usize::to_string).collect();
        let cells = [
            (i + 1).to_string(),
            substrate_word(run.substrate).to_owned(),
            pins.join(";"),
            run.sweep.as_str().to_owned(),
            run.load_mass_g.to_string(),
            run.speed_pct.to_string(),
            run.dwell_s.to_string(),
            run.repetitions[0].to_string(),
            run.repetitions[1].to_string(),
            run.mount.to_string(),
            format!("{:.2}", run.minutes),
            run.asks.clone(),
        ];
        text += &cells.join(",");
        if is_wrapped {
            let degrees = run.wrap_angle_deg.unwrap_or(published::WRAP_ANGLE_DEG);
            text += &format!(",{degrees}");
        }
        text.push('\n');
    }
    text
}

/// Parses runs. `file` is the name of the file in errors.
///
/// # Errors
/// A [`Diagnostic`] of the first invalid cell.
pub fn read_runs(text: &str, file: &str) -> Result<Vec<PlannedRun>, Diagnostic> {
    let malformed = |problem: String| {
        Diagnostic::new(codes::PLAN_NOT_USABLE, problem).with_location(Location::file(file)).with_help(HELP)
    };
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| malformed(e.to_string()))?.clone();
    let mut at = [0; COLUMNS.len()];
    for (place, column) in at.iter_mut().zip(COLUMNS) {
        *place = header
            .iter()
            .position(|name| name.trim_start_matches('\u{feff}') == column)
            .ok_or_else(|| malformed(format!("column '{column}' is missing")))?;
    }
    let wrap = header.iter().position(|name| name == WRAP);
    let (mut runs, mut series) = (Vec::new(), HashMap::new());
    for record in reader.records() {
        let record = record.map_err(|e| malformed(e.to_string()))?;
        let byte = record.position().map_or(0, csv::Position::byte);
        let byte = usize::try_from(byte).unwrap_or(usize::MAX);
        let line = Location::in_csv(file, text, byte, None).line.unwrap_or(1);
        let cell = |column: usize| record.get(at[column]).unwrap_or_default();
        let refuse_cell = |column: &str, index: Option<usize>, value: &str, problem: &str| {
            let location = Location::in_csv(file, text, byte, index).with_field(column, value);
            Diagnostic::new(codes::PLAN_NOT_USABLE, problem).with_location(location).with_help(HELP)
        };
        let refuse = |column: usize, problem: &str| {
            refuse_cell(COLUMNS[column], Some(at[column]), cell(column), problem)
        };
        let number = |column: usize, low: f64, high: f64, problem: &str| {
            let value: Option<f64> = cell(column).parse().ok();
            value.filter(|x| (low..=high).contains(x)).ok_or_else(|| refuse(column, problem))
        };
        let count = |column: usize| {
            let value: Option<u32> = cell(column).parse().ok();
            value.filter(|n| *n <= MOST_REPETITIONS).ok_or_else(|| refuse(column, "outside 0 to 1000"))
        };
        let wrap_angle_deg = match wrap.and_then(|at| record.get(at)).unwrap_or_default() {
            "" => None,
            degrees_text => {
                let degrees: Option<f64> = degrees_text.parse().ok();
                let wraps = MIN_WRAP_DEG..=MAX_WRAP_DEG;
                let degrees = degrees.filter(|x| wraps.contains(x));
                Some(degrees.ok_or_else(|| refuse_cell(WRAP, wrap, degrees_text, WRAPS))?)
            }
        };
        let pins: Option<Vec<usize>> =
            cell(2).split(';').filter(|p| !p.is_empty()).map(|p| p.trim().parse().ok()).collect();
        let is_layout = |p: &Vec<usize>| {
            p.is_sorted_by(|a, b| a < b) && p.iter().all(|g| (1..=published::GROOVES).contains(g))
        };
        let run = PlannedRun {
            substrate: match cell(1) {
                "silicone" => Some(Substrate::Silicone),
                "abs" => Some(Substrate::Abs),
                "plain" => None,
                _ => return Err(refuse(1, "expected silicone, abs or plain")),
            },
            pins: pins
                .filter(is_layout)
                .ok_or_else(|| refuse(2, "expected ascending grooves 1..15, separated by semicolons"))?,
            sweep: match cell(3) {
                "up" => Sweep::Up,
                "down" => Sweep::Down,
                _ => return Err(refuse(3, "expected up or down")),
            },
            load_mass_g: number(4, 0.0, 1e6, "outside 0 to 1000000 g")?,
            speed_pct: number(5, MIN_SPEED_PCT, MAX_SPEED_PCT, "outside 0.1 to 100 % of full speed")?,
            dwell_s: number(6, 0.01, 3600.0, "outside 0.01 to 3600 s")?,
            repetitions: [count(7)?, count(8)?],
            mount: cell(9)
                .parse()
                .ok()
                .filter(|n| *n <= MOST_RUNS)
                .ok_or_else(|| refuse(9, "outside 1 to 10000"))?,
            minutes: number(10, 0.0, 1e6, "outside 0 to 1000000")?,
            asks: cell(11).to_owned(),
            wrap_angle_deg,
        };
        if run.substrate == Some(Substrate::Abs) && run.pins.is_empty() {
            return Err(refuse(2, "abs needs at least one groove"));
        }
        if run.repetitions == [0, 0] {
            return Err(refuse(7, "zero repetitions in both directions"));
        }
        if let Some(before) = series.insert(cell(0).to_owned(), line) {
            return Err(refuse(0, &format!("the series is also in line {before}"))
                .with_help("give each run its own number"));
        }
        runs.push(run);
        if runs.len() > MOST_RUNS {
            return Err(malformed(format!("more than {MOST_RUNS} runs")));
        }
    }
    if runs.is_empty() {
        let problem = "the plan contains no runs, since `experiment` found none that answers a question";
        return Err(Diagnostic::new(codes::PLAN_NOT_USABLE, problem).with_location(Location::file(file)));
    }
    Ok(runs)
}

/// Returns the rows that the runs give in their order, with zero forces, in a session of this name.
pub fn rows_of(runs: &[PlannedRun], rig: &RigLimits, session: &str) -> Vec<PlateauRow> {
    let (mut rows, mut time_s) = (Vec::new(), 0.0);
    for (i, run) in runs.iter().enumerate() {
        time_s += 60.0 * (run.minutes - run.recording_minutes(rig)).max(0.0);
        append(run, &(i + 1).to_string(), session, rig, &mut time_s, &mut rows);
    }
    rows
}

/// Appends the rows of one run that starts at `time_s`: all eccentric, then all concentric.
pub(super) fn append(
    run: &PlannedRun,
    series: &str,
    session: &str,
    rig: &RigLimits,
    time_s: &mut f64,
    rows: &mut Vec<PlateauRow>,
) {
    for (direction, count) in
        [(Direction::Eccentric, run.repetitions[0]), (Direction::Concentric, run.repetitions[1])]
    {
        for repetition in 1..=count {
            *time_s += rig.seconds_per_repetition + run.dwell_s;
            let share = (f64::from(repetition) - 0.5) / f64::from(count);
            let position = if direction == Direction::Eccentric { share } else { 1.0 - share };
            rows.push(PlateauRow {
                series: series.to_owned(),
                substrate: run.substrate,
                pins: run.pins.clone(),
                sweep: run.sweep,
                load_mass_g: run.load_mass_g,
                load_n: rig.load_n(run.substrate, run.load_mass_g),
                speed_pct: run.speed_pct,
                dwell_s: run.dwell_s,
                direction,
                repetition,
                position_mm: rig.stroke_mm * position,
                time_s: *time_s,
                force_n: 0.0,
                wrap_angle_deg: run
                    .wrap_angle_deg
                    .or(rig.wrap_angle_deg)
                    .unwrap_or(published::WRAP_ANGLE_DEG),
                labels: Labels {
                    session: session.to_owned(),
                    mount: run.mount.to_string(),
                    ..Labels::default()
                },
                unknown: Unknown::default(),
            });
        }
    }
}

/// Summarizes runs by contact, in their order: `silicone 5;8;11: 24 runs, 503.6 to 4007.8 g, 40 to
/// 70 %, 1 to 10 s`.
pub fn by_contact(runs: &[PlannedRun]) -> Vec<String> {
    let mut contacts: Vec<String> = Vec::new();
    for words in runs.iter().map(contact_words) {
        if !contacts.contains(&words) {
            contacts.push(words);
        }
    }
    let summary = |contact: String| {
        let of: Vec<&PlannedRun> = runs.iter().filter(|run| contact_words(run) == contact).collect();
        let span = |value: fn(&PlannedRun) -> f64, unit: &str| {
            let low = of.iter().map(|run| value(run)).fold(f64::INFINITY, f64::min);
            let high = of.iter().map(|run| value(run)).fold(f64::NEG_INFINITY, f64::max);
            if low < high { format!("{low} to {high} {unit}") } else { format!("{low} {unit}") }
        };
        let down = of.iter().filter(|run| run.sweep == Sweep::Down).count();
        let down = if down > 0 { format!(" ({down} with loads descending)") } else { String::new() };
        format!(
            "{contact}: {} {}{down}, {}, {}, {}",
            of.len(),
            if of.len() == 1 { "run" } else { "runs" },
            span(|run| run.load_mass_g, "g"),
            span(|run| run.speed_pct, "%"),
            span(|run| run.dwell_s, "s")
        )
    };
    contacts.into_iter().map(summary).collect()
}

/// Returns the contact of a run in words: `silicone`, `abs 5;8;11`, `silicone 5;8;11, wrap 120
/// deg`.
pub fn contact_words(run: &PlannedRun) -> String {
    let pins: Vec<String> = run.pins.iter().map(usize::to_string).collect();
    let contact = format!("{} {}", substrate_word(run.substrate), pins.join(";"));
    let wrap = run.wrap_angle_deg.map_or_else(String::new, |degrees| format!(", wrap {degrees} deg"));
    format!("{}{wrap}", contact.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(load_mass_g: f64) -> PlannedRun {
        PlannedRun {
            substrate: Some(Substrate::Silicone),
            pins: vec![5, 8, 11],
            sweep: Sweep::Down,
            load_mass_g,
            speed_pct: 40.0,
            dwell_s: 3.0,
            repetitions: [4, 5],
            mount: 2,
            minutes: 3.7,
            asks: "rate_dependence or fixture_compliance".to_owned(),
            wrap_angle_deg: None,
        }
    }

    #[test]
    fn written_runs_read_back() {
        let runs = vec![run(251.2), run(5002.5)];
        let text = write_runs(&runs);
        assert_eq!(read_runs(&text, "next-runs.csv").unwrap(), runs);
        let rows = rows_of(&runs, &RigLimits::default(), "next");
        assert_eq!(rows.len(), 18);
        assert!(rows.is_sorted_by(|a, b| a.time_s < b.time_s));
        assert_eq!((rows[9].series.as_str(), rows[9].labels.mount.as_str()), ("2", "2"));
    }

    #[test]
    fn runs_are_summarized_by_contact() {
        let up = PlannedRun { sweep: Sweep::Up, dwell_s: 1.0, ..run(5002.5) };
        let bare = PlannedRun { pins: Vec::new(), ..up.clone() };
        assert_eq!(
            by_contact(&[up, run(251.2), bare]),
            [
                "silicone 5;8;11: 2 runs (1 with loads descending), 251.2 to 5002.5 g, 40 %, 1 to 3 s",
                "silicone: 1 run, 5002.5 g, 40 %, 1 s"
            ]
        );
    }

    #[test]
    fn another_wrap_adds_a_column() {
        let wrapped = vec![PlannedRun { wrap_angle_deg: Some(120.0), ..run(251.2) }];
        let text = write_runs(&wrapped);
        assert!(text.lines().next().unwrap().ends_with(",asks,wrap_angle_deg"), "{text}");
        assert_eq!(read_runs(&text, "r.csv").unwrap(), wrapped);
        let rig = RigLimits::default();
        let of = |runs: &[PlannedRun], rig: &RigLimits| rows_of(runs, rig, "")[0].wrap_angle_deg;
        assert_eq!(of(&wrapped, &rig), 120.0);
        assert_eq!(of(&[run(251.2)], &rig), published::WRAP_ANGLE_DEG);
        assert_eq!(of(&[run(251.2)], &rig.wrapped_by(70.0)), 70.0);
        let error = read_runs(&text.replace(",120", ",0"), "r.csv").unwrap_err().to_string();
        assert!(error.starts_with("r.csv:2:84: wrap_angle_deg = 0: outside 1 to 720 degrees"), "{error}");
    }

    #[test]
    fn invalid_cells_are_located() {
        let good = write_runs(&[run(251.2)]);
        for (from, to, words) in [
            ("silicone", "glass", "r.csv:2:3: substrate = glass: expected silicone, abs or plain"),
            ("5;8;11", "5;16", "r.csv:2:12: pins = 5;16: expected ascending grooves 1..15"),
            ("251.2", "nan", "r.csv:2:24: load_mass_g = nan: outside 0 to 1000000 g"),
            (",4,5,", ",0,0,", "r.csv:2:35: repetitions_eccentric = 0: zero repetitions"),
            (",4,5,", ",4,5000,", "r.csv:2:37: repetitions_concentric = 5000: outside 0 to 1000"),
            ("dwell_s", "dwell", "r.csv: column 'dwell_s' is missing"),
            ("down", "sideways", "r.csv:2:19: sweep = sideways: expected up or down"),
            (",40,", ",400,", "r.csv:2:30: speed_pct = 400: outside 0.1 to 100 % of full speed"),
        ] {
            let error = read_runs(&good.replacen(from, to, 1), "r.csv").unwrap_err().to_string();
            assert!(error.starts_with(words), "{error}");
        }
        let twice = write_runs(&[run(251.2), run(503.6)]).replace("\n2,", "\n1,");
        let error = read_runs(&twice, "r.csv").unwrap_err().to_string();
        assert_eq!(
            error,
            "r.csv:3:1: series = 1: the series is also in line 2; give each run its own number"
        );
        assert!(read_runs(&good[..good.find('\n').unwrap() + 1], "r.csv").is_err());
    }
}
