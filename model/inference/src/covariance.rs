//! Covariance of the readings of a series, which every hypothesis contains.
//!
//! Rows `i` and `j` of a series have the covariance
//!
//! ```text
//! V_ij = E_ij + (o_d^2 + o_l^2 F_i F_j / mean F^2) [same direction]  +  o_s^2  +  s^2 g_i g_j
//! E_ij = [i = j] ((1 - a) h_i^2 / w_i + quantum^2 / 12)  +  a h_i h_j rho^|i - j|
//! h_i  = sigma sqrt(1 + (c F_i / mean F)^2)
//! ```
//!
//! with the repetition noise `sigma` that grows with the load `F` by the ratio `c`, the weights `w`
//! of the heavy tails, an AR(1) process with share `a` and correlation `rho`, an offset per series
//! and direction with a constant part `o_d` and a part `o_l` that grows with load, an offset `o_s`
//! per series, and a scale of friction `s` per series, where `g` is the reading's sensitivity to
//! friction. Rows of different series are independent.
//!
//! So `V = E + U U'`, with few columns `U`.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::autoregression::Process;
use crate::noise::{
    DIRECTION_OFFSET, EXCLUDED, LOAD_GROWTH, LOAD_OFFSET, NoiseReference, SCALES, SERIES_OFFSET,
    SERIES_SCALE, Scales,
};
use crate::problem::Rows;

/// Standard deviation of an excluded row, in mean loads.
const EXCLUDED_SD: f64 = 1e5;

/// Noise of the rows of a table, at given scales, weights and sensitivities to friction.
pub(crate) struct Noise<'a> {
    rows: &'a Rows,
    reference: &'a NoiseReference,
    /// Values of the scales.
    values: [f64; SCALES],
    /// Share and correlation of the process.
    autoregression: (f64, f64),
    weights: &'a DVector<f64>,
    friction: &'a [f64],
}

impl<'a> Noise<'a> {
    pub(crate) fn new(
        rows: &'a Rows,
        reference: &'a NoiseReference,
        scales: &Scales,
        weights: &'a DVector<f64>,
        friction: &'a [f64],
    ) -> Self {
        let (values, autoregression) = (scales.values(), scales.autoregression());
        Self { rows, reference, values, autoregression, weights, friction }
    }

    /// Returns `h` of a row, and its relative derivative with respect to `ln c`.
    fn repetition_sd(&self, row: usize) -> (f64, f64) {
        let [sigma, growth, ..] = self.values;
        let square = (growth * self.relative_load(row)).powi(2);
        (sigma * (1.0 + square).sqrt(), square / (1.0 + square))
    }

    /// Returns the variance of a row that it shares with no other one, without the quantum's.
    pub(crate) fn independent_variance(&self, row: usize) -> f64 {
        (1.0 - self.autoregression.0) * self.repetition_sd(row).0.powi(2)
    }

    /// Returns the variance of a row about its expectation under its weight; that of an excluded row is
    /// so large that the row determines nothing.
    pub(crate) fn own_variance(&self, row: usize) -> f64 {
        match self.weights[row] {
            EXCLUDED => (EXCLUDED_SD * self.reference.repetition_sd.max(self.reference.mean_load)).powi(2),
            weight => self.independent_variance(row) / weight,
        }
    }

    /// Returns the variance of rounding to the quantum.
    pub(crate) fn quantum_variance(&self) -> f64 {
        self.reference.quantum.powi(2) / 12.0
    }

    /// Returns the diagonal of `E` without the process.
    pub(crate) fn independent_variances(&self, range: &Range<usize>) -> Vec<f64> {
        let quantum = self.quantum_variance();
        range.clone().map(|row| self.own_variance(row) + quantum).collect()
    }

    /// Returns the process of the rows of a series; `None` if they are not autocorrelated.
    pub(crate) fn process(&self, range: &Range<usize>) -> Option<Process> {
        let (share, correlation) = self.autoregression;
        let sd = || range.clone().map(|row| self.repetition_sd(row).0).collect();
        (share > 0.0).then(|| Process::new(&self.rows.order[range.clone()], sd(), share, correlation))
    }

