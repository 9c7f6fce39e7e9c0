//! Kinds of rig in the study, and the plan of each for a seed.

use pinswitch_calibration::effects::{CATALOGUE, Covariate, PaperProtocol, effect_named};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::disturbance::{Course, Disturbance, DisturbanceTarget};
use crate::effect_forms::forms_of;
use crate::plan::{EffectPlan, Plan, Protocol};

/// What is true of a rig.
#[derive(Clone, Debug, PartialEq)]
pub enum Truth {
    /// The paper's model.
    Nothing,
    /// Effects of the vocabulary.
    Effects(Vec<&'static str>),
    /// One effect that this protocol cannot tell from another: the answer must name both.
    Confounded(&'static str),
    /// Something outside the vocabulary that lies in this covariate.
    Outside(Covariate),
}

/// One kind of rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Its effects, or what is wrong with it, in words.
    pub name: String,
    /// Its protocol.
    pub protocol: Protocol,
    /// What is true of it.
    pub truth: Truth,
}

/// Kinds of noise on rigs without any effect.
const NULLS: [&str; 4] = [
    "no effect",
    "no effect, heavy tails and outliers",
    "no effect, uneven and correlated noise",
    "no effect, one weight mislabelled",
];

/// What lies outside the vocabulary in the study.
const OUTSIDE: [(&str, Covariate); 8] = [
    ("step of friction in mid-session", Covariate::Time),
    ("step of the reading in mid-session", Covariate::Time),
    ("another level for a while", Covariate::Time),
    ("wave in time", Covariate::Time),
    ("wave along the stroke", Covariate::Position),
    ("worn spot", Covariate::Position),
    ("one defective layout", Covariate::Condition),
    ("resonance at one speed", Covariate::Speed),
];

/// Pairs of effects in the study.
const PAIRS: [(&str, &str); 4] = [
    ("substrate_saturation", "thermal_drift"),
    ("coating_ploughing", "load_cell_offset"),
    ("direction_asymmetry", "guide_drag"),
    ("coating_stiffening", "run_in"),
];

/// All kinds of rig. Effects that a protocol cannot show are left out of it.
pub fn study_cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for protocol in [Protocol::Paper, Protocol::Randomised] {
        let mut push = |name: String, truth| cases.push(Case { name, protocol, truth });
        for name in NULLS {
            push(name.to_owned(), Truth::Nothing);
        }
        for effect in CATALOGUE {
            let id = effect.id();
            let truth = match (protocol, effect.description().study.paper) {
                (Protocol::Paper, PaperProtocol::Hidden) => continue,
                (Protocol::Paper, PaperProtocol::Confounded) => Truth::Confounded(id),
                _ => Truth::Effects(vec![id]),
            };
            push(id.to_owned(), truth);
        }
        for (a, b) in PAIRS {
            push(format!("{a} + {b}"), Truth::Effects(vec![a, b]));
        }
        for (name, covariate) in OUTSIDE {
            push(name.to_owned(), Truth::Outside(covariate));
        }
    }
    cases
}

/// The plan of a case and a seed: constants, sizes, forms and noise all drawn.
pub fn plan_of(case: &Case, seed: u64) -> Plan {
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
        Truth::Nothing => null(&case.name, &mut plan),
        Truth::Effects(ids) => {
            for id in ids {
                plan.effects.extend(drawn(id, &mut random));
            }
        }
        Truth::Confounded(id) => plan.effects.extend(drawn(id, &mut random)),
        Truth::Outside(_) => {
            let layouts = plan.layouts.clone();
            plan.disturbances.push(outside(&case.name, case.protocol, &layouts, &mut random));
        }
    }
    plan
}

/// Noise of a rig without effect.
fn null(name: &str, plan: &mut Plan) {
    if name.contains("outliers") {
        plan.noise.heavy_tails = true;
        plan.noise.outlier_share = 0.01;
        plan.noise.outlier_n = 3.0;
    } else if name.contains("correlated") {
        plan.noise.autocorrelation = 0.4;
        plan.noise.uneven = 0.3;
    } else if name.contains("mislabelled") {
        plan.noise.mislabelled_series = 1;
    }
}

