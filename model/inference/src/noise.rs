//! Covariance of the readings of a series, which every hypothesis contains.
//!
//! Rows `i` and `j` of a series have the covariance
//!
//! ```text
//! V_ij = [i = j] ((1 - a) h_i^2 / w_i + quantum^2 / 12)  +  a h_i h_j rho^|i - j|
//!      + (o_d^2 + o_l^2 F_i F_j / mean F^2) [same direction]  +  o_s^2  +  s^2 g_i g_j
//! h_i  = sigma sqrt(1 + (c F_i / mean F)^2)
//! ```
//!
//! with the repetition noise `sigma` that grows with the load `F` by the ratio `c`, the weights `w`
//! of the heavy tails, an AR(1) process with share `a` and correlation `rho`, an offset per series
//! and direction with a constant part `o_d` and a part `o_l` that grows with load, an offset `o_s`
//! per series, and a scale of friction `s` per series, where `g` is the reading's sensitivity to
//! friction. Rows of different series are independent.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::half_t::HalfT;
use crate::lower_triangular::{add_lower_times, inverse};
use crate::problem::Rows;

/// Number of scales of the noise.
pub(crate) const SCALES: usize = 6;
/// Indices of the scales `c`, `o_d`, `o_s`, `s` and `o_l`; that of `sigma` is 0.
pub(crate) const LOAD_GROWTH: usize = 1;
pub(crate) const DIRECTION_OFFSET: usize = 2;
pub(crate) const SERIES_OFFSET: usize = 3;
pub(crate) const SERIES_SCALE: usize = 4;
pub(crate) const LOAD_OFFSET: usize = 5;

/// Share and correlation of the AR(1) processes; the first is none.
pub(crate) const AUTOREGRESSIONS: [(f64, f64); 4] = [(0.0, 0.0), (0.5, 0.5), (0.5, 0.85), (0.8, 0.85)];
/// Prior probability that readings are not autocorrelated.
const UNCORRELATED_PROBABILITY: f64 = 0.5;

/// Prior mean of `ln c`: repetition noise doubles its variance at twice the mean load.
const LOG_LOAD_GROWTH: f64 = -0.7;
/// Scale of the half-Cauchy prior of the scale of friction per series, relative.
const SERIES_SCALE_PRIOR: f64 = 0.02;
/// Weight of an excluded row.
pub(crate) const EXCLUDED: f64 = 0.0;
/// Standard deviation of an excluded row, in mean loads.
const EXCLUDED_SD: f64 = 1e5;

/// Properties of the readings from which the priors of the noise follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseReference {
    /// Standard deviation of successive differences over the square root of two, robust.
    pub repetition_sd: f64,
    /// Distance of neighbouring readings of a coarse instrument; 0 if there is none.
    pub quantum: f64,
    /// Mean load.
    pub mean_load: f64,
}

impl NoiseReference {
    /// Estimates them from readings.
    pub(crate) fn of_readings(readings: &[f64], rows: &Rows) -> Self {
        let quantum = quantum(readings);
        let place = |row: usize| (rows.series[row], rows.direction[row]);
        let mut count: BTreeMap<(usize, bool), usize> = BTreeMap::new();
        (0..readings.len()).for_each(|row| *count.entry(place(row)).or_default() += 1);
        let (single, repeated): (Vec<usize>, Vec<usize>) =
            (0..readings.len()).partition(|row| count[&place(*row)] == 1);
        let mut steps = steps(readings, repeated, place);
        // A reading that its series does not repeat is next to those at its load, of neighbouring series.
        steps.extend(self::steps(readings, single, |row| (rows.load[row].to_bits(), rows.direction[row])));
        steps.sort_by(f64::total_cmp);
        let mean = readings.iter().sum::<f64>() / readings.len() as f64;
        let spread = readings.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / readings.len() as f64;
        let robust = if steps.is_empty() { 0.02 * spread.sqrt() } else { 1.4826 * steps[steps.len() / 2] };
        let mean_load = rows.load.iter().sum::<f64>() / rows.len() as f64;
        Self { repetition_sd: robust.max(quantum / 3.0).max(1e-4), quantum, mean_load: mean_load.max(1e-9) }
    }
}

