//! Prediction of each series from the others, exact for the linear model at the mode.
//!
//! With `H = I - A_s C A_s'` for the white columns `A_s` of a series and the posterior covariance
//! `C`, the residual of the series given all others is `W^-1 H^-1 W (r - A b)`, where `W` is the root of its
//! precision. Nothing is fitted again.
//!
//! A series that alone determines a coefficient is predicted worse from the others than a new series
//! at its conditions will be from all. The square root of `H^-1` standardises the residual, and that of
//! `I + A_s C A_s'` gives it the spread of a new series.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::design::{Design, Role};
use crate::fit::{Fit, size_variances};
use crate::marginal::posterior_mean;
use crate::problem::Problem;
use crate::scales::{ScalePoint, ScaleProblem};

/// Series predicted from the others.
#[derive(Clone, Debug)]
pub(crate) struct LeftOut {
    /// Reading minus prediction of each row.
    pub(crate) residuals: Vec<f64>,
    /// The same residuals, with the spread that they have for a new series at the same conditions:
    /// the series itself then helps to predict it.
    pub(crate) of_new_series: Vec<f64>,
    /// `ln p(y_s | y_-s, H)` of each series.
    pub(crate) log_predictive: Vec<f64>,
}

/// Linear model of a fit at its mode.
pub(crate) struct Linearised {
    pub(crate) design: Design,
    pub(crate) point: ScalePoint,
}

impl Linearised {
    pub(crate) fn new(problem: &Problem, fit: &Fit) -> Option<Self> {
        let variances = size_variances(&problem.space, &fit.hypothesis, &fit.mode, true);
        let design = Design::new(problem, &fit.hypothesis, &fit.mode)?;
        let at =
            ScaleProblem { problem, design: &design, weights: &fit.mode.weights, size_variances: &variances };
        let point = at.at(fit.mode.scales, &fit.mode.log_sd)?;
        Some(Self { design, point })
    }

    /// Predicts each series from the others; `None` if a series determines a coefficient alone, to
    /// rounding.
    pub(crate) fn leave_series_out(&self) -> Option<LeftOut> {
        let (marginal, solution) = (&self.point.marginal, &self.point.solution);
        let residual = marginal.white_residual(&solution.mean);
        let zeros = vec![0.0; residual.len()];
        let mut left_out =
            LeftOut { residuals: zeros.clone(), of_new_series: zeros, log_predictive: Vec::new() };
        let parts = marginal.white_design.times(&solution.root.transpose());
        for (range, root) in marginal.whitening.ranges.iter().zip(&marginal.whitening.roots) {
            let (first, length) = (range.start, range.len());
            let part = parts.rows(first, length).into_owned();
            let leverage = Leverage::new(&part);
            // A series that determines a coefficient alone leaves none of its variance.
            let left = |share: f64| 1.0 + 1e-10 - share;
            if leverage.shares.iter().any(|share| left(*share) <= 0.0) {
                return None;
            }
            let own = residual.rows(first, length).into_owned();
            let scaled = leverage.apply(|share| 1.0 / left(share), &own);
            let unscaled = &mut left_out.residuals[range.clone()];
            unscaled.copy_from_slice(scaled.as_slice());
            root.colour(unscaled);
            // Standard normal under the model, whatever the leverage of the series, and then with the spread of a new one.
            let new_series = leverage.apply(|share| ((1.0 + share) / left(share)).sqrt(), &own);
            let new = &mut left_out.of_new_series[range.clone()];
            new.copy_from_slice(new_series.as_slice());
            root.colour(new);
            let precision = 0.5 * leverage.shares.iter().map(|share| libm::log(left(*share))).sum::<f64>();
            let normaliser = 0.5 * length as f64 * libm::log(2.0 * std::f64::consts::PI);
            left_out
                .log_predictive
                .push(-0.5 * own.dot(&scaled) + precision - root.log_determinant - normaliser);
        }
        Some(left_out)
    }
}

/// Leverage `Z Z'` of a series on the coefficients, by its eigenvalues, which are shares of the variance, and their vectors: as
/// many as the smaller of rows and coefficients.
pub(crate) struct Leverage {
    pub(crate) shares: Vec<f64>,
    vectors: DMatrix<f64>,
}

/// Smallest share that changes a residual.
const LEAST_SHARE: f64 = 1e-12;

impl Leverage {
    pub(crate) fn new(z: &DMatrix<f64>) -> Self {
        let is_long = z.nrows() > z.ncols();
        let eigen = if is_long { z.tr_mul(z) } else { z * z.transpose() }.symmetric_eigen();
        let kept: Vec<usize> =
            (0..eigen.eigenvalues.len()).filter(|i| eigen.eigenvalues[*i] > LEAST_SHARE).collect();
        let shares: Vec<f64> = kept.iter().map(|i| eigen.eigenvalues[*i]).collect();
        let mut vectors = eigen.eigenvectors.select_columns(&kept);
        if is_long {
            vectors = z * vectors;
            for (mut vector, share) in vectors.column_iter_mut().zip(&shares) {
                vector /= share.sqrt();
            }
        }
        Self { shares, vectors }
    }

