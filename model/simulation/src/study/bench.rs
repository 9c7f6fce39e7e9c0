//! Rigs of a small bench: about 250 rows (420 with two layouts) at four or five loads, with heavy-tailed noise, a load cell
//! with coarse steps, and mounts and tendon seatings that differ.

use pinswitch_calibration::effects::Covariate;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::case::{Case, Group, Truth};
use super::cases::draw_effect;
use super::nulls::everything_at_once;
use crate::disturbance::{Disturbance, DisturbanceKind, DisturbanceTarget, OperatorSchedule};
use crate::plan::{ColumnsPlan, NoisePlan, Plan, Protocol};

/// Single effects.
const SINGLES: [&str; 8] = [
    "guide_drag",
    "load_cell_offset",
    "load_cell_gain",
    "coating_ploughing",
    "run_in",
    "thermal_drift",
    "stroke_position",
    "direction_asymmetry",
];

/// Pairs of effects.
const PAIRS: [[&str; 2]; 3] = [
    ["run_in", "load_cell_offset"],
    ["guide_drag", "load_cell_gain"],
    ["coating_ploughing", "thermal_drift"],
];

/// Disturbances outside the vocabulary, with the covariates of a correct answer.
const OUTSIDE: [(&str, &[Covariate]); 5] = [
    ("one layout off", &[Covariate::Condition]),
    ("alternating readings", &[Covariate::Repetition]),
    ("wave along the stroke", &[Covariate::Position]),
    ("step in time", &[Covariate::Time]),
    ("two operators", &Covariate::ALL),
];

/// Loads in grams.
const WEIGHTS_G: [&[f64]; 2] = [&[300.0, 1300.0, 2800.0, 4600.0], &[250.0, 1100.0, 2200.0, 3400.0, 4700.0]];

/// Returns the kinds of rig.
pub(super) fn bench_cases() -> Vec<Case> {
    let case = |name: &str, group, truth| Case {
        name: format!("bench, {name}"),
        protocol: Protocol::Randomised,
        group,
        truth,
        every_noise: false,
    };
    let mut cases = vec![case("no effect", Group::BenchNulls, Truth::Nothing)];
    cases.extend(SINGLES.map(|id| case(id, Group::BenchSingles, Truth::Effects(vec![id]))));
    cases.extend(PAIRS.map(|ids| case(&ids.join(" + "), Group::BenchPairs, Truth::Effects(ids.to_vec()))));
    cases.extend(OUTSIDE.map(|(name, covariates)| {
        let or_named = (name == "two operators").then_some("load_cell_offset");
        case(name, Group::BenchOutside, Truth::Outside { covariates, or_named })
    }));
    cases
}

/// Returns the plan of a kind and a seed; `None` for kinds of another rig.
pub(super) fn bench_plan(case: &Case, seed: u64) -> Option<Plan> {
    let name = case.name.strip_prefix("bench, ")?;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut layouts = vec![vec![5, 8, 11], vec![6, 8, 10]];
    // With a single layout, its defect would be that of all pins.
    let defective = layouts[random.random_range(0..2)].clone();
    if name != "one layout off" {
        layouts.retain(|layout| *layout == defective);
    }
    let weights_g = if layouts.len() > 1 { WEIGHTS_G[0] } else { WEIGHTS_G[random.random_range(0..2)] };
    let mut plan = Plan {
        seed,
        layouts,
        weights_g: weights_g.to_vec(),
        speeds_pct: vec![50.0],
        dwells_s: vec![3.0],
        repetitions: [4, 5],
        repetitions_spread: 3,
        columns: ColumnsPlan { mount: true, operator: name == "two operators" },
        ..Plan::randomised()
    };
    plan.constants.mu_p = random.random_range(0.042..0.066);
    plan.constants.mu_s = random.random_range(0.2..0.28);
    plan.constants.half_load_factor = (0..2).map(|_| random.random_range(0.85..1.15)).collect();
    plan.constants.steepness = (0..2).map(|_| random.random_range(4.0..7.0)).collect();
    plan.noise = NoisePlan {
        repetition_n: random.random_range(0.02..0.06),
        repetition_per_load: random.random_range(0.001..0.003),
        series_n: random.random_range(0.01..0.04),
        series_per_load: 0.001,
        outlier_share: 0.0,
        heavy_tails: true,
        autocorrelation: [0.0, 0.4][random.random_range(0..2)],
        series_scale: random.random_range(0.0..0.01),
        mount_scale: random.random_range(0.0..0.015),
        resolution_n: [0.01, 0.02, 0.05][random.random_range(0..3)],
        ..NoisePlan::default()
    };
    if let Truth::Effects(ids) = &case.truth {
        plan.effects.extend(ids.iter().filter_map(|id| draw_effect(id, None, &mut random)));
    }
    let friction = random.random_range(0.1..0.25);
    let sign = if random.random() { 1.0 } else { -1.0 };
    let phase = random.random_range(0.0..std::f64::consts::TAU);
    let mut disturb = |kind, target, size| plan.disturbances.push(Disturbance { kind, target, size });
    match name {
        "one layout off" => {
            disturb(
                DisturbanceKind::Layout { pins: defective },
                DisturbanceTarget::Friction,
                sign * friction,
            );
        }
        "alternating readings" => {
            disturb(DisturbanceKind::Alternation, DisturbanceTarget::Friction, 0.3 * friction)
        }
        "wave along the stroke" => {
            let kind =
                DisturbanceKind::StrokeWave { cycles: random.random_range(1.0..2.0), phase, square: false };
            disturb(kind, DisturbanceTarget::Friction, 0.5 * friction);
        }
        "step in time" => {
            let kind = DisturbanceKind::Step { at: random.random_range(0.3..0.7), over: 0.0 };
            disturb(kind, DisturbanceTarget::Friction, sign * friction);
        }
        "two operators" => {
            let kind = DisturbanceKind::Operators { turns: OperatorSchedule::Series };
            disturb(kind, DisturbanceTarget::Reading, sign * 2.0 * friction);
        }
        _ => {}
    }
    if case.every_noise {
        everything_at_once(&mut plan.noise, &mut random);
    }
    Some(plan)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::simulate;

    #[test]
    fn bench_tables_are_small() {
        for case in bench_cases() {
            let plan = bench_plan(&case, 3).unwrap();
            plan.check(&case.name).unwrap();
            let rows = simulate(&plan).rows.len();
            assert!((180..450).contains(&rows), "{}: {rows} rows", case.name);
            if let Truth::Outside { covariates, .. } = case.truth {
                assert_eq!(plan.disturbances[0].covariates(), covariates, "{}", case.name);
            }
        }
    }
}
