//! A predicted friction curve, with its band and a word on how far to trust it.

use serde::{Deserialize, Serialize};

use crate::published;
use crate::{Contact, Law, Substrate, SwitchState, Trust};

/// Tension and friction over load, as columns of equal length; forces in newtons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrictionCurve {
    /// The law behind the curve.
    pub law: Law,
    /// How far to trust it.
    pub trust: Trust,
    /// Why it is trusted no further; empty for a published condition.
    pub reasons: Vec<String>,
    /// Load on the tendon.
    pub load_n: Vec<f64>,
    /// Tension while the load is released.
    pub eccentric_n: Vec<f64>,
    /// Tension while the load is pulled.
    pub concentric_n: Vec<f64>,
    /// Friction `D = (F_c - F_e)/2`.
    pub friction_n: Vec<f64>,
    /// Lower edge of the band of `D`.
    pub band_low_n: Vec<f64>,
    /// Upper edge of the band of `D`.
    pub band_high_n: Vec<f64>,
    /// Share of `D` that the silicone makes, 0..1.
    pub silicone_share: Vec<f64>,
}

/// A measured friction maximum or onset that the paper prints for a contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PublishedPoint {
    /// Load in newtons.
    pub load_n: f64,
    /// Friction in newtons; `None` where the paper gives a load only (the onset of three-double).
    pub friction_n: Option<f64>,
}

/// One point of a curve: the state and its band.
pub(crate) struct Banded {
    pub(crate) state: SwitchState,
    pub(crate) low_n: f64,
    pub(crate) high_n: f64,
}

impl Banded {
    /// The state in a band of `D / (1 + spread) .. D (1 + spread)`.
    pub(crate) fn within(state: SwitchState, spread: f64) -> Self {
        Self { low_n: state.friction_n / (1.0 + spread), high_n: state.friction_n * (1.0 + spread), state }
    }
}

impl FrictionCurve {
    /// The curve of these points by a law.
    pub(crate) fn of(law: Law, (trust, reasons): (Trust, Vec<String>), points: &[Banded]) -> Self {
        let column = |f: fn(&Banded) -> f64| points.iter().map(f).collect::<Vec<_>>();
        Self {
            law,
            trust,
            reasons,
            load_n: column(|p| p.state.load_n),
            eccentric_n: column(|p| p.state.eccentric_n),
            concentric_n: column(|p| p.state.concentric_n),
            friction_n: column(|p| p.state.friction_n),
            band_low_n: column(|p| p.low_n),
            band_high_n: column(|p| p.high_n),
            silicone_share: column(|p| p.state.silicone_share),
        }
    }
}

/// What the paper prints for this contact: its maximum, and for three-double the onset of switching.
pub fn published_points(contact: &Contact) -> Vec<PublishedPoint> {
    if !contact.departures().is_empty() {
        return Vec::new();
    }
    let maximum = |d| PublishedPoint { load_n: published::heaviest_load_n(), friction_n: Some(d) };
    match (contact.published_layout(), contact.substrate()) {
        (Some(layout), substrate) => {
            let mut points = vec![maximum(layout.max_n(substrate))];
            if layout.name == "three-double" && substrate == Substrate::Silicone {
                points.push(PublishedPoint { load_n: published::THREE_DOUBLE_ONSET_N, friction_n: None });
            }
            points
        }
        (None, Substrate::Silicone) if contact.pins().count() == 0 => {
            vec![maximum(published::SILICONE_ALONE_MAX_N)]
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PinPattern, predict};
    use proptest::prelude::*;

    fn contact(substrate: Substrate, pins: PinPattern) -> Contact {
        Contact::new(substrate, pins, published::wrap_angle_rad()).unwrap()
    }

    #[test]
    fn every_published_condition_is_published_and_its_band_covers_the_measured_maximum() {
        let mut conditions = vec![contact(Substrate::Silicone, PinPattern::default())];
        for l in &published::LAYOUTS {
            for substrate in [Substrate::Silicone, Substrate::Abs] {
                conditions.push(contact(substrate, PinPattern::even(l.pins, l.pitch_rad())));
            }
        }
        for c in &conditions {
            let curve = predict(c, &[published::heaviest_load_n()]);
            assert_eq!((curve.law, curve.trust), (Law::Paper, Trust::Published));
            assert!(curve.reasons.is_empty());
            let measured = published_points(c)[0].friction_n.unwrap();
            let covered = curve.band_low_n[0] * 0.999_999..=curve.band_high_n[0] * 1.000_001;
            assert!(covered.contains(&measured), "{measured} outside {covered:?}");
        }
    }

    #[test]
    fn other_layouts_say_how_far_they_are_known() {
        let between = contact(Substrate::Silicone, PinPattern::even(4, 0.25));
        assert_eq!(predict(&between, &[20.0]).trust, Trust::Interpolated);
        let reasons = |pins| predict(&contact(Substrate::Silicone, pins), &[20.0]);
        for (pins, word) in [
            (PinPattern::even(9, 0.1), "9 pin"),
            (PinPattern::even(4, 0.1), "pitch"),
            (PinPattern::new(vec![-0.3, 0.0, 0.2]), "unevenly"),
            (PinPattern::new(vec![-0.4, -0.1, 0.2]), "off the middle"),
            (PinPattern::even(5, 0.29), "outside the wrap"),
        ] {
            let curve = reasons(pins);
            assert_eq!(curve.trust, Trust::Extrapolated);
            assert!(curve.reasons.iter().any(|r| r.contains(word)), "{word}: {:?}", curve.reasons);
        }
    }

    #[test]
    fn a_departure_makes_a_published_layout_an_extrapolation() {
        let l = &published::LAYOUTS[1];
        let plain = contact(Substrate::Silicone, PinPattern::even(l.pins, l.pitch_rad()));
        let soft = plain.clone().with_departures(vec!["another silicone".to_owned()]);
        let (a, b) = (predict(&plain, &[40.0]), predict(&soft, &[40.0]));
        assert_eq!(b.trust, Trust::Extrapolated);
        assert!(b.band_high_n[0] > a.band_high_n[0]);
        assert!(published_points(&soft).is_empty());
    }

    proptest! {
        #[test]
        fn bands_hold_the_curve_and_forces_stay_ordered(
            count in 0usize..15, pitch in 0.02..0.5f64, load in 0.0..80.0f64, wrap in 0.1..3.0f64
        ) {
            let c = Contact::new(Substrate::Silicone, PinPattern::even(count, pitch), wrap).unwrap();
            let curve = predict(&c, &[load]);
            prop_assert!(curve.band_low_n[0] <= curve.friction_n[0]);
            prop_assert!(curve.friction_n[0] <= curve.band_high_n[0]);
            prop_assert!(curve.eccentric_n[0] <= load && load <= curve.concentric_n[0]);
            prop_assert!((0.0..=1.0).contains(&curve.silicone_share[0]));
        }
    }
}
