//! Tests of predictions against the published measurements, and of the properties of every curve.

use proptest::prelude::*;

use crate::contact::Contact;
use crate::curve::{FrictionCurve, published_points};
use crate::law::{Law, LawError};
use crate::pattern::PinPattern;
use crate::prediction::{other_laws, predict, predict_by};
use crate::published;
use crate::status::PredictionStatus;
use crate::substrate::Substrate;

const HEAVIEST_N: f64 = 49.671;

fn contact(substrate: Substrate, pins: PinPattern) -> Contact {
    Contact::new(substrate, pins, published::wrap_angle_rad()).unwrap()
}

#[test]
fn bands_contain_the_published_maxima() {
    let mut conditions = vec![contact(Substrate::Silicone, PinPattern::default())];
    for l in &published::LAYOUTS {
        for substrate in [Substrate::Silicone, Substrate::Abs] {
            conditions.push(contact(substrate, PinPattern::even(l.pins, l.pitch_rad())));
        }
    }
    for c in &conditions {
        for law in Law::predictive() {
            let Ok(curve) = predict_by(law, c, &[published::heaviest_load_n()]) else { continue };
            assert_eq!((curve.law, curve.status), (law, PredictionStatus::Published));
            let measured = published_points(c)[0].friction_n.unwrap();
            let covered = curve.band_low_n[0] * 1.01..=curve.band_high_n[0] * 0.99;
            assert!(covered.contains(&measured), "{law:?}: {measured} outside {covered:?}");
        }
    }
}

/// The bands of any two laws overlap at every load, on measured and on other layouts.
#[test]
fn bands_of_the_laws_overlap() {
    let loads: Vec<f64> = (0..20).map(|i| 3.0766 + 2.4523 * f64::from(i)).collect();
    for pins in [
        PinPattern::even(6, published::LAYOUTS[0].pitch_rad()),
        PinPattern::even(3, published::LAYOUTS[1].pitch_rad()),
        PinPattern::even(4, 0.25),
        PinPattern::new(vec![-0.4, -0.3, 0.1]),
        PinPattern::new(vec![0.0]),
    ] {
        let c = contact(Substrate::Silicone, pins);
        let curves: Vec<_> = Law::predictive().filter_map(|law| predict_by(law, &c, &loads).ok()).collect();
        for a in &curves {
            for b in &curves {
                for (load, (low, high)) in loads.iter().zip(a.band_low_n.iter().zip(&b.band_high_n)) {
                    assert!(low <= high, "{:?} and {:?} at {load} N of {:?}", a.law, b.law, c.pins());
                }
            }
        }
        assert!(curves[0].reasons.iter().any(|r| r.contains("the laws disagree")), "{:?}", curves[0].reasons);
    }
}

#[test]
fn status_has_reasons() {
    let between = contact(Substrate::Silicone, PinPattern::even(4, 0.25));
    assert_eq!(predict(&between, &[20.0]).status, PredictionStatus::Interpolated);
    let reasons = |pins| predict(&contact(Substrate::Silicone, pins), &[20.0]);
    for (pins, word) in [
        (PinPattern::even(9, 0.1), "9 pin"),
        (PinPattern::even(4, 0.1), "pitch"),
        (PinPattern::new(vec![-0.3, 0.0, 0.2]), "unevenly"),
        (PinPattern::new(vec![-0.4, -0.1, 0.2]), "off the middle"),
        (PinPattern::even(5, 0.29), "outside the wrap"),
    ] {
        let curve = reasons(pins);
        assert_eq!(curve.status, PredictionStatus::Extrapolated);
        assert!(curve.reasons.iter().any(|r| r.contains(word)), "{word}: {:?}", curve.reasons);
    }
}

