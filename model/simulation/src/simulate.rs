//! Readings of a synthetic rig: the forward model at the plan's constants, then noise.

use std::collections::BTreeMap;

use pinswitch_calibration::table::PlateauRow;
use pinswitch_friction::published;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StudentT};

use super::plan::{Plan, PlanError};
use super::{protocol, twin};

/// The tables that a plan makes.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// The table as it would be recorded.
    pub rows: Vec<PlateauRow>,
    /// Rows of the same rig without noise, a part of the session, to judge predictions by.
    pub fresh: Vec<PlateauRow>,
}

/// Largest reading in newtons, as in a table.
const MAX_N: f64 = 1e5;

impl Simulated {
    /// Whether these are readings that a load cell can give. `file` is the name of the plan, used in errors.
    ///
    /// # Errors
    /// [`PlanError::Reading`] at the first that is none.
    pub fn check(&self, file: &str) -> Result<(), PlanError> {
        let is_reading = |row: &PlateauRow| row.force_n.abs() <= MAX_N && row.load_n <= MAX_N;
        for rows in [&self.rows, &self.fresh] {
            if let Some(at) = rows.iter().position(|row| !is_reading(row)) {
                let reading = rows[at].force_n.to_string();
                return Err(PlanError::Reading { file: file.to_owned(), row: at + 1, reading, most: MAX_N });
            }
        }
        Ok(())
    }
}

/// Runs a plan. The same plan makes the same rows, bit for bit.
///
/// ```
/// use pinswitch_simulation::{EffectPlan, Plan, simulate};
///
/// let mut plan = Plan { seed: 7, ..Plan::randomised() };
/// plan.effects.push(EffectPlan { id: "coating_ploughing".to_owned(), values: vec![0.024], form: 0 });
/// let simulated = simulate(&plan);
/// assert_eq!(simulated, simulate(&plan), "the same plan makes the same rows");
/// assert!(simulated.fresh.len() < simulated.rows.len());
/// ```
pub fn simulate(plan: &Plan) -> Simulated {
    let mut random = ChaCha8Rng::seed_from_u64(plan.seed);
    let mut rows = protocol::rows(plan, &mut random);
    let forces = twin::readings(plan, &rows);
    rows.iter_mut().zip(forces).for_each(|(row, force)| row.force_n = force);
    let mut fresh = Vec::new();
    let share = 400.0 / rows.len().max(1) as f64;
    for row in &rows {
        if random.random::<f64>() < share {
            fresh.push(row.clone());
        }
    }
    disturb(plan, &mut rows, &mut random);
    Simulated { rows, fresh }
}

/// Adds noise per repetition and per series and direction, gross errors, and loses rows.
fn disturb(plan: &Plan, rows: &mut Vec<PlateauRow>, random: &mut ChaCha8Rng) {
    let noise = &plan.noise;
    let heavy = StudentT::new(3.0).ok();
    // Of each series and direction: its offset, its factor on the repetition noise, and the last repetition's noise.
    let mut cells: BTreeMap<(String, bool), (f64, f64, f64)> = BTreeMap::new();
    let rho = noise.autocorrelation;
    for row in rows.iter_mut() {
        let up = row.direction == pinswitch_friction::Direction::Concentric;
        let cell = cells.entry((row.series.clone(), up)).or_insert_with(|| {
            let [offset, factor, before]: [f64; 3] = std::array::from_fn(|_| StandardNormal.sample(random));
            let sd = noise.series_n.hypot(noise.series_per_load * row.load_n);
            (offset * sd, (noise.uneven * factor).exp(), before)
        });
        let unit: f64 = match (noise.heavy_tails, &heavy) {
            // The quartiles of t with three degrees of freedom lie at 0.765, those of the normal law at 0.674.
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
        row.force_n += error;
    }
    mislabel(plan, rows, random);
    if noise.lost_share > 0.0 {
        rows.retain(|_| random.random::<f64>() >= noise.lost_share);
    }
}

/// Writes down a neighbouring weight for some series.
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

    #[test]
    fn a_rig_that_cannot_be_read_is_refused() {
        assert_eq!(simulate(&Plan::default()).check("plan.toml"), Ok(()));
        let plan = Plan::parse("wrap_angle_deg = 720\n[constants]\nmu_s = 9\n", "plan.toml").unwrap();
        let error = simulate(&plan).check("plan.toml").unwrap_err().to_string();
        assert!(error.starts_with("plan.toml: the plan makes a reading of "), "{error}");
    }

    #[test]
    fn the_same_plan_makes_the_same_rows_and_another_seed_others() {
        let plan = Plan::default();
        assert_eq!(simulate(&plan), simulate(&plan));
        let other = Plan { seed: 2, ..plan.clone() };
        assert_ne!(simulate(&plan).rows, simulate(&other).rows);
        assert!(simulate(&plan).rows.len() > 2500);
    }
}
