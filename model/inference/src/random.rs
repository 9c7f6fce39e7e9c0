//! Random numbers from an explicit seed, equal on every platform.

use std::f64::consts::PI;

/// A generator of pseudo-random numbers: SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    /// Returns the generator of a seed.
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number in the open interval from 0 to 1.
    pub(crate) fn uniform(&mut self) -> f64 {
        ((self.next() >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// Returns an index below `count`; 0 if `count` is 0.
    pub(crate) fn index(&mut self, count: usize) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below count")]
        let index = (self.uniform() * count as f64) as usize;
        index.min(count.saturating_sub(1))
    }

    /// Returns an index by these probabilities; `None` if there are none.
    pub(crate) fn by_probability(
        &mut self,
        probabilities: impl ExactSizeIterator<Item = f64>,
    ) -> Option<usize> {
        let last = probabilities.len().checked_sub(1)?;
        let share = self.uniform();
        let mut up_to = 0.0;
        let mut ends = probabilities.map(|probability| {
            up_to += probability;
            up_to
        });
        // The sum of all may be less than 1 by rounding.
        Some(ends.position(|end| share < end).unwrap_or(last))
    }

    /// Returns a standard normal number (Box and Muller).
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        radius * libm::cos(2.0 * PI * self.uniform())
    }

    /// Returns a number of Student's t distribution with 5 degrees of freedom, the noise's: a ratio of uniform numbers (Kinderman
    /// and Monahan, ACM Transactions on Mathematical Software 3, 1977), whose density needs products only.
    pub(crate) fn student(&mut self) -> f64 {
        // Largest |t| f(t)^(1/2) of f(t) = (1 + t^2/5)^-3, at t^2 = 5/2.
        const MOST: f64 = 0.860_662_965_823_87;
        loop {
            let below = self.uniform();
            let t = MOST * (2.0 * self.uniform() - 1.0) / below;
            let inverse = 1.0 + t * t / 5.0;
            if below * below * inverse * inverse * inverse <= 1.0 {
                return t;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_match_the_distributions() {
        let mut random = Random::new(7);
        let count = 20_000;
        let variance = |draw: &mut dyn FnMut() -> f64| -> f64 {
            (0..count).map(|_| draw().powi(2)).sum::<f64>() / f64::from(count)
        };
        assert!((variance(&mut || random.normal()) - 1.0).abs() < 0.03);
        assert!((variance(&mut || random.student()) - 5.0 / 3.0).abs() < 0.15);
        // Quantiles of Student's t distribution.
        for (quantile, share) in [(0.7267, 0.5), (2.0150, 0.1), (4.0321, 0.01)] {
            let outside = (0..count).filter(|_| random.student().abs() > quantile).count();
            let sd = (share * (1.0 - share) / f64::from(count)).sqrt();
            assert!(
                (outside as f64 / f64::from(count) - share).abs() < 4.0 * sd,
                "{outside} beyond {quantile}"
            );
        }
    }
}
