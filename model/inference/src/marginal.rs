//! Gaussian marginal likelihood: coefficients with independent normal priors, integrated exactly.
//!
//! For `r = A b + e` with `b ~ N(0, diag(l))` and `e ~ N(0, V)` the covariance of `r` is
//! `V + A diag(l) A'`. By Woodbury's identity everything follows from `A'V^-1 A`, `A'V^-1 r` and
//! `r'V^-1 r`, with matrices as large as the number of coefficients.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use crate::noise::{Noise, Whitening};

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
    /// `L^-1 A`, with `V = L L'`.
    pub(crate) white_matrix: DMatrix<f64>,
    /// `L^-1 r`.
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
        target: &DVector<f64>,
        noise: &Noise<'_>,
        ranges: &[std::ops::Range<usize>],
    ) -> Option<Self> {
        let whitening = noise.whitening(ranges)?;
        let white_matrix = whitening.whiten(matrix);
        let white_target = whitening.whiten_vector(target);
        let transposed = white_matrix.transpose();
        let gram = &transposed * &white_matrix;
        let moment = &transposed * &white_target;
        let constant = white_target.norm_squared()
            + whitening.log_determinant
            + target.len() as f64 * libm::log(2.0 * PI);
        Some(Self { gram, moment, constant, whitening, white_matrix, white_target })
    }

    /// Returns `ln p(r)` for prior variances `l`, of which some may be zero.
    pub(crate) fn log_likelihood(&self, variances: &[f64]) -> Option<f64> {
        Some(self.factor(variances)?.2)
    }

    /// Returns the posterior of the coefficients for prior variances.
    pub(crate) fn solve(&self, variances: &[f64]) -> Option<Solution> {
        let (factor, sd, log_likelihood) = self.factor(variances)?;
        // C = S (I + S G S)^-1 S with S = sqrt(diag(l)).
        let mut root = DMatrix::from_diagonal(&sd);
        factor.solve_lower_triangular_mut(&mut root);
        let covariance = root.transpose() * &root;
        let mean = &covariance * &self.moment;
        Some(Solution { log_likelihood, mean, covariance, root })
    }

    fn factor(&self, variances: &[f64]) -> Option<(DMatrix<f64>, DVector<f64>, f64)> {
        let sd = DVector::from_iterator(variances.len(), variances.iter().map(|v| v.sqrt()));
        let mut scaled = self.gram.clone();
        for (j, mut column) in scaled.column_iter_mut().enumerate() {
            column.iter_mut().zip(sd.iter()).for_each(|(x, s)| *x *= s * sd[j]);
        }
        for i in 0..sd.len() {
            scaled[(i, i)] += 1.0;
        }
        let factor = scaled.cholesky()?.unpack();
        let z = factor.solve_lower_triangular(&self.moment.component_mul(&sd))?;
        let determinant = 2.0 * factor.diagonal().iter().map(|d| libm::log(*d)).sum::<f64>();
        let log_likelihood = -0.5 * (self.constant - z.norm_squared() + determinant);
        log_likelihood.is_finite().then_some((factor, sd, log_likelihood))
    }

    /// Returns `L^-1 (r - A b)`.
    pub(crate) fn white_residual(&self, mean: &DVector<f64>) -> DVector<f64> {
        &self.white_target - &self.white_matrix * mean
    }
}
