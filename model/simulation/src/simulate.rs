//! Readings of a synthetic rig: the twin's readings with the constants of the plan, plus noise.

use std::collections::BTreeMap;

use pinswitch_calibration::table::{PlateauRow, PlateauTable};
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::published;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StudentT};

use crate::plan::Plan;
use crate::series_traits::{SessionTraits, ar1_step};
use crate::{protocol, twin};

/// Simulated session of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedSession {
    /// Rows as the rig would record them.
    pub rows: Vec<PlateauRow>,
    /// A sample of the rows without noise and random effects, for comparison with predictions.
    pub fresh: Vec<PlateauRow>,
    /// Random effects of the series.
    pub traits: SessionTraits,
}

impl SimulatedSession {
    /// Returns the rows as CSV, with the optional columns of the plan.
    pub fn table(&self, plan: &Plan) -> String {
        self.traits.add_columns(plan.columns, &self.rows, PlateauTable::write(&self.rows))
    }

    /// Returns the rows without noise as CSV, with the optional columns of the plan.
    pub fn fresh_table(&self, plan: &Plan) -> String {
        self.traits.add_columns(plan.columns, &self.fresh, PlateauTable::write(&self.fresh))
    }
}

/// Largest reading in newtons, as in a table.
const MAX_N: f64 = 1e5;

impl SimulatedSession {
    /// Checks that a load cell can give these readings; `file` is the name of the plan in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] at the first reading that is not finite or beyond the range of a table.
    pub fn check(&self, file: &str) -> Result<(), Diagnostic> {
        let is_reading = |row: &PlateauRow| row.force_n.abs() <= MAX_N && row.load_n <= MAX_N;
        for rows in [&self.rows, &self.fresh] {
            if let Some(at) = rows.iter().position(|row| !is_reading(row)) {
                let problem = format!(
                    "the plan makes a reading of {} N in row {}, at most {MAX_N} N are possible",
                    rows[at].force_n,
                    at + 1
                );
                return Err(Diagnostic::new(codes::PLAN_OF_RIG_INCONSISTENT, problem)
                    .with_location(Location::file(file))
                    .with_help("lower its constants, effects or noise"));
            }
        }
        Ok(())
    }
}

/// Simulates a plan. The same plan makes the same rows, bit by bit.
///
/// ```
/// use pinswitch_simulation::{Plan, simulate};
///
/// let mut plan = Plan { seed: 7, ..Plan::randomised() };
/// plan.add_effect("coating_ploughing", vec![0.024]);
/// let simulated = simulate(&plan);
/// assert_eq!(simulated, simulate(&plan), "the same plan makes the same rows");
/// assert!(simulated.fresh.len() < simulated.rows.len());
/// ```
pub fn simulate(plan: &Plan) -> SimulatedSession {
    let mut random = ChaCha8Rng::seed_from_u64(plan.seed);
    let rows = protocol::rows(plan, &mut random);
    recorded(plan, rows, &mut random)
}

/// Simulates these rows, such as those of a proposed experiment, on the rig of a plan. The protocol
/// of the plan is ignored.
pub fn simulate_rows(plan: &Plan, rows: Vec<PlateauRow>) -> SimulatedSession {
    recorded(plan, rows, &mut ChaCha8Rng::seed_from_u64(plan.seed))
}

/// Computes the readings of the rows, a sample of them without noise, and adds the noise.
fn recorded(plan: &Plan, mut rows: Vec<PlateauRow>, random: &mut ChaCha8Rng) -> SimulatedSession {
    let traits = SessionTraits::draw(plan, &rows);
    read(plan, &mut rows, &traits.without_friction_factors());
    let mut fresh = Vec::new();
    let share = 400.0 / rows.len().max(1) as f64;
    for row in &rows {
        if random.random::<f64>() < share {
            fresh.push(row.clone());
        }
    }
    if plan.noise.series_scale > 0.0 || plan.noise.mount_scale > 0.0 {
        read(plan, &mut rows, &traits);
    }
    add_noise(plan, &traits, &mut rows, random);
    SimulatedSession { rows, fresh, traits }
}

/// Writes the readings without noise into the rows.
fn read(plan: &Plan, rows: &mut [PlateauRow], traits: &SessionTraits) {
    let forces = twin::readings(plan, rows, traits);
    rows.iter_mut().zip(forces).for_each(|(row, force)| row.force_n = force);
}

