//! Raw logs of a synthetic run: sampled force, position and power, with faults.

use std::fmt::Write;

use pinswitch_calibration::table::{PlateauRow, substrate_word};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::published;
use pinswitch_friction::{Direction, Substrate};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::{Plan, RawPlan};

/// Faults that a log contains on purpose.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Faults {
    /// Number of samples with a spike.
    pub spikes: usize,
    /// Number of lost samples.
    pub lost: usize,
    /// Move that is too short: direction and repetition.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub odd_speed: Option<(Direction, u32)>,
    /// Repetition after which one is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing_after: Option<(Direction, u32)>,
}

/// Raw log of a series.
#[derive(Clone, Debug, PartialEq)]
pub struct RawLog {
    /// File name, without `.gz`.
    pub file: String,
    /// CSV text with the columns `time_s,force_N,position_mm,power_W`.
    pub text: String,
    /// True plateaus: direction, repetition as counted in the log, force in newtons.
    pub truth: Vec<(Direction, u32, f64)>,
    /// Faults of the log.
    pub faults: Faults,
}

/// Raw run, which makes its long logs one at a time.
///
/// ```
/// use pinswitch_calibration::segmentation::segment_run;
/// use pinswitch_simulation::{Plan, RawRun, simulate};
///
/// let plan = Plan { weights_g: vec![1003.2], layouts: Vec::new(), ..Plan::default() };
/// let rows = simulate(&plan).rows;
/// let run = RawRun::new(&plan, &rows, "plan.toml")?;
/// let log = run.log(0).ok_or("a run of one log")?;
/// let read = |_: &str| std::io::Result::Ok(log.text.clone().into_bytes());
/// let segmented = segment_run(&run.description(""), "run.toml", read)?;
/// assert_eq!(segmented.rows.len(), log.truth.len(), "every repetition has its plateau");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RawRun<'a> {
    plan: &'a Plan,
    series: Vec<Vec<PlateauRow>>,
}

/// Duration of a move in seconds.
const ON_S: f64 = 0.5;
/// Time before the first move and after the last rest, in seconds.
const LEAD_S: f64 = 2.0;
/// Time over which a plateau is averaged, in seconds.
const READ_S: f64 = 1.0;
/// Shortest dwell of a raw log in seconds: the force settles before the plateau is read.
const MIN_DWELL_S: f64 = 1.5;

impl<'a> RawRun<'a> {
    /// Creates the run that records the rows of a session; `file` is the name of the plan in
    /// errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] unless the plan has one dwell that is long enough to read a plateau.
    pub fn new(plan: &'a Plan, rows: &[PlateauRow], file: &str) -> Result<Self, Diagnostic> {
        if plan.dwells_s.len() != 1 || plan.dwells_s[0] < MIN_DWELL_S {
            let location = Location::file(file).with_field("dwells_s", format!("{:?}", plan.dwells_s));
            return Err(Diagnostic::new(
                codes::PLAN_OF_RIG_INCONSISTENT,
                format!("raw logs need one dwell of at least {MIN_DWELL_S} s"),
            )
            .with_location(location)
            .with_help("make one plan per dwell, since a run.toml has one dwell_s"));
        }
        let mut series: Vec<Vec<PlateauRow>> = Vec::new();
        for row in rows {
            match series.last_mut().filter(|s| s.first().is_some_and(|f| f.series == row.series)) {
                Some(last) => last.push(row.clone()),
                None => series.push(vec![row.clone()]),
            }
        }
        Ok(Self { plan, series })
    }

    /// Returns the number of logs.
    pub fn logs(&self) -> usize {
        self.series.len()
    }

    /// Returns the text of `run.toml`; `suffix` is appended to the names of the logs.
    pub fn description(&self, suffix: &str) -> String {
        let mut text = format!(
            "[rig]\nwrap_angle_deg = {}\nsample_rate_hz = {:?}\nhook_mass_g = {}\nstroke_mm = {}\non_s = {ON_S:?}\n\
             dwell_s = {:?}\n",
            self.plan.wrap_angle_deg,
            self.plan.raw.sample_rate_hz,
            published::HOOK_MASS_G,
            published::STROKE_MM,
            self.plan.dwells_s[0]
        );
        for (i, row) in self.series.iter().enumerate().filter_map(|(i, s)| s.first().map(|r| (i, r))) {
            let sweep = row.sweep.as_str();
            let _ = write!(
                text,
                "\n[[series]]\nfile = \"{}{suffix}\"\nsubstrate = \"{}\"\npins = {:?}\nload_mass_g = {:?}\n\
                 speed_pct = {:?}\nsweep = \"{sweep}\"\n",
                file_name(i, row),
                substrate_word(row.substrate),
                row.pins,
                row.load_mass_g,
                row.speed_pct,
            );
        }
        text
    }

