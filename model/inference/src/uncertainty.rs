//! Covariance of the coefficients when neither the weights of the readings nor the scales are known.
//!
//! The posterior at the mode takes both as known, so that its intervals are too narrow. Three corrections:
//!
//! - The Fisher information of Student's t distribution is `(nu + 1) / (nu + 3)` of that of normal readings with the weights at
//!   their mode, which are 1 on average (Lange, Little and Taylor, Journal of the American Statistical Association 84, 1989).
//! - The mean depends on the scales: with its derivatives `J` and the covariance `S` of the logarithms of the scales it has the
//!   additional covariance `J S J'` (Kackar and Harville, Journal of the American Statistical Association 79, 1984).
//! - A variance that depends on the scales is uncertain. Intervals are those of Student's t distribution with `2 v^2 / (g' S g)`
//!   degrees of freedom, for a variance `v` with derivatives `g` (Satterthwaite, Biometrics Bulletin 2, 1946).

use nalgebra::{DMatrix, DVector};

use crate::design::Role;
use crate::fit::{DEGREES_OF_FREEDOM, Fit, size_variances};
use crate::leave_out::Linearised;
use crate::noise::SCALES;
use crate::problem::Problem;
use crate::scales::{ScalePoint, ScaleProblem, Slopes};

/// Fisher information of Student's t noise over that with known weights.
const HEAVY_TAILS: f64 = (DEGREES_OF_FREEDOM + 1.0) / (DEGREES_OF_FREEDOM + 3.0);
/// Fewest degrees of freedom, below which the approximation of the quantile is poor.
const FEWEST: f64 = 3.0;
/// Quantile of the standard normal distribution at 97.5 %.
const NORMAL_95: f64 = 1.959_964;

impl Linearised {
    /// Returns the covariance of the coefficients with the corrections. Constants and sizes have the variances of the normal
    /// distributions with the 95 % intervals of their t distributions. `None` if the readings then determine nothing.
    pub(crate) fn covariance(&self, problem: &Problem, fit: &Fit) -> Option<DMatrix<f64>> {
        let weights = DVector::from_fn(problem.len(), |row, _| fit.mode.weights[row] * HEAVY_TAILS);
        let size_variances = size_variances(&problem.space, &fit.hypothesis, &fit.mode, true);
        let at = ScaleProblem {
            problem,
            design: &self.design,
            weights: &weights,
            size_variances: &size_variances,
        };
        let point = at.at(fit.mode.scales, &fit.mode.log_sd)?;
        let Slopes { information, tangents, .. } = at.slopes(&point);
        // With S^-1 = F F', J S J' is X'X for X = F^-1 J', and g' S g the square of F^-1 g.
        // To rounding, very many precise readings may have no positive information: scales are then known.
        let Some(factor) = information.cholesky() else { return Some(point.solution.covariance) };
        let factor = factor.unpack();
        let mut shifts = derivatives_of_mean(&at, &point, &tangents).transpose();
        factor.solve_lower_triangular_mut(&mut shifts);
        let mut covariance = shifts.transpose() * &shifts;
        covariance += &point.solution.covariance;
        for (i, role) in self.design.roles.iter().enumerate() {
            if !matches!(role, Role::Constant(_) | Role::Size(_)) {
                continue;
            }
            let variance = point.solution.covariance[(i, i)];
            let slopes = derivatives_of_variance(&at, &point, i);
            let spread = factor.solve_lower_triangular(&slopes)?.norm_squared();
            if variance > 0.0 && spread > 0.0 {
                let wider = student_95(2.0 * variance * variance / spread) / NORMAL_95;
                for j in 0..self.design.roles.len() {
                    covariance[(i, j)] *= wider;
                    covariance[(j, i)] *= wider;
                }
            }
        }
        Some(covariance)
    }
}

/// Returns the derivatives of the posterior mean with respect to the logarithms of the scales, from the columns `dV P r`.
fn derivatives_of_mean(at: &ScaleProblem<'_>, point: &ScalePoint, tangents: &DMatrix<f64>) -> DMatrix<f64> {
    let projected = point.marginal.white_design.transposed_times(&point.marginal.whitening.whiten(tangents));
    let mut shifts = &point.solution.covariance * projected;
    shifts.iter_mut().for_each(|shift| *shift = -*shift);
    for (i, component) in point.log_sd.keys().enumerate() {
        for column in at.design.columns_of(*component) {
            shifts[(column, SCALES + i)] += 2.0 * point.solution.mean[column];
        }
    }
    shifts
}

