//! What a planned experiment could see and tell apart, before anything is measured.

use std::collections::BTreeMap;

use serde::Serialize;

use super::plan::{EffectPlan, Plan};
use super::simulate::simulate;
use super::study::strengths;
use pinswitch_calibration::inference::{Levels, Model, Observations, Term, select};
use pinswitch_calibration::table::Frame;

/// What the plan makes of one effect at one size.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Power {
    /// Id of the effect.
    pub id: &'static str,
    /// Its constants.
    pub values: Vec<f64>,
    /// Runs simulated.
    pub runs: usize,
    /// Runs in which it was named alone.
    pub named: usize,
    /// Runs in which it was named with rivals.
    pub ambiguous: usize,
    /// Runs in which it was not seen.
    pub missed: usize,
    /// What was named with it or instead of it, and how often.
    pub others: BTreeMap<&'static str, usize>,
}

/// Puts each effect at a small and a large typical size into the plan, `runs` times each, and calibrates.
pub fn power(plan: &Plan, runs: u64, levels: Levels) -> Vec<Power> {
    let mut all = Vec::new();
    for strength in strengths() {
        let sizes =
            if strength.size.1 > 0.0 { vec![strength.size.0, strength.size.1] } else { vec![f64::NAN] };
        for size in sizes {
            let mut values: Vec<f64> = if size.is_nan() { Vec::new() } else { vec![size] };
            values.extend(strength.shapes.iter().map(|(least, most)| 0.5 * (least + most)));
            all.push(one(plan, strength.id, values, runs, levels));
        }
    }
    all
}

fn one(plan: &Plan, id: &'static str, values: Vec<f64>, runs: u64, levels: Levels) -> Power {
    let mut power = Power {
        id,
        values: values.clone(),
        runs: 0,
        named: 0,
        ambiguous: 0,
        missed: 0,
        others: BTreeMap::new(),
    };
    for run in 0..runs {
        let mut planned = plan.clone();
        planned.seed = plan.seed.wrapping_add(run);
        planned.effects.push(EffectPlan { id: id.to_owned(), values: values.clone(), form: 0 });
        let rows = simulate(&planned).rows;
        let frame = Frame::new(&rows);
        let Some(mut data) = Observations::new(&frame, &rows) else { continue };
        let found = select(&Model::baseline(frame), &mut data, levels);
        power.runs += 1;
        let (mut alone, mut with_rivals) = (false, false);
        let names = found
            .augmented
            .model
            .terms
            .iter()
            .filter_map(|t| if let Term::Named(e) = t { Some(*e) } else { None });
        for (effect, rivals) in names.zip(&found.rivals) {
            let here = effect.id() == id || rivals.iter().any(|r| r.effect.id() == id);
            alone |= here && rivals.is_empty();
            with_rivals |= here && !rivals.is_empty();
            for other in
                std::iter::once(effect.id()).chain(rivals.iter().map(|r| r.effect.id())).filter(|o| *o != id)
            {
                *power.others.entry(other).or_default() += 1;
            }
        }
        power.named += usize::from(alone);
        power.ambiguous += usize::from(with_rivals && !alone);
        power.missed += usize::from(!alone && !with_rivals);
    }
    power
}
