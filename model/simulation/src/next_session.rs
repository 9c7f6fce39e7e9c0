//! A later session of the same rig, for comparison with the predictions of a calibration.

use pinswitch_calibration::table::PlateauRow;
use pinswitch_friction::Substrate;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::plan::Plan;
use crate::protocol;
use crate::simulate::{SimulatedSession, simulate};

/// Simulates a later session of the rig of a plan.
///
/// Constants, effects and disturbances are the same. Noise, tendon seatings, mounts, operators and
/// random order are drawn again, and time starts at zero, and with it drift and wear. No weight is
/// mislabelled: a mislabelled weight is an error of one session, not a property of the rig.
///
/// ```
/// use pinswitch_simulation::{Plan, next_session, simulate};
///
/// let plan = Plan::randomised();
/// let next = next_session(&plan);
/// assert_ne!(next.rows, simulate(&plan).rows);
/// assert_eq!(next, next_session(&plan), "the same plan makes the same rows");
/// ```
pub fn next_session(plan: &Plan) -> SimulatedSession {
    simulate(&next_plan(plan))
}

/// Returns the plan of the later session.
fn next_plan(plan: &Plan) -> Plan {
    let next = later(plan);
    let order = layouts(&protocol::rows(&next, &mut ChaCha8Rng::seed_from_u64(next.seed)));
    with_constants_of(next, plan, &order)
}

/// Returns the plan of a later session with these rows.
pub(crate) fn plan_for(plan: &Plan, rows: &[PlateauRow]) -> Plan {
    with_constants_of(later(plan), plan, &layouts(rows))
}

/// Returns the same rig with another seed.
fn later(plan: &Plan) -> Plan {
    let mut next = plan.clone();
    // Far from the consecutive seeds of a study.
    next.seed = plan.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5EC0_4D5E_5510_4E37;
    next.noise.mislabelled_series = 0;
    next
}

/// Reorders the constants of layouts: they are listed in the order of measurement, which can differ
/// between sessions.
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

/// Returns the layouts on silicone in the order of measurement.
fn layouts(rows: &[PlateauRow]) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = Vec::new();
    for row in rows.iter().filter(|r| r.substrate == Some(Substrate::Silicone) && !r.pins.is_empty()) {
        if !all.contains(&row.pins) {
            all.push(row.pins.clone());
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::EffectPlan;

    /// Without noise, readings with the same settings are equal in both sessions.
    #[test]
    fn layouts_keep_their_constants() {
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
