//! Readings of a synthetic rig: the forward model at the plan's constants, then noise.

use std::collections::BTreeMap;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StudentT};

use super::plan::Plan;
use super::protocol;
use crate::effects::effect_named;
use crate::inference::{Model, Term};
use crate::rig::{Frame, PlateauRow};

/// What a plan gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// The table as it would be recorded.
    pub rows: Vec<PlateauRow>,
    /// Rows of the same rig without noise, a part of the session, to judge predictions by.
    pub fresh: Vec<PlateauRow>,
}

/// Runs a plan. The same plan gives the same rows, bit for bit.
pub fn simulate(plan: &Plan) -> Simulated {
    let mut random = ChaCha8Rng::seed_from_u64(plan.seed);
    let mut rows = protocol::rows(plan, &mut random);
    let frame = Frame::new(&rows);
    let model = model(plan, frame);
    let points = model.frame.points(&rows).unwrap_or_default();
    for (row, force) in rows.iter_mut().zip(model.predict(&points)) {
        row.force_n = force;
    }
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

/// The plan's constants and effects as a model.
fn model(plan: &Plan, frame: Frame) -> Model {
    let mut model = Model::baseline(frame);
    let mut values = model.values();
    values[0] = plan.constants.mu_p;
    values[1] = plan.constants.mu_s;
    for device in 0..model.frame.devices() {
        values[2 + 2 * device] *= plan.constants.half_load_factor.get(device).copied().unwrap_or(1.0);
        values[3 + 2 * device] = plan.constants.steepness.get(device).copied().unwrap_or(4.64);
    }
    let fits = model.set_values(&values);
    debug_assert!(fits, "the values are the model's own");
    for effect in &plan.effects {
        if let Some(known) = effect_named(&effect.id) {
            model = model.with_term(Term::Named(known), &effect.values);
        }
    }
    for s in &plan.structures {
        model = model.with_term(Term::Structure(s.structure.clone()), &[s.size]);
    }
    model
}

/// Adds noise per repetition and per series and direction, gross errors, and loses rows.
fn disturb(plan: &Plan, rows: &mut Vec<PlateauRow>, random: &mut ChaCha8Rng) {
    let noise = &plan.noise;
    let heavy = StudentT::new(3.0).ok();
    let mut offsets = BTreeMap::new();
    for row in rows.iter_mut() {
        let up = row.direction == crate::Direction::Concentric;
        let offset: &mut f64 = offsets.entry((row.series.clone(), up)).or_insert_with(|| {
            let unit: f64 = StandardNormal.sample(random);
            unit * noise.series_n.hypot(noise.series_per_load * row.load_n)
        });
        let unit: f64 = match (noise.heavy_tails, &heavy) {
            // The quartiles of t with three degrees of freedom lie at 0.765, those of the normal law at 0.674.
            (true, Some(t)) => t.sample(random) * 0.674 / 0.765,
            _ => StandardNormal.sample(random),
        };
        let mut error = *offset + unit * noise.repetition_n.hypot(noise.repetition_per_load * row.load_n);
        if random.random::<f64>() < noise.outlier_share {
            let gross: f64 = StandardNormal.sample(random);
            error += noise.outlier_n * gross;
        }
        row.force_n += error;
    }
    if noise.lost_share > 0.0 {
        rows.retain(|_| random.random::<f64>() >= noise.lost_share);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_plan_gives_the_same_rows_and_another_seed_others() {
        let plan = Plan::default();
        assert_eq!(simulate(&plan), simulate(&plan));
        let other = Plan { seed: 2, ..plan.clone() };
        assert_ne!(simulate(&plan).rows, simulate(&other).rows);
        assert!(simulate(&plan).rows.len() > 2500);
    }
}
