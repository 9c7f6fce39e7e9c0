//! Marginal likelihood as a function of the standard deviation that some coefficients share.
//!
//! With all other coefficients integrated, the columns `X` of the coefficients have the score
//! `u = X'Pr` and the information `S = X'PX`. In the eigenvectors of `S` each standard deviation costs
//! one sum over the columns, so that the integral over it can follow a posterior of any width.

use nalgebra::{DMatrix, DVector};

use crate::half_t::HalfT;
use crate::quadrature::{Mixture, log_sum_exp};

/// Largest distance of the logarithms of two nodes: a prior is smooth on it.
const SPACING: f64 = 0.5;
/// The same for nodes from which standard deviations are drawn.
const FINE_SPACING: f64 = 0.125;
/// Largest distance in standard deviations of the narrowest posterior: the trapezoidal rule for a normal density is then right
/// within 2 %.
const SPACING_IN_SD: f64 = 2.0;
/// The same for nodes from which standard deviations are drawn.
const FINE_SPACING_IN_SD: f64 = 0.5;

/// What the log marginal likelihood gains by coefficients whose prior variance is not zero.
#[derive(Clone, Debug)]
pub(crate) struct VarianceGain {
    /// Eigenvalues of the information.
    information: Vec<f64>,
    /// Squares of the scores in its eigenvectors.
    squared_scores: Vec<f64>,
}

impl VarianceGain {
    /// Returns the gain by columns with this information and these scores.
    pub(crate) fn new(information: DMatrix<f64>, score: &DVector<f64>) -> Self {
        if score.is_empty() {
            return Self { information: Vec::new(), squared_scores: Vec::new() };
        }
        let eigen = information.symmetric_eigen();
        let rotated = eigen.eigenvectors.tr_mul(score);
        Self {
            information: eigen.eigenvalues.iter().map(|value| value.max(0.0)).collect(),
            squared_scores: rotated.iter().map(|u| u * u).collect(),
        }
    }

    /// Returns the gain for a variance.
    pub(crate) fn at(&self, variance: f64) -> f64 {
        let terms = self.information.iter().zip(&self.squared_scores).map(|(information, square)| {
            let growth = 1.0 + variance * information;
            -0.5 * libm::log(growth) + 0.5 * variance * square / growth
        });
        terms.sum()
    }

    /// Returns the logarithm of the mean gain over a prior of the standard deviation.
    pub(crate) fn integral(&self, prior: HalfT) -> f64 {
        log_sum_exp(&self.terms(prior).iter().map(|(_, term)| *term).collect::<Vec<f64>>())
    }

    /// Returns standard deviations, each with its gain and the logarithm of its prior probability, for integrals over them.
    pub(crate) fn terms(&self, prior: HalfT) -> Vec<(f64, f64)> {
        self.terms_at(prior, SPACING.min(SPACING_IN_SD * self.narrowest_sd()))
    }

    /// Returns the same so close that a posterior has several, from which standard deviations are drawn.
    pub(crate) fn fine_terms(&self, prior: HalfT) -> Vec<(f64, f64)> {
        self.terms_at(prior, FINE_SPACING.min(FINE_SPACING_IN_SD * self.narrowest_sd()))
    }

    fn terms_at(&self, prior: HalfT, spacing: f64) -> Vec<(f64, f64)> {
        let prior = Mixture::half_t(prior, spacing);
        let nodes = prior.nodes.iter().zip(&prior.log_weights);
        nodes.map(|(sd, weight)| (*sd, weight + self.at(sd * sd))).collect()
    }

    /// Returns the smallest standard deviation of the logarithm of the standard deviation: that of coefficients which are
    /// known exactly.
    fn narrowest_sd(&self) -> f64 {
        1.0 / (2.0 * self.information.len().max(1) as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A random effect without levels.
    #[test]
    fn no_columns_gain_nothing() {
        let gain = VarianceGain::new(DMatrix::zeros(0, 0), &DVector::zeros(0));
        assert_eq!(gain.at(1.0), 0.0);
        assert!(gain.integral(HalfT::normal(0.1)).abs() < 1e-12);
    }

    /// Coefficients that are known well, so many that the posterior of their standard deviation lies between two nodes of a
    /// prior: the integral is that of a grid of a thousandth, whatever the standard deviation.
    #[test]
    fn the_integral_follows_a_narrow_posterior() {
        let prior = HalfT::normal(0.03);
        for columns in [1, 3, 20, 100, 700] {
            for share in [0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8] {
                let information = 1e7;
                let score = information * 0.03 * share;
                let gain = VarianceGain::new(
                    DMatrix::from_diagonal_element(columns, columns, information),
                    &DVector::from_element(columns, score),
                );
                let fine = gain.terms_at(prior, 1e-3);
                let exact = log_sum_exp(&fine.iter().map(|(_, term)| *term).collect::<Vec<f64>>());
                let sum = gain.integral(prior);
                assert!((sum - exact).abs() < 0.03, "{columns} columns, {share}: {sum} for {exact}");
            }
        }
    }
}
