//! Detection rates of a planned experiment: which effects it can detect, and distinguish from
//! others.

use std::collections::BTreeMap;

use pinswitch_calibration::calibrate;
use pinswitch_calibration::effects::UNATTRIBUTED;
use schemars::JsonSchema;
use serde::Serialize;

use crate::plan::{EffectPlan, Plan};
use crate::simulate::simulate;

/// Detection rate of an effect with one size.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Power {
    /// Id of the effect.
    pub id: String,
    /// Constants of the effect.
    pub values: Vec<f64>,
    /// Number of simulated runs.
    pub runs: usize,
    /// Runs in which it was attributed alone.
    pub named: usize,
    /// Runs in which it was reported with rivals.
    pub ambiguous: usize,
    /// Runs in which it was not detected.
    pub missed: usize,
    /// Other effects that were reported or their rivals, with the number of runs.
    pub others: BTreeMap<String, usize>,
}

/// Simulates and calibrates the plan with each effect, with a small and a large typical size,
/// `runs` times each.
///
/// ```
/// use pinswitch_calibration::effects::CATALOGUE;
/// use pinswitch_simulation::{Plan, power};
///
/// // Bare silicone, with few repetitions.
/// let mut plan = Plan { layouts: Vec::new(), repetitions: [4, 4], ..Plan::default() };
/// plan.repetitions_spread = 0;
/// let table = power(&plan, 1);
/// assert!(table.len() > CATALOGUE.len(), "two sizes of each effect");
/// let dwell = table.iter().find(|p| p.id == "dwell_relaxation").ok_or("not in the catalogue")?;
/// assert_eq!(dwell.missed, dwell.runs, "the plan has a single dwell");
/// # Ok::<(), &str>(())
/// ```
pub fn power(plan: &Plan, runs: u64) -> Vec<Power> {
    let mut all = Vec::new();
    for effect in plan.vocabulary.effects() {
        let range = effect.description().study;
        let sizes = range.size.map_or(vec![None], |(least, most)| vec![Some(least), Some(most)]);
        for size in sizes {
            all.push(one(plan, effect.id(), range.values_at(size), runs));
        }
    }
    all
}

/// Simulates and calibrates the plan with one effect.
fn one(plan: &Plan, id: &str, values: Vec<f64>, runs: u64) -> Power {
    let mut power = Power {
        id: id.to_owned(),
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
        let Ok(calibration) = calibrate(&rows, &plan.vocabulary, planned.seed) else { continue };
        power.runs += 1;
        let (mut alone, mut with_rivals) = (false, false);
        for effect in calibration.report.effects.iter().filter(|effect| effect.id != UNATTRIBUTED) {
            let ids = || std::iter::once(&effect.id).chain(effect.rivals.iter().map(|rival| &rival.id));
            let is_here = ids().any(|named| named == id);
            alone |= is_here && effect.rivals.is_empty();
            with_rivals |= is_here && !effect.rivals.is_empty();
            for other in ids().filter(|other| *other != id) {
                *power.others.entry(other.clone()).or_default() += 1;
            }
        }
        power.named += usize::from(alone);
        power.ambiguous += usize::from(with_rivals && !alone);
        power.missed += usize::from(!alone && !with_rivals);
    }
    power
}
