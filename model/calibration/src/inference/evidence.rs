//! Log evidence of a model and a noise: marginal likelihood by Laplace's approximation. It compares
//! explanations with different noise, which a sum of squares cannot.

use super::fit::{Fit, Slopes};
use super::model::{Model, Term};
use super::weighed::Weighed;
use crate::effects::Channel;

/// Prior standard deviations of sizes of structure: relative to friction, and in newtons.
const PRIOR_SHARE: f64 = 0.2;
const PRIOR_N: f64 = 0.5;

/// Returns minus twice the log prior density of a size, beyond the constants of a normal density: a
/// Cauchy distribution with quartiles at the typical size (H. Jeffreys, Theory of Probability,
/// 5.2). A normal prior would penalise a size twenty times the typical one with a deviance of 400,
/// which would decide between two explanations of the same friction that differ only in their
/// typical sizes.
fn size_toll(size: f64, typical: f64) -> f64 {
    let beside_bell = 2.0 * libm::log(std::f64::consts::PI) - libm::log(std::f64::consts::TAU);
    beside_bell + 2.0 * libm::log1p((size / typical).powi(2))
}

/// Returns minus twice the log marginal likelihood, up to a constant of the table: deviance, `ln
/// det V`, and the ratio of prior to posterior width of every constant.
pub(super) fn evidence(fitted: &Fit, weighed: &Weighed<'_>) -> f64 {
    let predicted: Vec<f64> =
        weighed.data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let mut a = Slopes::new(&fitted.model, weighed, &predicted).normal;
    let prior_sd = prior_sd(&fitted.model);
    let mut cost = fitted.cost + weighed.log_det();
    for (i, (sd, prior)) in prior_sd.iter().zip(fitted.model.priors()).enumerate() {
        if prior.sd > *sd {
            a[(i, i)] += sd.powi(-2);
            cost += size_toll(fitted.model.value(i).0, *sd);
        }
        cost += 2.0 * libm::log(sd.min(prior.sd));
    }
    // Determinant of the scaled matrix, to allow for constants of any unit.
    let n = a.nrows();
    let scale: Vec<f64> = (0..n).map(|i| a[(i, i)].max(1e-300).sqrt()).collect();
    let scaled = nalgebra::DMatrix::from_fn(n, n, |i, j| a[(i, j)] / (scale[i] * scale[j]));
    let log_det =
        scaled.cholesky().map_or(0.0, |c| 2.0 * c.l().diagonal().iter().map(|d| libm::log(*d)).sum::<f64>());
    cost + log_det + 2.0 * scale.iter().map(|s| libm::log(*s)).sum::<f64>()
}

/// Returns the prior standard deviation of each constant's coordinate; for sizes, which are fitted
/// without a prior, their typical values.
fn prior_sd(model: &Model) -> Vec<f64> {
    let mut sd: Vec<f64> = model.priors().iter().map(|p| p.sd).collect();
    for (index, term) in model.terms.iter().enumerate() {
        let at = model.term_offset(index);
        let typical = match term {
            Term::Named(effect) => {
                if effect.parameters().is_empty() {
                    continue;
                }
                let largest = effect.description().study.largest().unwrap_or(0.0);
                if largest > 0.0 { largest } else { continue }
            }
            Term::Structure(structure) => match structure.channel {
                Channel::Reading | Channel::Drag => PRIOR_N,
                _ => PRIOR_SHARE,
            },
        };
        sd[at] = typical;
    }
    sd
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two explanations of the same friction whose typical sizes differ by a tenth: at a typical
    /// size, and at twenty times that size, the evidence hardly differs.
    #[test]
    fn typical_sizes_do_not_decide() {
        let apart = |size: f64| {
            let toll = |typical: f64| size_toll(size, typical) + 2.0 * libm::log(typical);
            (toll(0.45) - toll(0.5)).abs()
        };
        for size in [0.0, 0.5, 2.0, 10.0, 100.0] {
            assert!(apart(size) < 0.25, "{size}: {}", apart(size));
        }
        // Quartiles: at the typical size the density is half its maximum.
        assert!((size_toll(0.3, 0.3) - size_toll(0.0, 0.3) - 2.0 * std::f64::consts::LN_2).abs() < 1e-12);
        assert!(size_toll(1e6, 0.3) < 64.0);
    }
}