/// Returns the differences of the reading of each row and of the row before in its group, over the square root of two.
fn steps<G: Ord>(readings: &[f64], rows: Vec<usize>, group: impl Fn(usize) -> G) -> Vec<f64> {
    let mut last = BTreeMap::new();
    let step = |row: usize| {
        let before: Option<f64> = last.insert(group(row), readings[row]);
        before.map(|before| (readings[row] - before).abs() / std::f64::consts::SQRT_2)
    };
    rows.into_iter().filter_map(step).collect()
}

/// Returns the smallest step between sorted readings if nine tenths of the steps are multiples of it,
/// and 0 otherwise.
fn quantum(readings: &[f64]) -> f64 {
    let mut sorted = readings.to_vec();
    sorted.sort_by(f64::total_cmp);
    let gaps: Vec<f64> = sorted.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap > 1e-9).collect();
    let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    let multiples = gaps.iter().filter(|gap| (*gap / least - (*gap / least).round()).abs() < 0.02).count();
    if least.is_finite() && 10 * multiples > 9 * gaps.len() { least } else { 0.0 }
}

/// Scales of the noise: logarithms, and the index of the autoregression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    pub(crate) log: [f64; SCALES],
    pub(crate) autoregression: usize,
}

/// Logarithm of the ratio of a scale to that of repeated readings above which it may stand for missing
/// structure.
const LOUD: f64 = std::f64::consts::LN_2;

impl Scales {
    /// Returns typical scales, from which a fit starts.
    pub(crate) fn typical(reference: &NoiseReference) -> Self {
        let sd = libm::log(reference.repetition_sd);
        let half = sd - libm::log(2.0);
        Self { log: [sd, LOG_LOAD_GROWTH, sd, half, libm::log(0.01), half], autoregression: 0 }
    }

    /// Raises scales that have vanished, since a fit would not find them again.
    pub(crate) fn raised(mut self, reference: &NoiseReference) -> Self {
        let typical = Self::typical(reference);
        for (log, usual) in self.log.iter_mut().zip(typical.log) {
            *log = log.max(usual - 2.0);
        }
        self
    }

    /// Returns the scales of repeated readings; `None` if these are not much smaller.
    pub(crate) fn quiet(mut self, reference: &NoiseReference) -> Option<Self> {
        let typical = Self::typical(reference);
        let is_loud = self.log.iter().zip(typical.log).any(|(log, usual)| *log > usual + LOUD);
        for (log, usual) in self.log.iter_mut().zip(typical.log) {
            *log = log.min(usual);
        }
        is_loud.then_some(self)
    }

    /// Returns repetition noise, its growth with load, offset per series and direction, offset per
    /// series, scale of friction per series, and offset per series and direction at the mean load
    /// that is proportional to the load. Noise and offsets are in the unit of the readings.
    pub fn values(&self) -> [f64; SCALES] {
        self.log.map(libm::exp)
    }

    /// Returns share and correlation of the autocorrelated part of the repetition noise.
    pub fn autoregression(&self) -> (f64, f64) {
        AUTOREGRESSIONS[self.autoregression]
    }

    /// Returns the logarithm of their prior density, its gradient in the logarithms of the scales,
    /// and the negative second derivatives.
    pub(crate) fn log_prior(&self, reference: &NoiseReference) -> (f64, [f64; SCALES], [f64; SCALES]) {
        let center = [libm::log(reference.repetition_sd), LOG_LOAD_GROWTH];
        let sd = reference.repetition_sd;
        let half_cauchy = [sd, sd, SERIES_SCALE_PRIOR, sd];
        let (mut value, mut gradient, mut curvature) = (0.0, [0.0; SCALES], [0.0; SCALES]);
        for (i, center) in center.iter().enumerate() {
            let distance = self.log[i] - center;
            value -= 0.5 * distance * distance;
            gradient[i] = -distance;
            curvature[i] = 1.0;
        }
        for (i, scale) in half_cauchy.into_iter().enumerate() {
            let term = HalfT::cauchy(scale).log_density(self.log[i + 2]);
            value += term.0;
            gradient[i + 2] = term.1;
            curvature[i + 2] = term.2;
        }
        let share = if self.autoregression == 0 {
            UNCORRELATED_PROBABILITY
        } else {
            (1.0 - UNCORRELATED_PROBABILITY) / (AUTOREGRESSIONS.len() - 1) as f64
        };
        (value + libm::log(share), gradient, curvature)
    }
}

