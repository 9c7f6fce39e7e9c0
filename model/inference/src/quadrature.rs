//! Heavy-tailed priors as finite mixtures, and sums of probabilities in logarithms.

use std::f64::consts::{PI, SQRT_2};

use crate::half_t::HalfT;

/// Logarithm of the range of a distribution over standard deviations, in scales of its prior.
const LOG_RANGE: f64 = 3.5;

/// A discrete distribution over positive nodes: variances of normals, or standard deviations.
#[derive(Clone, Debug)]
pub(crate) struct Mixture {
    /// Nodes, ascending.
    pub(crate) nodes: Vec<f64>,
    /// Logarithms of their probabilities.
    pub(crate) log_weights: Vec<f64>,
}

impl Mixture {
    /// Normalises the weights.
    fn new(nodes: Vec<f64>, mut log_weights: Vec<f64>) -> Self {
        let total = log_sum_exp(&log_weights);
        log_weights.iter_mut().for_each(|w| *w -= total);
        Self { nodes, log_weights }
    }

    /// Returns the standard Cauchy distribution as a mixture of zero-mean normals, whose variances
    /// are the nodes: an inverse gamma distribution with shape and rate 1/2.
    pub(crate) fn cauchy() -> Self {
        let nodes = geometric(0.02, 3e5, 21);
        let log_weights = nodes.iter().map(|v| -0.5 * libm::log(*v) - 0.5 / v).collect();
        Self::new(nodes, log_weights)
    }

    /// Returns a half-t distribution over standard deviations of any size, whose logarithms are at most `spacing` apart: on a
    /// geometric grid the width of a cell is proportional to its node.
    pub(crate) fn half_t(prior: HalfT, spacing: f64) -> Self {
        Self::half_t_over(prior, spacing, [prior.scale, prior.scale])
    }

    /// Returns the same over standard deviations from well below the first size to well above the second.
    pub(crate) fn half_t_over(prior: HalfT, spacing: f64, sizes: [f64; 2]) -> Self {
        let range = libm::log(sizes[1] / sizes[0]) + 2.0 * LOG_RANGE;
        let count = (range / spacing).ceil() as i32 + 1;
        let nodes = geometric(sizes[0] * libm::exp(-LOG_RANGE), sizes[1] * libm::exp(LOG_RANGE), count);
        let log_weights = nodes.iter().map(|sd| libm::log(*sd) + prior.log_kernel(*sd)).collect();
        Self::new(nodes, log_weights)
    }
}

/// Returns the sum of the logarithms of positive numbers, none beyond `1e-70` to `1e70`: of the products of four.
pub(crate) fn sum_of_logs(numbers: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut product) = (0.0, 1.0);
    for (i, number) in numbers.enumerate() {
        product *= number;
        if i % 4 == 3 {
            sum += libm::log(product);
            product = 1.0;
        }
    }
    sum + libm::log(product)
}

/// Returns numbers in geometric progression from `first` to `last`.
fn geometric(first: f64, last: f64, count: i32) -> Vec<f64> {
    let ratio = libm::log(last / first) / f64::from(count - 1);
    (0..count).map(|i| first * libm::exp(ratio * f64::from(i))).collect()
}

/// Returns the two-sided tail probability of Student's t distribution with 5 degrees of freedom at
/// `z`, in closed form.
pub(crate) fn student_tail(z: f64) -> f64 {
    let angle = libm::atan(z.abs() / 5f64.sqrt());
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    // For large z the closed form loses all digits; the leading term of the tail is then exact.
    if z.abs() > 1e3 {
        let density = 8.0 / (3.0 * PI * 5f64.sqrt());
        return 2.0 * density * libm::pow(5.0, 3.0) / (5.0 * libm::pow(z.abs(), 5.0));
    }
    (1.0 - 2.0 / PI * (angle + sin * (cos + 2.0 / 3.0 * libm::pow(cos, 3.0)))).max(0.0)
}

/// Returns `ln sum exp(x)` without overflow; negative infinity for an empty list.
pub(crate) fn log_sum_exp(terms: &[f64]) -> f64 {
    let most = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        return most;
    }
    most + libm::log(terms.iter().map(|x| libm::exp(x - most)).sum())
}

