//! Segmentation of a whole run into the rows of a plateau table and the defects of each log.

use std::error::Error;
use std::fmt;

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::Direction;
use schemars::JsonSchema;
use serde::Serialize;

use super::clock::SessionClock;
use super::finding::Finding;
use super::log::{DeclaredLoad, Log};
use super::moves::Source;
use super::plateaus::segment;
use super::run_plan::{RunPlan, SeriesPlan};
use super::segmented::{Motion, Segmented};
use crate::median::median;
use crate::table::{Labels, Optional, PlateauRow, Sweep, Unknown};

/// Name and version of the report's format.
const SCHEMA: &str = "pinswitch.segmentation/1";

/// Number of plateaus and defects of one log.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SegmentedSeries {
    /// Name of the log in the description of the run.
    pub file: String,
    /// Number of plateaus after a release of the load.
    pub eccentric: usize,
    /// Number of plateaus after a pull of the load.
    pub concentric: usize,
    /// Kind of the motion.
    pub motion: Motion,
    /// Column that shows the moves.
    pub source: Source,
    /// Defects of the log.
    pub findings: Vec<Finding>,
}

impl fmt::Display for SegmentedSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} eccentric, {} concentric", self.file, self.eccentric, self.concentric)?;
        write!(f, "; {} by {}", self.motion.as_str(), self.source.as_str())?;
        self.findings.iter().try_for_each(|finding| write!(f, "; {finding}"))
    }
}

/// Plateaus and defects of each log of a run, in the order of the run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SegmentationReport {
    /// Name and version of the format.
    pub schema: &'static str,
    /// Entry of each log.
    pub series: Vec<SegmentedSeries>,
}

/// A run with all logs segmented.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentedRun {
    /// Rows of the plateau table, in the order of the logs.
    pub rows: Vec<PlateauRow>,
    /// Plateaus and defects of each log.
    pub report: SegmentationReport,
}

/// Segmentation of a run, log by log, so that no log has to stay in memory.
#[derive(Clone, Debug)]
pub struct RunSegmentation<'a> {
    plan: &'a RunPlan,
    rows: Vec<PlateauRow>,
    series: Vec<SegmentedSeries>,
    clock: SessionClock,
    /// Names of the logs added so far.
    files: Vec<String>,
    /// Number of series in the table so far; logs of one move each form one series.
    numbers: usize,
    /// Start of the earliest log in seconds of the session.
    first_s: f64,
    /// The previous entry of the plan, if its log has one move.
    single_move: Option<SeriesPlan>,
}

/// Relative departure of a measured load or speed from the declared one that is a finding.
const DEPARTURE: f64 = 0.05;

impl<'a> RunSegmentation<'a> {
    /// Starts a segmentation.
    pub fn new(plan: &'a RunPlan) -> Self {
        Self {
            plan,
            rows: Vec::new(),
            series: Vec::new(),
            clock: SessionClock::default(),
            files: Vec::new(),
            numbers: 0,
            first_s: 0.0,
            single_move: None,
        }
    }

    /// Adds the logs of the next series, in the order of the plan: the text of each, and its name in
    /// errors. Returns the joined log and its plateaus, for a plot.
    ///
    /// # Errors
    /// As [`Log::parse`] and [`segment`]; if the clock of a log overlaps that of another one; or if
    /// neither the plan nor the log has a load.
    pub fn add(
        &mut self,
        series: &SeriesPlan,
        logs: &[(Vec<u8>, String)],
    ) -> Result<(Log, Segmented), Diagnostic> {
        let mut joined: Option<(Log, f64)> = None;
        for (text, file) in logs {
            let log = Log::parse_at(text, file, self.plan.rig.sample_rate_hz)?;
            let start_s = self.start_s(&log, file)?;
            match &mut joined {
                None => joined = Some((log, start_s)),
                Some((first, first_s)) => {
                    let end_s = *first_s + first.time_s.last().copied().unwrap_or_default();
                    // Two logs of one clock share no stamp.
                    first.append(&log, (start_s - *first_s).max(end_s - *first_s + log.period_s()));
                }
            }
        }
        let file = logs.first().map_or("", |(_, file)| file);
        let Some((log, start_s)) = joined else {
            return Err(Diagnostic::new(codes::MISSING_FIELD, "the series has no log")
                .with_location(Location::file(series.name())));
        };
        let segmented = self.add_parts(series, &log, start_s).map_err(|e| e.or_in_file(file))?;
        let count = |direction| segmented.plateaus.iter().filter(|p| p.direction == direction).count();
        self.series.push(SegmentedSeries {
            file: series.name().to_owned(),
            eccentric: count(Direction::Eccentric),
            concentric: count(Direction::Concentric),
            motion: segmented.motion,
            source: segmented.source,
            findings: segmented.findings.clone(),
        });
        Ok((log, segmented))
    }

