//! Log evidence of a hypothesis at its mode.
//!
//! The Gaussian marginal likelihood integrates every coefficient. Three parts of the model are not
//! Gaussian: Cauchy priors of sizes, signs of sizes, and the standard deviations of components. Each
//! is a one-dimensional integral by quadrature, with the others at their mode. The scales of the
//! noise stay at their mode.

use std::collections::BTreeMap;

use crate::design::{Component, Design, Role};
use crate::quadrature::{Mixture, log_normal_cdf, log_sum_exp};
use crate::scales::{ScalePoint, ScaleProblem};
use crate::variance_gain::VarianceGain;

/// Posterior of the size of an effect, given a hypothesis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizePosterior {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
}

/// Integrals of a hypothesis about its mode.
pub(crate) struct Integrals {
    /// `ln p(y | H)`.
    pub(crate) log_evidence: f64,
    /// Posterior of the size of each effect that has one.
    pub(crate) sizes: BTreeMap<usize, SizePosterior>,
    /// Posterior mean of the variance of each component.
    pub(crate) variances: BTreeMap<Component, f64>,
}

/// Integrates a hypothesis about its mode.
pub(crate) fn log_evidence(at: &ScaleProblem<'_>, point: &ScalePoint, log_weight_term: f64) -> Integrals {
    let space = &at.problem.space;
    let scale_prior = point.scales.log_prior(&at.problem.reference).0;
    let mut log_evidence = point.solution.log_likelihood + log_weight_term + scale_prior;
    let mut sizes = BTreeMap::new();
    let cauchy = Mixture::cauchy();
    for (i, role) in at.design.roles.iter().enumerate() {
        let Role::Size(effect) = role else { continue };
        let prior = &space.effects[*effect];
        let size = SizeIntegral {
            mean: point.solution.mean[i],
            variance: point.solution.covariance[(i, i)],
            normal_variance: point.variances[i],
            scale: prior.typical_size.unwrap_or(1.0),
            is_one_sided: prior.is_one_sided,
        };
        let (gain, posterior) = size.with_cauchy_prior(&cauchy);
        log_evidence += gain;
        sizes.insert(*effect, posterior);
    }
    let mut variances = BTreeMap::new();
    for component in at.design.components() {
        let (gain, variance) = component_integral(at, point, component);
        log_evidence += gain;
        variances.insert(component, variance);
    }
    Integrals { log_evidence, sizes, variances }
}

/// Returns what integrating the standard deviation of a component adds to the log likelihood at its
/// mode, and the posterior mean of the variance; that of a random effect has the predictive prior.
fn component_integral(at: &ScaleProblem<'_>, point: &ScalePoint, component: Component) -> (f64, f64) {
    let space = &at.problem.space;
    let prior = component.prior(space);
    let Some((at_zero, gain)) = component_gain(at.design, point, component) else {
        return (f64::NEG_INFINITY, 0.0);
    };
    let mut terms = gain.terms(prior);
    let total = log_sum_exp(&terms.iter().map(|(_, term)| *term).collect::<Vec<f64>>());
    if let Component::Random(i) = component {
        let predictive = space.random_effects[i].predictive_prior();
        terms.iter_mut().for_each(|(sd, term)| *term += predictive.log_kernel(*sd) - prior.log_kernel(*sd));
    }
    let all = log_sum_exp(&terms.iter().map(|(_, term)| *term).collect::<Vec<f64>>());
    let variance = terms.iter().map(|(sd, term)| libm::exp(term - all) * sd * sd).sum();
    (at_zero + total - point.solution.log_likelihood, variance)
}

/// Returns the log likelihood without the coefficients of a component, and what it gains by their variance; `None` if the
/// information is not finite.
pub(crate) fn component_gain(
    design: &Design,
    point: &ScalePoint,
    component: Component,
) -> Option<(f64, VarianceGain)> {
    point.marginal.variance_gain(&point.variances, &design.columns_of(component))
}

/// A size with a normal prior and its posterior, before the prior is replaced.
struct SizeIntegral {
    mean: f64,
    variance: f64,
    normal_variance: f64,
    scale: f64,
    is_one_sided: bool,
}

impl SizeIntegral {
    /// Replaces the normal prior by a Cauchy or half-Cauchy prior. Returns the change of the log
    /// evidence, and the posterior.
    fn with_cauchy_prior(&self, cauchy: &Mixture) -> (f64, SizePosterior) {
        let (mut terms, mut moments) = (Vec::new(), Vec::new());
        for (node, weight) in cauchy.nodes.iter().zip(&cauchy.log_weights) {
            let prior = node * self.scale * self.scale;
            let added = 1.0 / prior - 1.0 / self.normal_variance;
            let shrink = (1.0 + added * self.variance).max(1e-9);
            let (mean, variance) = (self.mean / shrink, self.variance / shrink);
            let mut term = weight
                - 0.5 * libm::log(prior / self.normal_variance)
                - 0.5 * libm::log(shrink)
                - 0.5 * added * self.mean * mean;
            if self.is_one_sided {
                term += libm::log(2.0) + log_normal_cdf(mean / variance.sqrt());
            }
            terms.push(term);
            moments.push((mean, variance));
        }
        let total = log_sum_exp(&terms);
        let (mut first, mut second) = (0.0, 0.0);
        for (term, (mean, variance)) in terms.iter().zip(&moments) {
            let share = libm::exp(term - total);
            first += share * mean;
            second += share * (variance + mean * mean);
        }
        (total, SizePosterior { mean: first, sd: (second - first * first).max(0.0).sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A likelihood N(y | s, 0.04) with a Cauchy prior on s, integrated on a grid.
    #[test]
    fn cauchy_evidence_matches_quadrature() {
        let (y, noise, scale, normal) = (0.7f64, 0.04f64, 0.5f64, 3.0f64);
        for is_one_sided in [false, true] {
            let variance = 1.0 / (1.0 / noise + 1.0 / normal);
            let size = SizeIntegral {
                mean: variance * y / noise,
                variance,
                normal_variance: normal,
                scale,
                is_one_sided,
            };
            let gaussian = -0.5 * y * y / (noise + normal)
                - 0.5 * libm::log(2.0 * std::f64::consts::PI * (noise + normal));
            let (gain, posterior) = size.with_cauchy_prior(&Mixture::cauchy());
            let (mut total, mut first) = (0.0, 0.0);
            let step = 1e-4;
            for i in -200_000..200_000 {
                let s = f64::from(i) * step + step / 2.0;
                if is_one_sided && s < 0.0 {
                    continue;
                }
                let prior = scale / std::f64::consts::PI / (scale * scale + s * s);
                let prior = if is_one_sided { 2.0 * prior } else { prior };
                let likelihood =
                    libm::exp(-0.5 * (y - s).powi(2) / noise) / (2.0 * std::f64::consts::PI * noise).sqrt();
                total += prior * likelihood * step;
                first += s * prior * likelihood * step;
            }
            assert!((gaussian + gain - libm::log(total)).abs() < 0.02, "{is_one_sided}");
            assert!((posterior.mean - first / total).abs() < 0.01, "{is_one_sided}");
        }
    }
}
