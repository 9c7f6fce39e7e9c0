//! Fisher information of rows, recorded or planned, about the constants of a model and the sizes of
//! further effects.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::effects::Effect;
use crate::inference::{CONSEQUENCE, Model, Noise, Observations, Term, Weighed, jacobian};
use crate::table::PlateauRow;

/// A column in addition to the model's constants: the change of the readings by an effect of a
/// given size.
#[derive(Clone, Debug)]
pub(super) enum Trace {
    /// Contribution of a term of the model.
    Found {
        /// Index of the term.
        term: usize,
    },
    /// Contribution of an effect that is not in the model.
    Absent {
        /// The effect.
        effect: &'static dyn Effect,
        /// Constants of the effect.
        values: Vec<f64>,
    },
    /// Change of a constant of the model in a new session, since a newly mounted switch may differ.
    Renewed {
        /// Index of the constant.
        constant: usize,
    },
    /// Error of friction above the recorded loads: zero at the first load, and increasing linearly
    /// to [`CONSEQUENCE`] of the friction at the second.
    Beyond {
        /// Highest recorded load in newtons.
        from_n: f64,
        /// Highest load of interest in newtons.
        to_n: f64,
    },
}

/// A model with additional columns, and the noise of rows.
#[derive(Debug)]
pub(super) struct Design<'a> {
    pub(super) model: &'a Model,
    pub(super) noise: Noise,
    pub(super) traces: &'a [Trace],
}

impl Design<'_> {
    /// Returns the number of the model's constants, whose columns come first.
    pub(super) fn own(&self) -> usize {
        self.model.values().len()
    }

    /// Returns the number of all columns.
    pub(super) fn columns(&self) -> usize {
        self.own() + self.traces.len()
    }

    /// Returns the information of the priors.
    pub(super) fn priors(&self) -> DMatrix<f64> {
        let mut known = DMatrix::zeros(self.columns(), self.columns());
        for (i, prior) in self.model.priors().iter().enumerate() {
            known[(i, i)] = prior.sd.powi(-2);
        }
        known
    }

    /// Returns the information of a table; its readings are irrelevant. `None` if the model lacks a
    /// condition.
    pub(super) fn of(&self, rows: &[PlateauRow]) -> Option<DMatrix<f64>> {
        let whole = Observations::new(&self.model.frame, rows)?.compacted();
        let (data, columns) = self.whitened(whole);
        let all: Vec<usize> = (0..data.points.len()).collect();
        Some(gram(&columns, &all))
    }

    /// Returns the information of each series of a table, in the order of their first rows.
    pub(super) fn by_series(&self, rows: &[PlateauRow]) -> Option<Vec<DMatrix<f64>>> {
        let (data, columns) = self.whitened(Observations::new(&self.model.frame, rows)?);
        Some(data.series_rows.iter().map(|rows| gram(&columns, rows)).collect())
    }

    fn whitened(&self, mut data: Observations) -> (Observations, Vec<Vec<f64>>) {
        let model = self.model;
        let predicted = model.predict(&data.points);
        data.friction_n = model.friction_n(&data.points);
        let mut columns = jacobian(model, &data, &predicted);
        for trace in self.traces {
            let (with, without) = match trace {
                Trace::Found { term } => (predicted.clone(), model.without_term(*term).predict(&data.points)),
                Trace::Absent { effect, values } => {
                    (model.with_term(Term::Named(*effect), values).predict(&data.points), predicted.clone())
                }
                Trace::Renewed { constant } => {
                    columns.push(columns[*constant].clone());
                    continue;
                }
                Trace::Beyond { from_n, to_n } => {
                    let share = |load_n: f64| CONSEQUENCE * ((load_n - from_n) / (to_n - from_n)).max(0.0);
                    let off = data.points.iter().zip(&data.friction_n).map(|(p, f)| share(p.load_n) * f);
                    columns.push(off.collect());
                    continue;
                }
            };
            columns.push(with.iter().zip(&without).map(|(w, o)| w - o).collect());
        }
        let weighed = Weighed::new(&data, self.noise);
        weighed.whiten_all(&mut columns);
        (data, columns)
    }
}

/// Returns the products of all pairs of columns over some rows.
fn gram(columns: &[Vec<f64>], rows: &[usize]) -> DMatrix<f64> {
    let n = columns.len();
    let mut products = DMatrix::zeros(n, n);
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = rows.iter().map(|r| columns[i][*r] * columns[j][*r]).sum();
            products[(i, j)] = sum;
            products[(j, i)] = sum;
        }
    }
    products
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
        let side = |c: usize| {
            DVector::from_fn(self.nuisance.len(), |i, _| {
                self.information[(self.nuisance[i], c)] * self.scale[i]
            })
        };
        self.information[(a, b)] - side(a).dot(&factor.solve(&side(b)))
    }

    /// Returns the squared norm, in standard deviations, of the projected part of a column.
    pub(super) fn squares(&self, signal: usize) -> f64 {
        self.covariance(signal, signal).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_removes_confounded_parts() {
        // Columns x, y and x + y + e over four rows.
        let columns = [vec![1.0, 0.0, 0.0, 0.0], vec![0.0, 2.0, 0.0, 0.0], vec![1.0, 2.0, 0.0, 0.5]];
        let information = gram(&columns, &[0, 1, 2, 3]);
        assert!((Projected::new(&information, &[]).squares(2) - 5.25).abs() < 1e-12);
        assert!((Projected::new(&information, &[0, 1]).squares(2) - 0.25).abs() < 1e-6);
        assert!((Projected::new(&information, &[1]).covariance(0, 2) - 1.0).abs() < 1e-6);
        assert!(Projected::new(&information, &[1, 0]).squares(0) < 1e-6);
    }
}
