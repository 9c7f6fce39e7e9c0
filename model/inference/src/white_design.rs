//! The design in standard deviations of the noise, with the columns that are constant within each series apart.
//!
//! A component such as mounts, or a curve over time, has the columns `c_s b_s'` at the rows of series `s`, with the sensitivity
//! `c_s` to its channel and one row `b_s` for the series. White, they are `v_s b_s'` with `v_s = W_s c_s`: their products need one
//! column and sums over the series, however many columns the component has.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::series_rows::SeriesRows;
use crate::whitening::Whitening;

/// Columns of a component that are constant within each series, times the sensitivity to its channel.
#[derive(Clone, Debug)]
pub(crate) struct SeriesColumns {
    /// Indices of the columns.
    pub(crate) columns: Range<usize>,
    /// Sensitivity of each row.
    pub(crate) sensitivity: DVector<f64>,
    /// One row per series, one column per column.
    pub(crate) by_series: Arc<SeriesRows>,
}

/// `W A`, with `W V W' = I`.
#[derive(Clone, Debug)]
pub(crate) struct WhiteDesign {
    /// Indices of the columns that vary within a series, and these.
    own: (Vec<usize>, DMatrix<f64>),
    /// The others, each with its white sensitivity in place of it.
    of_series: Vec<SeriesColumns>,
    ranges: Vec<Range<usize>>,
    columns: usize,
}

impl WhiteDesign {
    pub(crate) fn new(matrix: &DMatrix<f64>, of_series: &[SeriesColumns], whitening: &Whitening) -> Self {
        let is_own = |column: &usize| !of_series.iter().any(|of| of.columns.contains(column));
        let own: Vec<usize> = (0..matrix.ncols()).filter(is_own).collect();
        let mut white_own = matrix.select_columns(&own);
        whitening.whiten_mut(white_own.as_mut_slice());
        let white = |of: &SeriesColumns| SeriesColumns {
            columns: of.columns.clone(),
            sensitivity: whitening.whiten_vector(&of.sensitivity),
            by_series: of.by_series.clone(),
        };
        Self {
            own: (own, white_own),
            of_series: of_series.iter().map(white).collect(),
            ranges: whitening.ranges.clone(),
            columns: matrix.ncols(),
        }
    }

    /// Returns the products of two columns in each series.
    fn products(&self, first: &DVector<f64>, second: &DVector<f64>) -> DVector<f64> {
        let of = |range: &Range<usize>| {
            first.rows(range.start, range.len()).dot(&second.rows(range.start, range.len()))
        };
        DVector::from_iterator(self.ranges.len(), self.ranges.iter().map(of))
    }

    /// Returns one row per series: the products of two columns there.
    fn products_of_series(&self, first: &DVector<f64>, second: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(self.ranges.len(), second.ncols(), |series, j| {
            let range = &self.ranges[series];
            let rows = (range.start, range.len());
            first.rows(rows.0, rows.1).dot(&second.column(j).rows(rows.0, rows.1))
        })
    }

    /// Returns `A'W'W A`.
    pub(crate) fn gram(&self) -> DMatrix<f64> {
        let (indices, own) = &self.own;
        let mut gram = DMatrix::zeros(self.columns, self.columns);
        let of_own = own.transpose() * own;
        for (i, row) in indices.iter().enumerate() {
            indices.iter().enumerate().for_each(|(j, column)| gram[(*row, *column)] = of_own[(i, j)]);
        }
        for (nth, of) in self.of_series.iter().enumerate() {
            let with_own = of.by_series.transposed_times(&self.products_of_series(&of.sensitivity, own));
            for (i, row) in indices.iter().enumerate() {
                for (j, column) in of.columns.clone().enumerate() {
                    gram[(*row, column)] = with_own[(j, i)];
                    gram[(column, *row)] = with_own[(j, i)];
                }
            }
            for other in &self.of_series[..=nth] {
                let weights = self.products(&of.sensitivity, &other.sensitivity);
                let product = of.by_series.weighted_product(&weights, &other.by_series);
                for (i, row) in of.columns.clone().enumerate() {
                    for (j, column) in other.columns.clone().enumerate() {
                        gram[(row, column)] = product[(i, j)];
                        gram[(column, row)] = product[(i, j)];
                    }
                }
            }
        }
        gram
    }

    /// Returns the design with a linear map of the rows of each series in place of the root of its precision: `map` replaces a
    /// column of all rows.
    pub(crate) fn mapped(&self, map: impl Fn(&mut [f64])) -> Self {
        let mut mapped = self.clone();
        let rows = self.own.1.nrows();
        mapped.own.1.as_mut_slice().chunks_exact_mut(rows.max(1)).for_each(&map);
        mapped.of_series.iter_mut().for_each(|of| map(of.sensitivity.as_mut_slice()));
        mapped
    }

