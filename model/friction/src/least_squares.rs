//! Nonlinear least squares with few parameters: the Levenberg-Marquardt method with forward
//! differences.

use nalgebra::{DMatrix, DVector};
use pinswitch_diagnostic::{Diagnostic, codes};

/// Largest number of steps.
const MAX_STEPS: usize = 60;
/// Relative decrease of the sum of squares below which the iteration has converged.
const MIN_GAIN: f64 = 1e-12;

/// Minimum of a sum of squares.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Parameters at the minimum.
    pub at: Vec<f64>,
    /// Residuals at the minimum.
    pub residuals: Vec<f64>,
    /// `(J'J)^-1`; multiplied by the variance of the residuals, the covariance of the parameters.
    pub inverse_normal: DMatrix<f64>,
}

/// Reason why a least-squares problem has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", Diagnostic::from(self.clone()))]
#[non_exhaustive]
pub enum LeastSquaresError {
    /// The residuals do not depend on some direction of the parameters.
    Undetermined {
        /// Number of parameters.
        parameters: usize,
    },
}

impl From<LeastSquaresError> for Diagnostic {
    fn from(error: LeastSquaresError) -> Self {
        let LeastSquaresError::Undetermined { parameters } = error;
        Self::new(
            codes::PHYSICS_NOT_CONVERGED,
            format!("the data do not determine the {parameters} parameters"),
        )
        .with_help("add observations, or fit fewer parameters")
    }
}

/// Minimises the sum of squares of `residuals` from `start`, with derivatives by forward
/// differences of `step`.
///
/// The outer result has the errors of `residuals`, the inner one those of the method.
///
/// ```
/// use pinswitch_friction::least_squares::minimise;
/// use std::convert::Infallible;
///
/// // A line through three points.
/// let points = [(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)];
/// let residuals =
///     |p: &[f64]| Ok::<_, Infallible>(points.iter().map(|(x, y)| p[0] + p[1] * x - y).collect());
/// let Ok(solution) = minimise(&[0.0, 0.0], 1e-6, residuals);
/// let line = solution?.at;
/// assert!((line[0] - 1.0).abs() < 1e-6 && (line[1] - 2.0).abs() < 1e-6);
/// # Ok::<(), pinswitch_friction::least_squares::LeastSquaresError>(())
/// ```
///
/// # Errors
/// Any error of `residuals`, and [`LeastSquaresError::Undetermined`].
pub fn minimise<E>(
    start: &[f64],
    step: f64,
    residuals: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<Result<Solution, LeastSquaresError>, E> {
    let mut at = start.to_vec();
    let mut here = DVector::from_vec(residuals(&at)?);
    let mut damping = 1e-3;
    let mut jacobian = derivatives(&at, &here, step, &residuals)?;
    for _ in 0..MAX_STEPS {
        let normal = jacobian.transpose() * &jacobian;
        let gradient = jacobian.transpose() * &here;
        let mut damped = normal.clone();
        (0..at.len()).for_each(|i| damped[(i, i)] *= 1.0 + damping);
        let Some(move_by) = damped.cholesky().map(|c| c.solve(&gradient)) else {
            return Ok(Err(LeastSquaresError::Undetermined { parameters: at.len() }));
        };
        let trial: Vec<f64> = at.iter().zip(move_by.iter()).map(|(a, m)| a - m).collect();
        let there = DVector::from_vec(residuals(&trial)?);
        let gain = here.norm_squared() - there.norm_squared();
        if gain > 0.0 {
            at = trial;
            let done = gain <= MIN_GAIN * here.norm_squared();
            here = there;
            damping = (damping / 10.0).max(1e-12);
            jacobian = derivatives(&at, &here, step, &residuals)?;
            if done {
                break;
            }
        } else if damping > 1e8 || move_by.norm() < 1e-10 {
            break;
        } else {
            damping *= 10.0;
        }
    }
    let normal = jacobian.transpose() * &jacobian;
    Ok(match normal.try_inverse() {
        Some(inverse_normal) => Ok(Solution { at, residuals: here.as_slice().to_vec(), inverse_normal }),
        None => Err(LeastSquaresError::Undetermined { parameters: start.len() }),
    })
}

/// Returns the Jacobian of `residuals` at `at`.
fn derivatives<E>(
    at: &[f64],
    here: &DVector<f64>,
    step: f64,
    residuals: &impl Fn(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<DMatrix<f64>, E> {
    let mut jacobian = DMatrix::zeros(here.len(), at.len());
    for j in 0..at.len() {
        let mut moved = at.to_vec();
        moved[j] += step;
        let column = (DVector::from_vec(residuals(&moved)?) - here) / step;
        jacobian.set_column(j, &column);
    }
    Ok(jacobian)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rosenbrock_minimum_is_found() {
        let residuals =
            |p: &[f64]| Ok::<_, std::convert::Infallible>(vec![10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]);
        let Ok(solution) = minimise(&[-1.2, 1.0], 1e-7, residuals);
        let at = solution.unwrap().at;
        assert!(at.iter().all(|p| (p - 1.0).abs() < 1e-5), "{at:?}");
    }

    #[test]
    fn unused_parameters_are_undetermined() {
        let Ok(solution) = minimise(&[1.0, 1.0], 1e-6, |p: &[f64]| {
            Ok::<_, std::convert::Infallible>(vec![p[0], 2.0 * p[0]])
        });
        assert!(solution.is_err());
    }
}
