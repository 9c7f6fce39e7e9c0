//! Basis of a component that is constant within each series, with one row per series.
//!
//! Each series has at most one level of a factor such as mounts, so that its row has one entry: products then need one sum over the
//! series, however many levels there are.

use nalgebra::{DMatrix, DVector};

/// Columns of a matrix per entry of a row above which sums over the entries are faster than products of matrices.
pub(crate) const SPARSE: usize = 2;

/// One row per series, and one column per coefficient.
#[derive(Clone, Debug)]
pub(crate) struct SeriesRows {
    rows: DMatrix<f64>,
    /// Column and value of the entry of each row, if no row has two.
    levels: Option<Vec<Option<(usize, f64)>>>,
}

impl SeriesRows {
    /// Returns the columns that are not zero for a series, with their values.
    pub(crate) fn entries(&self, series: usize) -> Vec<(usize, f64)> {
        match &self.levels {
            Some(levels) => levels[series].into_iter().collect(),
            None => self.rows.row(series).iter().copied().enumerate().collect(),
        }
    }

    /// Returns `B'x` for one row of `x` per series.
    pub(crate) fn transposed_times(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let Some(levels) = &self.levels else { return self.rows.tr_mul(x) };
        let mut product = DMatrix::zeros(self.rows.ncols(), x.ncols());
        for (series, (level, value)) in known(levels) {
            for j in 0..x.ncols() {
                product[(level, j)] += value * x[(series, j)];
            }
        }
        product
    }

    /// Returns `B' diag(w) C` for one weight `w` per series, and the rows `C` of another component.
    pub(crate) fn weighted_product(&self, weights: &DVector<f64>, other: &Self) -> DMatrix<f64> {
        if let (Some(levels), Some(of_other)) = (&self.levels, &other.levels) {
            let mut product = DMatrix::zeros(self.rows.ncols(), other.rows.ncols());
            for (series, (level, value)) in known(levels) {
                if let Some((column, of_other)) = of_other[series] {
                    product[(level, column)] += value * weights[series] * of_other;
                }
            }
            return product;
        }
        let weighted = |rows: &DMatrix<f64>| {
            let mut weighted = rows.clone();
            weighted.column_iter_mut().for_each(|mut column| column.component_mul_assign(weights));
            weighted
        };
        match &other.levels {
            Some(_) => other.transposed_times(&weighted(&self.rows)).transpose(),
            None => self.transposed_times(&weighted(&other.rows)),
        }
    }

    /// Returns `B x` for one row of `x` per column.
    pub(crate) fn times(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let Some(levels) = &self.levels else { return &self.rows * x };
        let mut product = DMatrix::zeros(self.rows.nrows(), x.ncols());
        for (series, (level, value)) in known(levels) {
            for j in 0..x.ncols() {
                product[(series, j)] = value * x[(level, j)];
            }
        }
        product
    }
}

impl From<DMatrix<f64>> for SeriesRows {
    fn from(rows: DMatrix<f64>) -> Self {
        let mut levels = vec![None; rows.nrows()];
        let mut has_levels = true;
        for (column, values) in rows.column_iter().enumerate() {
            for (series, value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                has_levels &= levels[series].is_none();
                levels[series] = Some((column, *value));
            }
        }
        Self { rows, levels: has_levels.then_some(levels) }
    }
}

/// Returns the number of each series that has a level, with the level.
fn known(levels: &[Option<(usize, f64)>]) -> impl Iterator<Item = (usize, (usize, f64))> + '_ {
    levels.iter().enumerate().filter_map(|(series, level)| level.map(|level| (series, level)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Products are those of matrices, with levels and without.
    #[test]
    fn products_are_those_of_matrices() {
        let mut random = Random::new(5);
        let mut any = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| random.normal());
        let (dense, values, x, right) = (any(9, 3), any(9, 1), any(9, 2), any(4, 2));
        // The last series is without a level.
        let one = DMatrix::from_fn(9, 4, |i, j| if i % 4 == j && i < 8 { values[i] } else { 0.0 });
        let other = DMatrix::from_fn(9, 5, |i, j| if i / 2 == j { values[i] } else { 0.0 });
        let weights = DVector::from_column_slice(values.as_slice());
        let is_close = |found: DMatrix<f64>, expected: DMatrix<f64>| {
            assert!((&found - &expected).amax() < 1e-12, "{found} {expected}");
        };
        let all = [dense, one, other].map(|matrix| (SeriesRows::from(matrix.clone()), matrix));
        assert_eq!(all.each_ref().map(|(rows, _)| rows.levels.is_some()), [false, true, true]);
        for (rows, matrix) in &all {
            is_close(rows.transposed_times(&x), matrix.tr_mul(&x));
            let right =
                right.rows(0, matrix.ncols().min(4)).into_owned().resize_vertically(matrix.ncols(), 0.5);
            is_close(rows.times(&right), matrix * &right);
            for (of_other, other) in &all {
                let expected = matrix.tr_mul(&(DMatrix::from_diagonal(&weights) * other));
                is_close(rows.weighted_product(&weights, of_other), expected);
            }
            for series in 0..9 {
                let mut row = DMatrix::zeros(1, matrix.ncols());
                rows.entries(series).into_iter().for_each(|(column, value)| row[(0, column)] += value);
                is_close(row, matrix.rows(series, 1).into_owned());
            }
        }
    }
}