    /// Returns the start of a log in seconds of the session.
    fn start_s(&mut self, log: &Log, file: &str) -> Result<f64, Diagnostic> {
        let length_s = log.time_s.last().copied().unwrap_or_default();
        let start_s = self.clock.add(log.start_s, length_s).map_err(|overlap| {
            let other = self.files.get(overlap.with).map_or("", String::as_str);
            Diagnostic::new(codes::OVERLAPPING_CLOCKS, format!("the clock overlaps that of '{other}'"))
                .with_location(Location::file(file))
                .with_help("list each log once, with stamps of one clock")
        })?;
        self.files.push(file.to_owned());
        self.first_s = self.first_s.min(start_s);
        Ok(start_s)
    }

    /// Segments a log, part by part if it has several loads, and adds the rows.
    fn add_parts(&mut self, series: &SeriesPlan, log: &Log, start_s: f64) -> Result<Segmented, Diagnostic> {
        let rig = &self.plan.rig;
        let declared = series.load_mass_g.map(DeclaredLoad::MassG);
        let parts: Vec<(Log, Option<DeclaredLoad>)> = if log.parts.is_empty() {
            vec![(log.clone(), declared)]
        } else {
            log.parts.iter().map(|part| (log.part(part.samples.clone()), Some(part.load))).collect()
        };
        let mut all = Segmented { findings: log.clock.clone(), ..Segmented::default() };
        for (part, load) in &parts {
            if load.is_none() && part.load_n.is_none() {
                return Err(Diagnostic::new(codes::NO_LOAD_IN_LOG, "the load is missing").with_help(
                    "give load_mass_g of the series, or a column load_mass_g, load_N or load_measured_N",
                ));
            }
            let load = load.map(|load| load.with_hook(rig.hook_mass_g));
            let mut segmented = segment(part, rig, load.map(|l| l.1))?;
            let mut measured: Vec<f64> = segmented.plateaus.iter().filter_map(|p| p.load_n).collect();
            let comparisons = [
                ("load_N", load.map(|l| l.1), (!measured.is_empty()).then(|| median(&mut measured))),
                (
                    "speed_pct",
                    series.speed_pct,
                    segmented.speed_mm_s.zip(rig.full_speed_mm_s).map(|(speed, full)| 100.0 * speed / full),
                ),
            ];
            for (field, declared, measured) in comparisons {
                if let (Some(declared), Some(measured)) = (declared, measured)
                    && (measured - declared).abs() > DEPARTURE * declared
                {
                    segmented.findings.push(Finding::Departure { field, declared, measured });
                }
            }
            let sweep = series.sweep.map_or_else(|| self.sweep(load), Some);
            let is_single = parts.len() == 1 && segmented.moves.len() == 1;
            if is_single && self.single_move.as_ref().is_some_and(|last| last.has_same_condition(series)) {
                self.continue_series(&mut segmented);
            } else {
                self.numbers += 1;
            }
            self.single_move = is_single.then(|| series.clone());
            let number = self.numbers - 1;
            self.rows.extend(rows(self.plan, series, number, &segmented, (start_s, load, sweep)));
            all.plateaus.append(&mut segmented.plateaus);
            all.moves.append(&mut segmented.moves);
            all.findings.append(&mut segmented.findings);
            (all.motion, all.source, all.speed_mm_s) =
                (segmented.motion, segmented.source, segmented.speed_mm_s);
        }
        // The lines that are not samples belong to no part.
        if !log.parts.is_empty() && log.unusable > 0 {
            all.findings.push(Finding::UnusableLines { lines: log.unusable });
        }
        Ok(all)
    }

