//! Scales of the noise, their priors, and what the priors follow from.

use std::collections::BTreeMap;

use crate::half_t::HalfT;
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
pub(crate) const LOUD: f64 = std::f64::consts::LN_2;

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
