//! How often a made part meets the ask: every draw is a part of its own, with its dimensions, constants and model error,
//! predicted in full.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use super::candidate::{Draw, Trial};
use crate::config::Configuration;
use crate::parallel::map_each;

/// How often the draws met the ask.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probability {
    /// Share of draws that meet all targets.
    pub all: f64,
    /// Share of draws that meet each target.
    pub each: Vec<f64>,
    /// From which to which value 95 % of the draws of each target lie.
    pub band: Vec<[f64; 2]>,
    /// Draws that could be predicted.
    pub draws: usize,
}

impl Probability {
    /// Standard error of `all` by the number of draws.
    pub fn standard_error(&self) -> f64 {
        (self.all * (1.0 - self.all) / self.draws.max(1) as f64).sqrt()
    }
}

/// The draws of a seed: the same for every candidate, so that candidates are compared on the same parts.
pub(super) fn draws(seed: u64, count: usize, constants: usize) -> Vec<Draw> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
            Draw {
                constants: (0..constants).map(|_| normal()).collect(),
                model: normal(),
                made: std::array::from_fn(|_| normal()),
            }
        })
        .collect()
}

/// The probability that a made part of `configuration` meets the ask; `None` if it cannot be predicted.
pub(super) fn probability(
    trial: &Trial<'_>,
    configuration: &Configuration,
    draws: &[Draw],
) -> Option<Probability> {
    let part = trial.part(configuration)?;
    let error = trial.believed(&part)?.error;
    let hardness = configuration.silicone.hardness_shore_a;
    // A part that finds no equilibrium is left out of the count: it says nothing of the ask.
    let made: Vec<Vec<f64>> =
        map_each(draws.iter().collect(), |draw| trial.made(&part, hardness, &error, draw))
            .into_iter()
            .flatten()
            .collect();
    let count = made.len();
    if count == 0 {
        return None;
    }
    let share = |met: usize| met as f64 / count as f64;
    let targets = &trial.ask.targets;
    let each = (0..targets.len())
        .map(|t| share(made.iter().filter(|values| targets[t].wish.is_met(values[t])).count()))
        .collect();
    let band = (0..targets.len())
        .map(|t| {
            let mut column: Vec<f64> = made.iter().map(|values| values[t]).collect();
            column.sort_by(f64::total_cmp);
            [0.025, 0.975].map(|q| column[((count - 1) as f64 * q).round() as usize])
        })
        .collect();
    let all = share(
        made.iter().filter(|values| targets.iter().zip(*values).all(|(t, v)| t.wish.is_met(*v))).count(),
    );
    Some(Probability { all, each, band, draws: count })
}
