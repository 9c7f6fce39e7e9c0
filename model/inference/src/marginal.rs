//! Gaussian marginal likelihood: coefficients with independent normal priors, integrated exactly.
//!
//! For `r = A b + e` with `b ~ N(0, diag(l))` and `e ~ N(0, V)` the covariance of `r` is
//! `V + A diag(l) A'`. By Woodbury's identity everything follows from `A'V^-1 A`, `A'V^-1 r` and
//! `r'V^-1 r`, with matrices as large as the number of coefficients.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use crate::covariance::Noise;
use crate::variance_gain::VarianceGain;
use crate::white_design::{SeriesColumns, WhiteDesign};
use crate::whitening::Whitening;

/// Products of a design with the precision of the noise.
#[derive(Clone, Debug)]
pub(crate) struct Marginal {
    /// `A'V^-1 A`.
    pub(crate) gram: DMatrix<f64>,
    /// `A'V^-1 r`.
    pub(crate) moment: DVector<f64>,
    /// `r'V^-1 r + ln det V + n ln 2 pi`.
    constant: f64,
    pub(crate) whitening: Whitening,
    /// `W A`, with `W V W' = I`.
    pub(crate) white_design: WhiteDesign,
    /// `W r`.
    pub(crate) white_target: DVector<f64>,
}

/// Posterior of the coefficients.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    pub(crate) log_likelihood: f64,
    pub(crate) mean: DVector<f64>,
    pub(crate) covariance: DMatrix<f64>,
    /// `R` with `R'R` equal to the covariance.
    pub(crate) root: DMatrix<f64>,
}

impl Marginal {
    /// Computes the products; `None` if the covariance of the noise is not positive definite.
    pub(crate) fn new(
        matrix: &DMatrix<f64>,
        of_series: &[SeriesColumns],
        target: &DVector<f64>,
        noise: &Noise<'_>,
        ranges: &[std::ops::Range<usize>],
    ) -> Option<Self> {
        let whitening = Whitening::new(noise, ranges)?;
        let white_design = WhiteDesign::new(matrix, of_series, &whitening);
        let white_target = whitening.whiten_vector(target);
        let gram = white_design.gram();
        let moment =
            white_design.transposed_times(&DMatrix::from_columns(std::slice::from_ref(&white_target)));
        let moment = moment.column(0).into_owned();
        let constant = white_target.norm_squared()
            + whitening.log_determinant
            + target.len() as f64 * libm::log(2.0 * PI);
        Some(Self { gram, moment, constant, whitening, white_design, white_target })
    }

    /// Returns the posterior of the coefficients for prior variances `l`, each zero or positive.
    pub(crate) fn solve(&self, variances: &[f64]) -> Option<Solution> {
        let (factor, sd, log_likelihood) = self.factor(variances)?;
        // C = S (I + S G S)^-1 S with S = sqrt(diag(l)).
        let mut root = DMatrix::from_diagonal(&sd);
        factor.solve_lower_triangular_mut(&mut root);
        let covariance = root.transpose() * &root;
        let mean = &covariance * &self.moment;
        Some(Solution { log_likelihood, mean, covariance, root })
    }

    /// Returns `ln p(r)` without some coefficients, and what it gains by a common prior variance of them.
    pub(crate) fn variance_gain(
        &self,
        variances: &[f64],
        coefficients: &[usize],
    ) -> Option<(f64, VarianceGain)> {
        let mut rest = variances.to_vec();
        coefficients.iter().for_each(|i| rest[*i] = 0.0);
        let (factor, sd, log_likelihood) = self.factor(&rest)?;
        let cross = self.gram.select_columns(coefficients);
        let mut explained = cross.clone();
        explained.column_iter_mut().for_each(|mut column| column.component_mul_assign(&sd));
        factor.solve_lower_triangular_mut(&mut explained);
        let moment = factor.solve_lower_triangular(&self.moment.component_mul(&sd))?;
        let information = cross.select_rows(coefficients) - explained.transpose() * &explained;
        let score = self.moment.select_rows(coefficients) - explained.tr_mul(&moment);
        let is_finite = information.iter().chain(score.iter()).all(|x| x.is_finite());
        is_finite.then(|| (log_likelihood, VarianceGain::new(information, &score)))
    }

    fn factor(&self, variances: &[f64]) -> Option<(DMatrix<f64>, DVector<f64>, f64)> {
        let (factor, sd) = scaled_factor(self.gram.clone(), variances)?;
        let z = factor.solve_lower_triangular(&self.moment.component_mul(&sd))?;
        let determinant = 2.0 * factor.diagonal().iter().map(|d| libm::log(*d)).sum::<f64>();
        let log_likelihood = -0.5 * (self.constant - z.norm_squared() + determinant);
        log_likelihood.is_finite().then_some((factor, sd, log_likelihood))
    }

