//! Posterior of the coefficients of a fitted hypothesis, for models that leave the inference.

use nalgebra::DMatrix;

use crate::design::{Component, Role};
use crate::fit::Fit;
use crate::leave_out::Linearised;
use crate::problem::Problem;

/// What a coefficient multiplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coefficient {
    /// Constant of the baseline, in its coordinate.
    Constant(usize),
    /// Size of an effect.
    Size(usize),
    /// Shift of a constant of the shape of an effect, in standard deviations of its prior.
    Shape(usize, usize),
    /// Discrepancy of an effect: the first, second, ... of its columns.
    Discrepancy(usize, usize),
    /// Level of a random effect.
    Level(usize, usize),
    /// Coefficient of a kernel's basis.
    Kernel(usize, usize),
}

/// Coefficients with their joint posterior, which is normal about the mode.
#[derive(Clone, Debug)]
pub struct Coefficients {
    /// The coefficients.
    pub roles: Vec<Coefficient>,
    /// Posterior means; constants and sizes are absolute.
    pub mean: Vec<f64>,
    /// Posterior covariance, in which weights and scales are not known.
    pub covariance: DMatrix<f64>,
    /// Expectation of each fitted reading, without the offsets of its series.
    pub predicted: Vec<f64>,
}

impl Coefficients {
    /// Returns the coefficients of a fit; `None` if its design is not finite.
    pub fn new(problem: &Problem, fit: &Fit) -> Option<Self> {
        let linearised = Linearised::new(problem, fit)?;
        let covariance = linearised.covariance(problem, fit)?;
        let Linearised { design, point } = linearised;
        let mut roles: Vec<Coefficient> = Vec::new();
        for role in &design.roles {
            let count =
                |is_alike: &dyn Fn(&Coefficient) -> bool| roles.iter().filter(|r| is_alike(r)).count();
            roles.push(match *role {
                Role::Constant(i) => Coefficient::Constant(i),
                Role::Size(effect) => Coefficient::Size(effect),
                Role::Shape(effect, i) => Coefficient::Shape(effect, i),
                Role::Discrepancy(effect) => Coefficient::Discrepancy(
                    effect,
                    count(&|r| matches!(r, Coefficient::Discrepancy(e, _) if *e == effect)),
                ),
                Role::Variance(Component::Random(i)) => {
                    Coefficient::Level(i, count(&|r| matches!(r, Coefficient::Level(j, _) if *j == i)))
                }
                Role::Variance(Component::Kernel(i)) => {
                    Coefficient::Kernel(i, count(&|r| matches!(r, Coefficient::Kernel(j, _) if *j == i)))
                }
            });
        }
        let solution = point.solution;
        let residual = &design.target - &design.matrix * &solution.mean;
        let predicted = problem.readings.iter().zip(residual.iter()).map(|(y, r)| y - r).collect();
        let mean = solution.mean.iter().zip(&design.prior_mean).map(|(x, prior)| x + prior).collect();
        Some(Self { roles, mean, covariance, predicted })
    }

    /// Returns the index of a coefficient.
    pub fn index(&self, role: Coefficient) -> Option<usize> {
        self.roles.iter().position(|r| *r == role)
    }
}