    /// Numbers the repetitions of a log of one move after those of its series.
    fn continue_series(&self, segmented: &mut Segmented) {
        let series = (self.numbers - 1).to_string();
        for plateau in &mut segmented.plateaus {
            let same = self.rows.iter().rev().take_while(|row| row.series == series);
            let last = same.filter(|row| row.direction == plateau.direction).map(|row| row.repetition).max();
            plateau.repetition += last.unwrap_or_default();
        }
    }

    /// Returns the order of the loads from the previous row; `None` for the first series.
    fn sweep(&self, load: Option<(f64, f64)>) -> Option<Sweep> {
        let (last, (_, load_n)) = self.rows.last().zip(load)?;
        Some(if load_n < last.load_n { Sweep::Down } else { Sweep::Up })
    }

    /// Returns the table and the report. `file` is the name of the run's description in errors.
    ///
    /// # Errors
    /// If no log contains a plateau.
    pub fn finish(mut self, file: &str) -> Result<SegmentedRun, Diagnostic> {
        if self.rows.is_empty() {
            return Err(Diagnostic::new(codes::NO_PLATEAU, "no log contains a plateau")
                .with_location(Location::file(file))
                .with_help("give logs with moves and rests, or with full cycles, that the power, the position or the force shows"));
        }
        // The session starts with its earliest log, which need not be the first one of the plan.
        self.rows.iter_mut().for_each(|row| row.time_s -= self.first_s);
        let report = SegmentationReport { schema: SCHEMA, series: self.series };
        Ok(SegmentedRun { rows: self.rows, report })
    }
}

/// Segments a run, given the text of its `run.toml`. `read` returns the text of a log by its name
/// in that file; `file` is the name of the description in errors.
///
/// ```
/// use pinswitch_measurements::segmentation::segment_run;
/// use pinswitch_measurements::table::PlateauTable;
///
/// let run = r#"
/// [rig]
/// wrap_angle_deg = 63.89
/// sample_rate_hz = 200.0
/// hook_mass_g = 62.53
/// stroke_mm = 152.4
/// on_s = 0.5
/// dwell_s = 3.0
///
/// [[series]]
/// file = "a.csv"
/// substrate = "silicone"
/// pins = []
/// load_mass_g = 1003.2
/// speed_pct = 50.0
/// sweep = "up"
/// "#;
/// // A log of one move and the rest after it.
/// let mut log = "time_s,force_N,position_mm,power_W\n".to_owned();
/// for i in 0..900 {
///     let t = f64::from(i) * 0.005;
///     let (power_w, position_mm) = if (1.0..1.5).contains(&t) { (8.0, 20.0 * (t - 1.0)) } else { (0.0, 0.0) };
///     log += &format!("{t},{},{},{power_w}\n", 8.0, if t >= 1.5 { 10.0 } else { position_mm });
/// }
/// let run = segment_run(run, "run.toml", |_file| Ok::<_, std::io::Error>(log.clone().into_bytes()))?;
/// assert_eq!(run.rows.len(), 1);
/// assert!(PlateauTable::write(&run.rows).contains(",eccentric,1,"));
/// # Ok::<(), pinswitch_diagnostic::Diagnostic>(())
/// ```
///
/// # Errors
/// If the description is invalid, a log cannot be read or used, or no log contains a plateau.
pub fn segment_run<E: Error + Send + Sync + 'static>(
    text: &str,
    file: &str,
    mut read: impl FnMut(&str) -> Result<Vec<u8>, E>,
) -> Result<SegmentedRun, Diagnostic> {
    let plan = RunPlan::parse(text, file)?;
    let mut run = RunSegmentation::new(&plan);
    for series in &plan.series {
        let mut logs = Vec::new();
        for file in series.file_names() {
            let text = read(file).map_err(|e| {
                Diagnostic::from_error(codes::CANNOT_READ, e).with_location(Location::file(file))
            })?;
            logs.push((text, file.to_owned()));
        }
        run.add(series, &logs)?;
    }
    run.finish(file)
}

