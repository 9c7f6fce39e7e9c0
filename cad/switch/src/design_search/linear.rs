//! A fast approximation of the probability: the logarithm of each target is a sum of independent
//! errors. It guides the search and gives the sources of the uncertainty. Reported probabilities
//! come from [`super::probability`].

use schemars::JsonSchema;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

use pinswitch_friction::sort_by_number;

use super::candidate::Trial;
use crate::config::Configuration;
use crate::request::{Quantity, SOURCES, Target, Tolerances};

/// Standard deviation of a candidate whose uncertainty is not computed.
pub(super) const GUESSED_SD: f64 = 0.12;
/// Least standard deviation. With zero, the probability would have no slope.
const LEAST_SD: f64 = 0.005;

/// One target of a candidate.
#[derive(Clone, Debug)]
pub(super) struct Spread {
    /// Best estimate.
    pub(super) value: f64,
    /// Variance of the logarithm due to the constants.
    constants: f64,
    /// Change of the logarithm for a model error of one standard deviation upwards, and downwards.
    model: (f64, f64),
    /// Change of the logarithm for one standard deviation of each tolerance.
    made: [f64; SOURCES],
}

/// Share of the variance of a target.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct VarianceShare {
    /// `constants`, `model`, or a tolerance.
    pub source: String,
    /// Share of the variance, from 0 to 1.
    pub share: f64,
}

/// The approximation for all targets of a candidate.
#[derive(Clone, Debug)]
pub(super) struct Linear {
    pub(super) targets: Vec<Spread>,
}

impl Spread {
    /// Returns the standard deviation of the logarithm, upwards and downwards.
    fn sd(&self) -> (f64, f64) {
        let made: f64 = self.made.iter().map(|d| d * d).sum();
        let rest = self.constants + made + LEAST_SD * LEAST_SD;
        // Model errors of either sign may change a quantity in the same direction.
        let (up, down) = (self.model.0.max(self.model.1), self.model.0.min(self.model.1));
        ((rest + up * up).sqrt(), (rest + down * down).sqrt())
    }

    /// Returns the shares of the variance, the largest first.
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
    /// Returns the approximation for `configuration`; `None` if it cannot be predicted.
    pub(super) fn of(trial: &Trial<'_>, configuration: &Configuration) -> Option<Self> {
        let part = trial.part(configuration)?;
        let mut believed = trial.believed(&part)?;
        let next = believed.middle.switching()?.next;
        let middle = trial.values(&mut believed.middle, 1.0)?;
        let change = |values: Vec<f64>| -> Vec<f64> {
            values.iter().zip(&middle).map(|(v, m)| libm::log(v.max(1e-9) / m.max(1e-9))).collect()
        };
        let moved = believed.moved.iter_mut().map(|curve| Some(change(trial.values(curve, 1.0)?)));
        let constants: Vec<Vec<f64>> = moved.collect::<Option<_>>()?;
        let mut with_error = |z| {
            let (mut curve, factor) = believed.with_error(&trial.loads_n, z)?;
            Some(change(trial.values(&mut curve, factor)?))
        };
        let model = [with_error(1.0)?, with_error(-1.0)?];
        let hardness = configuration.silicone.hardness_shore_a;
        let mut made = vec![[0.0; SOURCES]; middle.len()];
        for source in (0..SOURCES).filter(|i| trial.request.tolerances.sd()[*i] > 0.0) {
            let mut z = [0.0; SOURCES];
            z[source] = 1.0;
            let mut curve = trial.curve_of_made(&part, hardness, &z)?.expecting(next);
            for (target, change) in change(trial.values(&mut curve, 1.0)?).into_iter().enumerate() {
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

    /// Returns minus the logarithm of the probability of meeting all targets, which are treated as
    /// independent.
    pub(super) fn cost(&self, trial: &Trial<'_>) -> f64 {
        let one = |(t, s): (&Target, &Spread)| cost(t, trial.range_n, s.value, s.sd());
        trial.request.targets.iter().zip(&self.targets).map(one).sum()
    }
}

/// Returns the same for the standard deviation [`GUESSED_SD`] of every target.
pub(super) fn guessed_cost(trial: &Trial<'_>, values: &[f64]) -> f64 {
    let one = |(t, v): (&Target, &f64)| cost(t, trial.range_n, *v, (GUESSED_SD, GUESSED_SD));
    trial.request.targets.iter().zip(values).map(one).sum()
}

/// Returns minus the logarithm of the probability that a target is met.
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

/// Returns the logarithm of the probability that a standard normal variable is between the bounds.
/// It stays smooth for bounds far in the tails.
fn log_between(low: f64, high: f64) -> f64 {
    let normal = Normal::standard();
    // Symmetry moves the interval to the side on which the tail is accurate.
    let (low, high) = if low > 0.0 { (-high, -low) } else { (low, high) };
    let inside = normal.cdf(high) - normal.cdf(low);
    if high > -30.0 && inside > 1e-200 {
        return libm::log(inside);
    }
    // Asymptotic tail: phi(x)/|x|.
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
