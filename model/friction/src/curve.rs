//! A predicted friction curve, with its band and a word on how far to trust it.

use serde::{Deserialize, Serialize};

use crate::band::Band;
use crate::published;
use crate::trust::is_measured;
use crate::{Contact, Law, Substrate, SwitchState, Trust};

/// Tension and friction over load, as columns of equal length; forces in newtons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrictionCurve {
    /// The law behind the curve.
    pub law: Law,
    /// How far to trust it.
    pub trust: Trust,
    /// Why it is trusted no further, where laws disagree, and what the law is known to get wrong.
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

impl FrictionCurve {
    /// The curve of these states by a law, within `band`.
    pub(crate) fn of(
        law: Law,
        trust: Trust,
        reasons: Vec<String>,
        states: &[SwitchState],
        band: &Band,
    ) -> Self {
        let column = |f: fn(&SwitchState) -> f64| states.iter().map(f).collect::<Vec<_>>();
        let halves: Vec<(f64, f64)> = states.iter().map(|s| band.half_width_at(s.load_n)).collect();
        let edge = |log: fn(&(f64, f64)) -> f64| {
            states.iter().zip(&halves).map(|(s, half)| s.friction_n * libm::exp(log(half))).collect()
        };
        Self {
            law,
            trust,
            reasons,
            load_n: column(|s| s.load_n),
            eccentric_n: column(|s| s.eccentric_n),
            concentric_n: column(|s| s.concentric_n),
            friction_n: column(|s| s.friction_n),
            band_low_n: edge(|half| -half.0),
            band_high_n: edge(|half| half.1),
            silicone_share: column(|s| s.silicone_share),
        }
    }
}

/// What the paper prints for this contact: its maximum, and for three-double the onset of switching.
pub fn published_points(contact: &Contact) -> Vec<PublishedPoint> {
    if !is_measured(contact) {
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
    use crate::{PinPattern, predict, predict_by};
    use proptest::prelude::*;

    fn contact(substrate: Substrate, pins: PinPattern) -> Contact {
        Contact::new(substrate, pins, published::wrap_angle_rad()).unwrap()
    }

    #[test]
    fn every_published_condition_is_published_and_its_band_holds_the_measured_maximum() {
        let mut conditions = vec![contact(Substrate::Silicone, PinPattern::default())];
        for l in &published::LAYOUTS {
            for substrate in [Substrate::Silicone, Substrate::Abs] {
                conditions.push(contact(substrate, PinPattern::even(l.pins, l.pitch_rad())));
            }
        }
        for c in &conditions {
            for law in Law::predictive() {
                let Ok(curve) = predict_by(law, c, &[published::heaviest_load_n()]) else { continue };
                assert_eq!((curve.law, curve.trust), (law, Trust::Published));
                let measured = published_points(c)[0].friction_n.unwrap();
                let covered = curve.band_low_n[0] * 1.01..=curve.band_high_n[0] * 0.99;
                assert!(covered.contains(&measured), "{law:?}: {measured} outside {covered:?}");
            }
        }
    }

    /// No two laws have bands that do not meet, anywhere, on any layout.
    #[test]
    fn bands_of_the_laws_meet_everywhere() {
        let loads: Vec<f64> = (0..20).map(|i| 3.0766 + 2.4523 * f64::from(i)).collect();
        for pins in [
            PinPattern::even(6, published::LAYOUTS[0].pitch_rad()),
            PinPattern::even(3, published::LAYOUTS[1].pitch_rad()),
            PinPattern::even(4, 0.25),
            PinPattern::new(vec![-0.4, -0.3, 0.1]),
            PinPattern::new(vec![0.0]),
        ] {
            let c = contact(Substrate::Silicone, pins);
            let curves: Vec<_> =
                Law::predictive().filter_map(|law| predict_by(law, &c, &loads).ok()).collect();
            for a in &curves {
                for b in &curves {
                    for (load, (low, high)) in loads.iter().zip(a.band_low_n.iter().zip(&b.band_high_n)) {
                        assert!(low <= high, "{:?} and {:?} at {load} N of {:?}", a.law, b.law, c.pins());
                    }
                }
            }
            assert!(
                curves[0].reasons.iter().any(|r| r.contains("the laws disagree")),
                "{:?}",
                curves[0].reasons
            );
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
    fn what_no_law_knows_of_makes_a_published_layout_an_extrapolation() {
        let l = &published::LAYOUTS[1];
        let plain = contact(Substrate::Silicone, PinPattern::even(l.pins, l.pitch_rad()));
        let mixed = plain.clone().with_unmodelled(vec!["another mix".to_owned()]);
        let (a, b) = (predict(&plain, &[49.0]), predict(&mixed, &[49.0]));
        assert_eq!((a.trust, b.trust), (Trust::Published, Trust::Extrapolated));
        assert!(b.band_high_n[0] > a.band_high_n[0] && b.reasons.contains(&"another mix".to_owned()));
        assert!(published_points(&mixed).is_empty());
    }

    /// Loads are a parameter, too: outside the tested ones nothing is published, and the band widens.
    #[test]
    fn loads_beyond_those_tested_are_extrapolated() {
        let l = &published::LAYOUTS[1];
        let c = contact(Substrate::Silicone, PinPattern::even(l.pins, l.pitch_rad()));
        let (inside, beyond) = (predict(&c, &[49.6]), predict(&c, &[49.6, 120.0]));
        assert_eq!((inside.trust, beyond.trust), (Trust::Published, Trust::Extrapolated));
        assert!(beyond.reasons.iter().any(|r| r.contains("tested were")), "{:?}", beyond.reasons);
        let width = |curve: &FrictionCurve, i: usize| libm::log(curve.band_high_n[i] / curve.band_low_n[i]);
        assert!(width(&beyond, 1) > width(&inside, 0) + 0.2);
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