#[test]
fn unmodelled_deviations_are_extrapolated() {
    let l = &published::LAYOUTS[1];
    let plain = contact(Substrate::Silicone, PinPattern::even(l.pins, l.pitch_rad()));
    let mixed = plain.clone().with_unmodelled(vec!["another mix".to_owned()]);
    let (a, b) = (predict(&plain, &[49.0]), predict(&mixed, &[49.0]));
    assert_eq!((a.status, b.status), (PredictionStatus::Published, PredictionStatus::Extrapolated));
    assert!(b.band_high_n[0] > a.band_high_n[0] && b.reasons.contains(&"another mix".to_owned()));
    assert!(published_points(&mixed).is_empty());
}

/// Beyond the tested loads the band widens.
#[test]
fn heavier_loads_are_extrapolated() {
    let l = &published::LAYOUTS[1];
    let c = contact(Substrate::Silicone, PinPattern::even(l.pins, l.pitch_rad()));
    let (inside, beyond) = (predict(&c, &[49.6]), predict(&c, &[49.6, 120.0]));
    assert_eq!((inside.status, beyond.status), (PredictionStatus::Published, PredictionStatus::Extrapolated));
    assert!(beyond.reasons.iter().any(|r| r.contains("tested range")), "{:?}", beyond.reasons);
    let width = |curve: &FrictionCurve, i: usize| libm::log(curve.band_high_n[i] / curve.band_low_n[i]);
    assert!(width(&beyond, 1) > width(&inside, 0) + 0.2);
}

#[test]
fn inapplicable_laws_return_their_domain() {
    let uneven = contact(Substrate::Silicone, PinPattern::new(vec![-0.3, 0.0, 0.2]));
    let proxy = contact(Substrate::Abs, PinPattern::even(3, 0.2));
    for (law, contact, word) in [
        (Law::Paper, &uneven, "six-single"),
        (Law::Layout, &proxy, "pins on silicone only"),
        (Law::Calibrated, &proxy, "--model"),
    ] {
        let error = predict_by(law, contact, &[10.0]).unwrap_err();
        assert!(matches!(error, LawError::DoesNotApply { .. }), "{error:?}");
        assert!(error.to_string().contains(word), "{error}");
    }
}

#[test]
fn other_laws_exclude_the_main_law() {
    let double = contact(Substrate::Silicone, PinPattern::even(3, published::LAYOUTS[1].pitch_rad()));
    let laws: Vec<_> = other_laws(Law::Paper, &double, &[20.0]).iter().map(|c| c.law).collect();
    let others: Vec<_> = Law::predictive().filter(|law| *law != Law::Paper).collect();
    assert_eq!(laws, others, "all laws apply to a published layout");
    assert!(laws.starts_with(&[Law::Layout, Law::Physics]));
}

#[test]
fn default_law_predicts_every_contact() {
    for (substrate, pins) in [
        (Substrate::Silicone, PinPattern::default()),
        (Substrate::Silicone, PinPattern::new(vec![0.1])),
        (Substrate::Abs, PinPattern::new(vec![-0.4, 0.3])),
    ] {
        let contact = contact(substrate, pins);
        assert_eq!(predict(&contact, &[10.0]).law, Law::DEFAULT);
    }
}

/// `model/doc/friction-laws.md`: the paper's model has a root mean square relative error of 31 % on
/// its seven maxima.
#[test]
fn paper_model_error_is_31_percent() {
    let max = |substrate, pins| {
        let contact = Contact::new(substrate, pins, published::wrap_angle_rad()).unwrap();
        predict_by(Law::Paper, &contact, &[published::heaviest_load_n()]).unwrap().friction_n[0]
    };
    let mut errors =
        vec![max(Substrate::Silicone, PinPattern::default()) / published::SILICONE_ALONE_MAX_N - 1.0];
    for l in &published::LAYOUTS {
        for substrate in [Substrate::Silicone, Substrate::Abs] {
            errors.push(max(substrate, PinPattern::even(l.pins, l.pitch_rad())) / l.max_n(substrate) - 1.0);
        }
    }
    assert_eq!(errors.len(), 7);
    let rms = nalgebra::DVector::from_vec(errors).norm() / 7f64.sqrt();
    assert_eq!(format!("{:.0}", rms * 100.0), "31");
}

