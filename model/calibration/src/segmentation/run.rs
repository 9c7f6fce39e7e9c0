//! A whole run: every log segmented, the rows of the plateau table, and what is wrong with each log.

use std::fmt;

use pinswitch_friction::Direction;
use serde::Serialize;

use super::finding::Finding;
use super::log::{Log, LogError};
use super::plateaus::{Segmented, segment};
use super::run_plan::{RunPlan, RunPlanError, SeriesPlan};
use crate::table::{Labels, PlateauRow};

/// Name and version of the report's format.
const SCHEMA: &str = "pinswitch.segmentation/1";

/// Why a run cannot be segmented; `E` is what the caller's reader of logs returns.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SegmentationError<E> {
    /// The description of the run cannot be used.
    #[error(transparent)]
    Plan(#[from] RunPlanError),
    /// A log cannot be used.
    #[error(transparent)]
    Log(#[from] LogError),
    /// A log cannot be read.
    #[error("{0}")]
    Read(E),
    /// The logs hold no plateau at all.
    #[error("{file}: no plateau in any log; power_W must exceed 2 W while the actuator runs")]
    NoPlateau {
        /// Name of the run's description as given.
        file: String,
    },
}

/// Plateaus counted and findings of one log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SegmentedSeries {
    /// Name of the log in the run's description.
    pub file: String,
    /// Plateaus after a release of the load.
    pub eccentric: usize,
    /// Plateaus after a pull.
    pub concentric: usize,
    /// What is wrong with the log.
    pub findings: Vec<Finding>,
}

impl fmt::Display for SegmentedSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} eccentric, {} concentric", self.file, self.eccentric, self.concentric)?;
        self.findings.iter().try_for_each(|finding| write!(f, "; {finding}"))
    }
}

/// What was found in each log of a run, in the order of the run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SegmentationReport {
    /// Name and version of the format.
    pub schema: &'static str,
    /// One entry per log.
    pub series: Vec<SegmentedSeries>,
}

/// A run with all of its logs segmented.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentedRun {
    /// Rows of the plateau table, in the order of the logs.
    pub rows: Vec<PlateauRow>,
    /// What was found in each log.
    pub report: SegmentationReport,
}

/// A run on its way to a table: its logs are added one after the other, so that none has to be kept.
#[derive(Clone, Debug)]
pub struct RunSegmentation<'a> {
    plan: &'a RunPlan,
    rows: Vec<PlateauRow>,
    series: Vec<SegmentedSeries>,
    /// Seconds of the logs added so far.
    start_s: f64,
}

impl<'a> RunSegmentation<'a> {
    /// A run without any log yet.
    pub fn new(plan: &'a RunPlan) -> Self {
        Self { plan, rows: Vec::new(), series: Vec::new(), start_s: 0.0 }
    }

    /// Adds the log of the run's next series, in the order of the plan. Returns the log and what was found in it, to
    /// draw or to discard. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`LogError`] if the text is no log.
    pub fn add(
        &mut self,
        series: &SeriesPlan,
        text: &[u8],
        file: &str,
    ) -> Result<(Log, Segmented), LogError> {
        let log = Log::parse(text, file)?;
        let found = segment(&log, &self.plan.rig);
        let number = self.series.len();
        self.rows.extend(rows(self.plan, series, number, &found, self.start_s));
        self.start_s += log.time_s.last().copied().unwrap_or(0.0);
        let count = |direction| found.plateaus.iter().filter(|p| p.direction == direction).count();
        self.series.push(SegmentedSeries {
            file: series.file.clone(),
            eccentric: count(Direction::Eccentric),
            concentric: count(Direction::Concentric),
            findings: found.findings.clone(),
        });
        Ok((log, found))
    }

    /// The table and the report. `file` is the name of the run's description, used in errors.
    ///
    /// # Errors
    /// [`SegmentationError::NoPlateau`] if no log holds a plateau.
    pub fn finish<E>(self, file: &str) -> Result<SegmentedRun, SegmentationError<E>> {
        if self.rows.is_empty() {
            return Err(SegmentationError::NoPlateau { file: file.to_owned() });
        }
        let report = SegmentationReport { schema: SCHEMA, series: self.series };
        Ok(SegmentedRun { rows: self.rows, report })
    }
}

/// Segments a run from the text of its `run.toml`. `read` returns the text of a log by its name in that file; `file` is
/// the name of the description used in errors.
///
/// ```
/// use pinswitch_calibration::segmentation::segment_run;
/// use pinswitch_calibration::table::PlateauTable;
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
/// // A log of one move and the rest after it; a real one comes from a file.
/// let mut log = "time_s,force_N,position_mm,power_W\n".to_owned();
/// for i in 0..900 {
///     let t = f64::from(i) * 0.005;
///     let (power_w, position_mm) = if (1.0..1.5).contains(&t) { (8.0, 20.0 * (t - 1.0)) } else { (0.0, 0.0) };
///     log += &format!("{t},{},{},{power_w}\n", 8.0, if t >= 1.5 { 10.0 } else { position_mm });
/// }
/// let found = segment_run(run, "run.toml", |_file| Ok::<_, std::io::Error>(log.clone().into_bytes()))?;
/// assert_eq!(found.rows.len(), 1);
/// assert!(PlateauTable::write(&found.rows).contains(",eccentric,1,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SegmentationError`] at the first thing that cannot be used.
pub fn segment_run<E>(
    text: &str,
    file: &str,
    mut read: impl FnMut(&str) -> Result<Vec<u8>, E>,
) -> Result<SegmentedRun, SegmentationError<E>> {
    let plan = RunPlan::parse(text, file)?;
    let mut run = RunSegmentation::new(&plan);
    for series in &plan.series {
        let text = read(&series.file).map_err(SegmentationError::Read)?;
        run.add(series, &text, &series.file)?;
    }
    run.finish(file)
}

/// The plateaus of one log as rows of the table; `start_s` is where the log begins in the session.
fn rows<'a>(
    plan: &'a RunPlan,
    series: &'a SeriesPlan,
    number: usize,
    found: &'a Segmented,
    start_s: f64,
) -> impl Iterator<Item = PlateauRow> + 'a {
    found.plateaus.iter().map(move |p| PlateauRow {
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
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_that_cannot_be_read_and_runs_without_plateaus_are_refused() {
        let text = "[rig]\nwrap_angle_deg=90\nsample_rate_hz=200.0\nhook_mass_g=0\nstroke_mm=100\non_s=0.5\ndwell_s=3.0\n\
                    [[series]]\nfile=\"a.csv\"\nsubstrate=\"plain\"\npins=[]\nload_mass_g=100\nspeed_pct=47\nsweep=\"up\"\n";
        let lost = segment_run(text, "run.toml", |file| Err::<Vec<u8>, _>(format!("{file} is lost")));
        assert_eq!(lost, Err(SegmentationError::Read("a.csv is lost".to_owned())));
        let still: String = (0..200).fold("time_s,force_N,position_mm,power_W\n".to_owned(), |text, i| {
            text + &format!("{},1,0,0\n", f64::from(i) * 0.005)
        });
        let none = segment_run(text, "run.toml", |_| Ok::<_, String>(still.clone().into_bytes()));
        assert_eq!(none, Err(SegmentationError::NoPlateau { file: "run.toml".to_owned() }));
    }
}
