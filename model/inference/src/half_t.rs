//! The half-t prior of standard deviations, with the half-normal and the half-Cauchy distribution as limits.

use std::f64::consts::PI;

/// Power of a standard deviation that multiplies its density, so that its logarithm has a mode above zero.
const SCALE_POWER: f64 = 0.02;

/// Half of Student's t distribution, the usual prior of a standard deviation of which a table has few groups (Gelman 2006,
/// Bayesian Analysis 1, 515-533).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HalfT {
    /// Scale, in the unit of the standard deviation.
    pub(crate) scale: f64,
    /// Degrees of freedom; infinite for the half-normal distribution.
    pub(crate) degrees: f64,
}

impl HalfT {
    /// Returns the half-Cauchy distribution, with one degree of freedom.
    pub(crate) const fn cauchy(scale: f64) -> Self {
        Self { scale, degrees: 1.0 }
    }

    /// Returns the half-normal distribution.
    pub(crate) const fn normal(scale: f64) -> Self {
        Self { scale, degrees: f64::INFINITY }
    }

    /// Returns the logarithm of its density at a standard deviation, without a constant.
    pub(crate) fn log_kernel(self, sd: f64) -> f64 {
        let square = (sd / self.scale).powi(2);
        if self.degrees.is_infinite() {
            return -0.5 * square;
        }
        -0.5 * (self.degrees + 1.0) * libm::log1p(square / self.degrees)
    }

    /// Returns value, derivative and negative second derivative, in the logarithm of a standard deviation, of the logarithm of
    /// the density.
    pub(crate) fn log_density(self, log_sd: f64) -> (f64, f64, f64) {
        let Self { scale, degrees } = self;
        if degrees.is_infinite() {
            let square = libm::exp(2.0 * (log_sd - libm::log(scale)));
            let value = 0.5 * libm::log(2.0 / PI) - libm::log(scale) - 0.5 * square;
            return (value + SCALE_POWER * log_sd, SCALE_POWER - square, 2.0 * square);
        }
        let square = libm::exp(2.0 * (log_sd - libm::log(scale))) / degrees;
        let constant = libm::lgamma(0.5 * (degrees + 1.0)) - libm::lgamma(0.5 * degrees) + libm::log(2.0)
            - 0.5 * libm::log(PI * degrees)
            - libm::log(scale);
        let value = constant - 0.5 * (degrees + 1.0) * libm::log1p(square) + SCALE_POWER * log_sd;
        let share = square / (1.0 + square);
        (value, SCALE_POWER - (degrees + 1.0) * share, 2.0 * (degrees + 1.0) * share * (1.0 - share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_normal_is_the_limit() {
        let (limit, close) = (HalfT::normal(0.2), HalfT { scale: 0.2, degrees: 1e7 });
        for sd in [0.01, 0.2, 0.7] {
            assert!((limit.log_kernel(sd) - close.log_kernel(sd)).abs() < 1e-5);
            assert!((limit.log_density(libm::log(sd)).0 - close.log_density(libm::log(sd)).0).abs() < 1e-5);
        }
    }

    /// The density integrates to one, and its derivatives are those of finite differences.
    #[test]
    fn the_density_is_normalised_and_smooth() {
        for degrees in [1.0, 3.0, 8.0, f64::INFINITY] {
            let prior = HalfT { scale: 0.3, degrees };
            let density = |log: f64| libm::exp(prior.log_density(log).0 - SCALE_POWER * log);
            let step = 1e-3;
            let integral: f64 = (-12_000..12_000)
                .map(|i| f64::from(i) * step)
                .map(|log| density(log) * libm::exp(log) * step)
                .sum();
            assert!((integral - 1.0).abs() < 1e-3, "{degrees}: {integral}");
            for log in [-3.0, -1.0, 0.5, 2.0] {
                let (below, at, above) =
                    (prior.log_density(log - step), prior.log_density(log), prior.log_density(log + step));
                let least = 1e-5 * (1.0 + at.2);
                assert!(((above.0 - below.0) / (2.0 * step) - at.1).abs() < least);
                assert!(((above.1 - below.1) / (2.0 * step) + at.2).abs() < least);
            }
        }
    }
}
