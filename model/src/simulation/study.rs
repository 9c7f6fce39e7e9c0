//! The study of the calibrator: many rigs with one known flaw each, and what the calibrator says of them.

use std::collections::BTreeMap;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::plan::{EffectPlan, Plan, Protocol, StructurePlan};
use super::rig::simulate;
use crate::calibration::Verdict;
use crate::effects::{Channel, Covariate, Shape, Structure, effect_named};
use crate::inference::{Levels, Model, Observations, Term, select};
use crate::rig::{Frame, PlateauTable};

/// One kind of rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Ids of its effects joined with `+`, `none`, or the name of what is outside the vocabulary.
    pub name: String,
    /// Its protocol.
    pub protocol: Protocol,
    /// Where its structure lies, for what is outside the vocabulary.
    pub covariate: Option<Covariate>,
}

/// Range of an effect's size and shape: typical values of effects.md, and whether the sign is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Id of the effect.
    pub id: &'static str,
    /// Smallest and largest size.
    pub size: (f64, f64),
    /// Either sign.
    pub signed: bool,
    /// Range of the shape constant, if it has one.
    pub shape: Option<(f64, f64)>,
}

const fn strength(id: &'static str, least: f64, most: f64, signed: bool) -> Strength {
    Strength { id, size: (least, most), signed, shape: None }
}

/// Sizes drawn in the study: the upper part of the typical sizes of effects.md, log-uniform.
static STRENGTHS: [Strength; 21] = [
    Strength { shape: Some((1.0, 2.0)), ..strength("coating_stiffening", 0.3, 1.2, false) },
    strength("coating_ploughing", 0.012, 0.03, false),
    strength("polygon_bending", 0.3, 1.5, false),
    Strength { shape: Some((0.0, 1.0)), ..strength("substrate_saturation", 0.12, 0.33, false) },
    strength("adhesion", 0.2, 0.6, false),
    strength("dwell_relaxation", 0.04, 0.12, true),
    Strength { shape: Some((1.5, 6.0)), ..strength("run_in", 0.05, 0.4, false) },
    Strength { shape: Some((0.2, 3.0)), ..strength("wear_drift", 0.08, 0.25, true) },
    strength("rate_dependence", 0.15, 0.5, false),
    strength("fixture_compliance", 0.06, 0.25, false),
    strength("stroke_position", 0.05, 0.2, true),
    strength("direction_asymmetry", 0.05, 0.2, true),
    strength("switching_hysteresis", 3.0, 10.0, false),
    strength("guide_drag", 0.1, 0.5, false),
    strength("load_cell_offset", 0.2, 1.5, true),
    strength("load_cell_gain", 0.01, 0.06, true),
    strength("load_cell_nonlinearity", 0.3, 1.5, true),
    strength("load_cell_saturation", 46.0, 58.0, false),
    strength("thermal_drift", 0.3, 1.5, true),
    Strength { size: (0.0, 0.0), ..strength("hook_omitted", 0.0, 0.0, false) },
    Strength { size: (0.0, 0.0), ..strength("switch_local_tension", 0.0, 0.0, false) },
];

/// Sizes of all effects.
pub(super) fn strengths() -> &'static [Strength] {
    &STRENGTHS
}

/// What lies outside the vocabulary in the study.
const OUTSIDE: [(&str, Covariate); 7] = [
    ("step of friction in mid-session", Covariate::Time),
    ("step of the reading in mid-session", Covariate::Time),
    ("wave along the stroke", Covariate::Position),
    ("wave in time", Covariate::Time),
    ("one defective layout", Covariate::Condition),
    ("worn spot", Covariate::Position),
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
        let mut push = |name: String, covariate| cases.push(Case { name, protocol, covariate });
        push("none".to_owned(), None);
        for s in STRENGTHS {
            let needs_variation = ["dwell_relaxation", "switching_hysteresis"].contains(&s.id);
            if !(needs_variation && protocol == Protocol::Paper) {
                push(s.id.to_owned(), None);
            }
        }
        for (a, b) in PAIRS {
            push(format!("{a}+{b}"), None);
        }
        for (name, covariate) in OUTSIDE {
            push(name.to_owned(), Some(covariate));
        }
    }
    cases
}

/// What the calibrator said of one rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The verdict.
    pub verdict: Verdict,
    /// What it named, `a|b` for rivals, sorted; `unattributed:covariate` for what has no name.
    pub named: Vec<String>,
    /// Root mean square errors on fresh rows, baseline and augmented, in newtons.
    pub fresh_n: [f64; 2],
    /// Whether the truth was named exactly.
    pub exact: bool,
    /// Whether every true effect is named or among the rivals, and nothing else stands alone.
    pub honest: bool,
    /// For each size of a true effect: whether its 95 % interval holds it.
    pub covered: Vec<bool>,
}