/// An effect with its size, shape and form drawn.
fn drawn(id: &str, random: &mut ChaCha8Rng) -> Option<EffectPlan> {
    let range = effect_named(id)?.description().study;
    let mut values = Vec::new();
    if let Some((least, most)) = range.size {
        let size = (least.ln() + (most / least).ln() * random.random::<f64>()).exp();
        values.push(if range.signed && random.random::<bool>() { -size } else { size });
    }
    values.extend(range.shapes.iter().map(|(least, most)| least + (most - least) * random.random::<f64>()));
    let form = u8::try_from(random.random_range(0..forms_of(id).len())).unwrap_or(0);
    Some(EffectPlan { id: id.to_owned(), values, form })
}

/// Something outside the vocabulary.
fn outside(name: &str, protocol: Protocol, layouts: &[Vec<usize>], random: &mut ChaCha8Rng) -> Disturbance {
    let sign = if random.random::<bool>() { 1.0 } else { -1.0 };
    let friction = random.random_range(0.08..0.25);
    let newtons = random.random_range(0.3..0.8);
    let of = |kind, target, size| Disturbance { kind, target, size };
    let phase = random.random_range(0.0..std::f64::consts::TAU);
    let even = random.random::<bool>();
    match name {
        "step of friction in mid-session" => {
            let over = if even { 0.0 } else { 0.02 };
            of(
                Course::Step { at: random.random_range(0.3..0.7), over },
                DisturbanceTarget::Friction,
                sign * friction,
            )
        }
        "step of the reading in mid-session" => of(
            Course::Step { at: random.random_range(0.3..0.7), over: 0.0 },
            DisturbanceTarget::Reading,
            sign * newtons,
        ),
        "another level for a while" => {
            let from = random.random_range(0.2..0.6);
            let to = from + random.random_range(0.1..0.3);
            of(Course::Window { from, to }, DisturbanceTarget::Reading, sign * newtons)
        }
        "wave in time" => {
            let cycles = random.random_range(3.0..40.0);
            of(Course::TimeWave { cycles, phase }, DisturbanceTarget::Reading, 0.5 * newtons)
        }
        "wave along the stroke" => {
            let cycles = random.random_range(1.5..4.5);
            of(
                Course::StrokeWave { cycles, phase, square: even },
                DisturbanceTarget::Friction,
                0.5 * friction,
            )
        }
        "worn spot" => {
            let (at, width) = (random.random_range(0.25..0.75), random.random_range(0.08..0.2));
            of(Course::Spot { at, width, flat: even }, DisturbanceTarget::Friction, friction)
        }
        "one defective layout" => {
            // With three layouts, the one with another number of pins is what bending is known by.
            let pins = layouts[random.random_range(1..layouts.len())].clone();
            let target = if even { DisturbanceTarget::Friction } else { DisturbanceTarget::Pins };
            of(Course::Layout { pins }, target, sign * friction * if even { 1.0 } else { 2.0 })
        }
        _ => {
            let (least, most, width_pct) = match protocol {
                Protocol::Paper => (49.0f64, 55.0, 0.6),
                Protocol::Randomised => (40.0, 70.0, 3.0),
            };
            let mut speed_pct = random.random_range(least..most).round();
            if protocol == Protocol::Randomised {
                speed_pct = (speed_pct / 10.0).round().clamp(5.0, 6.0) * 10.0;
            }
            of(Course::Resonance { speed_pct, width_pct }, DisturbanceTarget::Friction, friction)
        }
    }
}

#[cfg(test)]
mod tests {
    use pinswitch_calibration::table::PlateauTable;

    use super::*;

    #[test]
    fn plans_of_the_study_can_be_written_and_read() {
        for case in study_cases() {
            let plan = plan_of(&case, 3);
            let text = toml::to_string(&plan).unwrap();
            assert_eq!(Plan::parse(&text, "plan.toml").unwrap(), plan, "{}", case.name);
        }
    }

    /// FNV-1a over the tables of the cases that the study began with.
    #[test]
    fn the_first_cases_make_the_bytes_they_always_made() {
        let mut hash = 0xcbf2_9ce4_8422_2325u64;
        for case in study_cases() {
            let text = PlateauTable::write(&crate::simulate(&plan_of(&case, 3)).rows);
            hash = text.bytes().fold(hash, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
        }
        assert_eq!(hash, 0x7cd8_2337_9b64_01d8, "{hash:x}");
    }
}