    /// Returns `a'C b` for each row: its row `a` of `W A`, its row `b` of `X A`, where `right` is the design with `X` in place of
    /// `W`, and a symmetric matrix `C`.
    pub(crate) fn products_by_row(&self, right: &Self, matrix: &DMatrix<f64>) -> DVector<f64> {
        let (indices, own) = &self.own;
        let right_own = &right.own.1;
        let of_own = own * matrix.select_rows(indices).select_columns(indices);
        let mut products = vec![0.0; own.nrows()];
        for column in 0..indices.len() {
            add_products(&mut products, 1.0, column_of(&of_own, column), column_of(right_own, column));
        }
        for (of, of_right) in self.of_series.iter().zip(&right.of_series) {
            // `C b` for the coefficients `b` of each series.
            let of_series = of.by_series.times(&matrix.rows(of.columns.start, of.columns.len()).into_owned());
            for (series, range) in self.ranges.iter().enumerate() {
                let sums = &mut products[range.clone()];
                let left_of = &of.sensitivity.as_slice()[range.clone()];
                let right_of = &of_right.sensitivity.as_slice()[range.clone()];
                for (i, column) in indices.iter().enumerate() {
                    let factor = of_series[(series, *column)];
                    add_products(sums, factor, left_of, &column_of(right_own, i)[range.clone()]);
                    add_products(sums, factor, right_of, &column_of(own, i)[range.clone()]);
                }
                for other in &right.of_series {
                    let mut factor = 0.0;
                    for (column, value) in other.by_series.entries(series) {
                        factor += value * of_series[(series, other.columns.start + column)];
                    }
                    add_products(sums, factor, left_of, &other.sensitivity.as_slice()[range.clone()]);
                }
            }
        }
        DVector::from_vec(products)
    }

    /// Returns the columns that may not be zero in a series.
    pub(crate) fn columns_in(&self, series: usize) -> Vec<usize> {
        self.columns_of(&self.entries_in(series))
    }

    /// Returns the entries of each component that is constant within a series.
    fn entries_in(&self, series: usize) -> Vec<Vec<(usize, f64)>> {
        self.of_series.iter().map(|of| of.by_series.entries(series)).collect()
    }

    /// Returns the columns that vary within a series, and those of these entries.
    fn columns_of(&self, entries: &[Vec<(usize, f64)>]) -> Vec<usize> {
        let mut columns = self.own.0.clone();
        for (of, entries) in self.of_series.iter().zip(entries) {
            columns.extend(entries.iter().map(|(column, _)| of.columns.start + column));
        }
        columns
    }

    /// Returns `A_s'W_s'X` for white columns of one series, without the rows that are zero whatever `X`, and their numbers.
    pub(crate) fn transposed_times_in(
        &self,
        series: usize,
        white: &DMatrix<f64>,
    ) -> (Vec<usize>, DMatrix<f64>) {
        let range = &self.ranges[series];
        let (indices, own) = &self.own;
        let entries = self.entries_in(series);
        let rows = self.columns_of(&entries);
        let mut product = DMatrix::zeros(rows.len(), white.ncols());
        for (j, column) in white.column_iter().enumerate() {
            for i in 0..indices.len() {
                product[(i, j)] = own.column(i).rows(range.start, range.len()).dot(&column);
            }
            let mut row = indices.len();
            for (of, entries) in self.of_series.iter().zip(&entries) {
                let share = of.sensitivity.rows(range.start, range.len()).dot(&column);
                for (_, value) in entries {
                    product[(row, j)] = share * value;
                    row += 1;
                }
            }
        }
        (rows, product)
    }

    /// Returns `W A B`.
    pub(crate) fn times(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let (indices, own) = &self.own;
        let mut product = own * right.select_rows(indices);
        for of in &self.of_series {
            let of_series = of.by_series.times(&right.rows(of.columns.start, of.columns.len()).into_owned());
            for (j, mut column) in product.column_iter_mut().enumerate() {
                for (series, range) in self.ranges.iter().enumerate() {
                    let factor = of_series[(series, j)];
                    if factor != 0.0 {
                        let sensitivity = of.sensitivity.rows(range.start, range.len());
                        column.rows_mut(range.start, range.len()).axpy(factor, &sensitivity, 1.0);
                    }
                }
            }
        }
        product
    }

    /// Returns `W A b`.
    pub(crate) fn times_vector(&self, right: &DVector<f64>) -> DVector<f64> {
        self.times(&DMatrix::from_columns(std::slice::from_ref(right))).column(0).into_owned()
    }