    /// Returns `W (r - A b)`.
    pub(crate) fn white_residual(&self, mean: &DVector<f64>) -> DVector<f64> {
        &self.white_target - self.white_design.times_vector(mean)
    }
}

/// Returns the Cholesky factor of `I + S G S` and the diagonal of `S = sqrt(diag(l))`.
fn scaled_factor(mut gram: DMatrix<f64>, variances: &[f64]) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let sd = DVector::from_iterator(variances.len(), variances.iter().map(|v| v.sqrt()));
    for (j, mut column) in gram.column_iter_mut().enumerate() {
        column.iter_mut().zip(sd.iter()).for_each(|(x, s)| *x *= s * sd[j]);
    }
    for i in 0..sd.len() {
        gram[(i, i)] += 1.0;
    }
    Some((gram.cholesky()?.unpack(), sd))
}

/// Returns the posterior mean of coefficients with prior variances `l` from `A'V^-1 A` and `A'V^-1 r`.
pub(crate) fn posterior_mean(
    gram: DMatrix<f64>,
    moment: &DVector<f64>,
    variances: &[f64],
) -> Option<DVector<f64>> {
    let (factor, sd) = scaled_factor(gram, variances)?;
    let half = factor.solve_lower_triangular(&moment.component_mul(&sd))?;
    Some(factor.tr_solve_lower_triangular(&half)?.component_mul(&sd))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_problem::{fitted, full_hypothesis, noise_of, problem};

    /// Density of a normal distribution with a dense covariance.
    fn dense_log_likelihood(target: &DVector<f64>, covariance: DMatrix<f64>) -> f64 {
        let factor = covariance.cholesky().unwrap();
        let determinant = 2.0 * factor.l().diagonal().iter().map(|d| libm::log(*d)).sum::<f64>();
        -0.5 * (target.dot(&factor.solve(target)) + determinant + target.len() as f64 * libm::log(2.0 * PI))
    }

    #[test]
    fn woodbury_matches_dense_covariance() {
        let problem = problem(6, 0.4);
        let (fit, design, point) = fitted(&problem, &full_hypothesis());
        let noise = noise_of(&problem, &fit, &design, &point);
        let mut covariance = DMatrix::zeros(problem.len(), problem.len());
        for range in &problem.ranges {
            let at = (range.start, range.start);
            covariance.view_mut(at, (range.len(), range.len())).copy_from(&noise.covariance(range));
        }
        let prior = DMatrix::from_diagonal(&DVector::from_vec(point.variances.clone()));
        covariance += &design.matrix * prior * design.matrix.transpose();
        let dense = dense_log_likelihood(&design.target, covariance);
        assert!((point.solution.log_likelihood - dense).abs() < 1e-7, "{dense}");
    }

    /// The gain by a variance is that of the likelihood with the variance.
    #[test]
    fn variance_gain_matches_the_likelihood() {
        let problem = problem(6, 0.4);
        let (_, design, point) = fitted(&problem, &full_hypothesis());
        for component in design.components() {
            let columns = design.columns_of(component);
            let (at_zero, gain) = point.marginal.variance_gain(&point.variances, &columns).unwrap();
            for variance in [0.0, 1e-6, 0.01, 3.0] {
                let mut variances = point.variances.clone();
                columns.iter().for_each(|i| variances[*i] = variance);
                let exact = point.marginal.solve(&variances).unwrap().log_likelihood;
                assert!((at_zero + gain.at(variance) - exact).abs() < 1e-7, "{component:?} {variance}");
            }
        }
    }

    /// One coefficient, integrated on a grid.
    #[test]
    fn marginal_likelihood_matches_integration() {
        let problem = problem(3, 0.0);
        let (fit, design, point) = fitted(&problem, &crate::Hypothesis::default());
        let noise = noise_of(&problem, &fit, &design, &point);
        let column = DMatrix::from_columns(&[design.matrix.column(0)]);
        let marginal = Marginal::new(&column, &[], &design.target, &noise, &problem.ranges).unwrap();
        let exact = marginal.solve(&[0.25]).unwrap().log_likelihood;
        let flat = |b: f64| {
            let residual = marginal.white_residual(&DVector::from_element(1, b));
            let likelihood = residual.norm_squared()
                + marginal.whitening.log_determinant
                + design.target.len() as f64 * libm::log(2.0 * PI);
            -0.5 * likelihood - 0.5 * b * b / 0.25 - 0.5 * libm::log(2.0 * PI * 0.25)
        };
        let step = 1e-4;
        let terms: Vec<f64> = (-30_000..30_000).map(|i| flat(f64::from(i) * step)).collect();
        let sum = crate::quadrature::log_sum_exp(&terms) + libm::log(step);
        assert!((exact - sum).abs() < 1e-6, "{exact} {sum}");
    }
}
