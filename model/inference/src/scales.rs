//! Mode of the scales: those of the noise, and the standard deviations of components.
//!
//! Newton's method in the logarithms of the scales, with the average information matrix (Gilmour,
//! Thompson and Cullis 1995) in place of the second derivatives of the marginal likelihood.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::covariance::{Derivative, Noise};
use crate::design::{Component, Design, Mode};
use crate::marginal::{Marginal, Solution};
use crate::noise::{AUTOREGRESSIONS, SCALES, Scales};
use crate::problem::Problem;
use crate::traces::{Explained, diagonal_of_repetition};

/// Information that is added to each scale, so that a step is finite where the data have none.
const DAMPING: f64 = 0.05;
/// Largest step of the logarithm of a scale.
const MOST_STEP: f64 = 1.2;
/// Range of the logarithm of a scale.
const LOG_RANGE: (f64, f64) = (-12.0, 8.0);
/// Times that a step is halved before the search gives up.
const HALVINGS: usize = 3;
/// Information that is added where no shorter Newton step gains (Levenberg and Marquardt): scales that the readings do not
/// separate make a step long, and its limited components are another direction.
const MORE_DAMPING: [f64; 4] = [0.0, 1.0, 10.0, 100.0];
/// Gain in nats below which a step is the last one.
const CONVERGED: f64 = 0.02;

/// Scales of a hypothesis, with its design, weights and prior variances of sizes fixed.
pub(crate) struct ScaleProblem<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) design: &'a Design,
    pub(crate) weights: &'a DVector<f64>,
    pub(crate) size_variances: &'a BTreeMap<usize, f64>,
}

/// Value of the scales.
#[derive(Clone, Debug)]
pub(crate) struct ScalePoint {
    pub(crate) scales: Scales,
    pub(crate) log_sd: BTreeMap<Component, f64>,
    pub(crate) variances: Vec<f64>,
    pub(crate) marginal: Marginal,
    pub(crate) solution: Solution,
    /// Marginal likelihood plus the prior density of all scales.
    pub(crate) log_posterior: f64,
}

/// Slopes of the log posterior in the logarithms of the scales: those of the noise, then of the components.
pub(crate) struct Slopes {
    pub(crate) gradient: DVector<f64>,
    /// Average information of the readings, with the curvature of the priors.
    pub(crate) information: DMatrix<f64>,
    /// The column `dV P r` of each scale.
    pub(crate) tangents: DMatrix<f64>,
}

