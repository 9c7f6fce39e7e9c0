//! Intervals of a log: the moves of the actuator, their declared times and their usual length.

use super::log::Log;

/// An interval in which the actuator runs: sample indices, with the end excluded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Move {
    pub(super) from: usize,
    pub(super) to: usize,
}

/// Declared lengths of a move and of the rest after it, in seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schedule {
    pub(super) on_s: Option<f64>,
    pub(super) dwell_s: Option<f64>,
}

/// Returns the number of samples in a time, at least one.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive and limited")]
pub(super) fn samples_in(log: &Log, seconds: f64) -> usize {
    (seconds / log.period_s().max(1e-9)).round().clamp(1.0, 1e6) as usize
}

/// Returns the time in seconds at which a move has ended: that of the first sample after it, unless
/// samples are lost there.
pub(super) fn stop_s(log: &Log, m: Move) -> f64 {
    let last_s = log.time_s[m.to - 1];
    let next_s = log.time_s.get(m.to).copied().filter(|_| !log.breaks.contains(&m.to)).unwrap_or(last_s);
    if next_s - last_s < 5.0 * log.period_s() { next_s } else { last_s }
}

/// Share of the lengths that must be near the usual one, and what is near: a few pauses between
/// series are longer together than all rests.
const USUAL_SHARE: f64 = 0.1;
const NEAR_USUAL: f64 = 0.5;

/// Returns the median of lengths, weighted by the lengths: half of the total is in longer ones. Rare
/// lengths do not count.
pub(super) fn usual(mut lengths: Vec<f64>) -> f64 {
    lengths.sort_by(f64::total_cmp);
    let count = lengths.len();
    loop {
        let half = 0.5 * lengths.iter().sum::<f64>();
        let mut sum = 0.0;
        let median = lengths.iter().copied().find(|length| {
            sum += length;
            sum >= half
        });
        let Some(median) = median else { return 0.0 };
        let shorter = lengths.partition_point(|length| *length < NEAR_USUAL * median);
        if (lengths.len() - shorter) as f64 >= USUAL_SHARE * count as f64 || shorter == 0 {
            return median;
        }
        lengths.truncate(shorter);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_are_not_usual() {
        let with = |extra: &[f64]| usual([&[3.0; 20][..], &[0.4; 40], extra].concat());
        assert!((with(&[]) - 3.0).abs() < 1e-12);
        assert!((with(&[5_000.0, 90.0]) - 3.0).abs() < 1e-12);
        assert!((usual(vec![8.0]) - 8.0).abs() < 1e-12 && usual(Vec::new()) == 0.0);
    }
}
