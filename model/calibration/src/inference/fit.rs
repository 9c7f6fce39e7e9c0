//! Generalised least squares by the Levenberg-Marquardt algorithm, with weak priors as pseudo-rows
//! and a convergence check.

use nalgebra::{DMatrix, DVector};
use pinswitch_friction::LayoutLaw;

use super::model::Model;
use super::noise::Noise;
use super::observations::Observations;
use super::projection::dot;
use super::reliability::Reliability;
use super::significance::gain_at;
use super::weighed::Weighed;
use crate::table::Point;

/// A model fitted to data.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model at its optimum.
    pub model: Model,
    /// Deviance: whitened sum of squares plus the contribution of the priors.
    pub cost: f64,
    /// Residuals in newtons: reading minus prediction.
    pub residual_n: Vec<f64>,
    /// Whether the linearised model predicts no further reduction; a local minimum resembles
    /// missing physics.
    pub converged: bool,
}

/// Returns sensitivities of the readings to all coordinates, in newtons per unit, by forward
/// differences.
pub(crate) fn jacobian(model: &Model, data: &Observations, at: &[f64]) -> Vec<Vec<f64>> {
    let mut shifted = model.clone();
    (0..model.coordinates.len())
        .map(|j| {
            let step = 1e-5 * model.coordinates[j].abs().max(0.1);
            shifted.coordinates[j] = model.coordinates[j] + step;
            let mut column = shifted.predict_changed(&data.points, at, j);
            shifted.coordinates[j] = model.coordinates[j];
            column.iter_mut().zip(at).for_each(|(c, a)| *c = (*c - a) / step);
            column
        })
        .collect()
}

/// Returns `sum ((theta - mean)/sd)^2` over the priors.
fn prior_cost(model: &Model) -> f64 {
    model.coordinates.iter().zip(model.priors()).map(|(c, p)| ((c - p.mean) / p.sd).powi(2)).sum()
}

fn evaluate(model: &Model, weighed: &Weighed<'_>) -> (f64, Vec<f64>, Vec<f64>) {
    let predicted = model.predict(&weighed.data.points);
    let residual: Vec<f64> = weighed.data.force_n.iter().zip(&predicted).map(|(y, f)| y - f).collect();
    let mut white = residual.clone();
    weighed.whiten(&mut white);
    (dot(&white, &white) + prior_cost(model), predicted, white)
}

/// Whitened sensitivities of a model, with quantities derived from them.
pub(crate) struct Slopes {
    columns: Vec<Vec<f64>>,
    /// `J' V^-1 J` plus the contribution of the priors.
    pub(crate) normal: DMatrix<f64>,
}

impl Slopes {
    /// Computes the sensitivities of a model that predicts `predicted`.
    pub(crate) fn new(model: &Model, weighed: &Weighed<'_>, predicted: &[f64]) -> Self {
        let mut columns = jacobian(model, weighed.data, predicted);
        weighed.whiten_all(&mut columns);
        let p = columns.len();
        let mut normal = DMatrix::zeros(p, p);
        for i in 0..p {
            for j in 0..=i {
                let value = dot(&columns[i], &columns[j]);
                normal[(i, j)] = value;
                normal[(j, i)] = value;
            }
            normal[(i, i)] += model.priors()[i].sd.powi(-2);
        }
        Self { columns, normal }
    }

    /// Returns the products of the sensitivities with a whitened column.
    pub(crate) fn along(&self, white: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.columns.len(), self.columns.iter().map(|column| dot(column, white)))
    }

    /// Returns minus half the gradient of the cost.
    fn gradient(&self, model: &Model, white: &[f64]) -> DVector<f64> {
        DVector::from_fn(self.columns.len(), |i, _| {
            let prior = model.priors()[i];
            dot(&self.columns[i], white) - (model.coordinates[i] - prior.mean) / prior.sd.powi(2)
        })
    }
}

/// Ratio of actual to predicted reduction for which the sensitivities are reused.
const STILL_LINEAR: std::ops::RangeInclusive<f64> = 0.8..=1.2;

/// Largest step of a coordinate, which covers the useful range of logarithms and logits.
const MOST_STEP: f64 = 3.0;
/// Coordinate above which the largest step grows in proportion; those of built-in effects are
/// smaller.
const FAR: f64 = 100.0;

