//! Segmentation of a whole run into the rows of a plateau table and the defects of each log.

use std::error::Error;
use std::fmt;

use pinswitch_diagnostic::{Diagnostic, Location};
use pinswitch_friction::Direction;
use serde::Serialize;

use super::finding::Finding;
use super::log::Log;
use super::plateaus::{Segmented, segment};
use super::run_plan::{RunPlan, SeriesPlan};
use crate::table::{Labels, PlateauRow, Unknown};

/// Name and version of the report's format.
const SCHEMA: &str = "pinswitch.segmentation/1";

/// Number of plateaus and defects of one log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SegmentedSeries {
    /// Name of the log in the description of the run.
    pub file: String,
    /// Number of plateaus after a release of the load.
    pub eccentric: usize,
    /// Number of plateaus after a pull of the load.
    pub concentric: usize,
    /// Defects of the log.
    pub findings: Vec<Finding>,
}

impl fmt::Display for SegmentedSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} eccentric, {} concentric", self.file, self.eccentric, self.concentric)?;
        self.findings.iter().try_for_each(|finding| write!(f, "; {finding}"))
    }
}

/// Plateaus and defects of each log of a run, in the order of the run.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    /// Total duration in seconds of the logs added so far.
    start_s: f64,
}

impl<'a> RunSegmentation<'a> {
    /// Starts a segmentation.
    pub fn new(plan: &'a RunPlan) -> Self {
        Self { plan, rows: Vec::new(), series: Vec::new(), start_s: 0.0 }
    }

    /// Adds the log of the next series, in the order of the plan. Returns the log and its plateaus,
    /// for a plot. `file` is the name of the log in errors.
    ///
    /// # Errors
    /// As [`Log::parse`].
    pub fn add(
        &mut self,
        series: &SeriesPlan,
        text: &[u8],
        file: &str,
    ) -> Result<(Log, Segmented), Diagnostic> {
        let log = Log::parse(text, file)?;
        let segmented = segment(&log, &self.plan.rig);
        let number = self.series.len();
        self.rows.extend(rows(self.plan, series, number, &segmented, self.start_s));
        self.start_s += log.time_s.last().copied().unwrap_or(0.0);
        let count = |direction| segmented.plateaus.iter().filter(|p| p.direction == direction).count();
        self.series.push(SegmentedSeries {
            file: series.file.clone(),
            eccentric: count(Direction::Eccentric),
            concentric: count(Direction::Concentric),
            findings: segmented.findings.clone(),
        });
        Ok((log, segmented))
    }

    /// Returns the table and the report. `file` is the name of the run's description in errors.
    ///
    /// # Errors
    /// If no log contains a plateau.
    pub fn finish(self, file: &str) -> Result<SegmentedRun, Diagnostic> {
        if self.rows.is_empty() {
            return Err(Diagnostic::new("no log contains a plateau")
                .with_location(Location::file(file))
                .with_help("check that power_W exceeds 2 W while the actuator runs"));
        }
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
        let text = read(&series.file)
            .map_err(|e| Diagnostic::from_error(e).with_location(Location::file(&series.file)))?;
        run.add(series, &text, &series.file)?;
    }
    run.finish(file)
}

/// Converts the plateaus of one log to rows of the table; `start_s` is the start of the log in the
/// session.
fn rows<'a>(
    plan: &'a RunPlan,
    series: &'a SeriesPlan,
    number: usize,
    segmented: &'a Segmented,
    start_s: f64,
) -> impl Iterator<Item = PlateauRow> + 'a {
    segmented.plateaus.iter().map(move |p| PlateauRow {
        series: number.to_string(),
        substrate: series.substrate,
        pins: series.pins.clone(),
        sweep: series.sweep,
        load_mass_g: series.load_mass_g,
        load_n: series.load_n(&plan.rig),
        speed_pct: series.speed_pct,
        dwell_s: plan.rig.dwell_s,
        direction: p.direction,
        repetition: p.repetition,
        position_mm: p.position_mm,
        time_s: start_s + p.time_s,
        force_n: p.force_n,
        wrap_angle_deg: plan.rig.wrap_angle_deg,
        labels: Labels::default(),
        unknown: Unknown::default(),
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
}