/// Start of a log in seconds of the session, its declared load in grams and newtons, and the order
/// of the loads.
type Context = (f64, Option<(f64, f64)>, Option<Sweep>);

/// Converts the plateaus of one log to rows of the table.
fn rows<'a>(
    plan: &'a RunPlan,
    series: &'a SeriesPlan,
    number: usize,
    segmented: &'a Segmented,
    (start_s, load, sweep): Context,
) -> impl Iterator<Item = PlateauRow> + 'a {
    segmented.plateaus.iter().map(move |p| {
        let mut unknown = Unknown::default();
        for (quantity, is_known) in [
            (Optional::Sweep, sweep.is_some()),
            (Optional::LoadMass, load.is_some()),
            (Optional::Speed, series.speed_pct.is_some()),
            (Optional::Position, p.position_mm.is_some()),
        ] {
            if !is_known {
                unknown = unknown.with(quantity);
            }
        }
        PlateauRow {
            series: number.to_string(),
            substrate: series.substrate,
            pins: series.pins.clone(),
            sweep: sweep.unwrap_or(Sweep::Up),
            load_mass_g: load.map_or(0.0, |l| l.0),
            load_n: p.load_n.or(load.map(|l| l.1)).unwrap_or_default(),
            speed_pct: series.speed_pct.unwrap_or_default(),
            dwell_s: p.dwell_s,
            direction: p.direction,
            repetition: p.repetition,
            position_mm: p.position_mm.unwrap_or_default(),
            time_s: start_s + p.time_s,
            force_n: p.force_n,
            wrap_angle_deg: plan.rig.wrap_angle_deg,
            labels: Labels::default(),
            unknown,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unreadable_and_empty_runs_are_refused() {
        let text = "[rig]\nwrap_angle_deg=90\nsample_rate_hz=200.0\nhook_mass_g=0\nstroke_mm=100\non_s=0.5\ndwell_s=3.0\n\
                    [[series]]\nfile=\"a.csv\"\nsubstrate=\"plain\"\npins=[]\nload_mass_g=100\nspeed_pct=47\nsweep=\"up\"\n";
        let lost = segment_run(text, "run.toml", |_| Err::<Vec<u8>, _>(std::io::Error::other("disk full")));
        assert_eq!(lost.unwrap_err().to_string(), "a.csv: disk full");
        let still: String = (0..200).fold("time_s,force_N,position_mm,power_W\n".to_owned(), |text, i| {
            text + &format!("{},1,0,0\n", f64::from(i) * 0.005)
        });
        let none = segment_run(text, "run.toml", |_| Ok::<_, std::io::Error>(still.clone().into_bytes()));
        assert!(none.unwrap_err().to_string().starts_with("run.toml: no log contains a plateau"));
    }

    /// A log of moves between two levels; each move takes 0.5 s and each rest 3 s.
    fn log(start_s: f64, directions: &[Direction], columns: &str) -> String {
        let mut text = format!("time_s,{columns}\n");
        let (mut position_mm, mut force_n) = (0.0, 10.0);
        for i in 0..50 * (2 + 4 * directions.len()) {
            let t = i as f64 / 50.0;
            let phase = (t - 2.0) % 3.5;
            let at = ((t - 2.0) / 3.5).floor();
            let is_move = t >= 2.0 && phase < 0.5 && at < directions.len() as f64;
            if is_move {
                let direction = directions[at as usize];
                position_mm -= 0.4 * direction.sign();
                force_n = 10.0 + 3.0 * direction.sign();
            }
            let noise = 0.02 * libm::sin(37.0 * (i * i) as f64);
            text += &format!("{},{}", start_s + t, force_n + noise);
            for column in columns.split(',').skip(1) {
                text += &match column {
                    "position_mm" => format!(",{position_mm}"),
                    "power_W" => if is_move { ",8" } else { ",0" }.to_owned(),
                    _ => ",10.5".to_owned(),
                };
            }
            text.push('\n');
        }
        text
    }

    const PLAIN: &str = "substrate=\"plain\"\npins=[]\nload_mass_g=1019.7\n";
    const RIG: &str = "[rig]\nwrap_angle_deg=90\n";

    #[test]
    fn single_moves_form_one_series() {
        let entry = |file: &str| format!("[[series]]\nfile=\"{file}\"\n{PLAIN}");
        let text = format!("{RIG}{}{}{}", entry("0"), entry("1"), entry("2"));
        let moves = [Direction::Eccentric, Direction::Concentric, Direction::Concentric];
        let run = segment_run(&text, "run.toml", |file| {
            let at: usize = file.parse().unwrap();
            Ok::<_, std::io::Error>(log(0.0, &moves[at..=at], "force_N,position_mm,power_W").into_bytes())
        })
        .unwrap();
        let rows: Vec<_> = run.rows.iter().map(|r| (r.series.as_str(), r.direction, r.repetition)).collect();
        let expected = [("0", moves[0], 1), ("0", moves[1], 1), ("0", moves[2], 2)];
        assert_eq!(rows, expected);
        assert!(run.rows.windows(2).all(|w| w[0].time_s < w[1].time_s));
    }

    #[test]
    fn files_of_a_series_are_joined() {
        let text = format!("{RIG}[[series]]\nfiles=[\"0\", \"1\"]\n{PLAIN}");
        let run = segment_run(&text, "run.toml", |file| {
            let (start_s, direction) =
                if file == "0" { (0.0, Direction::Eccentric) } else { (500.0, Direction::Concentric) };
            Ok::<_, std::io::Error>(log(start_s, &[direction; 3], "force_N").into_bytes())
        })
        .unwrap();
        let directions: String = run.rows.iter().map(|r| &r.direction.as_str()[..1]).collect();
        assert!(directions.starts_with('e') && directions.ends_with('c'), "{directions}");
        assert!(run.rows.last().unwrap().time_s > 500.0);
        assert!(run.rows[0].unknown.contains(Optional::Position));
    }

    #[test]
    fn measured_loads_replace_declared_ones() {
        let text = format!("{RIG}[[series]]\nfile=\"0\"\n{PLAIN}");
        let moves = [[Direction::Eccentric; 3], [Direction::Concentric; 3]].concat();
        let read = |columns: &'static str| {
            let log = log(0.0, &moves, columns).into_bytes();
            segment_run(&text, "run.toml", move |_| Ok::<_, std::io::Error>(log.clone())).unwrap()
        };
        assert!((read("force_N,power_W").rows[0].load_n - 10.0).abs() < 1e-3);
        let measured = read("force_N,power_W,load_measured_N");
        assert_eq!((measured.rows[0].load_n, measured.rows.len()), (10.5, 6));
    }

    /// A log of time and force at 100 Hz after a rest of 2 s at the load. Each move has a level in
    /// newtons, with an overshoot of 2 % of it, and a length; the rest after it has another one.
    fn force_log(moves: &[(f64, f64, f64)]) -> Vec<u8> {
        let (mut text, mut count, mut force_n) = ("time_s,force_N\n".to_owned(), 0u32, LOAD_N);
        let mut put = |force_n: f64| {
            let noise_n = 0.02 * libm::sin(0.7 * f64::from(count) * f64::from(count));
            text += &format!("{:.2},{:.4}\n", f64::from(count) / 100.0, force_n + noise_n);
            count += 1;
        };
        (0..200).for_each(|_| put(force_n));
        for &(level_n, on_s, rest_s) in moves {
            let overshoot = if level_n > LOAD_N { 0.02 } else { -0.02 };
            for i in 0..(100.0 * on_s) as u32 {
                let share = (f64::from(i + 1) / 10.0).min(1.0);
                put(force_n + (level_n * (1.0 + overshoot) - force_n) * share);
            }
            for i in 0..(100.0 * rest_s) as u32 {
                put(level_n * (1.0 + overshoot * libm::exp(-f64::from(i) / 30.0)));
            }
            force_n = level_n;
        }
        text.into_bytes()
    }

    const LOAD_N: f64 = 19.6133;
    const LEVELS_N: [f64; 2] = [LOAD_N / 1.2, LOAD_N * 1.2];

    fn segment_force(log: &[u8]) -> Result<SegmentedRun, Diagnostic> {
        let text =
            format!("{RIG}[[series]]\nfile=\"a.csv\"\nsubstrate=\"plain\"\npins=[]\nload_mass_g=2000\n");
        segment_run(&text, "run.toml", |_| Ok::<_, std::io::Error>(log.to_vec()))
    }

    /// The weight is raised after five pulls: both levels are above the declared load.
    #[test]
    fn changed_weights_are_refused() {
        let moves = [[(LEVELS_N[1], 0.5, 3.0); 5], [(1.25 * LEVELS_N[1], 0.5, 3.0); 5]].concat();
        let error = segment_force(&force_log(&moves)).unwrap_err();
        assert!(error.problem().contains("both above the load of 19.61 N"), "{error}");
        assert!(error.to_string().contains("if the weight changes, add a column load_N"), "{error}");
    }

    /// The force alone shows each rest of a log with rests of different lengths.
    #[test]
    fn rests_of_different_lengths_are_read() {
        for rests_s in [[1.5, 3.0, 8.0], [8.0, 1.5, 3.0]] {
            let moves: Vec<_> = (0..6).map(|k| (LEVELS_N[k % 2], 0.5, rests_s[k % 3])).collect();
            let run = segment_force(&force_log(&moves)).unwrap();
            let dropped = (run.report.series[0].findings.iter())
                .filter(|f| matches!(f, Finding::UnreadableRest { .. } | Finding::UncertainDirection { .. }))
                .count();
            assert_eq!(run.rows.len() + dropped, 6, "{rests_s:?}: {}", run.report.series[0]);
            let mut end_s = 2.0;
            let truth: Vec<(f64, f64)> = (moves.iter())
                .map(|(level_n, on_s, rest_s)| {
                    end_s += on_s + rest_s;
                    (end_s, *level_n)
                })
                .collect();
            for row in &run.rows {
                let is_true = |(end_s, level_n): &(f64, f64)| {
                    (row.time_s - end_s).abs() < 0.1 && (row.force_n / level_n - 1.0).abs() < 0.003
                };
                assert!(truth.iter().any(is_true), "{rests_s:?}: {row:?}");
            }
        }
        let moves: Vec<_> = (0..6).map(|k| (LEVELS_N[k % 2], 0.5, [1.5, 3.0, 8.0][k % 3])).collect();
        assert_eq!(segment_force(&force_log(&moves)).unwrap().rows.len(), 6);
    }

    /// Moves at a steady force that are longer than the rests after them look like rests.
    #[test]
    fn long_moves_by_force_are_refused() {
        let moves: Vec<_> = (0..8).map(|k| (LEVELS_N[k % 2], 3.0, 1.0)).collect();
        let error = segment_force(&force_log(&moves)).unwrap_err();
        assert!(error.problem().starts_with("the force alone does not distinguish the rests"), "{error}");
        assert!(error.to_string().contains("add a column position_mm or power_W"), "{error}");
    }

    /// The force alone does not show whether the actuator rests, unless `on_s` is declared.
    #[test]
    fn dwells_by_force_are_reported() {
        let moves: Vec<_> = (0..6).map(|k| (LEVELS_N[k % 2], 0.5, 3.0)).collect();
        let run = segment_force(&force_log(&moves)).unwrap();
        assert_eq!(run.report.series[0].findings, [Finding::DwellByForce]);
    }

    #[test]
    fn overlapping_logs_are_refused() {
        let entry = |file: &str| format!("[[series]]\nfile=\"{file}\"\n{PLAIN}");
        let moves = [[Direction::Eccentric; 3], [Direction::Concentric; 3]].concat();
        let read = |file: &str| {
            let start_s = if file == "0" { 1000.0 } else { 1020.0 };
            Ok::<_, std::io::Error>(log(start_s, &moves, "force_N,power_W").into_bytes())
        };
        let error = segment_run(&format!("{RIG}{}{}", entry("0"), entry("1")), "run.toml", read).unwrap_err();
        assert_eq!(error.to_string().split(';').next(), Some("1: the clock overlaps that of '0'"));
    }
}
