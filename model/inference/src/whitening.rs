//! Roots of the precision of the noise, in time proportional to the rows.
//!
//! The covariance of a series is `V = E + U U'`. A root `W` of its precision starts as that of the repetition noise `E`, which is
//! diagonal or the [`Filter`] of a process, and changes by one factor for each column `u` of `U`: with `b = W u` and `t = b'b`
//!
//! ```text
//! (I + b b')^-1/2 = I - f b b',   f = 1 / (q (q + 1)),   q = sqrt(1 + t)
//! ```
//!
//! so that `W V W' = I` and `ln det V = ln det E + sum ln(1 + t)`.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::autoregression::Filter;
use crate::covariance::Noise;
use crate::quadrature::sum_of_logs;

/// Root of the precision of all series.
#[derive(Clone, Debug)]
pub(crate) struct Whitening {
    /// Rows of each series.
    pub(crate) ranges: Vec<Range<usize>>,
    /// Root of each series.
    pub(crate) roots: Vec<PrecisionRoot>,
    /// `ln det V`.
    pub(crate) log_determinant: f64,
}

impl Whitening {
    /// Returns the roots for the noise of some series; `None` if a covariance is not finite.
    pub(crate) fn new(noise: &Noise<'_>, ranges: &[Range<usize>]) -> Option<Self> {
        let roots: Vec<PrecisionRoot> = ranges.iter().map(|range| PrecisionRoot::new(noise, range)).collect();
        let log_determinant = 2.0 * roots.iter().map(|root| root.log_determinant).sum::<f64>();
        log_determinant.is_finite().then(|| Self { ranges: ranges.to_vec(), roots, log_determinant })
    }

    /// Returns `W X`.
    pub(crate) fn whiten(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut white = columns.clone();
        self.whiten_mut(white.as_mut_slice());
        white
    }

    /// Returns `W x`.
    pub(crate) fn whiten_vector(&self, column: &DVector<f64>) -> DVector<f64> {
        let mut white = column.clone();
        self.whiten_mut(white.as_mut_slice());
        white
    }

    /// Whitens columns that follow each other.
    pub(crate) fn whiten_mut(&self, columns: &mut [f64]) {
        let rows = self.ranges.last().map_or(1, |range| range.end);
        for (range, root) in self.ranges.iter().zip(&self.roots) {
            for column in columns.chunks_exact_mut(rows) {
                root.whiten(&mut column[range.clone()]);
            }
        }
    }

    /// Returns `W' x`.
    pub(crate) fn whiten_transposed(&self, white: &DVector<f64>) -> DVector<f64> {
        let mut result = white.clone();
        self.whiten_transposed_mut(result.as_mut_slice());
        result
    }

    /// Replaces `x` by `W' x`.
    pub(crate) fn whiten_transposed_mut(&self, x: &mut [f64]) {
        for (range, root) in self.ranges.iter().zip(&self.roots) {
            root.whiten_transposed(&mut x[range.clone()]);
        }
    }
}

/// Root `W` of the precision of a series.
#[derive(Clone, Debug)]
pub(crate) struct PrecisionRoot {
    repetition: Repetition,
    contractions: Vec<Contraction>,
    /// `-ln det W`.
    pub(crate) log_determinant: f64,
}

/// Root of the precision of the repetition noise.
#[derive(Clone, Debug)]
enum Repetition {
    /// The inverse standard deviation of each row.
    Independent(Vec<f64>),
    Autocorrelated(Filter),
}

/// The factor `I - f b b'`, with the inverse `I + f q b b'`.
#[derive(Clone, Debug)]
struct Contraction {
    b: Vec<f64>,
    /// `q`.
    stretch: f64,
}

impl Contraction {
    fn new(b: Vec<f64>) -> Self {
        let stretch = (1.0 + dot(&b, &b)).sqrt();
        Self { b, stretch }
    }

    fn apply(&self, x: &mut [f64]) {
        let share = -dot(&self.b, x) / (self.stretch * (self.stretch + 1.0));
        add_scaled(x, &self.b, share);
    }