    /// Returns `A'W'X` for white columns.
    pub(crate) fn transposed_times(&self, white: &DMatrix<f64>) -> DMatrix<f64> {
        let (indices, own) = &self.own;
        let mut product = DMatrix::zeros(self.columns, white.ncols());
        let of_own = own.transpose() * white;
        indices.iter().enumerate().for_each(|(i, row)| product.set_row(*row, &of_own.row(i)));
        for of in &self.of_series {
            let rows = of.by_series.transposed_times(&self.products_of_series(&of.sensitivity, white));
            product.rows_mut(of.columns.start, of.columns.len()).copy_from(&rows);
        }
        product
    }

    /// Returns `A_s'W_s'x_s`, one column per series, for a white column.
    pub(crate) fn transposed_times_series(&self, white: &DVector<f64>) -> DMatrix<f64> {
        let (indices, own) = &self.own;
        let mut product = DMatrix::zeros(self.columns, self.ranges.len());
        let of_own = self.products_of_series(white, own);
        indices.iter().enumerate().for_each(|(i, row)| product.set_row(*row, &of_own.column(i).transpose()));
        for of in &self.of_series {
            let shared = self.products(&of.sensitivity, white);
            for series in 0..self.ranges.len() {
                for (column, value) in of.by_series.entries(series) {
                    product[(of.columns.start + column, series)] = shared[series] * value;
                }
            }
        }
        product
    }

    /// Returns all columns.
    pub(crate) fn columns(&self) -> DMatrix<f64> {
        self.times(&DMatrix::identity(self.columns, self.columns))
    }
}

/// Returns the numbers of a column.
fn column_of(matrix: &DMatrix<f64>, column: usize) -> &[f64] {
    &matrix.as_slice()[column * matrix.nrows()..(column + 1) * matrix.nrows()]
}

/// Adds the products of two numbers of each row, times a factor.
fn add_products(sums: &mut [f64], factor: f64, x: &[f64], y: &[f64]) {
    for (sum, (x, y)) in sums.iter_mut().zip(x.iter().zip(y)) {
        *sum += factor * x * y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::test_problem::{fitted, full_hypothesis, long_problem};

    /// Products agree with those of all columns, whichever of them are apart.
    #[test]
    fn products_are_those_of_all_columns() {
        let problem = long_problem(7, 9, 0.4);
        let (_, design, point) = fitted(&problem, &full_hypothesis());
        assert!(design.of_series.len() > 1, "mounts and levels of the load");
        let whitening = &point.marginal.whitening;
        let apart = WhiteDesign::new(&design.matrix, &design.of_series, whitening);
        let columns = whitening.whiten(&design.matrix);
        let mut random = Random::new(3);
        let right = DMatrix::from_fn(design.matrix.ncols(), 4, |_, _| random.normal());
        let white = DMatrix::from_fn(problem.len(), 3, |_, _| random.normal());
        let is_close = |found: &DMatrix<f64>, expected: &DMatrix<f64>| {
            assert!((found - expected).amax() < 1e-9 * expected.amax(), "{found} {expected}");
        };
        is_close(&apart.columns(), &columns);
        is_close(&apart.gram(), &columns.tr_mul(&columns));
        let scaled = |x: &mut [f64]| x.iter_mut().enumerate().for_each(|(i, x)| *x *= (i % 5) as f64);
        let mut scaled_columns = columns.clone();
        scaled_columns.as_mut_slice().chunks_exact_mut(problem.len()).for_each(scaled);
        let matrix = columns.tr_mul(&columns);
        let by_row = (&columns * &matrix).component_mul(&scaled_columns).column_sum();
        let found = apart.products_by_row(&apart.mapped(scaled), &matrix);
        assert!((found - &by_row).amax() < 1e-9 * by_row.amax());
        is_close(&apart.times(&right), &(&columns * &right));
        is_close(&apart.transposed_times(&white), &columns.tr_mul(&white));
        let first = white.column(0).into_owned();
        let by_series = apart.transposed_times_series(&first);
        for (series, range) in apart.ranges.iter().enumerate() {
            let of_series = white.rows(range.start, range.len()).into_owned();
            let expected = columns.rows(range.start, range.len()).tr_mul(&of_series);
            let (rows, product) = apart.transposed_times_in(series, &of_series);
            is_close(&product, &expected.select_rows(&rows));
            assert!((product.norm() / expected.norm() - 1.0).abs() < 1e-12, "other rows are zero");
        }
        let sum = DMatrix::from_columns(&[by_series.column_sum()]);
        is_close(&sum, &columns.tr_mul(&white.columns(0, 1)));
    }
}