    /// Returns the variance of a row.
    pub(crate) fn variance(&self, row: usize) -> f64 {
        let shared: f64 = self.shared_columns(&(row..row + 1)).iter().flatten().map(|x| x * x).sum();
        let process = self.autoregression.0 * self.repetition_sd(row).0.powi(2);
        shared + process + self.own_variance(row) + self.quantum_variance()
    }

    /// Returns the columns `U` of a series. Offsets are merged where a direction has one load.
    pub(crate) fn shared_columns(&self, range: &Range<usize>) -> Vec<Vec<f64>> {
        let [_, _, direction, series, scale, by_load] = self.values;
        let is_of = |row: usize, side: bool| self.rows.direction[row] == side;
        let load_of =
            |side: bool| range.clone().find(|row| is_of(*row, side)).map(|row| self.relative_load(row));
        let loads = [false, true].map(load_of);
        let mut columns: Vec<Vec<f64>> = Vec::new();
        // Variance of the constant offset of each direction.
        let mut variances = [0.0; 2];
        for (side, load) in [false, true].into_iter().zip(loads) {
            let Some(load) = load else { continue };
            variances[usize::from(side)] = direction * direction;
            if range.clone().all(|row| !is_of(row, side) || self.relative_load(row) == load) {
                variances[usize::from(side)] += (by_load * load).powi(2);
            } else {
                let slope = |row| if is_of(row, side) { by_load * self.relative_load(row) } else { 0.0 };
                columns.push(range.clone().map(slope).collect());
            }
        }
        // Cholesky factor of the covariance of the two constant offsets, with that of the series.
        let common = series * series;
        let first = (variances[0] + common).sqrt();
        let second = (variances[1] + common * variances[0] / (variances[0] + common)).sqrt();
        let alone = (variances[1] + common).sqrt();
        let mut offsets = |of_first: f64, of_second: f64| {
            let offset = |row| if is_of(row, false) { of_first } else { of_second };
            columns.push(range.clone().map(offset).collect());
        };
        match loads {
            [Some(_), Some(_)] => {
                offsets(first, common / first);
                offsets(0.0, second);
            }
            [Some(_), None] => offsets(first, 0.0),
            [None, _] => offsets(0.0, alone),
        }
        columns.push(range.clone().map(|row| scale * self.friction[row]).collect());
        columns
    }

    fn relative_load(&self, row: usize) -> f64 {
        self.rows.load[row] / self.reference.mean_load
    }

    /// Returns the derivative of the covariance of a series with respect to the logarithm of a scale.
    pub(crate) fn derivative(&self, range: &Range<usize>, scale: usize) -> Derivative {
        let root = std::f64::consts::SQRT_2 * self.values[scale];
        let (first, length) = (range.start, range.len());
        let is_second =
            |i: usize, second: bool| if self.rows.direction[first + i] == second { root } else { 0.0 };
        match scale {
            DIRECTION_OFFSET => {
                Derivative::Factor(DMatrix::from_fn(length, 2, |i, side| is_second(i, side == 1)))
            }
            LOAD_OFFSET => Derivative::Factor(DMatrix::from_fn(length, 2, |i, side| {
                is_second(i, side == 1) * self.relative_load(first + i)
            })),
            SERIES_OFFSET => Derivative::Factor(DMatrix::from_element(length, 1, root)),
            SERIES_SCALE => {
                Derivative::Factor(DMatrix::from_fn(length, 1, |i, _| root * self.friction[first + i]))
            }
            _ => self.repetition_derivative(range, scale),
        }
    }

    fn repetition_derivative(&self, range: &Range<usize>, scale: usize) -> Derivative {
        let growth = |row: usize| if scale == LOAD_GROWTH { self.repetition_sd(row).1 } else { 1.0 };
        Derivative::Repetition {
            growth: range.clone().map(growth).collect(),
            own: self.estimated_variances(range),
            process: self.process(range),
        }
    }