    fn apply_inverse(&self, x: &mut [f64]) {
        let share = dot(&self.b, x) / (self.stretch + 1.0);
        add_scaled(x, &self.b, share);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (of_a, of_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = of_a.remainder().iter().zip(of_b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in of_a.zip(of_b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

fn add_scaled(x: &mut [f64], b: &[f64], factor: f64) {
    x.iter_mut().zip(b).for_each(|(x, b)| *x += factor * b);
}

impl PrecisionRoot {
    fn new(noise: &Noise<'_>, range: &Range<usize>) -> Self {
        let variances = noise.independent_variances(range);
        let (repetition, log_determinant) = match noise.process(range) {
            Some(process) => {
                let filter = process.filter(&variances);
                let log_determinant = filter.log_determinant();
                (Repetition::Autocorrelated(filter), log_determinant)
            }
            None => {
                let log_determinant = 0.5 * sum_of_logs(variances.iter().copied());
                let inverse = variances.iter().map(|v| 1.0 / v.sqrt()).collect();
                (Repetition::Independent(inverse), log_determinant)
            }
        };
        let mut root = Self { repetition, contractions: Vec::new(), log_determinant };
        for mut column in noise.shared_columns(range) {
            root.whiten(&mut column);
            let contraction = Contraction::new(column);
            root.log_determinant += libm::log(contraction.stretch);
            root.contractions.push(contraction);
        }
        root
    }

    /// Replaces `x` by `W x`.
    pub(crate) fn whiten(&self, x: &mut [f64]) {
        match &self.repetition {
            Repetition::Independent(inverse) => x.iter_mut().zip(inverse).for_each(|(x, i)| *x *= i),
            Repetition::Autocorrelated(filter) => filter.whiten(x),
        }
        self.contractions.iter().for_each(|contraction| contraction.apply(x));
    }

    /// Replaces `x` by `W' x`.
    pub(crate) fn whiten_transposed(&self, x: &mut [f64]) {
        self.transposed_after(self.contractions.len(), x);
    }

    /// Replaces `x` by the transposed product with the root after some of the contractions.
    fn transposed_after(&self, contractions: usize, x: &mut [f64]) {
        self.contractions[..contractions].iter().rev().for_each(|contraction| contraction.apply(x));
        match &self.repetition {
            Repetition::Independent(inverse) => x.iter_mut().zip(inverse).for_each(|(x, i)| *x *= i),
            Repetition::Autocorrelated(filter) => filter.whiten_transposed(x),
        }
    }

    /// Replaces `x` by `W^-1 x`.
    pub(crate) fn colour(&self, x: &mut [f64]) {
        self.contractions.iter().rev().for_each(|contraction| contraction.apply_inverse(x));
        match &self.repetition {
            Repetition::Independent(inverse) => x.iter_mut().zip(inverse).for_each(|(x, i)| *x /= i),
            Repetition::Autocorrelated(filter) => filter.colour(x),
        }
    }

    /// Returns the diagonal of `E^-1`, and columns `M` with `V^-1 = E^-1 - M M'`.
    pub(crate) fn precision(&self) -> (Vec<f64>, Vec<Vec<f64>>) {
        let diagonal = match &self.repetition {
            Repetition::Independent(inverse) => inverse.iter().map(|i| i * i).collect(),
            Repetition::Autocorrelated(filter) => filter.precision_diagonal(),
        };
        // The precision so far loses `V^-1 u u' V^-1 / (1 + t)` by each column (Sherman and Morrison).
        let column = |(place, contraction): (usize, &Contraction)| {
            let mut column: Vec<f64> = contraction.b.iter().map(|b| b / contraction.stretch).collect();
            self.transposed_after(place, &mut column);
            column
        };
        (diagonal, self.contractions.iter().enumerate().map(column).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_problem::with_noise;

    /// All products agree with the dense covariance.
    #[test]
    fn products_agree_with_the_dense_covariance() {
        for autoregression in [0, 1, 3] {
            with_noise(autoregression, |noise, range| {
                let n = range.len();
                let dense = noise.covariance(range);
                let whitening = Whitening::new(noise, std::slice::from_ref(range)).unwrap();
                let identity = DMatrix::identity(n, n);
                let root = whitening.whiten(&identity);
                assert!((&root * &dense * root.transpose() - &identity).amax() < 1e-6);
                let factor = dense.clone().cholesky().unwrap();
                let log_determinant: f64 = 2.0 * factor.l().diagonal().map(libm::log).sum();
                assert!((whitening.log_determinant - log_determinant).abs() < 1e-9);
                let transposed = |x: DVector<f64>| whitening.whiten_transposed(&x);
                let (diagonal, columns) = whitening.roots[0].precision();
                let precision = factor.inverse();
                for i in 0..n {
                    let unit = DVector::from_fn(n, |j, _| f64::from(u8::from(i == j)));
                    assert!((transposed(unit.clone()) - root.row(i).transpose()).amax() < 1e-9 * root.amax());
                    let mut restored = root.column(i).into_owned();
                    whitening.roots[0].colour(restored.as_mut_slice());
                    assert!((restored - unit).amax() < 1e-6);
                    let explained: f64 = columns.iter().map(|column| column[i] * column[i]).sum();
                    let expected = precision[(i, i)];
                    assert!((diagonal[i] - explained - expected).abs() < 1e-9 * expected.max(1e-3));
                }
            });
        }
    }
}