/// Adds noise of repetitions, of series and directions, and of series, and gross errors; rounds;
/// mislabels and loses rows.
fn add_noise(plan: &Plan, traits: &SessionTraits, rows: &mut Vec<PlateauRow>, random: &mut ChaCha8Rng) {
    let noise = &plan.noise;
    let heavy = StudentT::new(3.0).ok();
    // By series and direction: offset, factor on the repetition noise, and noise of the last
    // repetition.
    let mut cells: BTreeMap<(String, bool), (f64, f64, f64)> = BTreeMap::new();
    let rho = noise.autocorrelation;
    // Offset of the last series by direction, in standard deviations.
    let mut last = [None; 2];
    for row in rows.iter_mut() {
        let up = row.direction == pinswitch_friction::Direction::Concentric;
        let cell = cells.entry((row.series.clone(), up)).or_insert_with(|| {
            let [offset, factor, before]: [f64; 3] = std::array::from_fn(|_| StandardNormal.sample(random));
            let sd = noise.series_n.hypot(noise.series_per_load * row.load_n);
            let offset = ar1_step(noise.series_walk, last[usize::from(up)], offset);
            last[usize::from(up)] = Some(offset);
            (offset * sd, (noise.uneven * factor).exp(), before)
        });
        let unit: f64 = match (noise.heavy_tails, &heavy) {
            // The quartiles of t with three degrees of freedom are at 0.765, those of the normal
            // distribution at 0.674.
            (true, Some(t)) => t.sample(random) * 0.674 / 0.765,
            _ => StandardNormal.sample(random),
        };
        cell.2 = rho * cell.2 + (1.0 - rho * rho).sqrt() * unit;
        let sd = cell.1 * noise.repetition_n.hypot(noise.repetition_per_load * row.load_n);
        let mut error = cell.0 + cell.2 * sd;
        if random.random::<f64>() < noise.outlier_share {
            let gross: f64 = StandardNormal.sample(random);
            error += noise.outlier_n * gross;
        }
        let common_n = noise.series_common_n.hypot(noise.series_common_per_load * row.load_n);
        if common_n > 0.0 {
            error += common_n * traits.of(&row.series).common_offset;
        }
        row.force_n += error;
        if noise.resolution_n > 0.0 {
            row.force_n = (row.force_n / noise.resolution_n).round() * noise.resolution_n;
        }
    }
    mislabel(plan, rows, random);
    if noise.lost_share > 0.0 {
        rows.retain(|_| random.random::<f64>() >= noise.lost_share);
    }
}