impl ScaleProblem<'_> {
    pub(crate) fn noise<'b>(&'b self, scales: &'b Scales) -> Noise<'b> {
        Noise::new(
            &self.problem.rows,
            &self.problem.reference,
            scales,
            self.weights,
            &self.design.channels[self.problem.space.series_scale_channel],
        )
    }

    /// Evaluates the scales of a mode.
    pub(crate) fn at(&self, scales: Scales, log_sd: &BTreeMap<Component, f64>) -> Option<ScalePoint> {
        let (problem, design) = (self.problem, self.design);
        let noise = self.noise(&scales);
        let marginal =
            Marginal::new(&design.matrix, &design.of_series, &design.target, &noise, &problem.ranges)?;
        let size = |effect: usize| self.size_variances.get(&effect).copied().unwrap_or(0.0);
        let variances = design.prior_variances(&problem.space, log_sd, size);
        let solution = marginal.solve(&variances)?;
        let mut log_posterior = solution.log_likelihood + scales.log_prior(&problem.reference).0;
        for (component, log) in log_sd {
            log_posterior += component.prior(&self.problem.space).log_density(*log).0;
        }
        Some(ScalePoint { scales, log_sd: log_sd.clone(), variances, marginal, solution, log_posterior })
    }

    /// Takes Newton steps from a mode until they gain little, at most `steps`.
    pub(crate) fn maximum(&self, mode: &Mode, steps: usize) -> Option<ScalePoint> {
        let mut point = self.at(mode.scales, &mode.log_sd)?;
        for _ in 0..steps {
            let Some(better) = self.ascend(&point) else { break };
            let gain = better.log_posterior - point.log_posterior;
            point = better;
            if gain < CONVERGED {
                break;
            }
        }
        Some(point)
    }

    /// Returns the best of the autoregressions at the scales of a point.
    pub(crate) fn best_autoregression(&self, point: ScalePoint) -> ScalePoint {
        let current = point.scales.autoregression;
        (0..AUTOREGRESSIONS.len()).filter(|a| *a != current).fold(point, |best, autoregression| {
            let other = self.at(Scales { autoregression, ..best.scales }, &best.log_sd);
            other.filter(|other| other.log_posterior > best.log_posterior).unwrap_or(best)
        })
    }

    /// Shortens a step until it gains.
    fn line_search(&self, point: &ScalePoint, step: &[f64]) -> Option<ScalePoint> {
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            let mut scales = point.scales;
            let mut log_sd = point.log_sd.clone();
            let logs = scales.log.iter_mut().chain(log_sd.values_mut());
            for (log, step) in logs.zip(step) {
                *log = (*log + share * step.clamp(-MOST_STEP, MOST_STEP)).clamp(LOG_RANGE.0, LOG_RANGE.1);
            }
            let moved = self.at(scales, &log_sd).filter(|moved| moved.log_posterior > point.log_posterior);
            if moved.is_some() {
                return moved;
            }
            share *= 0.35;
        }
        None
    }

    /// Takes a Newton step of all scales, with more damping if none gains; `None` if little is expected of it.
    fn ascend(&self, point: &ScalePoint) -> Option<ScalePoint> {
        let Slopes { gradient, information, .. } = self.slopes(point);
        for damping in MORE_DAMPING {
            let damped = &information + DMatrix::identity(gradient.len(), gradient.len()) * damping;
            let Some(factors) = damped.cholesky() else { continue };
            let step = factors.solve(&gradient);
            let gain = 0.5 * step.dot(&gradient);
            if !gain.is_finite() || gain < CONVERGED {
                return None;
            }
            if let Some(better) = self.line_search(point, step.as_slice()) {
                return Some(better);
            }
        }
        None
    }

    /// Returns the slopes of the log posterior in the logarithms of the scales.
    pub(crate) fn slopes(&self, point: &ScalePoint) -> Slopes {
        let (mut gradient, tangents) = self.likelihood_gradient(point);
        let white = point.marginal.whitening.whiten(&tangents);
        let projected = point.marginal.white_design.transposed_times(&white);
        let explained = &point.solution.root * &projected;
        let mut information = (white.transpose() * &white - explained.transpose() * &explained) * 0.5;
        for (i, (slope, curvature)) in self.prior_slopes(point).into_iter().enumerate() {
            gradient[i] += slope;
            information[(i, i)] += curvature;
        }
        Slopes { gradient, information, tangents }
    }

    /// Returns the slope of the prior of the logarithm of each scale, and its curvature with the damping.
    fn prior_slopes(&self, point: &ScalePoint) -> Vec<(f64, f64)> {
        let (_, slopes, curvatures) = point.scales.log_prior(&self.problem.reference);
        let components = point.log_sd.iter().map(|(c, log)| c.prior(&self.problem.space).log_density(*log));
        let all = slopes
            .into_iter()
            .zip(curvatures)
            .chain(components.map(|(_, slope, curvature)| (slope, curvature)));
        all.map(|(slope, curvature)| (slope, curvature + DAMPING)).collect()
    }

    /// Returns the gradient of the marginal likelihood, and the column `dV P r` of each scale.
    fn likelihood_gradient(&self, point: &ScalePoint) -> (DVector<f64>, DMatrix<f64>) {
        let count = SCALES + point.log_sd.len();
        let mut gradient = DVector::zeros(count);
        let mut tangents = DMatrix::zeros(self.problem.len(), count);
        let noise = self.noise(&point.scales);
        let (marginal, solution) = (&point.marginal, &point.solution);
        let white_residual = marginal.white_residual(&solution.mean);
        let repetition = diagonal_of_repetition(&noise, marginal, &solution.covariance);
        // Of `A'V^-1 F` with the factors `F` of each series.
        let mut explained = Explained::new(solution);
        for (series, (range, root)) in
            marginal.whitening.ranges.iter().zip(&marginal.whitening.roots).enumerate()
        {
            let (first, length) = (range.start, range.len());
            let mut alpha = white_residual.rows(first, length).into_owned();
            root.whiten_transposed(alpha.as_mut_slice());
            for scale in 0..SCALES {
                let derivative = noise.derivative(range, scale);
                let tangent = derivative.times(alpha.as_slice());
                gradient[scale] += 0.5 * alpha.dot(&tangent);
                tangents.view_mut((first, scale), (length, 1)).copy_from(&tangent);
                match derivative {
                    Derivative::Factor(mut factor) => {
                        factor.as_mut_slice().chunks_exact_mut(length).for_each(|x| root.whiten(x));
                        gradient[scale] -= 0.5 * factor.norm_squared();
                        let (rows, of_series) = marginal.white_design.transposed_times_in(series, &factor);
                        explained.add(scale, &rows, &of_series, &mut gradient);
                    }
                    Derivative::Repetition { growth, .. } => {
                        let of_rows = growth.iter().zip(&repetition.as_slice()[range.clone()]);
                        gradient[scale] -= of_rows.map(|(growth, x)| growth * x).sum::<f64>();
                    }
                }
            }
        }
        explained.finish(&mut gradient);
        for (i, (component, log)) in point.log_sd.iter().enumerate() {
            let columns = self.design.columns_of(*component);
            let precision = libm::exp(-2.0 * log);
            for column in columns {
                let (mean, variance) = (solution.mean[column], solution.covariance[(column, column)]);
                gradient[SCALES + i] += (mean * mean + variance) * precision - 1.0;
                tangents.column_mut(SCALES + i).axpy(2.0 * mean, &self.design.matrix.column(column), 1.0);
            }
        }
        (gradient, tangents)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::size_variances;
    use crate::noise::EXCLUDED;
    use crate::random::Random;
    use crate::test_problem::{fitted, full_hypothesis, problem, rows, unit_weights};

    /// The gradient of the marginal likelihood matches central differences, without and with autocorrelation: with two mounts and
    /// equal weights, and with 24 mounts, weights, an excluded reading, and steps of the load cell.
    #[test]
    fn gradient_matches_finite_differences() {
        let plain = problem(6, 0.4);
        let unit = unit_weights(&plain);
        assert_gradients(&plain, &unit);
        const MOUNTS: usize = 24;
        let mut rows = rows(2 * MOUNTS);
        rows.levels = vec![rows.series.iter().map(|series| Some(series / 2)).collect()];
        let mut space = plain.space.clone();
        space.random_effects[0].levels = MOUNTS;
        let mut random = Random::new(4);
        let readings = rows.load.iter().map(|load| 2.0 * load + 0.1 * random.normal()).collect();
        let mut mounts = Problem::new(space, rows, readings).unwrap();
        mounts.reference.quantum = 0.03;
        let weight = |row: usize| if row == 4 { EXCLUDED } else { 0.3 + random.uniform() };
        let weights = DVector::from_iterator(mounts.len(), (0..mounts.len()).map(weight));
        assert_gradients(&mounts, &weights);
    }

    fn assert_gradients(problem: &Problem, weights: &DVector<f64>) {
        let hypothesis = full_hypothesis();
        let (fit, design, _) = fitted(problem, &hypothesis);
        let size_variances = size_variances(&problem.space, &hypothesis, &fit.mode, true);
        let at = ScaleProblem { problem, design: &design, weights, size_variances: &size_variances };
        for autoregression in [0, 2] {
            let scales = Scales { log: [-3.3, -0.4, -3.5, -3.0, -4.0, -3.6], autoregression };
            assert_gradient(&at, scales);
        }
    }

    fn assert_gradient(at: &ScaleProblem<'_>, scales: Scales) {
        let log_sd: BTreeMap<Component, f64> =
            [(Component::Random(0), -4.0), (Component::Kernel(0), -2.0)].into();
        let (gradient, _) = at.likelihood_gradient(&at.at(scales, &log_sd).unwrap());
        let likelihood = |index: usize, step: f64| {
            let (mut scales, mut log_sd) = (scales, log_sd.clone());
            if let Some(log) = scales.log.iter_mut().chain(log_sd.values_mut()).nth(index) {
                *log += step;
            }
            at.at(scales, &log_sd).unwrap().solution.log_likelihood
        };
        for index in 0..gradient.len() {
            let slope = (likelihood(index, 1e-4) - likelihood(index, -1e-4)) / 2e-4;
            assert!((gradient[index] - slope).abs() < 1e-4 * (1.0 + slope.abs()), "{index}: {slope}");
        }
    }

    /// No step of a tenth in any scale gains after the Newton steps.
    #[test]
    fn newton_steps_reach_the_maximum() {
        let problem = problem(12, 0.4);
        let hypothesis = full_hypothesis();
        let (fit, design, _) = fitted(&problem, &hypothesis);
        let size_variances = size_variances(&problem.space, &hypothesis, &fit.mode, true);
        let at = ScaleProblem {
            problem: &problem,
            design: &design,
            weights: &fit.mode.weights,
            size_variances: &size_variances,
        };
        let best = at.maximum(&fit.mode, 30).unwrap();
        for index in 0..SCALES + best.log_sd.len() {
            for step in [-0.1, 0.1] {
                let (mut scales, mut log_sd) = (best.scales, best.log_sd.clone());
                if let Some(log) = scales.log.iter_mut().chain(log_sd.values_mut()).nth(index) {
                    *log += step;
                }
                let moved = at.at(scales, &log_sd).unwrap().log_posterior;
                assert!(moved < best.log_posterior + 0.02, "{index} {step}");
            }
        }
    }
}
