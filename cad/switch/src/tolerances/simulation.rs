//! Simulated switches: independent draws of all deviations, and the threshold of each by a complete solution.

use pinswitch_diagnostic::{Diagnostic, codes};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::parallel::map_each;

/// Thresholds of simulated switches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Simulated {
    /// Number of simulated switches.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Mean of the thresholds, N.
    pub mean_n: f64,
    /// Standard error of the mean, N.
    pub mean_error_n: f64,
    /// Standard deviation, N.
    pub standard_deviation_n: f64,
    /// Standard error of the standard deviation for a normal distribution, N.
    pub standard_deviation_error_n: f64,
    /// 2.5 % and 97.5 % quantiles, N.
    pub interval_n: [f64; 2],
    /// Switches without a threshold, which are not part of the other numbers.
    pub without_threshold: usize,
}

/// Simulates switches. `threshold_n` draws the deviations of one switch from its source of standard normal numbers, and
/// returns its threshold. The draws of a switch depend on the seed and on its number only.
///
/// # Errors
/// A [`Diagnostic`] if fewer than two switches have a threshold.
pub(super) fn simulate(
    draws: usize,
    seed: u64,
    threshold_n: impl Fn(&mut dyn FnMut() -> f64) -> Option<f64> + Sync + Send,
) -> Result<Simulated, Diagnostic> {
    let normal = Normal::standard();
    let all = map_each((0..draws as u64).collect(), |switch| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(switch);
        // Within 0 and 1, so that the normal number is finite.
        let mut standard = || normal.inverse_cdf(random.random_range(f64::EPSILON..1.0 - f64::EPSILON));
        threshold_n(&mut standard)
    });
    let mut thresholds_n: Vec<f64> = all.into_iter().flatten().collect();
    thresholds_n.sort_by(f64::total_cmp);
    let n = thresholds_n.len();
    if n < 2 {
        return Err(Diagnostic::new(
            codes::SWITCH_WITHOUT_THRESHOLD,
            format!("{n} of {draws} simulated switches have a threshold"),
        )
        .with_help("raise --draws, or widen friction.load_min_n and friction.load_max_n"));
    }
    let mean_n = thresholds_n.iter().sum::<f64>() / n as f64;
    let squares: f64 = thresholds_n.iter().map(|t| (t - mean_n).powi(2)).sum();
    let standard_deviation_n = (squares / (n - 1) as f64).sqrt();
    let quantile = |q: f64| {
        let at = q * (n - 1) as f64;
        let (below, share) = (at.floor() as usize, at.fract());
        thresholds_n[below] + share * (thresholds_n[(below + 1).min(n - 1)] - thresholds_n[below])
    };
    Ok(Simulated {
        draws,
        seed,
        mean_n,
        mean_error_n: standard_deviation_n / (n as f64).sqrt(),
        standard_deviation_n,
        standard_deviation_error_n: standard_deviation_n / (2.0 * (n - 1) as f64).sqrt(),
        interval_n: [quantile(0.025), quantile(0.975)],
        without_threshold: draws - n,
    })
}