    /// Makes the log with this index. The same plan makes the same bytes.
    pub fn log(&self, index: usize) -> Option<RawLog> {
        let rows = self.series.get(index)?;
        let first = rows.first()?;
        let mut random = ChaCha8Rng::seed_from_u64(self.plan.seed ^ (0x5A17_0000 + index as u64));
        let raw = &self.plan.raw;
        let mut faults = Faults::default();
        let pick = |share: f64, random: &mut ChaCha8Rng| {
            (random.random::<f64>() < share).then(|| random.random_range(1..rows.len().max(2)))
        };
        let odd = pick(raw.odd_speed_share, &mut random);
        let missing = pick(raw.missing_share, &mut random).filter(|i| Some(*i) != odd);
        let mut recorder = Recorder::new(self.plan, first.load_n, &mut random);
        recorder.rest(LEAD_S, first.load_n, 0.0, 0.0);
        let (mut truth, mut counts) = (Vec::new(), [0u32; 2]);
        for (i, row) in rows.iter().enumerate() {
            let slot = usize::from(row.direction == Direction::Concentric);
            let in_direction = rows.iter().filter(|r| r.direction == row.direction).count();
            // Not where the direction changes, since a longer pause is normal there.
            let turns = [i.wrapping_sub(1), i + 1]
                .iter()
                .any(|j| rows.get(*j).is_none_or(|r| r.direction != row.direction));
            if Some(i) == missing && !turns {
                recorder.rest(ON_S + self.plan.dwells_s[0], rows[i - 1].force_n, 0.0, 0.0);
                faults.missing_after = Some((row.direction, counts[slot]));
                continue;
            }
            counts[slot] += 1;
            let mut way_mm = -row.direction.sign() * published::STROKE_MM / in_direction as f64;
            if Some(i) == odd {
                way_mm *= 0.6;
                faults.odd_speed = Some((row.direction, counts[slot]));
            }
            recorder.step(way_mm, row.force_n, row.direction.sign(), self.plan.dwells_s[0]);
            truth.push((row.direction, counts[slot], recorder.clipped(row.force_n)));
        }
        let last = rows.last().map_or(0.0, |r| r.force_n);
        recorder.rest(LEAD_S, last, 0.0, 0.0);
        (faults.spikes, faults.lost) = (recorder.spikes, recorder.lost);
        Some(RawLog { file: file_name(index, first), text: recorder.text, truth, faults })
    }
}

/// Returns the file name of a log, such as `012-device-5-8-11_2505g.csv`.
fn file_name(index: usize, row: &PlateauRow) -> String {
    let pins: Vec<String> = row.pins.iter().map(usize::to_string).collect();
    let contact = match row.substrate {
        Some(Substrate::Silicone) if pins.is_empty() => "silicone".to_owned(),
        Some(Substrate::Silicone) => format!("device-{}", pins.join("-")),
        other => format!("{}-{}", substrate_word(other), pins.join("-")),
    };
    format!("{index:03}-{contact}_{:04.0}g.csv", row.load_mass_g)
}

/// Writer of the samples of a log.
struct Recorder<'a> {
    raw: &'a RawPlan,
    random: &'a mut ChaCha8Rng,
    text: String,
    sample: u64,
    position_mm: f64,
    force_n: f64,
    spikes: usize,
    lost: usize,
}

impl<'a> Recorder<'a> {
    fn new(plan: &'a Plan, load_n: f64, random: &'a mut ChaCha8Rng) -> Self {
        let text = "time_s,force_N,position_mm,power_W\n".to_owned();
        Self {
            raw: &plan.raw,
            random,
            text,
            sample: 0,
            position_mm: 0.0,
            force_n: load_n,
            spikes: 0,
            lost: 0,
        }
    }

    /// Returns the force as the channel records it.
    fn clipped(&self, force_n: f64) -> f64 {
        self.raw.clip_n.map_or(force_n, |clip| force_n.min(clip))
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(self.random)
    }

