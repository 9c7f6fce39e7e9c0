//! The probability that a made part meets the request. Every draw is a simulated part with its own
//! dimensions, constants and model error, and a complete prediction.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

use super::candidate::{Draw, Trial};
use crate::config::Configuration;
use crate::parallel::map_each;
use crate::request::SOURCES;

/// The probability of meeting a request, estimated from simulated parts.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Probability {
    /// Share of draws that meet all targets.
    pub all: f64,
    /// Share of draws that meet each target.
    pub each: Vec<f64>,
    /// 2.5 % and 97.5 % quantiles of each target.
    pub band: Vec<[f64; 2]>,
    /// Number of draws that could be predicted.
    pub draws: usize,
}

impl Probability {
    /// Returns the standard error of `all` for this number of draws.
    pub fn standard_error(&self) -> f64 {
        (self.all * (1.0 - self.all) / self.draws.max(1) as f64).sqrt()
    }
}

/// Returns the draws of a seed. They are the same for every candidate, so that all candidates are
/// compared on the same parts. Each standard normal variable has one value in each of `count`
/// equally probable intervals (a Latin hypercube), since independent draws give quantiles with
/// errors of several percent.
pub(super) fn draws(seed: u64, count: usize, constants: usize) -> Vec<Draw> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::standard();
    let mut column = || -> Vec<f64> {
        let mut column: Vec<f64> = (0..count)
            .map(|i| normal.inverse_cdf((i as f64 + random.random_range(0.01..0.99)) / count as f64))
            .collect();
        column.shuffle(&mut random);
        column
    };
    let columns: Vec<Vec<f64>> = (0..constants + 1 + SOURCES).map(|_| column()).collect();
    (0..count)
        .map(|i| Draw {
            constants: columns[..constants].iter().map(|c| c[i]).collect(),
            model: columns[constants][i],
            made: std::array::from_fn(|source| columns[constants + 1 + source][i]),
        })
        .collect()
}

/// Returns the probability that a made part of `configuration` meets the request; `None` if it
/// cannot be predicted.
pub(super) fn probability(
    trial: &Trial<'_>,
    configuration: &Configuration,
    draws: &[Draw],
) -> Option<Probability> {
    let part = trial.part(configuration)?;
    let mut believed = trial.believed(&part)?;
    let (error, next) = (believed.error()?, believed.middle.switching()?.next);
    let hardness = configuration.silicone.hardness_shore_a;
    // A part without an equilibrium is excluded, since it carries no information about the request.
    let made: Vec<Vec<f64>> =
        map_each(draws.iter().collect(), |draw| trial.made(&part, hardness, (&error, next), draw))
            .into_iter()
            .flatten()
            .collect();
    let count = made.len();
    if count == 0 {
        return None;
    }
    let share = |met: usize| met as f64 / count as f64;
    let targets = &trial.request.targets;
    let each = (0..targets.len())
        .map(|t| share(made.iter().filter(|values| targets[t].requirement.is_met(values[t])).count()))
        .collect();
    let band = (0..targets.len())
        .map(|t| {
            let mut column: Vec<f64> = made.iter().map(|values| values[t]).collect();
            column.sort_by(f64::total_cmp);
            [0.025, 0.975].map(|q| column[((count - 1) as f64 * q).round() as usize])
        })
        .collect();
    let all = share(
        made.iter()
            .filter(|values| targets.iter().zip(*values).all(|(t, v)| t.requirement.is_met(*v)))
            .count(),
    );
    Some(Probability { all, each, band, draws: count })
}

#[cfg(test)]
mod tests {
    use super::super::{Belief, PublishedPhysics};
    use super::*;
    use crate::request::{Quantity, Request, Requirement, Target, Tolerances};

    #[test]
    fn bands_of_parts_without_tolerances_are_those_of_the_law() {
        let exact: Tolerances = Tolerances {
            pin_diameter_mm: 0.0,
            groove_diameter_mm: 0.0,
            radius_mm: 0.0,
            layer_mm: 0.0,
            hardness_shore_a: 0.0,
        };
        let request = Request {
            targets: vec![Target { quantity: Quantity::MaxFriction, requirement: Requirement::AtMost(9.0) }],
            tolerances: exact,
            ..Request::default()
        };
        let mut configuration = Configuration::default();
        configuration.layout.pins = vec![5, 7, 9, 10];
        let belief = PublishedPhysics::default();
        let f = &configuration.friction;
        let trial = Trial::new(&request, &belief, (f.load_min_n, f.load_max_n), f.points);
        let part = trial.part(&configuration).unwrap();
        let law = belief.banded(&part, &[trial.range_n.1]).unwrap();
        // With this seed, independent draws gave a band whose lower end was 4 % too high.
        let drawn = probability(&trial, &configuration, &draws(1, 400, belief.constants())).unwrap();
        for (drawn, law) in drawn.band[0].iter().zip([law.band_low_n[0], law.band_high_n[0]]) {
            assert!((drawn / law - 1.0).abs() < 0.02, "{drawn} {law}");
        }
    }
}
