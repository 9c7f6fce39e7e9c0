//! Random effects of the series of a session: mount, operator, tendon seating and offset.
//!
//! Each random effect has a separate stream of random numbers, so that enabling one does not change
//! the others.

use std::collections::{BTreeMap, BTreeSet};

use pinswitch_calibration::table::PlateauRow;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::disturbance::{DisturbanceKind, OperatorSchedule};
use crate::plan::{ColumnsPlan, Plan};

/// Streams of random numbers, in addition to stream 0 of all other random numbers.
const SERIES_SCALE: u64 = 1;
const MOUNT_SCALE: u64 = 2;
const COMMON_OFFSET: u64 = 3;
const OPERATORS: u64 = 4;

/// Mount, operator and random effects of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesTraits {
    /// Number of the mount, from 1; a new one begins whenever the condition changes.
    pub mount: u32,
    /// Operator: 1 or 2.
    pub operator: u32,
    /// Factor of mount and series on all friction.
    pub friction_factor: f64,
    /// Offset of both directions, in its standard deviations.
    pub common_offset: f64,
}

impl Default for SeriesTraits {
    fn default() -> Self {
        Self { mount: 1, operator: 1, friction_factor: 1.0, common_offset: 0.0 }
    }
}

/// Traits of the series of a session, by the name of the series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SessionTraits(BTreeMap<String, SeriesTraits>);

impl SessionTraits {
    /// Draws the traits for a session whose rows are in the order of time.
    pub(crate) fn draw(plan: &Plan, session: &[PlateauRow]) -> Self {
        let stream = |number| {
            let mut random = ChaCha8Rng::seed_from_u64(plan.seed);
            random.set_stream(number);
            random
        };
        let mut seats = stream(SERIES_SCALE);
        let mut mounts = stream(MOUNT_SCALE);
        let mut offsets = Ar1::new(plan.noise.series_walk, stream(COMMON_OFFSET));
        let mut operators = Operators::new(plan, session, stream(OPERATORS));
        let mut traits = BTreeMap::new();
        let mut before: Option<&PlateauRow> = None;
        let (mut mount, mut wrap) = (0, 0.0);
        for row in session {
            if before.is_some_and(|b| b.series == row.series) {
                continue;
            }
            if before.is_none_or(|b| (b.substrate, &b.pins) != (row.substrate, &row.pins)) {
                mount += 1;
                wrap = plan.noise.mount_scale * normal(&mut mounts);
            }
            before = Some(row);
            let seat = plan.noise.series_scale * normal(&mut seats);
            let series = SeriesTraits {
                mount,
                operator: operators.next(),
                friction_factor: (wrap + seat).exp(),
                common_offset: offsets.next(),
            };
            traits.insert(row.series.clone(), series);
        }
        Self(traits)
    }

    /// Returns the traits of a series.
    pub fn of(&self, series: &str) -> SeriesTraits {
        self.0.get(series).copied().unwrap_or_default()
    }

    /// Returns the same traits without random effects on friction.
    pub(crate) fn without_friction_factors(&self) -> Self {
        let ideal = |traits: &SeriesTraits| SeriesTraits { friction_factor: 1.0, ..*traits };
        Self(self.0.iter().map(|(series, traits)| (series.clone(), ideal(traits))).collect())
    }

    /// Adds the optional columns to the CSV text of these rows.
    pub(crate) fn add_columns(&self, columns: ColumnsPlan, rows: &[PlateauRow], text: String) -> String {
        if columns.is_empty() {
            return text;
        }
        let optional = [("mount", columns.mount), ("operator", columns.operator)];
        let names = optional.iter().filter(|c| c.1).fold(String::new(), |line, c| line + "," + c.0);
        let cells = rows.iter().map(|row| {
            let traits = self.of(&row.series);
            [traits.mount, traits.operator]
                .iter()
                .zip(optional)
                .filter(|(_, c)| c.1)
                .fold(String::new(), |line, (value, _)| format!("{line},{value}"))
        });
        // The names of simulated series are numbers, so that a line of text is a row.
        text.lines()
            .zip(std::iter::once(names).chain(cells))
            .map(|(line, more)| format!("{line}{more}\n"))
            .collect()
    }
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

/// AR(1) process with unit variance.
#[derive(Debug)]
pub(crate) struct Ar1 {
    correlation: f64,
    last: Option<f64>,
    random: ChaCha8Rng,
}

impl Ar1 {
    fn new(correlation: f64, random: ChaCha8Rng) -> Self {
        Self { correlation, last: None, random }
    }

