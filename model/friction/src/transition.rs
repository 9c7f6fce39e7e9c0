//! The transition of a curve: the load at which silicone carries half of the friction.

use serde::Serialize;

use crate::curve::FrictionCurve;

/// Transition of a curve from the pins to the silicone.
///
/// ```
/// use pinswitch_friction::{Contact, Law, PinPattern, Substrate, Transition, predict_by};
/// use pinswitch_friction::published::{LAYOUTS, wrap_angle_rad};
///
/// let pins = PinPattern::even(3, LAYOUTS[1].pitch_rad());
/// let contact = Contact::new(Substrate::Silicone, pins, wrap_angle_rad())?;
/// let loads_n: Vec<f64> = (1..=50).map(f64::from).collect();
/// let curve = predict_by(Law::Layout, &contact, &loads_n)?;
/// let transition = Transition::of(&curve).ok_or("no transition within these loads")?;
/// assert!(transition.low_n < transition.threshold_n);
/// assert!(transition.threshold_n < transition.high_n);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Transition {
    /// Load at which silicone and pins carry the same friction, N.
    pub threshold_n: f64,
    /// Load at which the upper edge of the band reaches the friction at the threshold, N.
    pub low_n: f64,
    /// Load at which the lower edge of the band reaches it, N; the heaviest load if it does not.
    pub high_n: f64,
}

/// Returns the load at which a rising `column` first reaches `level`, by linear interpolation.
fn crossing(load_n: &[f64], column: &[f64], level: f64) -> Option<f64> {
    let i = column.iter().position(|v| *v >= level)?;
    let Some(before) = i.checked_sub(1) else { return load_n.first().copied() };
    let share = (level - column[before]) / (column[i] - column[before]);
    Some(load_n[before] + share * (load_n[i] - load_n[before]))
}

impl Transition {
    /// Returns the transition of `curve`, or `None` if the silicone's share of friction does not
    /// cross one half within its loads.
    pub fn of(curve: &FrictionCurve) -> Option<Self> {
        let threshold_n = Self::threshold_n(&curve.load_n, &curve.silicone_share)?;
        let reach = |column: &[f64]| {
            let friction = interpolated(&curve.load_n, &curve.friction_n, threshold_n);
            crossing(&curve.load_n, column, friction)
        };
        Some(Self {
            threshold_n,
            low_n: reach(&curve.band_high_n).unwrap_or(threshold_n),
            high_n: reach(&curve.band_low_n).or_else(|| curve.load_n.last().copied()).unwrap_or(threshold_n),
        })
    }

    /// Returns the threshold in newtons from the silicone's share of friction at ascending loads,
    /// if it is among them.
    pub fn threshold_n(load_n: &[f64], silicone_share: &[f64]) -> Option<f64> {
        let starts_on_pins = *silicone_share.first()? < 0.5;
        starts_on_pins.then(|| crossing(load_n, silicone_share, 0.5)).flatten()
    }
}

/// Returns `column` at `load`, by linear interpolation.
pub(crate) fn interpolated(load_n: &[f64], column: &[f64], load: f64) -> f64 {
    let i = load_n.partition_point(|l| *l < load).clamp(1, load_n.len().saturating_sub(1).max(1));
    match (load_n.get(i - 1).zip(load_n.get(i)), column.get(i - 1).zip(column.get(i))) {
        (Some((l0, l1)), Some((c0, c1))) => c0 + (c1 - c0) * (load - l0) / (l1 - l0),
        _ => column.first().copied().unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contact;
    use crate::law::Law;
    use crate::pattern::PinPattern;
    use crate::prediction::predict_by;
    use crate::published;
    use crate::substrate::Substrate;

    #[test]
    fn threshold_is_below_the_half_load() {
        let pins = PinPattern::even(3, published::LAYOUTS[1].pitch_rad());
        let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap();
        let loads: Vec<f64> = (1..=100).map(|i| 0.5 * f64::from(i)).collect();
        let curve = predict_by(Law::Layout, &contact, &loads).unwrap();
        let t = Transition::of(&curve).unwrap();
        // The coefficient of silicone is five times that of the pins, so that it carries half of
        // the friction well before half of the contact has switched.
        assert!(t.threshold_n > 15.0 && t.threshold_n < 38.0, "{t:?}");
        assert!(t.low_n < t.threshold_n && t.threshold_n < t.high_n);
    }

    #[test]
    fn pins_alone_have_no_transition() {
        let pins = PinPattern::even(3, 0.3);
        let contact = Contact::new(Substrate::Abs, pins, published::wrap_angle_rad()).unwrap();
        assert_eq!(Transition::of(&predict_by(Law::Physics, &contact, &[1.0, 50.0]).unwrap()), None);
    }

    #[test]
    fn crossings_are_interpolated() {
        assert_eq!(crossing(&[1.0, 2.0], &[0.0, 1.0], 0.25), Some(1.25));
        assert_eq!(crossing(&[1.0, 2.0], &[0.6, 1.0], 0.25), Some(1.0));
        assert_eq!(crossing(&[1.0, 2.0], &[0.0, 0.1], 0.25), None);
        assert_eq!(interpolated(&[1.0, 2.0], &[0.0, 1.0], 1.25), 0.25);
    }
}
