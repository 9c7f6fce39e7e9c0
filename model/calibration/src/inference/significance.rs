//! Probability of a gain by chance, over all candidates.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::observations::Observations;

/// Returns the number of independent units of an estimate: a load or a layout is determined by
/// series, not by repetitions.
pub fn degrees_of_freedom(data: &Observations, constants: usize) -> f64 {
    (data.series as f64 - data.excluded_series() as f64 - constants as f64).max(4.0)
}

/// Returns the probability that the largest of `tried` gains reaches `gain` by chance (Sidak). A
/// gain is the square of a Student's t, since the noise is estimated from the series.
pub fn family_p_value(gain: f64, tried: usize, degrees: f64) -> f64 {
    let single = StudentsT::new(0.0, 1.0, degrees).map_or(1.0, |t| 2.0 * t.sf(gain.max(0.0).sqrt()));
    (-libm::expm1(tried as f64 * libm::log1p(-single.min(1.0)))).clamp(0.0, 1.0)
}

/// Returns the gain that chance reaches with this probability.
pub(crate) fn gain_at(p: f64, tried: usize, degrees: f64) -> f64 {
    let (mut low, mut high) = (0.0f64, 1e4f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if family_p_value(middle, tried, degrees) > p { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_and_probabilities_are_inverse() {
        for (p, degrees) in [(0.05, 64.0), (0.01, 140.0), (0.02, 10.0)] {
            let gain = gain_at(p, 21, degrees);
            assert!((family_p_value(gain, 21, degrees) / p - 1.0).abs() < 1e-6);
        }
        // One candidate and many series: the square of the normal quantile 1.96.
        assert!((gain_at(0.05, 1, 1e6) - 3.841).abs() < 0.01);
        assert_eq!(family_p_value(0.0, 21, 64.0), 1.0);
    }
}
