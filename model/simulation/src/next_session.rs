//! A later session of the same rig, to judge by what a calibration promises of it.

use pinswitch_calibration::table::PlateauRow;
use pinswitch_friction::Substrate;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::plan::Plan;
use crate::protocol;
use crate::simulate::{Simulated, simulate};

/// Runs a later session of the rig of a plan: the same constants, effects and disturbances; noise, seatings, mounts,
/// turns of operators and random order are its own. Time, and with it drift and wear, begins anew.
///
/// No weight is written down wrongly: that is a slip, and nothing that a calibration could promise about the rig.
///
/// ```
/// use pinswitch_simulation::{Plan, next_session, simulate};
///
/// let plan = Plan::randomised();
/// let next = next_session(&plan);
/// assert_ne!(next.rows, simulate(&plan).rows);
/// assert_eq!(next, next_session(&plan), "the same plan makes the same rows");
/// ```
pub fn next_session(plan: &Plan) -> Simulated {
    simulate(&next_plan(plan))
}

/// The plan of the later session.
fn next_plan(plan: &Plan) -> Plan {
    let next = later(plan);
    let order = layouts(&protocol::rows(&next, &mut ChaCha8Rng::seed_from_u64(next.seed)));
    with_constants_of(next, plan, &order)
}

/// The plan of a later session of a rig in which these rows are made.
pub(crate) fn plan_for(plan: &Plan, rows: &[PlateauRow]) -> Plan {
    with_constants_of(later(plan), plan, &layouts(rows))
}

/// The same rig with noise of its own.
fn later(plan: &Plan) -> Plan {
    let mut next = plan.clone();
    // Far from the seeds that a study counts through.
    next.seed = plan.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5EC0_4D5E_5510_4E37;
    next.noise.mislabelled_series = 0;
    next
}

/// Constants of layouts are listed in the order in which the layouts are measured, which may be another now.
fn with_constants_of(mut next: Plan, plan: &Plan, order: &[Vec<usize>]) -> Plan {
    let before = layouts(&protocol::rows(plan, &mut ChaCha8Rng::seed_from_u64(plan.seed)));
    let places: Vec<usize> =
        order.iter().map(|layout| before.iter().position(|b| b == layout).unwrap_or(usize::MAX)).collect();
    let factors = &plan.constants.half_load_factor;
    next.constants.half_load_factor =
        places.iter().map(|i| factors.get(*i).copied().unwrap_or(1.0)).collect();
    next.constants.steepness = places.iter().map(|i| plan.constants.steepness_of(*i)).collect();
    next
}

/// The layouts on silicone in the order in which they are measured.
fn layouts(rows: &[PlateauRow]) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = Vec::new();
    for row in rows.iter().filter(|r| r.substrate == Some(Substrate::Silicone) && !r.pins.is_empty()) {
        if !found.contains(&row.pins) {
            found.push(row.pins.clone());
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::EffectPlan;

    /// Without noise, a reading of the later session is that of the same setting in the first.
    #[test]
    fn a_layout_keeps_its_constants_in_another_order() {
        for seed in 0..6 {
            let mut plan = Plan { seed, dwells_s: vec![3.0], speeds_pct: vec![50.0], ..Plan::randomised() };
            plan.constants.half_load_factor = vec![0.8, 1.0, 1.2];
            plan.constants.steepness = vec![4.0, 5.0];
            plan.effects.push(EffectPlan { id: "coating_ploughing".to_owned(), values: vec![0.02], form: 0 });
            let key = |r: &PlateauRow| (r.substrate, r.pins.clone(), r.load_mass_g, r.direction, r.sweep);
            let first = simulate(&plan).fresh;
            let mut compared = 0;
            for row in next_session(&plan).fresh {
                for same in first.iter().filter(|f| key(f) == key(&row)) {
                    assert!((same.force_n - row.force_n).abs() < 1e-9, "seed {seed}: {:?}", key(&row));
                    compared += 1;
                }
            }
            assert!(compared > 50, "{compared}");
        }
    }
}
