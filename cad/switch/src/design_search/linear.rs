//! A cheap guess of the probability: each target's logarithm as a sum of independent errors. It leads the search and says
//! what the uncertainty comes from; what is stated in the end comes from [`super::probability`].

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

use pinswitch_friction::sort_by_number;

use super::candidate::Trial;
use crate::config::Configuration;
use crate::request::{Quantity, SOURCES, Target, Tolerances};

/// Standard deviation that stands in before anything is known of a candidate.
pub(super) const GUESSED_SD: f64 = 0.12;
/// Least standard deviation: without any, a probability has no slope.
const LEAST_SD: f64 = 0.005;

/// One target of a candidate.
#[derive(Clone, Debug)]
pub(super) struct Spread {
    /// Best guess.
    pub(super) value: f64,
    /// Variance of its logarithm by the constants.
    constants: f64,
    /// Change of its logarithm as the model errs by one standard deviation up, and down.
    model: (f64, f64),
    /// Change of its logarithm by each tolerance.
    made: [f64; SOURCES],
}

/// Share of the variance of a target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VarianceShare {
    /// `constants`, `model`, or a tolerance.
    pub source: String,
    /// Its share, 0..1.
    pub share: f64,
}

/// A candidate, target by target.
#[derive(Clone, Debug)]
pub(super) struct Linear {
    pub(super) targets: Vec<Spread>,
}

impl Spread {
    /// Standard deviation of the logarithm, upwards and downwards.
    fn sd(&self) -> (f64, f64) {
        let made: f64 = self.made.iter().map(|d| d * d).sum();
        let rest = self.constants + made + LEAST_SD * LEAST_SD;
        // The model may move a quantity to one side whichever way it errs.
        let (up, down) = (self.model.0.max(self.model.1), self.model.0.min(self.model.1));
        ((rest + up * up).sqrt(), (rest + down * down).sqrt())
    }

    /// Shares of the variance, largest first.
    pub(super) fn shares(&self) -> Vec<VarianceShare> {
        let model = f64::midpoint(self.model.0.powi(2), self.model.1.powi(2));
        let mut all = vec![("constants".to_owned(), self.constants), ("model".to_owned(), model)];
        all.extend(Tolerances::NAMES.iter().zip(self.made).map(|(name, d)| ((*name).to_owned(), d * d)));
        let sum: f64 = all.iter().map(|a| a.1).sum();
        let mut shares: Vec<_> = all
            .into_iter()
            .map(|(source, v)| VarianceShare { source, share: if sum > 0.0 { v / sum } else { 0.0 } })
            .collect();
        sort_by_number(&mut shares, |s| -s.share);
        shares
    }
}

impl Linear {
    /// The candidate of `configuration`; `None` if it cannot be predicted.
    pub(super) fn of(trial: &Trial<'_>, configuration: &Configuration) -> Option<Self> {
        let part = trial.part(configuration)?;
        let believed = trial.believed(&part)?;
        let middle = trial.values(&believed.middle, 1.0);
        let change = |values: Vec<f64>| -> Vec<f64> {
            values.iter().zip(&middle).map(|(v, m)| libm::log(v.max(1e-9) / m.max(1e-9))).collect()
        };
        let constants: Vec<Vec<f64>> =
            believed.moved.iter().map(|curve| change(trial.values(curve, 1.0))).collect();
        let model = [1.0, -1.0].map(|z| {
            let (curve, factor) = believed.error.applied(believed.middle.clone(), z);
            change(trial.values(&curve, factor))
        });
        let hardness = configuration.silicone.hardness_shore_a;
        let mut made = vec![[0.0; SOURCES]; middle.len()];
        for source in (0..SOURCES).filter(|i| trial.request.tolerances.sd()[*i] > 0.0) {
            let mut z = [0.0; SOURCES];
            z[source] = 1.0;
            let curve = trial.curve_of_made(&part, hardness, &z)?;
            for (target, change) in change(trial.values(&curve, 1.0)).into_iter().enumerate() {
                made[target][source] = change;
            }
        }
        let targets = middle
            .iter()
            .enumerate()
            .map(|(i, value)| Spread {
                value: *value,
                constants: constants.iter().map(|c| c[i] * c[i]).sum(),
                model: (model[0][i], model[1][i]),
                made: made[i],
            })
            .collect();
        Some(Self { targets })
    }

    /// Minus the logarithm of the probability of meeting all targets, as if they were independent.
    pub(super) fn cost(&self, trial: &Trial<'_>) -> f64 {
        let one = |(t, s): (&Target, &Spread)| cost(t, trial.range_n, s.value, s.sd());
        trial.request.targets.iter().zip(&self.targets).map(one).sum()
    }
}

/// The same with standard deviations that are only guessed.
pub(super) fn guessed_cost(trial: &Trial<'_>, values: &[f64]) -> f64 {
    let one = |(t, v): (&Target, &f64)| cost(t, trial.range_n, *v, (GUESSED_SD, GUESSED_SD));
    trial.request.targets.iter().zip(values).map(one).sum()
}

/// Minus the logarithm of the probability that a target is met.
fn cost(target: &Target, range_n: (f64, f64), value: f64, (up, down): (f64, f64)) -> f64 {
    let (mut low, mut high) = target.requirement.interval();
    if target.quantity == Quantity::Threshold {
        (low, high) = (low.max(range_n.0), high.min(range_n.1));
    }
    let at = libm::log(value.max(1e-9));
    let scaled = |bound: f64| {
        let distance = libm::log(bound.max(1e-9)) - at;
        distance / if distance > 0.0 { up } else { down }
    };
    -log_between(scaled(low), scaled(high))
}

/// Logarithm of the probability that a standard normal lies between both; it falls smoothly however far they lie out.
fn log_between(low: f64, high: f64) -> f64 {
    let normal = Normal::standard();
    // By symmetry to the side where the tails are computed exactly.
    let (low, high) = if low > 0.0 { (-high, -low) } else { (low, high) };
    let inside = normal.cdf(high) - normal.cdf(low);
    if high > -30.0 && inside > 1e-200 {
        return libm::log(inside);
    }
    // The tail: phi(x)/|x|.
    let x = high.abs().max(1.0);
    -x * x / 2.0 - libm::log(x) - 0.919
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::Requirement;

    #[test]
    fn the_logarithm_falls_without_a_step() {
        let far: Vec<f64> = (0..60).map(|i| log_between(-100.0, -f64::from(i))).collect();
        assert!(far.windows(2).all(|w| w[1] < w[0]), "{far:?}");
        assert!((log_between(-1.959_964, 1.959_964) - libm::log(0.95f64)).abs() < 1e-6);
        assert!((log_between(2.0, 50.0) - log_between(-50.0, -2.0)).abs() < 1e-12);
    }

    #[test]
    fn a_value_on_the_bound_is_met_half_of_the_time() {
        let target = Target { quantity: Quantity::MaxFriction, requirement: Requirement::AtMost(8.0) };
        let chance = |value: f64| libm::exp(-cost(&target, (3.0, 50.0), value, (0.1, 0.1)));
        assert!((chance(8.0) - 0.5).abs() < 1e-9);
        assert!(chance(6.0) > 0.99 && chance(10.0) < 0.02);
    }
}