    /// Returns the part of the diagonal of `E` that follows the scales: neither the process nor the quantum, and nothing of
    /// excluded rows.
    pub(crate) fn estimated_variances(&self, range: &Range<usize>) -> Vec<f64> {
        let own = |row: usize| match self.weights[row] {
            EXCLUDED => 0.0,
            weight => self.independent_variance(row) / weight,
        };
        range.clone().map(own).collect()
    }

    /// Returns the covariance of the rows of a series, element by element.
    #[cfg(test)]
    pub(crate) fn covariance(&self, range: &Range<usize>) -> DMatrix<f64> {
        let [_, _, direction, series, scale, by_load] = self.values.map(|x| x * x);
        let (share, correlation) = self.autoregression;
        DMatrix::from_fn(range.len(), range.len(), |i, j| {
            let (a, b) = (range.start + i, range.start + j);
            let mut sum = series + scale * self.friction[a] * self.friction[b];
            if self.rows.direction[a] == self.rows.direction[b] {
                sum += direction + by_load * self.relative_load(a) * self.relative_load(b);
            }
            let lag = self.rows.order[a].abs_diff(self.rows.order[b]) as f64;
            sum += share * self.repetition_sd(a).0 * self.repetition_sd(b).0 * libm::pow(correlation, lag);
            if i == j {
                sum += self.own_variance(a) + self.quantum_variance();
            }
            sum
        })
    }
}

/// Derivative of the covariance of a series.
#[derive(Clone, Debug)]
pub(crate) enum Derivative {
    /// `F F'`.
    Factor(DMatrix<f64>),
    /// `G A + A G + 2 G D`, with the covariance `A` of the process.
    Repetition {
        /// Diagonal of `G`.
        growth: Vec<f64>,
        /// Diagonal of `D`.
        own: Vec<f64>,
        process: Option<Process>,
    },
}

impl Derivative {
    /// Returns the product with a vector.
    pub(crate) fn times(&self, vector: &[f64]) -> DVector<f64> {
        match self {
            Self::Factor(factor) => {
                let vector = nalgebra::DVectorView::from_slice(vector, vector.len());
                factor * factor.tr_mul(&vector)
            }
            Self::Repetition { growth, own, process } => {
                let mut product = DVector::from_fn(vector.len(), |i, _| 2.0 * growth[i] * own[i] * vector[i]);
                if let Some(process) = process {
                    let grown: Vec<f64> = growth.iter().zip(vector).map(|(g, x)| g * x).collect();
                    let (after, before) = (process.times(vector), process.times(&grown));
                    for (i, product) in product.iter_mut().enumerate() {
                        *product += growth[i] * after[i] + before[i];
                    }
                }
                product
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_problem::with_noise;

    /// The parts of the covariance sum to it.
    #[test]
    fn columns_and_process_are_the_covariance() {
        for autoregression in [0, 2] {
            with_noise(autoregression, |noise, range| {
                let dense = noise.covariance(range);
                let columns: Vec<DVector<f64>> =
                    noise.shared_columns(range).into_iter().map(DVector::from_vec).collect();
                let shared = DMatrix::from_columns(&columns);
                let mut sum = &shared * shared.transpose();
                sum += DMatrix::from_diagonal(&DVector::from_vec(noise.independent_variances(range)));
                for j in range.clone() {
                    let mut unit = vec![0.0; range.len()];
                    unit[j] = 1.0;
                    let column = noise.process(range).map_or(vec![0.0; range.len()], |p| p.times(&unit));
                    sum.column_mut(j).iter_mut().zip(column).for_each(|(sum, x)| *sum += x);
                    assert!((noise.variance(j) / dense[(j, j)] - 1.0).abs() < 1e-12);
                }
                for (sum, dense) in sum.iter().zip(dense.iter()) {
                    assert!((sum - dense).abs() < 1e-12 * dense.abs().max(0.01), "{sum} {dense}");
                }
            });
        }
    }
}
