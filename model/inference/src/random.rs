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

    /// Returns a standard normal number (Box and Muller).
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(self.uniform())).sqrt();
        radius * libm::cos(2.0 * PI * self.uniform())
    }

    /// Returns a number of Student's t distribution with 5 degrees of freedom, the noise's (Bailey,
    /// Mathematics of Computation 62, 1994).
    pub(crate) fn student(&mut self) -> f64 {
        const NU: f64 = 5.0;
        let radius = (NU * libm::expm1(-2.0 / NU * libm::log(self.uniform()))).sqrt();
        radius * libm::cos(2.0 * PI * self.uniform())
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
    }
}
