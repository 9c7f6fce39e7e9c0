//! Line search along a step of Newton's method.

/// Share of the initial slope below which the search ends.
const FLAT: f64 = 0.5;
/// Share of the interval at both of its ends that the next point avoids.
const INNER: f64 = 0.1;

/// Returns the share of a step at which the slope of the energy is small; `falling` is the slope at its start. A whole
/// step along which the energy still falls is accepted. The energy is convex along almost every step, so that the slope
/// crosses zero once.
pub(super) fn share_of_step(falling: f64, max_cuts: usize, mut slope: impl FnMut(f64) -> f64) -> f64 {
    let (mut low, mut high) = ((0.0, falling), None);
    let mut share = 1.0;
    for _ in 0..max_cuts {
        let now = slope(share);
        if now.abs() <= FLAT * falling.abs() {
            break;
        }
        if now > 0.0 {
            high = Some((share, now));
        } else {
            low = (share, now);
        }
        share = match high {
            None => break,
            // Regula falsi, limited to the inner part of the interval.
            Some((end, rising)) => {
                let cut = low.0 + (end - low.0) * low.1.abs() / (low.1.abs() + rising);
                cut.clamp(low.0 + INNER * (end - low.0), end - INNER * (end - low.0))
            }
        };
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_at_the_share_is_small() {
        for minimum in [0.02, 0.3, 0.9, 1.5] {
            let slope = |share: f64| (share - minimum) * (1.0 + share * share);
            let share = share_of_step(slope(0.0), 30, slope);
            assert!(
                slope(share).abs() <= FLAT * slope(0.0).abs() || share == 1.0 && minimum > 1.0,
                "{share}"
            );
        }
    }
}