    /// Returns the product of a function of `Z Z'` and a vector.
    pub(crate) fn apply(&self, function: impl Fn(f64) -> f64, x: &DVector<f64>) -> DVector<f64> {
        let rest = function(0.0);
        let mut along = self.vectors.tr_mul(x);
        for (along, share) in along.iter_mut().zip(&self.shares) {
            *along *= function(*share) - rest;
        }
        x * rest + &self.vectors * along
    }
}

/// Predicts the series of each group from those of all other groups, with the noise and the members of
/// a fit. `group_of_series` has the group of each series; constants of the baseline that `own` lists for
/// a group are then fitted to it, since no other group determines them. Returns reading minus
/// prediction of each row; `None` if the design of the fit is not finite.
pub fn leave_groups_out(
    problem: &Problem,
    fit: &Fit,
    group_of_series: &[usize],
    own: impl Fn(usize) -> Vec<usize>,
) -> Option<Vec<f64>> {
    let Linearised { design, point } = Linearised::new(problem, fit)?;
    let marginal = &point.marginal;
    let mut residuals = vec![0.0; problem.len()];
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (row, series) in problem.rows.series.iter().enumerate() {
        if let Some(group) = group_of_series.get(*series) {
            groups.entry(*group).or_default().push(row);
        }
    }
    let white_columns = marginal.white_design.columns();
    for (group, out) in groups {
        let matrix = white_columns.select_rows(&out);
        let target = marginal.white_target.select_rows(&out);
        let gram = &marginal.gram - matrix.tr_mul(&matrix);
        let moment = &marginal.moment - matrix.tr_mul(&target);
        let mut mean = posterior_mean(gram, &moment, &point.variances)?;
        let own = own(group);
        let is_own = |role: &Role| matches!(role, Role::Constant(i) if own.contains(i));
        let columns: Vec<usize> = (0..design.roles.len()).filter(|i| is_own(&design.roles[*i])).collect();
        if !columns.is_empty() {
            let part = matrix.select_columns(&columns);
            let left = part.tr_mul(&(target - &matrix * &mean));
            let variances: Vec<f64> = columns.iter().map(|i| point.variances[*i]).collect();
            let moved = posterior_mean(part.tr_mul(&part), &left, &variances)?;
            columns.iter().zip(moved.iter()).for_each(|(i, step)| mean[*i] += step);
        }
        for row in out {
            residuals[row] = design.target[row] - (design.matrix.row(row) * &mean)[0];
        }
    }
    Some(residuals)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::covariance::Noise;
    use crate::marginal::Marginal;
    use crate::test_problem::{ROWS_PER_SERIES, fitted, full_hypothesis, problem, rows};

    /// Leaving one series out of many is a group of one series.
    #[test]
    fn groups_of_one_series_match_single_series() {
        let problem = problem(7, 0.4);
        let (fit, ..) = fitted(&problem, &full_hypothesis());
        let single = Linearised::new(&problem, &fit).unwrap().leave_series_out().unwrap();
        let groups: Vec<usize> = (0..7).collect();
        let grouped = leave_groups_out(&problem, &fit, &groups, |_| Vec::new()).unwrap();
        for (a, b) in grouped.iter().zip(&single.residuals) {
            assert!((a - b).abs() < 1e-7, "{a} {b}");
        }
    }

    /// Prediction of the last series equals that of a solution without its rows.
    #[test]
    fn left_out_residuals_match_a_refit() {
        let problem = problem(7, 0.4);
        let hypothesis = full_hypothesis();
        let (fit, design, point) = fitted(&problem, &hypothesis);
        let left_out = Linearised::new(&problem, &fit).unwrap().leave_series_out().unwrap();

        let kept = problem.len() - ROWS_PER_SERIES;
        let fewer = rows(6);
        let weights = fit.mode.weights.rows(0, kept).into_owned();
        let noise = Noise::new(&fewer, &problem.reference, &point.scales, &weights, &design.channels[1]);
        let matrix = design.matrix.rows(0, kept).into_owned();
        let target = design.target.rows(0, kept).into_owned();
        let marginal = Marginal::new(&matrix, &[], &target, &noise, &fewer.ranges()).unwrap();
        let solution = marginal.solve(&point.variances).unwrap();
        let predicted = &design.matrix * &solution.mean;
        for row in kept..problem.len() {
            let expected = design.target[row] - predicted[row];
            assert!((left_out.residuals[row] - expected).abs() < 1e-7, "{row}");
        }
        let difference = point.solution.log_likelihood - solution.log_likelihood;
        assert!((left_out.log_predictive[6] - difference).abs() < 1e-6);
    }
}
