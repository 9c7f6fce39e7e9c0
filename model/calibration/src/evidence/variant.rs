//! A discrete form of a kernel, with its basis at the rows of the fitted table.

use std::rc::Rc;

use nalgebra::{DMatrix, DVector};
use pinswitch_inference::{Basis, kernel};

use super::covariates::Covariates;
use super::groups::Groups;

/// Root mean square of the rows of a basis below which it changes nothing.
const LEAST_NORM: f64 = 1e-9;

/// A function of the rows that returns a basis.
pub(super) type BasisOfRows = Rc<dyn Fn(&Covariates) -> DMatrix<f64>>;

/// A discrete form of a kernel. Clones share their numbers.
#[derive(Clone)]
pub(super) struct Variant {
    basis: BasisOfRows,
    /// Factor of the basis.
    factor: f64,
    pub(super) probability: f64,
    /// The basis at the rows of the fitted table, where it was evaluated once.
    pub(super) fitted: Basis,
    /// Its mean row.
    pub(super) mean: Vec<f64>,
}

impl Variant {
    /// Returns a variant with unit variance at the rows of the fitted table; `None` if it is zero there.
    pub(super) fn of_unit_variance(basis: BasisOfRows, rows: &Covariates, probability: f64) -> Option<Self> {
        let columns = basis(rows);
        let norm = kernel::rms_norm(&columns);
        (norm > LEAST_NORM).then(|| {
            let columns = columns / norm;
            let mean = columns.row_mean().iter().copied().collect();
            Self { basis, factor: 1.0 / norm, probability, fitted: columns.into(), mean }
        })
    }

    /// Returns the same for a basis that is constant in groups of the rows.
    pub(super) fn of_groups(basis: BasisOfRows, groups: &Groups, probability: f64) -> Option<Self> {
        let columns = basis(&groups.firsts);
        let squares = columns.row_iter().zip(&groups.counts).map(|(row, count)| count * row.norm_squared());
        let norm = (squares.sum::<f64>() / groups.counts.iter().sum::<f64>()).sqrt();
        (norm > LEAST_NORM).then(|| Self::scaled(basis, &(columns / norm), 1.0 / norm, groups, probability))
    }

    /// Returns a variant with the height of its basis, which is constant in groups of the rows.
    pub(super) fn as_is(basis: BasisOfRows, groups: &Groups, probability: f64) -> Self {
        let columns = basis(&groups.firsts);
        Self::scaled(basis, &columns, 1.0, groups, probability)
    }

    fn scaled(
        basis: BasisOfRows,
        columns: &DMatrix<f64>,
        factor: f64,
        groups: &Groups,
        probability: f64,
    ) -> Self {
        let counts = DVector::from_column_slice(&groups.counts);
        let mean = columns.tr_mul(&counts) / counts.sum();
        let fitted = Basis::of_groups(columns, groups.of_row.clone());
        Self { basis, factor, probability, fitted, mean: mean.as_slice().to_vec() }
    }

    /// Returns the variant with another probability.
    pub(super) fn with_probability(&self, probability: f64) -> Self {
        Self { probability, ..self.clone() }
    }

    pub(super) fn columns(&self, rows: &Covariates) -> DMatrix<f64> {
        (self.basis)(rows) * self.factor
    }
}