#[test]
fn one_pin_has_an_upper_band() {
    let curve =
        predict_by(Law::Physics, &contact(Substrate::Silicone, PinPattern::new(vec![0.0])), &[HEAVIEST_N])
            .unwrap();
    assert!(curve.reasons.iter().any(|r| r.contains("1 pin;")), "{:?}", curve.reasons);
    assert!(curve.band_high_n[0] > curve.friction_n[0]);
}

fn patterns() -> impl Strategy<Value = PinPattern> {
    prop::collection::btree_set(-5i32..=5, 1..9)
        .prop_map(|steps| PinPattern::new(steps.iter().map(|s| f64::from(*s) * 0.10408).collect()))
}

proptest! {
    #[test]
    fn bands_contain_the_curve(
        count in 0usize..15, pitch in 0.02..0.5f64, load in 0.0..80.0f64, wrap in 0.1..3.0f64
    ) {
        let c = Contact::new(Substrate::Silicone, PinPattern::even(count, pitch), wrap).unwrap();
        let curve = predict(&c, &[load]);
        prop_assert!(curve.band_low_n[0] <= curve.friction_n[0]);
        prop_assert!(curve.friction_n[0] <= curve.band_high_n[0]);
        prop_assert!(curve.eccentric_n[0] <= load && load <= curve.concentric_n[0]);
        prop_assert!((0.0..=1.0).contains(&curve.silicone_share[0]));
    }

    #[test]
    fn friction_rises_with_load(pins in patterns()) {
        let loads: Vec<f64> = (1..=12).map(|i| 5.0 * f64::from(i)).collect();
        let curve = predict_by(Law::Physics, &contact(Substrate::Silicone, pins), &loads).unwrap();
        for (i, load) in loads.iter().enumerate() {
            prop_assert!(curve.eccentric_n[i] <= *load && *load <= curve.concentric_n[i]);
            prop_assert!(curve.band_low_n[i] <= curve.friction_n[i] && curve.friction_n[i] <= curve.band_high_n[i]);
            prop_assert!(i == 0 || curve.friction_n[i] > curve.friction_n[i - 1]);
        }
    }
}

/// The band of a layer whose modulus scatters is as wide as the change of friction for another modulus, to first order: where
/// the tendon begins to touch silicone, at 15 N, a change of 6 % is not small.
#[test]
fn scatter_of_the_modulus_widens_the_band() {
    use crate::band::Band;
    use crate::physics::{Bed, Constants, PhysicsSwitch};
    let loads = [5.0, 20.0, 30.0, HEAVIEST_N];
    let (scatter, step) = (0.06, 0.005);
    for layout in &published::LAYOUTS {
        let known = contact(Substrate::Silicone, PinPattern::even(layout.pins, layout.pitch_rad()));
        let scattered = known.clone().with_modulus_scatter(scatter);
        let band = Band::new(Law::Physics, &scattered, &loads).unwrap();
        let source = band.sources.iter().find(|s| s.name.starts_with("scatter of the hardness")).unwrap();
        for (i, load) in loads.iter().enumerate() {
            let log_friction = |factor: f64| {
                let bed = Bed { modulus_mpa: factor * known.bed().modulus_mpa, ..*known.bed() };
                let switch = PhysicsSwitch::new(&known.clone().with_bed(bed), Constants::published());
                libm::log(switch.friction_n(*load).unwrap())
            };
            let by_difference =
                1.96 * scatter * (log_friction(1.0 + step) - log_friction(1.0 - step)).abs() / (2.0 * step);
            let here = source.up[i];
            assert!(
                (here - by_difference).abs() <= 0.1 * by_difference + 1e-3,
                "{} at {load} N: {here} for {by_difference}",
                layout.name
            );
        }
        let without = Band::new(Law::Physics, &known, &loads).unwrap();
        assert!(without.sources.iter().all(|s| !s.name.starts_with("scatter")));
        assert!(band.half_width(2).0 > without.half_width(2).0);
    }
}