/// Returns the derivatives of the variance of a coefficient with respect to the logarithms of the scales.
fn derivatives_of_variance(at: &ScaleProblem<'_>, point: &ScalePoint, coefficient: usize) -> DVector<f64> {
    let mut slopes = DVector::zeros(SCALES + point.log_sd.len());
    let column = point.solution.covariance.column(coefficient);
    let white = point.marginal.white_design.times_vector(&column.into_owned());
    let noise = at.noise(&point.scales);
    for (range, root) in point.marginal.whitening.ranges.iter().zip(&point.marginal.whitening.roots) {
        let mut alpha = white.rows(range.start, range.len()).into_owned();
        root.whiten_transposed(alpha.as_mut_slice());
        for scale in 0..SCALES {
            slopes[scale] += alpha.dot(&noise.derivative(range, scale).times(alpha.as_slice()));
        }
    }
    for (i, (component, log_sd)) in point.log_sd.iter().enumerate() {
        let columns = at.design.columns_of(*component).into_iter();
        let square: f64 = columns.map(|j| column[j] * column[j]).sum();
        slopes[SCALES + i] = 2.0 * square * libm::exp(-2.0 * log_sd);
    }
    slopes
}

/// Returns the 97.5 % quantile of Student's t distribution, at least that of [`FEWEST`] degrees of freedom (Abramowitz and Stegun,
/// Handbook of Mathematical Functions, 26.7.5).
fn student_95(degrees_of_freedom: f64) -> f64 {
    let (z, n) = (NORMAL_95, degrees_of_freedom.max(FEWEST));
    let power = |k: i32| z.powi(k);
    z + (power(3) + z) / (4.0 * n)
        + (5.0 * power(5) + 16.0 * power(3) + 3.0 * z) / (96.0 * n.powi(2))
        + (3.0 * power(7) + 19.0 * power(5) + 17.0 * power(3) - 15.0 * z) / (384.0 * n.powi(3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Start;
    use crate::hypothesis::Hypothesis;
    use crate::problem::{Rows, Space};
    use crate::random::Random;
    use crate::test_problem::{full_hypothesis, problem, rows, space};

    /// Quantiles of a table of Student's t distribution.
    #[test]
    fn quantiles_match_the_table() {
        for (n, quantile) in [(3.0, 3.182), (5.0, 2.571), (10.0, 2.228), (30.0, 2.042), (1e9, 1.960)] {
            assert!((student_95(n) / quantile - 1.0).abs() < 0.01, "{n}: {}", student_95(n));
        }
    }

    /// The derivatives of mean and variance match central differences.
    #[test]
    fn derivatives_match_finite_differences() {
        let problem = problem(6, 0.4);
        let hypothesis = full_hypothesis();
        let fit = Fit::new(&problem, &hypothesis, Start::default()).unwrap();
        let linearised = Linearised::new(&problem, &fit).unwrap();
        let size_variances = size_variances(&problem.space, &hypothesis, &fit.mode, true);
        let (design, weights) = (&linearised.design, &fit.mode.weights);
        let at = ScaleProblem { problem: &problem, design, weights, size_variances: &size_variances };
        let point = &linearised.point;
        let shifts = derivatives_of_mean(&at, point, &at.slopes(point).tangents);
        let slopes = derivatives_of_variance(&at, point, 0);
        for scale in 0..SCALES + point.log_sd.len() {
            let moved = |step: f64| {
                let (mut scales, mut log_sd) = (point.scales, point.log_sd.clone());
                if let Some(log) = scales.log.iter_mut().chain(log_sd.values_mut()).nth(scale) {
                    *log += step;
                }
                at.at(scales, &log_sd).unwrap().solution
            };
            let (above, below) = (moved(1e-4), moved(-1e-4));
            let shift = (&above.mean - &below.mean) / 2e-4;
            let most = shift.amax().max(1e-6);
            assert!((&shift - shifts.column(scale)).amax() < 1e-3 * most, "{scale}: {shift}");
            let slope = (above.covariance[(0, 0)] - below.covariance[(0, 0)]) / 2e-4;
            assert!((slope - slopes[scale]).abs() < 1e-3 * slope.abs().max(1e-9), "{scale}: {slope}");
        }
    }

    /// Of 400 tables with t noise and offsets of series, 95 % of the intervals of the slope contain it.
    #[test]
    fn intervals_contain_the_truth() {
        let mut random = Random::new(5);
        let (mut known, mut unknown) = (0, 0);
        for _ in 0..400 {
            let rows = Rows { levels: vec![], ..rows(8) };
            let shared: Vec<f64> = (0..8).map(|_| 0.03 * random.normal()).collect();
            let reading = |i: usize| 2.0 * rows.load[i] + shared[rows.series[i]] + 0.05 * random.student();
            let readings = (0..rows.len()).map(reading).collect();
            let problem = Problem::new(Space { random_effects: vec![], ..space() }, rows, readings).unwrap();
            let fit = Fit::new(&problem, &Hypothesis::default(), Start::default()).unwrap();
            let linearised = Linearised::new(&problem, &fit).unwrap();
            let slope = linearised.point.solution.mean[0] + linearised.design.prior_mean[0];
            let is_inside = |variance: f64| i32::from((slope - 2.0).abs() < NORMAL_95 * variance.sqrt());
            known += is_inside(linearised.point.solution.covariance[(0, 0)]);
            unknown += is_inside(linearised.covariance(&problem, &fit).unwrap()[(0, 0)]);
        }
        assert!((372..=390).contains(&unknown), "{unknown} of 400; {known} with known scales");
        assert!(known < unknown, "{known} {unknown}");
    }
}