/// The plan of a case and a seed, all constants drawn.
pub fn plan_of(case: &Case, seed: u64) -> Plan {
    let mut random = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(0x9E37_79B9).wrapping_add(77));
    let mut plan = match case.protocol {
        Protocol::Paper => Plan::default(),
        Protocol::Randomised => Plan::randomised(),
    };
    plan.seed = seed;
    plan.constants.mu_p = random.random_range(0.042..0.066);
    plan.constants.mu_s = random.random_range(0.2..0.28);
    plan.constants.half_load_factor = (0..3).map(|_| random.random_range(0.88..1.12)).collect();
    plan.constants.steepness = (0..3).map(|_| random.random_range(4.0..7.0)).collect();
    plan.noise.repetition_n = random.random_range(0.04..0.12);
    plan.noise.repetition_per_load = random.random_range(0.0012..0.003);
    plan.noise.series_n = random.random_range(0.01..0.04);
    plan.noise.series_per_load = random.random_range(0.001..0.006);
    plan.noise.outlier_share = if seed.is_multiple_of(3) { 0.01 } else { 0.002 };
    plan.noise.heavy_tails = seed.is_multiple_of(5);
    plan.noise.lost_share = if seed.is_multiple_of(4) { 0.03 } else { 0.0 };
    for id in case.name.split('+') {
        if let Some(s) = STRENGTHS.iter().find(|s| s.id == id) {
            let mut values = Vec::new();
            if s.size.1 > 0.0 {
                let size = (s.size.0.ln() + (s.size.1 / s.size.0).ln() * random.random::<f64>()).exp();
                values.push(if s.signed && random.random::<bool>() { -size } else { size });
            }
            values.extend(s.shape.map(|(least, most)| random.random_range(least..most)));
            plan.effects.push(EffectPlan { id: id.to_owned(), values });
        }
    }
    if let Some(covariate) = case.covariate {
        plan.structures = outside(&case.name, covariate, case.protocol, &mut random);
    }
    plan
}

/// Structures of a case outside the vocabulary.
fn outside(
    name: &str,
    covariate: Covariate,
    protocol: Protocol,
    random: &mut ChaCha8Rng,
) -> Vec<StructurePlan> {
    let sign = if random.random::<bool>() { 1.0 } else { -1.0 };
    let one = |size: f64, channel, form| {
        vec![StructurePlan { size, structure: Structure { covariate, channel, form } }]
    };
    let friction = sign * random.random_range(0.08..0.25);
    let newtons = sign * random.random_range(0.3..0.8);
    match name {
        "step of friction in mid-session" => {
            one(friction, Channel::Friction, Shape::TimeStep { at: random.random_range(0.3..0.7) })
        }
        "step of the reading in mid-session" => {
            one(newtons, Channel::Reading, Shape::TimeStep { at: random.random_range(0.3..0.7) })
        }
        "wave along the stroke" => one(
            0.5 * friction,
            Channel::Friction,
            Shape::PositionWave { cycles: random.random_range(1.5..4.5), quarter: 0 },
        ),
        "wave in time" => one(
            0.5 * newtons,
            Channel::Reading,
            Shape::TimeWave { cycles: random.random_range(3.0..40.0), quarter: 1 },
        ),
        "one defective layout" => {
            // In the paper's order condition 1 + l and 4 + l have layout l.
            let layout = random.random_range(1..4);
            match protocol {
                Protocol::Paper => one(
                    friction,
                    Channel::Friction,
                    Shape::ConditionIs { conditions: vec![layout, layout + 3] },
                ),
                Protocol::Randomised => {
                    one(friction, Channel::Friction, Shape::ConditionIs { conditions: vec![layout] })
                }
            }
        }
        "worn spot" => one(
            friction.abs(),
            Channel::Friction,
            Shape::PositionBump {
                at: random.random_range(0.25..0.75),
                width: random.random_range(0.03..0.08),
            },
        ),
        _ => {
            // Wide enough to hold the speed it is meant for, whatever the mean speed of the session.
            let (log_speed, half_width) = match protocol {
                Protocol::Paper => ((random.random_range(49.0f64..55.0).round() / 51.9).ln(), 0.012),
                Protocol::Randomised => ((60.0f64 / 53.9).ln(), 0.08),
            };
            one(friction.abs(), Channel::Friction, Shape::SpeedLevel { log_speed, half_width })
        }
    }
}

