//! Nonlinear least squares by Levenberg and Marquardt with forward differences, for a handful of parameters.

use nalgebra::{DMatrix, DVector};
use pinswitch_diagnostic::Diagnostic;

/// Steps before the search ends.
const MAX_STEPS: usize = 60;
/// Relative gain of a step below which the search has converged.
const MIN_GAIN: f64 = 1e-12;

/// Where the sum of squares is least.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The parameters.
    pub at: Vec<f64>,
    /// The residuals there.
    pub residuals: Vec<f64>,
    /// `(J'J)^-1`: times the residuals' variance, the covariance of the parameters.
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
        Self::new(format!("the data do not determine the {parameters} parameters"))
            .with_help("add observations, or fit fewer parameters")
    }
}

/// Minimises the sum of squares of `residuals` from `start`; derivatives by forward differences of `step`. The inner
/// result carries errors of the residuals themselves.
///
/// ```
/// use pinswitch_friction::least_squares::minimise;
/// use std::convert::Infallible;
///
/// // A line through three points.
/// let residuals = |p: &[f64]| Ok::<_, Infallible>(vec![p[0] - 1.0, p[0] + p[1] - 3.0, p[0] + 2.0 * p[1] - 5.0]);
/// let Ok(found) = minimise(&[0.0, 0.0], 1e-6, residuals);
/// let line = found?.at;
/// assert!((line[0] - 1.0).abs() < 1e-6 && (line[1] - 2.0).abs() < 1e-6);
/// # Ok::<(), pinswitch_friction::least_squares::LeastSquaresError>(())
/// ```
///
/// # Errors
/// [`LeastSquaresError::Undetermined`]; whatever `residuals` returns.
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
        let tried: Vec<f64> = at.iter().zip(move_by.iter()).map(|(a, m)| a - m).collect();
        let there = DVector::from_vec(residuals(&tried)?);
        let gain = here.norm_squared() - there.norm_squared();
        if gain > 0.0 {
            at = tried;
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
    fn finds_the_valley_of_rosenbrock() {
        let residuals =
            |p: &[f64]| Ok::<_, std::convert::Infallible>(vec![10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]);
        let Ok(found) = minimise(&[-1.2, 1.0], 1e-7, residuals);
        let found = found.unwrap();
        assert!(found.at.iter().all(|p| (p - 1.0).abs() < 1e-5), "{:?}", found.at);
    }

    #[test]
    fn parameters_that_do_nothing_are_undetermined() {
        let Ok(found) = minimise(&[1.0, 1.0], 1e-6, |p: &[f64]| {
            Ok::<_, std::convert::Infallible>(vec![p[0], 2.0 * p[0]])
        });
        assert!(found.is_err());
    }
}