/// Noise of the rows of a table, at given scales, weights and sensitivities to friction.
pub(crate) struct Noise<'a> {
    pub(crate) rows: &'a Rows,
    pub(crate) reference: &'a NoiseReference,
    pub(crate) scales: &'a Scales,
    pub(crate) weights: &'a DVector<f64>,
    pub(crate) friction: &'a [f64],
}

impl Noise<'_> {
    /// Returns `h` of a row, and its relative derivative with respect to `ln c`.
    fn repetition_sd(&self, row: usize) -> (f64, f64) {
        let [sigma, growth, ..] = self.scales.values();
        let square = (growth * self.rows.load[row] / self.reference.mean_load).powi(2);
        (sigma * (1.0 + square).sqrt(), square / (1.0 + square))
    }

    /// Returns the variance of a row that it shares with no other one, without the quantum's.
    pub(crate) fn independent_variance(&self, row: usize) -> f64 {
        (1.0 - self.scales.autoregression().0) * self.repetition_sd(row).0.powi(2)
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

    /// Returns the covariance of the rows of a series.
    pub(crate) fn covariance(&self, range: &std::ops::Range<usize>) -> DMatrix<f64> {
        let [_, _, direction, series, scale, by_load] = self.scales.values().map(|x| x * x);
        let (share, correlation) = self.scales.autoregression();
        let first = range.start;
        let sd: Vec<f64> = range.clone().map(|row| self.repetition_sd(row).0).collect();
        let powers = powers(correlation, range.len());
        DMatrix::from_fn(range.len(), range.len(), |i, j| {
            let (a, b) = (first + i, first + j);
            let mut sum = series + scale * self.friction[a] * self.friction[b];
            if self.rows.direction[a] == self.rows.direction[b] {
                sum += direction + by_load * self.relative_load(a) * self.relative_load(b);
            }
            if share > 0.0 {
                sum += share * sd[i] * sd[j] * powers[self.lag(a, b).min(range.len())];
            }
            if i == j {
                sum += self.own_variance(a) + self.quantum_variance();
            }
            sum
        })
    }

    fn relative_load(&self, row: usize) -> f64 {
        self.rows.load[row] / self.reference.mean_load
    }

    /// Returns the distance of two rows in the order of their series.
    fn lag(&self, a: usize, b: usize) -> usize {
        self.rows.order[a].abs_diff(self.rows.order[b])
    }

    /// Returns the derivative of the covariance of a series with respect to the logarithm of a scale.
    pub(crate) fn derivative(&self, range: &std::ops::Range<usize>, scale: usize) -> Derivative {
        let root = std::f64::consts::SQRT_2 * libm::exp(self.scales.log[scale]);
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

    fn repetition_derivative(&self, range: &std::ops::Range<usize>, scale: usize) -> Derivative {
        let (share, correlation) = self.scales.autoregression();
        let first = range.start;
        let sd: Vec<(f64, f64)> = range
            .clone()
            .map(|row| {
                let (sd, growth) = self.repetition_sd(row);
                (sd, if scale == LOAD_GROWTH { growth } else { 1.0 })
            })
            .collect();
        let own = |i: usize| match self.weights[first + i] {
            EXCLUDED => 0.0,
            weight => 2.0 * sd[i].1 * (1.0 - share) * sd[i].0 * sd[i].0 / weight,
        };
        if share == 0.0 {
            return Derivative::Diagonal(DVector::from_fn(range.len(), |i, _| own(i)));
        }
        let powers = powers(correlation, range.len());
        Derivative::Dense(DMatrix::from_fn(range.len(), range.len(), |i, j| {
            let power = powers[self.lag(first + i, first + j).min(range.len())];
            let shared = share * (sd[i].1 + sd[j].1) * sd[i].0 * sd[j].0 * power;
            if i == j { shared + own(i) } else { shared }
        }))
    }

    /// Returns the Cholesky factors of the covariance; `None` if it is not positive definite.
    pub(crate) fn whitening(&self, ranges: &[std::ops::Range<usize>]) -> Option<Whitening> {
        let mut whitening = Whitening {
            ranges: ranges.to_vec(),
            factors: Vec::new(),
            inverses: Vec::new(),
            log_determinant: 0.0,
        };
        for range in ranges {
            let factor = self.covariance(range).cholesky()?.unpack();
            whitening.log_determinant += 2.0 * factor.diagonal().iter().map(|d| libm::log(*d)).sum::<f64>();
            whitening.inverses.push(inverse(&factor));
            whitening.factors.push(factor);
        }
        whitening.log_determinant.is_finite().then_some(whitening)
    }
}

/// Derivative of the covariance of a series.
#[derive(Clone, Debug)]
pub(crate) enum Derivative {
    /// `F F'`.
    Factor(DMatrix<f64>),
    /// A diagonal matrix.
    Diagonal(DVector<f64>),
    /// Any matrix.
    Dense(DMatrix<f64>),
}

impl Derivative {
    /// Returns the product with a vector.
    pub(crate) fn times(&self, vector: &DVector<f64>) -> DVector<f64> {
        match self {
            Self::Factor(factor) => factor * factor.tr_mul(vector),
            Self::Diagonal(diagonal) => diagonal.component_mul(vector),
            Self::Dense(dense) => dense * vector,
        }
    }
}

/// Returns the powers of a number from 0 to `most`.
fn powers(base: f64, most: usize) -> Vec<f64> {
    std::iter::successors(Some(1.0), |power| Some(power * base)).take(most + 1).collect()
}

/// Rows of a block of short series.
const BLOCK_ROWS: usize = 256;

/// Cholesky factors of the covariance `V = L L'` of all series.
#[derive(Clone, Debug)]
pub(crate) struct Whitening {
    /// Rows of each series.
    pub(crate) ranges: Vec<std::ops::Range<usize>>,
    /// `L` of each series.
    pub(crate) factors: Vec<DMatrix<f64>>,
    /// `L^-1` of each series.
    pub(crate) inverses: Vec<DMatrix<f64>>,
    /// `ln det V`.
    pub(crate) log_determinant: f64,
}

impl Whitening {
    /// Returns `L^-1 X`.
    pub(crate) fn whiten(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut white = DMatrix::zeros(columns.nrows(), columns.ncols());
        for block in self.blocks() {
            for first in (0..columns.ncols()).map(|column| column * columns.nrows()) {
                for (range, inverse) in self.ranges[block.clone()].iter().zip(&self.inverses[block.clone()]) {
                    let part = first + range.start..first + range.end;
                    let x = &columns.as_slice()[part.clone()];
                    add_lower_times(inverse, x, &mut white.as_mut_slice()[part]);
                }
            }
        }
        white
    }

    /// Returns the series of blocks of neighbouring ones, whose factors stay in the processor's cache for all columns.
    fn blocks(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let mut first = 0;
        std::iter::from_fn(move || {
            let start = self.ranges.get(first)?.start;
            let rest = self.ranges[first..].iter().take_while(|range| range.end - start <= BLOCK_ROWS);
            let block = first..first + rest.count().max(1);
            first = block.end;
            Some(block)
        })
    }

    /// Returns `L^-1 x`.
    pub(crate) fn whiten_vector(&self, column: &DVector<f64>) -> DVector<f64> {
        let mut white = DVector::zeros(column.len());
        for (range, inverse) in self.ranges.iter().zip(&self.inverses) {
            add_lower_times(
                inverse,
                &column.as_slice()[range.clone()],
                &mut white.as_mut_slice()[range.clone()],
            );
        }
        white
    }

    /// Returns `L'^-1 x`.
    pub(crate) fn unwhiten_transposed(&self, white: &DVector<f64>) -> DVector<f64> {
        let mut result = DVector::zeros(white.len());
        for (range, inverse) in self.ranges.iter().zip(&self.inverses) {
            let part = white.rows(range.start, range.len());
            result.rows_mut(range.start, range.len()).gemv_tr(1.0, inverse, &part, 0.0);
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::test_problem::long_rows;

    /// Heavy loads do not hide how close repeated readings are, whether all series repeat them, one, or none.
    #[test]
    fn the_reference_is_the_noise_of_repeated_readings() {
        for (length, joined, outlier) in [(8, 0, 0.0), (1, 0, 0.0), (1, 2, 0.0), (1, 2, 20.0)] {
            let mut rows = long_rows(600 / length, length);
            let mut random = Random::new(5);
            let mut readings: Vec<f64> =
                rows.load.iter().map(|load| 50.0 * load + 0.1 * random.normal()).collect();
            // Two readings in one direction may be of one series, and differ by an outlier.
            rows.series[joined] = 0;
            rows.load[joined] = rows.load[0];
            readings[joined] = readings[0] + outlier;
            let sd = NoiseReference::of_readings(&readings, &rows).repetition_sd;
            assert!((0.08..0.12).contains(&sd), "{length} {joined} {outlier}: {sd}");
        }
    }
}