/// Simulates one rig and calibrates it from the table's text alone.
pub fn run_case(case: &Case, seed: u64, levels: Levels) -> Outcome {
    let plan = plan_of(case, seed);
    let simulated = simulate(&plan);
    let text = PlateauTable::write(&simulated.rows);
    let rows =
        PlateauTable::read(text.as_bytes(), "simulated").map_or_else(|_| simulated.rows.clone(), |t| t.rows);
    let frame = Frame::new(&rows);
    let start = Model::baseline(frame.clone());
    let Some(mut data) = Observations::new(&frame, &rows) else {
        return Outcome {
            verdict: Verdict::None,
            named: vec!["unusable".to_owned()],
            fresh_n: [f64::NAN; 2],
            exact: false,
            honest: false,
            covered: Vec::new(),
        };
    };
    let found = select(&start, &mut data, levels);
    let error = |model: &Model| {
        let predicted = model.predict(&frame.points(&simulated.fresh).unwrap_or_default());
        let sum: f64 = predicted.iter().zip(&simulated.fresh).map(|(p, r)| (p - r.force_n).powi(2)).sum();
        (sum / predicted.len().max(1) as f64).sqrt()
    };
    let mut sets: Vec<Vec<&str>> = Vec::new();
    for (effect, rivals) in found
        .augmented
        .model
        .terms
        .iter()
        .filter_map(|t| if let Term::Named(e) = t { Some(*e) } else { None })
        .zip(&found.rivals)
    {
        let mut set = vec![effect.id()];
        set.extend(rivals.iter().map(|r| r.effect.id()));
        set.sort_unstable();
        sets.push(set);
    }
    let mut named: Vec<String> = sets.iter().map(|s| s.join("|")).collect();
    named.extend(found.structure.map(|(c, _)| format!("unattributed:{}", c.word())));
    named.sort();
    let truth: Vec<&str> = plan.effects.iter().map(|e| e.id.as_str()).collect();
    let verdict = if found.structure.is_some() {
        Verdict::Unattributed
    } else if sets.is_empty() {
        Verdict::None
    } else if sets.iter().any(|s| s.len() > 1) {
        Verdict::Ambiguous
    } else {
        Verdict::Attributed
    };
    let mut expected: Vec<String> = truth.iter().map(|t| (*t).to_owned()).collect();
    expected.extend(case.covariate.map(|c| format!("unattributed:{}", c.word())));
    expected.sort();
    let honest = found.structure.is_none() == case.covariate.is_none()
        && sets.iter().all(|s| truth.iter().any(|t| s.contains(t)))
        && truth.iter().all(|t| sets.iter().any(|s| s.contains(t)));
    let widths = crate::inference::interval_half_widths(&found.augmented, &data, found.noise);
    let names = found.augmented.model.names();
    let covered = plan
        .effects
        .iter()
        .filter_map(|e| {
            let parameter = effect_named(&e.id)?.parameters().first()?;
            let at = names.iter().position(|(n, _)| *n == format!("{}.{}", e.id, parameter.name))?;
            let value = found.augmented.model.values()[at];
            Some((value - e.values.first()?).abs() <= widths[at])
        })
        .collect();
    Outcome {
        verdict,
        exact: named == expected,
        named,
        fresh_n: [error(&found.baseline.model), error(&found.augmented.model)],
        honest,
        covered,
    }
}

/// Results by case.
#[derive(Clone, Debug, Default)]
pub struct Study {
    /// Outcomes by protocol and case.
    pub outcomes: BTreeMap<(String, String), Vec<Outcome>>,
}

impl Study {
    /// Adds an outcome.
    pub fn add(&mut self, case: &Case, outcome: Outcome) {
        let protocol = format!("{:?}", case.protocol).to_lowercase();
        self.outcomes.entry((protocol, case.name.clone())).or_default().push(outcome);
    }

    /// The confusion matrix as a table in Markdown.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "| protocol | rig | sets | exact | honest | error after/before | said instead |\n|---|---|---|---|---|---|---|\n",
        );
        for ((protocol, name), outcomes) in &self.outcomes {
            let n = outcomes.len();
            let exact = outcomes.iter().filter(|o| o.exact).count();
            let honest = outcomes.iter().filter(|o| o.exact || o.honest).count();
            let mut ratios: Vec<f64> =
                outcomes.iter().map(|o| o.fresh_n[1] / o.fresh_n[0].max(1e-9)).collect();
            ratios.sort_by(f64::total_cmp);
            let mut other: BTreeMap<String, usize> = BTreeMap::new();
            for o in outcomes.iter().filter(|o| !o.exact) {
                let said = if o.named.is_empty() { "none".to_owned() } else { o.named.join(" + ") };
                *other.entry(said).or_default() += 1;
            }
            let other: Vec<String> = other.into_iter().map(|(said, k)| format!("{said} ({k})")).collect();
            text.push_str(&format!(
                "| {protocol} | {name} | {n} | {exact} | {honest} | {:.3} | {} |\n",
                ratios.get(n / 2).copied().unwrap_or(f64::NAN),
                other.join("; ")
            ));
        }
        let all: Vec<bool> = self.outcomes.values().flatten().flat_map(|o| o.covered.clone()).collect();
        let covered = all.iter().filter(|c| **c).count();
        text.push_str(&format!("\n95 % intervals hold the true size in {covered} of {} cases.\n", all.len()));
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_of_the_study_can_be_written_and_read() {
        for case in study_cases() {
            let plan = plan_of(&case, 3);
            let text = toml::to_string(&plan).unwrap();
            assert_eq!(Plan::parse(&text, "plan.toml").unwrap(), plan, "{}", case.name);
        }
    }
}
