//! Fisher information of rows, recorded or planned, about the constants of a model and the sizes of
//! further contributions to the readings.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::whitening::{Series, separate, together, white_series};
use crate::effects::SharedEffect;
use crate::evidence::CONSEQUENCE;
use crate::model::{Model, Noise, Term, jacobian};
use crate::table::{PlateauRow, Point};

/// Relative standard deviation of the change of a friction coefficient between sessions.
const SESSION_SD: f64 = 0.05;

/// A contribution to the readings, as a column in addition to those of the model's constants.
#[derive(Clone, Debug)]
pub(super) enum Contribution {
    /// That of a term of the model.
    Term {
        /// Index of the term.
        term: usize,
    },
    /// That of an effect that is not in the model.
    Added {
        /// The effect.
        effect: SharedEffect,
        /// Constants of the effect.
        values: Vec<f64>,
    },
    /// Change of a constant of the model in the planned session, since a newly mounted switch may
    /// differ.
    NewSession {
        /// Index of the constant.
        constant: usize,
    },
    /// Error of friction above the recorded loads: zero at the first load, and increasing linearly
    /// to [`CONSEQUENCE`] of the friction at the second.
    AboveLoads {
        /// Highest recorded load in newtons.
        from_n: f64,
        /// Highest load of interest in newtons.
        to_n: f64,
    },
}

/// Share of the size at which the change of the readings is linear.
const SMALL: f64 = 1e-3;

impl Contribution {
    fn column(&self, model: &Model, points: &[Point], constants: &[Vec<f64>]) -> Vec<f64> {
        let mut scale = 1.0;
        let (with, without) = match self {
            Self::Term { term } => (model.predict(points), model.without_term(*term).predict(points)),
            Self::Added { effect, values } => {
                // The refit is linear: a constant must absorb what is proportional to it at any size.
                let mut values = values.clone();
                if let Some(size) = values.first_mut().filter(|_| effect.description().scales) {
                    scale = SMALL;
                    *size *= scale;
                }
                (model.with_term(Term::Named(effect.clone()), &values).predict(points), model.predict(points))
            }
            Self::NewSession { constant } => return constants[*constant].clone(),
            Self::AboveLoads { from_n, to_n } => {
                let share = |p: &Point| CONSEQUENCE * ((p.load_n - from_n) / (to_n - from_n)).max(0.0);
                let friction = model.friction_n(points);
                return points.iter().zip(friction).map(|(p, friction)| share(p) * friction).collect();
            }
        };
        with.iter().zip(&without).map(|(with, without)| (with - without) / scale).collect()
    }
}

/// A model with contributions, and the noise of rows.
#[derive(Debug)]
pub(super) struct Design<'a> {
    pub(super) model: &'a Model,
    pub(super) noise: Noise,
    pub(super) contributions: &'a [Contribution],
}

impl Design<'_> {
    /// Returns the information of planned rows; `None` if the model lacks a condition.
    pub(super) fn planned(&self, rows: &[PlateauRow]) -> Option<DMatrix<f64>> {
        Some(together(&self.series(rows)?, self.noise))
    }

    /// Returns the information of each planned series in a mount of its own, in the order of their
    /// first rows.
    pub(super) fn planned_series(&self, rows: &[PlateauRow]) -> Option<Vec<DMatrix<f64>>> {
        Some(separate(&self.series(rows)?, self.noise))
    }

    /// Returns the information of the recorded rows and the priors.
    pub(super) fn recorded(&self, rows: &[PlateauRow]) -> Option<DMatrix<f64>> {
        let mut information = self.planned(rows)?;
        let priors = self.model.priors();
        priors.iter().enumerate().for_each(|(i, prior)| information[(i, i)] += prior.sd.powi(-2));
        for (at, contribution) in self.contributions.iter().enumerate() {
            if matches!(contribution, Contribution::NewSession { .. }) {
                let at = priors.len() + at;
                information.row_mut(at).fill(0.0);
                information.column_mut(at).fill(0.0);
                information[(at, at)] = SESSION_SD.powi(-2);
            }
        }
        Some(information)
    }

    fn series(&self, rows: &[PlateauRow]) -> Option<Vec<Series>> {
        let points = self.model.frame.points(rows)?;
        let constants = jacobian(self.model, &points);
        let contributions = self.contributions.iter().map(|c| c.column(self.model, &points, &constants));
        let contributions: Vec<Vec<f64>> = contributions.collect();
        let columns = [constants, contributions].concat();
        white_series(self.model, self.noise, rows, &points, &columns)
    }
}

/// Information with the columns `nuisance` projected out of all others.
#[derive(Debug)]
pub(super) struct Projected<'a> {
    information: &'a DMatrix<f64>,
    nuisance: &'a [usize],
    /// Scale of each column, since their lengths differ widely.
    scale: Vec<f64>,
    factor: Option<Cholesky<f64, Dyn>>,
}

impl<'a> Projected<'a> {
    pub(super) fn new(information: &'a DMatrix<f64>, nuisance: &'a [usize]) -> Self {
        let n = nuisance.len();
        let scale: Vec<f64> =
            nuisance.iter().map(|i| information[(*i, *i)].max(1e-300).sqrt().recip()).collect();
        let mut inner =
            DMatrix::from_fn(n, n, |i, j| information[(nuisance[i], nuisance[j])] * scale[i] * scale[j]);
        // A column that depends linearly on the others is removed with them.
        (0..n).for_each(|i| inner[(i, i)] += 1e-10);
        Self { information, nuisance, scale, factor: inner.cholesky() }
    }

    /// Returns whether these are the projected columns.
    pub(super) fn is_without(&self, nuisance: &[usize]) -> bool {
        self.nuisance == nuisance
    }

    /// Returns the product of the projected parts of two columns.
    pub(super) fn covariance(&self, a: usize, b: usize) -> f64 {
        let Some(factor) = &self.factor else { return 0.0 };
        let fitted = self.fitted(factor, a);
        let product = if a == b { fitted.norm_squared() } else { fitted.dot(&self.fitted(factor, b)) };
        self.information[(a, b)] - product
    }

    /// Returns the squared length, in standard deviations, of the projected part of a column.
    pub(super) fn squares(&self, column: usize) -> f64 {
        self.covariance(column, column).max(0.0)
    }

    /// Returns the coordinates of the part of a column that the nuisance absorbs.
    fn fitted(&self, factor: &Cholesky<f64, Dyn>, column: usize) -> DVector<f64> {
        let side = |i: usize| self.information[(self.nuisance[i], column)] * self.scale[i];
        let mut side = DVector::from_fn(self.nuisance.len(), |i, _| side(i));
        factor.l_dirty().solve_lower_triangular_mut(&mut side);
        side
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_removes_confounded_parts() {
        // Columns x, y and x + y + e over four rows.
        let columns =
            DMatrix::from_row_slice(4, 3, &[1.0, 0.0, 1.0, 0.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5]);
        let information = columns.tr_mul(&columns);
        assert!((Projected::new(&information, &[]).squares(2) - 5.25).abs() < 1e-12);
        assert!((Projected::new(&information, &[0, 1]).squares(2) - 0.25).abs() < 1e-6);
        assert!((Projected::new(&information, &[1]).covariance(0, 2) - 1.0).abs() < 1e-6);
        assert!(Projected::new(&information, &[1, 0]).squares(0) < 1e-6);
    }
}
