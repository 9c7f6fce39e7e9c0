//! What a planned experiment could see and tell apart, before anything is measured.

use std::collections::BTreeMap;

use pinswitch_calibration::inference::{Levels, Model, Observations, select};
use pinswitch_calibration::table::Frame;
use serde::Serialize;

use crate::plan::{EffectPlan, Plan};
use crate::simulate::simulate;

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
///
/// ```
/// use pinswitch_calibration::effects::CATALOGUE;
/// use pinswitch_calibration::inference::Levels;
/// use pinswitch_simulation::{Plan, power};
///
/// // Silicone alone, a few repetitions: what could such a session see?
/// let plan = Plan { layouts: Vec::new(), repetitions: [4, 4], repetitions_spread: 0, ..Plan::default() };
/// let table = power(&plan, 1, Levels::default());
/// assert!(table.len() > CATALOGUE.len(), "each effect at a small and a large size");
/// let dwell = table.iter().find(|p| p.id == "dwell_relaxation").ok_or("not in the catalogue")?;
/// assert_eq!(dwell.missed, dwell.runs, "one dwell cannot show it");
/// # Ok::<(), &str>(())
/// ```
pub fn power(plan: &Plan, runs: u64, levels: Levels) -> Vec<Power> {
    let mut all = Vec::new();
    for effect in plan.vocabulary.effects() {
        let range = effect.description().study;
        let sizes = range.size.map_or(vec![None], |(least, most)| vec![Some(least), Some(most)]);
        for size in sizes {
            all.push(one(plan, effect.id(), range.values_at(size), runs, levels));
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
        let found = select(&Model::baseline(frame).among(&plan.vocabulary), &mut data, levels);
        power.runs += 1;
        let (mut alone, mut with_rivals) = (false, false);
        for effect in &found.effects {
            let ids = effect.ids();
            let here = ids.contains(&id);
            alone |= here && effect.rivals.is_empty();
            with_rivals |= here && !effect.rivals.is_empty();
            for other in ids.into_iter().filter(|other| *other != id) {
                *power.others.entry(other).or_default() += 1;
            }
        }
        power.named += usize::from(alone);
        power.ambiguous += usize::from(with_rivals && !alone);
        power.missed += usize::from(!alone && !with_rivals);
    }
    power
}