/// Returns the index of the largest number; 0 for an empty list.
pub(crate) fn largest(terms: &[f64]) -> usize {
    (0..terms.len()).fold(0, |best, i| if terms[i] > terms[best] { i } else { best })
}

/// Returns the standard normal distribution function.
pub(crate) fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z / SQRT_2)
}

/// Returns the logarithm of the standard normal distribution function. Below -20 the first terms of
/// its asymptotic series replace it, since the function itself underflows.
pub(crate) fn log_normal_cdf(z: f64) -> f64 {
    if z > -20.0 {
        libm::log(normal_cdf(z))
    } else {
        -0.5 * z * z - libm::log(-z) - 0.5 * libm::log(2.0 * PI) + libm::log1p(-1.0 / (z * z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_add_up_for_any_count() {
        for count in 0..10 {
            let numbers = || (0..count).map(|i| 1e-12 * libm::pow(17.0, f64::from(i)));
            let sum: f64 = numbers().map(libm::log).sum();
            assert!((sum_of_logs(numbers()) - sum).abs() < 1e-12 * (1.0 + sum.abs()), "{count}");
        }
    }

    /// Quantiles of a table of Student's t distribution.
    #[test]
    fn student_tails_match_the_table() {
        for (z, p) in [(2.571, 0.05), (4.032, 0.01), (6.869, 0.001)] {
            assert!((student_tail(z) / p - 1.0).abs() < 2e-3, "{z}: {}", student_tail(z));
        }
        let ratio = student_tail(1.001e3) / student_tail(0.999e3);
        assert!((ratio - libm::pow(0.999 / 1.001, 5.0)).abs() < 0.02, "{ratio}");
    }

    /// The density of the mixture is that of the Cauchy distribution within 3 % to 30 scales.
    #[test]
    fn cauchy_is_a_mixture_of_normals() {
        let cauchy = Mixture::cauchy();
        for x in [0.0, 0.3, 1.0, 3.0, 10.0, 30.0] {
            let density: f64 = cauchy
                .nodes
                .iter()
                .zip(&cauchy.log_weights)
                .map(|(v, w)| libm::exp(w - 0.5 * x * x / v) / (2.0 * PI * v).sqrt())
                .sum();
            let exact = 1.0 / (PI * (1.0 + x * x));
            assert!((density / exact - 1.0).abs() < 0.03, "{x}: {density} for {exact}");
        }
    }

    /// The mean of the half-t distribution with 3 degrees of freedom, and its share above two scales. Nodes are close at any
    /// size, so that a well known standard deviation lies between two of them.
    #[test]
    fn half_t_has_its_mean_and_tail() {
        let prior = Mixture::half_t(HalfT { scale: 1.0, degrees: 3.0 }, 0.5);
        let weights: Vec<f64> = prior.log_weights.iter().map(|w| libm::exp(*w)).collect();
        let mean: f64 = prior.nodes.iter().zip(&weights).map(|(x, w)| x * w).sum();
        assert!((mean / (2.0 * 3f64.sqrt() / PI) - 1.0).abs() < 0.05, "{mean}");
        let above: f64 = prior.nodes.iter().zip(&weights).filter(|(x, _)| **x > 2.0).map(|(_, w)| w).sum();
        assert!((above - 0.139).abs() < 0.03, "{above}");
        assert!(prior.nodes.windows(2).all(|pair| pair[1] < 1.7 * pair[0]));
    }

    #[test]
    fn log_normal_cdf_is_continuous() {
        assert!((log_normal_cdf(-19.999_999) - log_normal_cdf(-20.000_001)).abs() < 1e-3);
        assert!((log_normal_cdf(0.0) - libm::log(0.5)).abs() < 1e-15);
    }

    #[test]
    fn log_sums_do_not_overflow() {
        assert!((log_sum_exp(&[1000.0, 1000.0]) - 1000.0 - libm::log(2.0)).abs() < 1e-12);
        assert_eq!(log_sum_exp(&[]), f64::NEG_INFINITY);
    }
}
