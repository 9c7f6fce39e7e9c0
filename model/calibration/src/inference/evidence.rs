//! How probable a table is under a model and a noise, whatever the constants are: the marginal likelihood, by Laplace's
//! approximation. It weighs explanations against each other that differ in their noise, which a sum of squares cannot.

use super::fit::{Fit, Slopes};
use super::model::{Model, Term};
use super::weighed::Weighed;
use crate::effects::Channel;

/// Prior standard deviations of sizes without a name: a share of friction, and newtons.
const PRIOR_SHARE: f64 = 0.2;
const PRIOR_N: f64 = 0.5;

/// Minus twice the logarithm of the prior density of a size, beyond the Gauss bell's own constants: a Cauchy
/// distribution whose quartiles are at the typical size (H. Jeffreys, Theory of Probability, 5.2). A bell would speak of
/// a size twenty times the typical with four hundred squares, which then decide between two explanations of the same
/// friction that differ in nothing but what is typical of them.
fn size_toll(size: f64, typical: f64) -> f64 {
    let beside_bell = 2.0 * libm::log(std::f64::consts::PI) - libm::log(std::f64::consts::TAU);
    beside_bell + 2.0 * libm::log1p((size / typical).powi(2))
}

/// Minus twice the logarithm of the marginal likelihood, up to a constant of the table: whitened squares, `ln det V`, and for every constant how much narrower the data made it.
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
    // The determinant of the scaled matrix, so that constants of any unit can be told.
    let n = a.nrows();
    let scale: Vec<f64> = (0..n).map(|i| a[(i, i)].max(1e-300).sqrt()).collect();
    let scaled = nalgebra::DMatrix::from_fn(n, n, |i, j| a[(i, j)] / (scale[i] * scale[j]));
    let log_det =
        scaled.cholesky().map_or(0.0, |c| 2.0 * c.l().diagonal().iter().map(|d| libm::log(*d)).sum::<f64>());
    cost + log_det + 2.0 * scale.iter().map(|s| libm::log(*s)).sum::<f64>()
}

/// Standard deviation of each constant's coordinate before any data; for sizes, which are fitted without a prior, what
/// is typical of them.
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

    /// Two explanations of the same friction in which other sizes are typical, by a tenth: where the size is typical they
    /// differ by less than two things to choose from, and where it is twenty times that by hardly more.
    #[test]
    fn how_typical_a_large_size_is_decides_nothing() {
        let apart = |size: f64| {
            let toll = |typical: f64| size_toll(size, typical) + 2.0 * libm::log(typical);
            (toll(0.45) - toll(0.5)).abs()
        };
        for size in [0.0, 0.5, 2.0, 10.0, 100.0] {
            assert!(apart(size) < 0.25, "{size}: {}", apart(size));
        }
        // Quartiles: half of the density at the typical size, none is ever impossible.
        assert!((size_toll(0.3, 0.3) - size_toll(0.0, 0.3) - 2.0 * std::f64::consts::LN_2).abs() < 1e-12);
        assert!(size_toll(1e6, 0.3) < 64.0);
    }
}
