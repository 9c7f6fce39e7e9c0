//! Kinds of rig in the study, and the random plan of each.

use pinswitch_calibration::effects::{CATALOGUE, Covariate, PaperProtocol, effect_named};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::bench::{bench_cases, bench_plan};
use super::case::{Case, Group, Truth};
use super::masks::{drag_n, masked, sizes};
use super::nulls::{self, NULLS};
use super::outside::{LATER, OUTSIDE, outside};
use crate::effect_forms::forms_of;
use crate::plan::{EffectPlan, Plan, Protocol};

/// Pairs of effects in the study.
const PAIRS: [(&str, &str); 4] = [
    ("substrate_saturation", "thermal_drift"),
    ("coating_ploughing", "load_cell_offset"),
    ("direction_asymmetry", "guide_drag"),
    ("coating_stiffening", "run_in"),
];

/// Small effects that are confounded with another in the paper's protocol, with their sizes.
const SMALL: [(&str, &str, f64); 2] =
    [("rate_dependence", "fixture_compliance", 0.2), ("fixture_compliance", "rate_dependence", 0.05)];

/// Returns all kinds of rig, without effects that are invisible in the protocol.
pub fn study_cases() -> Vec<Case> {
    let protocols = || [Protocol::Paper, Protocol::Randomised].into_iter();
    let later = protocols()
        .flat_map(|protocol| LATER.map(|(name, covariates)| outside_case(name, covariates, protocol)));
    protocols().flat_map(cases_of).chain(later).chain(bench_cases()).collect()
}

fn outside_case(name: &str, covariates: &'static [Covariate], protocol: Protocol) -> Case {
    let or_named = (name == "two operators").then_some("load_cell_offset");
    let truth = Truth::Outside { covariates, or_named };
    Case { name: name.to_owned(), protocol, group: Group::Outside, truth, every_noise: false }
}

fn cases_of(protocol: Protocol) -> Vec<Case> {
    let mut cases = Vec::new();
    let mut push = |group, name: String, truth| {
        cases.push(Case { name, protocol, group, truth, every_noise: false });
    };
    for (name, _) in NULLS {
        push(Group::Nulls, name.to_owned(), Truth::Nothing);
    }
    let mut scattered = Vec::new();
    for effect in CATALOGUE {
        let id = effect.id();
        let (group, truth) = match (protocol, effect.description().study.paper) {
            (Protocol::Paper, PaperProtocol::Hidden) => continue,
            (Protocol::Paper, PaperProtocol::Confounded) => (Group::Confounded, Truth::Confounded(vec![id])),
            _ => (Group::Singles, Truth::Effects(vec![id])),
        };
        push(group, id.to_owned(), truth.clone());
        scattered.push((format!("{id} under scatter"), truth));
    }
    for (name, truth) in scattered {
        push(Group::Scattered, name, truth);
    }
    for (a, b) in PAIRS {
        push(Group::Pairs, format!("{a} + {b}"), Truth::Effects(vec![a, b]));
    }
    for (name, truth) in masked(protocol) {
        push(Group::Masks, name, truth);
    }
    if protocol == Protocol::Paper {
        for (id, rival, size) in SMALL {
            push(Group::Confounded, format!("small {id} of {size}"), Truth::SmallConfounded([id, rival]));
        }
    }
    cases.extend(OUTSIDE.map(|(name, covariates)| outside_case(name, covariates, protocol)));
    cases
}

/// Returns the plan of a kind and a seed, with random constants, sizes, forms and noise.
pub fn plan_of(case: &Case, seed: u64) -> Plan {
    if let Some(plan) = bench_plan(case, seed) {
        return plan;
    }
    let mut random = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(0x9E37_79B9).wrapping_add(77));
    let mut plan = match case.protocol {
        Protocol::Paper => Plan::default(),
        Protocol::Randomised => Plan::randomised(),
    };
    plan.seed = seed;
    plan.constants.mu_p = random.random_range(0.042..0.066);
    plan.constants.mu_s = random.random_range(0.2..0.28);
    plan.constants.half_load_factor = (0..3).map(|_| random.random_range(0.85..1.15)).collect();
    plan.constants.steepness = (0..3).map(|_| random.random_range(4.0..7.0)).collect();
    plan.noise.repetition_n = random.random_range(0.04..0.12);
    plan.noise.repetition_per_load = random.random_range(0.0012..0.003);
    plan.noise.series_n = random.random_range(0.01..0.04);
    plan.noise.series_per_load = random.random_range(0.001..0.006);
    plan.noise.outlier_share = if seed.is_multiple_of(3) { 0.01 } else { 0.002 };
    plan.noise.heavy_tails = seed.is_multiple_of(5);
    plan.noise.uneven = if seed.is_multiple_of(2) { 0.15 } else { 0.0 };
    plan.noise.lost_share = if seed.is_multiple_of(4) { 0.03 } else { 0.0 };
    match &case.truth {
        Truth::Nothing => nulls::apply(&case.name, &mut plan.noise, &mut random),
        Truth::Effects(ids) | Truth::Confounded(ids) => {
            let drag_n = drag_n(&case.name);
            for id in ids {
                plan.effects.extend(match drag_n {
                    Some(n) if *id == "guide_drag" => draw_effect(id, Some((n, n)), &mut random),
                    Some(_) => draw_effect(id, sizes(id, case.protocol), &mut random),
                    None => draw_effect(id, None, &mut random),
                });
            }
        }
        Truth::SmallConfounded([id, _]) => {
            let size = SMALL.iter().find(|s| s.0 == *id).map(|s| (s.2, s.2));
            plan.effects.extend(draw_effect(id, size, &mut random));
        }
        Truth::Outside { .. } => {
            let layouts = plan.layouts.clone();
            plan.disturbances.push(outside(&case.name, case.protocol, &layouts, &mut random));
        }
    }
    if case.group == Group::Scattered {
        plan.noise.series_scale = random.random_range(0.01..0.02);
    }
    if case.every_noise {
        nulls::everything_at_once(&mut plan.noise, &mut random);
    }
    plan.shuffled = is_shuffled(case, seed);
    plan
}