/// Replaces the weight of some series by a neighbouring one.
fn mislabel(plan: &Plan, rows: &mut [PlateauRow], random: &mut ChaCha8Rng) {
    let mut names: Vec<String> = rows.iter().map(|r| r.series.clone()).collect();
    names.dedup();
    for _ in 0..plan.noise.mislabelled_series {
        let name = names[random.random_range(0..names.len())].clone();
        let Some(mass_g) = rows.iter().find(|r| r.series == name).map(|r| r.load_mass_g) else { continue };
        let at = plan.weights_g.partition_point(|w| *w < mass_g - 1e-9);
        let other = if at + 1 < plan.weights_g.len() { at + 1 } else { at.saturating_sub(1) };
        for row in rows.iter_mut().filter(|r| r.series == name) {
            row.load_mass_g = plan.weights_g[other];
            row.load_n = published::load_n(row.load_mass_g);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::NoisePlan;

    #[test]
    fn impossible_readings_are_refused() {
        assert_eq!(simulate(&Plan::default()).check("plan.toml"), Ok(()));
        let plan = Plan::parse("wrap_angle_deg = 720\n[constants]\nmu_s = 9\n", "plan.toml").unwrap();
        let error = simulate(&plan).check("plan.toml").unwrap_err().to_string();
        assert!(error.starts_with("plan.toml: the plan makes a reading of "), "{error}");
    }

    #[test]
    fn rows_depend_on_the_seed() {
        let plan = Plan::default();
        assert_eq!(simulate(&plan), simulate(&plan));
        let other = Plan { seed: 2, ..plan.clone() };
        assert_ne!(simulate(&plan).rows, simulate(&other).rows);
        assert!(simulate(&plan).rows.len() > 2500);
    }

    /// Returns the standard deviation of the means of the series.
    fn sd_of_means(rows: &[PlateauRow], of: impl Fn(&PlateauRow) -> Option<f64>) -> f64 {
        let mut series: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for row in rows {
            series.entry(&row.series).or_default().extend(of(row));
        }
        let means: Vec<f64> = series.values().map(|v| v.iter().sum::<f64>() / v.len() as f64).collect();
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / means.len() as f64).sqrt()
    }

    /// Returns a plan without noise, with many series of one load on silicone.
    fn noiseless() -> Plan {
        let mut plan = Plan { weights_g: vec![3007.2; 400], layouts: Vec::new(), ..Plan::default() };
        plan.speeds_pct = vec![50.0];
        plan.noise = NoisePlan {
            repetition_n: 0.0,
            repetition_per_load: 0.0,
            series_n: 0.0,
            series_per_load: 0.0,
            outlier_share: 0.0,
            ..NoisePlan::default()
        };
        plan
    }

    #[test]
    fn rows_have_the_planned_scatter() {
        let mut plan = noiseless();
        // Friction exponent of the capstan.
        let exponent = |r: &PlateauRow| Some((r.force_n / r.load_n).ln() * r.direction.sign());
        assert!(sd_of_means(&simulate(&plan).rows, exponent) < 1e-9);
        plan.noise.series_scale = 0.02;
        let x = plan.constants.mu_s * plan.wrap_angle_deg.to_radians();
        let made = simulate(&plan);
        assert!((sd_of_means(&made.rows, exponent) / x / 0.02 - 1.0).abs() < 0.1);
        assert!(sd_of_means(&made.fresh, exponent) < 1e-9, "fresh rows have no random effects");
        let mut plan = noiseless();
        (plan.noise.series_common_n, plan.noise.series_common_per_load) = (0.03, 0.004);
        let rows = simulate(&plan).rows;
        let expected = 0.03f64.hypot(0.004 * rows[0].load_n);
        for sign in [-1.0, 1.0] {
            let sd = sd_of_means(&rows, |r| (r.direction.sign() == sign).then_some(r.force_n));
            assert!((sd / expected - 1.0).abs() < 0.1, "{sd} instead of {expected}");
        }
    }

    /// The offsets of a series and direction have the same autocorrelation as those of a series.
    #[test]
    fn direction_offsets_are_correlated() {
        for walk in [0.0, 0.7] {
            let mut plan = noiseless();
            plan.speeds_pct = vec![50.0];
            (plan.noise.series_n, plan.noise.series_walk) = (0.1, walk);
            let rows = simulate(&plan).rows;
            let noise = |r: &PlateauRow| {
                let x = plan.constants.mu_s * plan.wrap_angle_deg.to_radians();
                r.force_n - r.load_n * (r.direction.sign() * x).exp()
            };
            for sign in [-1.0, 1.0] {
                let offsets: Vec<f64> = rows
                    .iter()
                    .filter(|r| r.repetition == 1 && r.direction.sign() == sign)
                    .map(noise)
                    .collect();
                let square = offsets.iter().map(|o| o * o).sum::<f64>() / offsets.len() as f64;
                let product = offsets.windows(2).map(|o| o[0] * o[1]).sum::<f64>() / offsets.len() as f64;
                assert!((product / square - walk).abs() < 0.12, "{} instead of {walk}", product / square);
                assert!((square.sqrt() / 0.1 - 1.0).abs() < 0.15, "{}", square.sqrt());
            }
        }
    }

    #[test]
    fn readings_are_multiples_of_the_resolution() {
        let mut plan = Plan::default();
        plan.noise.resolution_n = 0.05;
        for row in simulate(&plan).rows {
            let steps = row.force_n / 0.05;
            assert!((steps - steps.round()).abs() < 1e-6, "{}", row.force_n);
        }
    }

    #[test]
    fn optional_columns_follow_the_plan() {
        let mut plan = Plan::randomised();
        let made = simulate(&plan);
        assert_eq!(made.table(&plan), PlateauTable::write(&made.rows));
        (plan.columns.mount, plan.columns.operator) = (true, true);
        let text = made.table(&plan);
        let first = text.lines().next().unwrap();
        assert!(first.ends_with(",mount,operator"), "{first}");
        assert!(text.lines().last().unwrap().ends_with(",7,1"));
        assert_eq!(PlateauTable::read(text.as_bytes(), "t").unwrap().rows.len(), made.rows.len());
    }

    /// FNV-1a, of 64 bits.
    fn hash(text: &str) -> u64 {
        text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
    }

    fn tables(plan: &Plan) -> String {
        let made = simulate(plan);
        PlateauTable::write(&made.rows) + &PlateauTable::write(&made.fresh)
    }

    /// Regression test: features added later do not change the tables of plans that do not use
    /// them.
    #[test]
    fn tables_of_old_plans_are_unchanged() {
        let mut noisy = Plan { seed: 9, ..Plan::randomised() };
        noisy.noise.heavy_tails = true;
        noisy.noise.autocorrelation = 0.4;
        noisy.noise.uneven = 0.3;
        noisy.noise.lost_share = 0.03;
        noisy.noise.mislabelled_series = 2;
        let hashes = [Plan::default(), Plan::randomised(), noisy].map(|plan| hash(&tables(&plan)));
        assert_eq!(
            hashes,
            [0xe6bc_542c_dcf6_c464, 0x13ec_7e9d_543c_4722, 0x264f_ffbb_1205_371c],
            "{hashes:x?}"
        );
    }
}
