//! Two-level split of numbers (N. Otsu, "A threshold selection method from gray-level histograms",
//! IEEE Trans. Syst. Man Cybern. 9, 1979), and robust noise.

use crate::median::median;

/// Least distance of two levels, or of a move, in standard deviations of the noise.
pub(super) const LEVELS_NOISE: f64 = 6.0;

/// Two groups of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TwoLevels {
    /// Midpoint between the groups.
    pub(super) threshold: f64,
    /// Mean of the lower group.
    pub(super) low: f64,
    /// Mean of the upper group.
    pub(super) high: f64,
    /// Pooled standard deviation within the groups.
    pub(super) within: f64,
    /// Variance between the groups over the total variance: 0.64 for one normal distribution, 0.75
    /// for a uniform one, 1 for two constants.
    pub(super) between_share: f64,
}

/// Splits numbers so that the variance between the groups is largest; `None` if all are equal.
pub(super) fn two_levels(values: &[f64]) -> Option<TwoLevels> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len() as f64;
    let mean = sorted.iter().sum::<f64>() / count.max(1.0);
    let total: f64 = sorted.iter().map(|v| (v - mean) * (v - mean)).sum();
    let (mut sum, mut best): (f64, Option<(usize, f64)>) = (0.0, None);
    for (i, pair) in sorted.windows(2).enumerate() {
        sum += pair[0] - mean;
        if pair[0] < pair[1] {
            // Sums are relative to the mean, so that both groups have the same one with opposite sign.
            let low = (i + 1) as f64;
            let between = sum * sum / low + sum * sum / (count - low);
            if best.is_none_or(|b| between > b.1) {
                best = Some((i + 1, between));
            }
        }
    }
    let (split, between) = best?;
    let group = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    Some(TwoLevels {
        threshold: 0.5 * (sorted[split - 1] + sorted[split]),
        low: group(&sorted[..split]),
        high: group(&sorted[split..]),
        within: ((total - between).max(0.0) / count).sqrt(),
        between_share: between / total,
    })
}

/// Returns the standard deviation of the noise, from the median of the absolute differences of
/// consecutive values. If most values are equal, it is a third of the smallest difference.
pub(super) fn noise(values: &[f64]) -> f64 {
    let mut steps: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    let resolution = steps.iter().copied().filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
    let floor = if resolution.is_finite() { resolution / 3.0 } else { 0.0 };
    (1.4826 * median(&mut steps) / std::f64::consts::SQRT_2).max(floor)
}

/// Returns the standard deviation of the noise of a signal that may move at a constant speed most of
/// the time, from the median of the absolute second differences.
pub(super) fn noise_about_slope(values: &[f64]) -> f64 {
    let mut bends: Vec<f64> = values.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).collect();
    let resolution = bends.iter().copied().filter(|d| *d > 1e-9).fold(f64::INFINITY, f64::min);
    let floor = if resolution.is_finite() { resolution / 3.0 } else { 0.0 };
    // The variance of a second difference of independent values is six times theirs.
    (1.4826 * median(&mut bends) / 6f64.sqrt()).max(floor)
}

/// Distance of a spike from the median of its neighbourhood, in standard deviations of the noise.
const SPIKE: f64 = 5.0;

/// Returns the values without single spikes: a value far from the median of three is replaced by it.
/// Other values stay, since a running median would correlate their noise.
pub(super) fn without_spikes(values: &[f64]) -> Vec<f64> {
    let bound = SPIKE * noise(values);
    let at = |i: usize| values[i.min(values.len() - 1)];
    (0..values.len())
        .map(|i| {
            let (a, b, c) = (at(i.saturating_sub(1)), at(i), at(i + 1));
            let middle = a.max(b).min(a.min(b).max(c));
            if (b - middle).abs() > bound { middle } else { b }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_levels_are_separated() {
        let split = two_levels(&[0.1, 8.0, 0.0, 0.2, 8.2, 0.1]).unwrap();
        assert!((split.threshold - 4.1).abs() < 1e-12 && split.between_share > 0.99, "{split:?}");
        let line: Vec<f64> = (0..100).map(f64::from).collect();
        assert!((two_levels(&line).unwrap().between_share - 0.75).abs() < 0.01);
        assert_eq!(two_levels(&[1.0, 1.0]), None);
    }

    #[test]
    fn spikes_are_removed_and_steps_stay() {
        let mut values: Vec<f64> =
            (0..40).map(|i| f64::from(i % 3) + if i < 20 { 0.0 } else { 50.0 }).collect();
        let clean = values.clone();
        values[7] = 90.0;
        let mut expected = clean.clone();
        expected[7] = 2.0;
        assert_eq!(without_spikes(&values), expected);
        assert_eq!(without_spikes(&clean), clean);
        let ramp: Vec<f64> = (0..90).map(|i| f64::from(i) * 5.0 + 0.1 * f64::from(i % 2)).collect();
        assert!(noise_about_slope(&ramp) < 0.2 && noise(&ramp) > 3.0);
        assert!((noise(&[0.0, 1.0, 0.0, 1.0]) - 1.4826 / 2f64.sqrt()).abs() < 1e-12);
    }
}
