//! Pin positions along the wrap.

/// Largest difference between two pitches of an even pattern, in radians (0.006 degrees).
const EVEN_TOLERANCE_RAD: f64 = 1e-4;

/// Angles of the pins about the axis, ascending, in radians; zero is the middle of the wrap.
///
/// ```
/// use pinswitch_friction::PinPattern;
///
/// let pattern = PinPattern::even(3, 0.3);
/// assert_eq!(pattern.angles_rad(), [-0.3, 0.0, 0.3]);
/// assert!(pattern.is_even() && pattern.is_centred());
/// assert_eq!(pattern.within(0.4).count(), 1, "0.2 rad to each side");
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PinPattern {
    angles_rad: Vec<f64>,
}

impl PinPattern {
    /// Creates a pattern from the angles of its pins in radians, in any order.
    pub fn new(mut angles_rad: Vec<f64>) -> Self {
        angles_rad.sort_by(f64::total_cmp);
        Self { angles_rad }
    }

    /// Creates a pattern of `count` pins with a pitch of `pitch_rad`, centred on the wrap.
    pub fn even(count: usize, pitch_rad: f64) -> Self {
        let middle = (count as f64 - 1.0) / 2.0;
        Self::new((0..count).map(|i| (i as f64 - middle) * pitch_rad).collect())
    }

    /// Returns the angles of the pins in radians, ascending.
    pub fn angles_rad(&self) -> &[f64] {
        &self.angles_rad
    }

    /// Returns the number of pins.
    pub fn count(&self) -> usize {
        self.angles_rad.len()
    }

    /// Returns the angle from the first to the last pin in radians, or `None` without pins.
    pub fn span_rad(&self) -> Option<f64> {
        Some(self.angles_rad.last()? - self.angles_rad.first()?)
    }

    /// Returns the mean centre-to-centre pitch in radians, or `None` with fewer than two pins.
    pub fn mean_pitch_rad(&self) -> Option<f64> {
        (self.count() > 1).then(|| self.span_rad().map(|s| s / (self.count() - 1) as f64))?
    }

    /// Whether the pitch is the same between all neighbouring pins.
    pub fn is_even(&self) -> bool {
        self.mean_pitch_rad().is_none_or(|mean| {
            self.angles_rad.windows(2).all(|w| (w[1] - w[0] - mean).abs() < EVEN_TOLERANCE_RAD)
        })
    }

    /// Whether the pins are symmetric about the middle of the wrap.
    pub fn is_centred(&self) -> bool {
        self.angles_rad
            .iter()
            .zip(self.angles_rad.iter().rev())
            .all(|(a, b)| (a + b).abs() < EVEN_TOLERANCE_RAD)
    }

    /// Returns the pins within a wrap of `wrap_rad` radians.
    pub fn within(&self, wrap_rad: f64) -> Self {
        let half = wrap_rad / 2.0 + EVEN_TOLERANCE_RAD;
        Self::new(self.angles_rad.iter().copied().filter(|a| a.abs() <= half).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_patterns_are_centred() {
        let pattern = PinPattern::even(6, 0.2);
        assert!(pattern.is_even() && pattern.is_centred());
        assert!((pattern.mean_pitch_rad().unwrap() - 0.2).abs() < 1e-12);
        assert!((pattern.span_rad().unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn pins_outside_the_wrap_are_dropped() {
        let pattern = PinPattern::new(vec![-0.9, -0.1, 0.3, 0.8]);
        assert_eq!(pattern.within(1.0).angles_rad(), &[-0.1, 0.3]);
        assert!(!pattern.is_even() && !pattern.is_centred());
    }

    #[test]
    fn one_pin_has_no_pitch() {
        assert_eq!(PinPattern::even(1, 0.2).mean_pitch_rad(), None);
        assert_eq!(PinPattern::default().span_rad(), None);
    }
}