/// Whether all series of a randomised rig are in random order: always if the previous load matters,
/// and in half of the rigs with random effects of series or masked effects.
fn is_shuffled(case: &Case, seed: u64) -> bool {
    let half = matches!(case.group, Group::Scattered | Group::Masks) || case.name.contains("series scale");
    let always = case.name == "memory of the load before";
    case.protocol == Protocol::Randomised && (always || half && (seed / 2).is_multiple_of(2))
}

/// Draws size, shape and form of an effect; the range of the size is that of the study, unless
/// `sizes` is given.
pub(super) fn draw_effect(
    id: &str,
    sizes: Option<(f64, f64)>,
    random: &mut ChaCha8Rng,
) -> Option<EffectPlan> {
    let range = effect_named(id)?.description().study;
    let mut values = Vec::new();
    if let Some((least, most)) = sizes.or(range.size) {
        let size = (least.ln() + (most / least).ln() * random.random::<f64>()).exp().clamp(least, most);
        values.push(if range.signed && random.random::<bool>() { -size } else { size });
    }
    values.extend(range.shapes.iter().map(|(least, most)| least + (most - least) * random.random::<f64>()));
    let form = u8::try_from(random.random_range(0..forms_of(id).len())).unwrap_or(0);
    Some(EffectPlan { id: id.to_owned(), values, form })
}

#[cfg(test)]
mod tests {
    use pinswitch_calibration::table::PlateauTable;

    use super::*;
    use crate::simulate::simulate;

    #[test]
    fn plans_round_trip_through_toml() {
        for case in study_cases() {
            let plan = plan_of(&case, 3);
            let text = toml::to_string(&plan).unwrap();
            assert_eq!(Plan::parse(&text, "plan.toml").unwrap(), plan, "{}", case.name);
        }
    }

    /// Returns the kinds of the first study.
    fn first_kinds() -> impl Iterator<Item = Case> {
        let first = |case: &Case| match case.group {
            Group::Nulls => NULLS[..4].iter().any(|k| k.0 == case.name),
            Group::Outside => OUTSIDE[..8].iter().any(|k| k.0 == case.name),
            Group::Scattered | Group::Masks => false,
            Group::BenchNulls | Group::BenchSingles | Group::BenchPairs | Group::BenchOutside => false,
            Group::Confounded => !case.name.starts_with("small"),
            Group::Singles | Group::Pairs => true,
        };
        study_cases().into_iter().filter(first)
    }

    /// FNV-1a hash of the tables: the results of earlier and later studies stay comparable.
    #[test]
    fn tables_of_first_kinds_are_unchanged() {
        assert_eq!(first_kinds().count(), 72);
        let mut hash = 0xcbf2_9ce4_8422_2325u64;
        for case in first_kinds() {
            let text = PlateauTable::write(&simulate(&plan_of(&case, 3)).rows);
            hash = text.bytes().fold(hash, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
        }
        assert_eq!(hash, 0x7cd8_2337_9b64_01d8, "{hash:x}");
    }

    #[test]
    fn plans_match_their_names() {
        let plan = |name: &str, protocol| {
            let case = study_cases().into_iter().find(|c| c.name == name && c.protocol == protocol);
            plan_of(&case.unwrap(), 4)
        };
        let mask = plan("guide_drag of 10 N + load_cell_gain", Protocol::Randomised);
        assert_eq!(mask.effects[0].values, [10.0]);
        assert!((0.03..0.06).contains(&mask.effects[1].values[0].abs()));
        assert_eq!(plan("small rate_dependence of 0.2", Protocol::Paper).effects[0].values[0].abs(), 0.2);
        assert_eq!(plan("no effect, series scale 5 %", Protocol::Paper).noise.series_scale, 0.05);
        let scattered = plan("run_in under scatter", Protocol::Randomised);
        assert!((0.01..0.02).contains(&scattered.noise.series_scale) && scattered.effects.len() == 1);
        assert!(plan("memory of the load before", Protocol::Randomised).shuffled);
        for case in study_cases() {
            let plan = plan_of(&case, 4);
            plan.check(&case.name).unwrap();
            if let Truth::Outside { covariates, .. } = case.truth {
                assert_eq!(plan.disturbances[0].covariates(), covariates, "{}", case.name);
            }
        }
    }

    #[test]
    fn every_noise_applies_to_all_kinds() {
        for case in study_cases() {
            let noise = plan_of(&Case { every_noise: true, ..case }, 4).noise;
            assert!((0.01..0.04).contains(&noise.series_scale) && (0.01..0.03).contains(&noise.mount_scale));
            assert!(
                noise.series_walk > 0.0
                    && noise.autocorrelation > 0.0
                    && noise.heavy_tails
                    && noise.resolution_n > 0.0
            );
        }
    }

    #[test]
    fn words_match_groups_or_names() {
        let matches = |word: &str| study_cases().iter().filter(|c| c.matches(word)).count();
        assert_eq!(matches("nulls"), 2 * NULLS.len());
        assert_eq!(matches("masks"), 21);
        assert_eq!(matches("worn spot"), 2);
        assert!(matches("singles") > 30 && matches("scattered") >= matches("singles"));
        assert_eq!(matches("an unknown kind"), 0);
    }
}