/// Fits all constants of a model, from their current values.
pub fn fit(start: &Model, weighed: &Weighed<'_>) -> Fit {
    let mut model = start.clone();
    let (mut cost, mut predicted, mut white) = evaluate(&model, weighed);
    let mut damping = 1e-4;
    let mut converged = false;
    let mut slopes = Slopes::new(&model, weighed, &predicted);
    let mut fresh = true;
    'outer: for _ in 0..60 {
        let g = slopes.gradient(&model, &white);
        let a = &slopes.normal;
        for _ in 0..12 {
            let mut damped = a.clone();
            for i in 0..damped.nrows() {
                damped[(i, i)] += damping * a[(i, i)] + 1e-12;
            }
            let Some(step) = damped.cholesky().map(|c| c.solve(&g)) else {
                damping *= 10.0;
                continue;
            };
            let promised = 2.0 * step.dot(&g) - (a * &step).dot(&step);
            let mut trial = model.clone();
            for (coordinate, step) in trial.coordinates.iter_mut().zip(step.iter()) {
                // Sizes of user-defined effects may be thousands of their unit.
                let most = MOST_STEP * (coordinate.abs() / FAR).max(1.0);
                *coordinate += step.clamp(-most, most);
            }
            let (trial_cost, trial_predicted, trial_white) = evaluate(&trial, weighed);
            if promised < 1e-3 && trial_cost >= cost {
                converged = true;
                break 'outer;
            }
            if trial_cost < cost {
                let gained = cost - trial_cost;
                (model, cost, predicted, white) = (trial, trial_cost, trial_predicted, trial_white);
                damping = (damping * if gained > 0.5 * promised { 0.1 } else { 1.0 }).max(1e-9);
                if promised < 1e-2 && gained < 1e-2 {
                    converged = true;
                    break 'outer;
                }
                // The sensitivities are reused once if the model has been linear.
                fresh = !(fresh && STILL_LINEAR.contains(&(gained / promised)));
                if fresh {
                    slopes = Slopes::new(&model, weighed, &predicted);
                }
                continue 'outer;
            }
            if !fresh {
                fresh = true;
                slopes = Slopes::new(&model, weighed, &predicted);
                continue 'outer;
            }
            damping = (damping * 8.0).max(1e-6);
        }
        break;
    }
    let residual_n = weighed.data.force_n.iter().zip(&predicted).map(|(y, f)| y - f).collect();
    Fit { model, cost, residual_n, converged }
}

/// Returns the covariance of the constants' coordinates from the normal equations, scaled by at
/// least one.
pub fn coordinate_covariance(fitted: &Fit, weighed: &Weighed<'_>) -> DMatrix<f64> {
    let (_, predicted, white) = evaluate(&fitted.model, weighed);
    let a = Slopes::new(&fitted.model, weighed, &predicted).normal;
    let degrees = (weighed.data.points.len() as f64 - a.nrows() as f64).max(1.0);
    let scale = (dot(&white, &white) / degrees).max(1.0);
    a.clone().cholesky().map_or_else(|| DMatrix::zeros(a.nrows(), a.ncols()), |c| c.inverse() * scale)
}

/// Returns half widths of 95 % intervals of all constants in their own units: Student's t with the
/// degrees of freedom of each, since the noise is estimated (Satterthwaite's approximation).
pub fn interval_half_widths(fitted: &Fit, weighed: &Weighed<'_>) -> Vec<f64> {
    let covariance = coordinate_covariance(fitted, weighed);
    let predicted: Vec<f64> =
        weighed.data.force_n.iter().zip(&fitted.residual_n).map(|(y, r)| y - r).collect();
    let columns = jacobian(&fitted.model, weighed.data, &predicted);
    let information: Vec<f64> = (0..columns.len()).map(|i| 1.0 / covariance[(i, i)].max(1e-300)).collect();
    let quantiles: Vec<f64> =
        Reliability::degrees_of_each(weighed.data, weighed.noise, &columns, &information)
            .into_iter()
            .map(|degrees| gain_at(0.05, 1, degrees).sqrt())
            .collect();
    (0..covariance.nrows())
        .map(|i| quantiles[i] * covariance[(i, i)].max(0.0).sqrt() * fitted.model.value(i).1.abs())
        .collect()
}

/// Returns standard deviations of predicted readings in newtons, from the noise of a reading and
/// the uncertainty of the constants. Rows of `covariance` beyond the model's constants are ignored,
/// missing ones count as certain.
pub fn prediction_sd_n(model: &Model, points: &[Point], covariance: &[Vec<f64>], noise: Noise) -> Vec<f64> {
    let at = model.predict(points);
    let friction = model.friction_n(points);
    let mut shifted = model.clone();
    let columns: Vec<Vec<f64>> = (0..model.coordinates.len())
        .map(|j| {
            let step = 1e-5 * model.coordinates[j].abs().max(0.1);
            shifted.coordinates[j] = model.coordinates[j] + step;
            let moved = shifted.predict(points);
            shifted.coordinates[j] = model.coordinates[j];
            moved.iter().zip(&at).map(|(m, a)| (m - a) / step).collect()
        })
        .collect();
    let same = covariance.len() == columns.len();
    (0..points.len())
        .map(|row| {
            let mut variance = noise.at(points[row].load_n, friction[row]).powi(2);
            for (i, line) in covariance.iter().enumerate().filter(|_| same) {
                for (j, c) in line.iter().enumerate() {
                    variance += columns[i][row] * c * columns[j][row];
                }
            }
            if !same {
                // An unmeasured layout: the uncertainty of the layout law, relative to the friction
                // force.
                variance += (LayoutLaw::UNCERTAINTY * (at[row] - points[row].load_n)).powi(2);
            }
            variance.max(0.0).sqrt()
        })
        .collect()
}
