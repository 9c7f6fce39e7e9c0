//! Traces of the precision of the readings, for the gradient of the marginal likelihood in the scales of the noise.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::autoregression::Process;
use crate::covariance::Noise;
use crate::marginal::{Marginal, Solution};
use crate::series_rows::SPARSE;

/// Sums `x'C x / 2` of columns `x` with the covariance `C` of the coefficients, for each scale.
pub(crate) struct Explained<'a> {
    solution: &'a Solution,
    /// Columns with as many entries as there are coefficients, one after the other, and the scale of each.
    waiting: (Vec<f64>, Vec<usize>),
}

impl<'a> Explained<'a> {
    pub(crate) fn new(solution: &'a Solution) -> Self {
        Self { solution, waiting: Default::default() }
    }

    /// Adds columns with entries in some rows only.
    pub(crate) fn add(
        &mut self,
        scale: usize,
        rows: &[usize],
        columns: &DMatrix<f64>,
        sums: &mut DVector<f64>,
    ) {
        let covariance = &self.solution.covariance;
        if SPARSE * rows.len() < covariance.nrows() {
            let own = DMatrix::from_fn(rows.len(), rows.len(), |i, j| covariance[(rows[i], rows[j])]);
            sums[scale] += 0.5 * (own * columns).dot(columns);
            return;
        }
        let (entries, scales) = &mut self.waiting;
        for column in columns.column_iter() {
            let first = entries.len();
            entries.resize(first + covariance.nrows(), 0.0);
            rows.iter().zip(column.iter()).for_each(|(row, x)| entries[first + row] = *x);
            scales.push(scale);
        }
    }

    /// Adds the columns that wait. One product of all is faster than one for each series.
    pub(crate) fn finish(self, sums: &mut DVector<f64>) {
        let (entries, scales) = self.waiting;
        let columns = DMatrix::from_vec(self.solution.mean.len(), scales.len(), entries);
        let explained = &self.solution.root * columns;
        for (scale, column) in scales.into_iter().zip(explained.column_iter()) {
            sums[scale] += 0.5 * column.norm_squared();
        }
    }
}

/// Diagonal of `V' P`, with the covariance `V' = D + A` of the estimated repetition noise and the precision `P` of the readings, the
/// coefficients with the covariance `C` integrated: `P = V^-1 - B C B'` with `B = V^-1 A`. The trace `tr(G V' P)` is a sum of it,
/// weighted by the diagonal `G`.
pub(crate) fn diagonal_of_repetition(
    noise: &Noise<'_>,
    marginal: &Marginal,
    covariance: &DMatrix<f64>,
) -> DVector<f64> {
    let whitening = &marginal.whitening;
    let precise = marginal.white_design.mapped(|column| whitening.whiten_transposed_mut(column));
    let estimated: Vec<EstimatedNoise> =
        whitening.ranges.iter().map(|range| EstimatedNoise::new(noise, range)).collect();
    let of_noise = precise.mapped(|column| {
        let parts = whitening.ranges.iter().zip(&estimated);
        parts.for_each(|(range, noise)| noise.apply(&mut column[range.clone()]));
    });
    let mut diagonal = -of_noise.products_by_row(&precise, covariance);
    for ((root, range), estimated) in whitening.roots.iter().zip(&whitening.ranges).zip(&estimated) {
        let (repetition, shared) = root.precision();
        // `E` is `V'` plus the variance that is not estimated: of steps of the load cell and of excluded rows.
        let independent = noise.independent_variances(range);
        let of_series = &mut diagonal.as_mut_slice()[range.clone()];
        let of_inverse = estimated.diagonal_of_inverse(&repetition, &independent);
        of_series.iter_mut().zip(of_inverse).for_each(|(sum, x)| *sum += x);
        for column in shared {
            let mut product = column.clone();
            estimated.apply(&mut product);
            of_series.iter_mut().zip(product.iter().zip(&column)).for_each(|(sum, (a, x))| *sum -= a * x);
        }
    }
    diagonal
}

/// Estimated repetition noise of a series: `V' = D + A`.
struct EstimatedNoise {
    own: Vec<f64>,
    process: Option<Process>,
}

impl EstimatedNoise {
    fn new(noise: &Noise<'_>, range: &Range<usize>) -> Self {
        Self { own: noise.estimated_variances(range), process: noise.process(range) }
    }

    /// Replaces `x` by `V' x`.
    fn apply(&self, x: &mut [f64]) {
        let of_process = self.process.as_ref().map(|process| process.times(x));
        x.iter_mut().zip(&self.own).for_each(|(x, own)| *x *= own);
        x.iter_mut().zip(of_process.into_iter().flatten()).for_each(|(x, product)| *x += product);
    }

    /// Returns the diagonal of `V' E^-1` for that of `E^-1`, where `E` is the process and independent noise.
    fn diagonal_of_inverse(&self, precision: &[f64], independent: &[f64]) -> Vec<f64> {
        // `A E^-1 = I - (E - A) E^-1`.
        let of_process = |precision: f64, independent: f64| match self.process {
            Some(_) => 1.0 - independent * precision,
            None => 0.0,
        };
        let rows = precision.iter().zip(independent).zip(&self.own);
        rows.map(|((precision, independent), own)| own * precision + of_process(*precision, *independent))
            .collect()
    }
}