    /// Adds one sample.
    fn write(&mut self, force_n: f64, power_w: f64) {
        let time_s = self.sample as f64 / self.raw.sample_rate_hz + self.raw.jitter_s * self.normal();
        self.sample += 1;
        let mut force_n = force_n + self.raw.sample_n * self.normal();
        if self.random.random::<f64>() < self.raw.lost_share {
            self.lost += 1;
            return;
        }
        if self.random.random::<f64>() < self.raw.spike_share {
            self.spikes += 1;
            force_n += if self.random.random::<bool>() { 15.0 } else { -15.0 };
        }
        let (force_n, place) = (self.clipped(force_n), self.position_mm + 0.02 * self.normal());
        let power_w = (power_w + 0.04 * self.normal()).max(0.0);
        let _ = writeln!(self.text, "{:.4},{force_n:.3},{place:.2},{power_w:.2}", time_s.max(0.0));
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "seconds of a log, checked")]
    /// Returns the number of samples in a time.
    fn samples(&self, seconds: f64) -> u32 {
        (seconds * self.raw.sample_rate_hz).round() as u32
    }

    /// Writes a rest at a plateau. The force starts `excess_n` above it and decays; the weight
    /// swings by `swing_n`.
    fn rest(&mut self, seconds: f64, plateau_n: f64, excess_n: f64, swing_n: f64) {
        let transient = |t: f64| {
            excess_n * (-t / 0.4).exp() + swing_n * (-t / 0.9).exp() * (std::f64::consts::TAU * 1.7 * t).sin()
        };
        let count = self.samples(seconds);
        let time = |i: u32| f64::from(i) / self.raw.sample_rate_hz;
        // The plateau is the mean over the last second: the mean of the transient there is
        // subtracted.
        let read = self.samples(READ_S.min(seconds));
        let left = (count - read..count).map(|i| transient(time(i))).sum::<f64>() / f64::from(read.max(1));
        let values: Vec<f64> = (0..count).map(|i| plateau_n - left + transient(time(i))).collect();
        values.into_iter().for_each(|force_n| self.write(force_n, 0.0));
        self.force_n = plateau_n;
    }

    /// Writes a move over `way_mm` and the rest after it.
    fn step(&mut self, way_mm: f64, plateau_n: f64, sign: f64, dwell_s: f64) {
        let count = self.samples(ON_S);
        let (from_mm, from_n) = (self.position_mm, self.force_n);
        let excess_n = sign * (0.2 + 0.01 * plateau_n.abs());
        for i in 1..=count {
            let share = f64::from(i) / f64::from(count);
            self.position_mm = from_mm + way_mm * share;
            let risen = 1.0 - (-8.0 * share).exp();
            self.write(from_n + (plateau_n + 1.5 * excess_n - from_n) * risen, 8.0);
        }
        let swing_n = 0.02 * plateau_n.abs();
        self.rest(dwell_s, plateau_n, excess_n, swing_n);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::simulate;
    use pinswitch_calibration::segmentation::{Finding, Log, RunPlan, segment};

    /// Segmentation recovers the plateaus and reports the faults.
    #[test]
    fn logs_round_trip_through_segmentation() {
        let mut plan = Plan { weights_g: vec![251.2, 2505.4, 5002.5], ..Plan::default() };
        plan.raw.odd_speed_share = 0.5;
        plan.raw.missing_share = 0.5;
        plan.raw.clip_n = Some(55.0);
        let rows = simulate(&plan).rows;
        let run = RawRun::new(&plan, &rows, "plan").unwrap();
        let description = RunPlan::parse(&run.description(""), "run.toml").unwrap();
        assert_eq!(description.series.len(), run.logs());
        let (mut sum, mut count) = (0.0, 0.0);
        for index in 0..run.logs() {
            let raw = run.log(index).unwrap();
            let log = Log::parse(raw.text.as_bytes(), &raw.file).unwrap();
            let load_n = description.series[index].load_n(&description.rig);
            let segmented = segment(&log, &description.rig, load_n).unwrap();
            let got: Vec<_> = segmented.plateaus.iter().map(|p| (p.direction, p.repetition)).collect();
            let put: Vec<_> = raw.truth.iter().map(|t| (t.0, t.1)).collect();
            assert_eq!(got, put, "{}", raw.file);
            for (p, t) in segmented.plateaus.iter().zip(&raw.truth) {
                sum += (p.force_n - t.2).powi(2);
                count += 1.0;
            }
            let findings = &segmented.findings;
            let missing = findings.iter().any(|f| matches!(f, Finding::MissingRepetition { .. }));
            assert_eq!(missing, raw.faults.missing_after.is_some(), "{}: {findings:?}", raw.file);
            let odd = findings.iter().any(|f| matches!(f, Finding::OddSpeed { .. }));
            assert_eq!(odd, raw.faults.odd_speed.is_some(), "{}: {findings:?}", raw.file);
        }
        let rms = f64::sqrt(sum / count);
        assert!(rms < 0.02, "{rms}");
    }

    #[test]
    fn several_dwells_are_refused() {
        let plan = Plan::randomised();
        let error = RawRun::new(&plan, &[], "plan.toml").unwrap_err().to_string();
        assert!(error.contains("dwells_s") && error.contains("plan.toml"), "{error}");
    }
}