    fn next(&mut self) -> f64 {
        let unit = normal(&mut self.random);
        let value = ar1_step(self.correlation, self.last, unit);
        self.last = Some(value);
        value
    }
}

/// Returns the next value of an AR(1) process with unit variance, from a unit normal number; the
/// first value is that number.
pub(crate) fn ar1_step(correlation: f64, last: Option<f64>, unit: f64) -> f64 {
    last.map_or(unit, |last| correlation * last + (1.0 - correlation * correlation).sqrt() * unit)
}

/// Operators of the series, in order.
struct Operators {
    turns: Option<OperatorSchedule>,
    random: ChaCha8Rng,
    begins: bool,
    half: usize,
    served: usize,
}

impl Operators {
    fn new(plan: &Plan, session: &[PlateauRow], mut random: ChaCha8Rng) -> Self {
        let turns = plan.disturbances.iter().find_map(|d| match d.kind {
            DisturbanceKind::Operators { turns } => Some(turns),
            _ => None,
        });
        let series: BTreeSet<&str> = session.iter().map(|r| r.series.as_str()).collect();
        let begins = random.random();
        Self { turns, random, begins, half: series.len() / 2, served: 0 }
    }

    fn next(&mut self) -> u32 {
        let first_half = self.served < self.half;
        self.served += 1;
        let second = match self.turns {
            None => false,
            Some(OperatorSchedule::Series) => self.random.random(),
            Some(OperatorSchedule::Half) => first_half == self.begins,
        };
        1 + u32::from(second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disturbance::{Disturbance, DisturbanceTarget};

    fn traits(plan: &Plan) -> Vec<SeriesTraits> {
        let rows = crate::protocol::rows(plan, &mut ChaCha8Rng::seed_from_u64(plan.seed));
        let traits = SessionTraits::draw(plan, &rows);
        let mut names: Vec<&str> = rows.iter().map(|r| r.series.as_str()).collect();
        names.dedup();
        names.into_iter().map(|n| traits.of(n)).collect()
    }

    fn sd(values: &[f64]) -> f64 {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
    }

    /// Returns values of many seeds, with one repetition per series.
    fn over_seeds(plan: &Plan, of: impl Fn(Vec<SeriesTraits>) -> Vec<f64>) -> Vec<f64> {
        (0..300).flat_map(|seed| of(traits(&Plan { seed, repetitions: [1, 1], ..plan.clone() }))).collect()
    }

    #[test]
    fn random_effects_have_the_planned_scatter() {
        let logs = |traits: Vec<SeriesTraits>| traits.iter().map(|m| m.friction_factor.ln()).collect();
        let mut plan = Plan::randomised();
        assert!(over_seeds(&plan, logs).iter().all(|v| *v == 0.0));
        plan.noise.series_scale = 0.03;
        assert!((sd(&over_seeds(&plan, logs)) / 0.03 - 1.0).abs() < 0.03);
        (plan.noise.series_scale, plan.noise.mount_scale) = (0.0, 0.04);
        assert!((sd(&over_seeds(&plan, logs)) / 0.04 - 1.0).abs() < 0.05);
        let common = |traits: Vec<SeriesTraits>| traits.iter().map(|m| m.common_offset).collect();
        assert!((sd(&over_seeds(&plan, common)) - 1.0).abs() < 0.03);
    }

    #[test]
    fn offsets_have_the_planned_correlation() {
        for walk in [0.0, 0.8] {
            let mut plan = Plan::default();
            plan.noise.series_walk = walk;
            let products = over_seeds(&plan, |traits| {
                traits.windows(2).map(|m| m[0].common_offset * m[1].common_offset).collect()
            });
            let correlation = products.iter().sum::<f64>() / products.len() as f64;
            assert!((correlation - walk).abs() < 0.05, "{correlation} instead of {walk}");
        }
    }

    #[test]
    fn mounts_change_with_the_condition() {
        let mut plan = Plan::randomised();
        plan.noise.mount_scale = 0.02;
        let once = traits(&plan);
        assert_eq!(once.last().map(|m| m.mount), Some(7));
        for pair in once.windows(2) {
            assert_eq!(pair[0].mount == pair[1].mount, pair[0].friction_factor == pair[1].friction_factor);
        }
        plan.shuffled = true;
        assert!(traits(&plan).last().is_some_and(|m| m.mount > 50));
    }

    #[test]
    fn operators_follow_their_schedule() {
        let of = |turns| {
            let mut plan = Plan { seed: 3, ..Plan::randomised() };
            let kind = DisturbanceKind::Operators { turns };
            plan.disturbances.push(Disturbance { kind, target: DisturbanceTarget::Reading, size: 0.5 });
            traits(&plan).iter().map(|m| m.operator).collect::<Vec<_>>()
        };
        let changes = |turns: &[u32]| turns.windows(2).filter(|w| w[0] != w[1]).count();
        assert_eq!(changes(&of(OperatorSchedule::Half)), 1);
        let by_series = of(OperatorSchedule::Series);
        assert!((50..104).contains(&changes(&by_series)), "{by_series:?}");
        assert!(traits(&Plan::randomised()).iter().all(|m| m.operator == 1));
    }
}
