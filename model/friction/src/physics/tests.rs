//! The physics against the regression values of `model/doc/friction-laws.md`, its own invariants, and the published
//! maxima.

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::equilibrium::Supports;
use super::fit::{PUBLISHED_FIT, fit, published_maxima};
use super::grid::Grid;
use super::hypotheses::hypotheses;
use super::*;
use crate::published::{self, LAYOUTS};
use crate::{Contact, Direction, Law, PinPattern, Substrate};

const HEAVIEST_N: f64 = 49.671;

fn layout(i: usize) -> PinPattern {
    PinPattern::even(LAYOUTS[i].pins, LAYOUTS[i].pitch_rad())
}

fn device(pins: PinPattern) -> Contact {
    Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap()
}

/// The bed of the regression values of `model/doc/friction-laws.md`: tendon radius 0.6, linear pins of 200 N/mm,
/// silicone over the whole wrap.
fn regression_bed() -> Bed {
    Bed { tendon_radius_mm: 0.6, softening: 0.0, outside: OutsidePins::OnSilicone, ..Bed::published() }
}

/// A tendon slid from nowhere near its state.
fn slid(
    supports: Supports<'_>,
    constants: &Constants,
    wrap_rad: f64,
    load_n: f64,
    direction: Direction,
) -> march::Sliding {
    march::slide(march::Slide { supports, constants, wrap_rad, load_n, direction }, None).unwrap()
}

/// `model/doc/friction-laws.md`: half-layout pin forces six [7.05 10.05 10.20] N, silicone 0; three-double [16.54
/// 15.49], 0.118; three-single [13.93 10.53], 0.302.
#[test]
fn reproduces_the_regression_values() {
    let expected: [(&[f64], f64); 3] =
        [(&[7.05, 10.05, 10.20], 0.0), (&[16.54, 15.49], 0.118), (&[13.93, 10.53], 0.302)];
    let bed = regression_bed();
    for (i, (forces, share)) in expected.iter().enumerate() {
        // A few hundred nodes, as in `model/doc/friction-laws.md`.
        let grid = Grid::new(published::wrap_angle_rad(), layout(i).angles_rad(), &bed, 400);
        let supports = Supports { grid: &grid, bed: &bed, flush_force_n: 200.0 * bed.protrusion_mm() };
        let found = supports.equilibrium(&vec![HEAVIEST_N; grid.len()], None).unwrap();
        for (n, expected) in found.pin_n.iter().zip(*forces) {
            assert!((n - expected).abs() < 0.06, "{}: {:?}", LAYOUTS[i].name, found.pin_n);
        }
        let silicone: f64 = found.silicone_n.iter().sum();
        let found_share = silicone / (silicone + found.pin_n.iter().sum::<f64>());
        assert!((found_share - share).abs() < 0.003, "{}: {found_share}", LAYOUTS[i].name);
        assert!(found.steps <= 15, "{} Newton steps", found.steps);
    }
}

/// With one uniform material the capstan comes out: `T = F exp(mu a)`, whatever the march does in between.
#[test]
fn one_uniform_material_gives_the_capstan() {
    let bed = regression_bed();
    let wrap = published::wrap_angle_rad();
    let grid = Grid::new(wrap, &[], &bed, 200);
    let supports = Supports { grid: &grid, bed: &bed, flush_force_n: 8.5 };
    for direction in [Direction::Eccentric, Direction::Concentric] {
        let constants = Constants::published();
        let sliding = slid(supports, &constants, wrap, 30.0, direction);
        assert!((sliding.silicone_exponent - constants.mu_silicone * wrap).abs() < 1e-9);
        let bare = PhysicsSwitch::new(&device(PinPattern::default()), constants).states(&[30.0]).unwrap();
        assert!((bare[0].concentric_n - 30.0 * (constants.mu_silicone * wrap).exp()).abs() < 1e-9);
    }
}

#[test]
fn refinement_converges() {
    for i in 0..LAYOUTS.len() {
        let friction = |elements| {
            let contact = device(layout(i));
            PhysicsSwitch::with_elements(&contact, *contact.bed(), Constants::published(), elements)
                .friction_n(HEAVIEST_N)
                .unwrap()
        };
        let (coarse, usual, fine, finest) = (friction(30), friction(60), friction(240), friction(960));
        assert!((usual / finest - 1.0).abs() < 1e-3, "{coarse} {usual} {fine} {finest}");
        assert!((fine - finest).abs() < (coarse - finest).abs(), "{coarse} {usual} {fine} {finest}");
    }
}

/// The constants in the code are what the fit returns, and so are the errors in the code.
#[test]
fn the_published_constants_are_the_fit() {
    let found = fit_maxima(&Bed::published()).unwrap();
    let known = &PUBLISHED_FIT;
    let constants =
        [found.constants.kappa_per_sqrt_n, found.constants.mu_silicone, found.constants.flush_force_n];
    for (a, b) in constants.iter().zip(known.constants) {
        assert!((a / b - 1.0).abs() < 1e-3, "{found:?}");
    }
    for (a, b) in found.covariance.concat().iter().zip(known.covariance.concat()) {
        assert!((a - b).abs() < 2e-5, "{found:?}");
    }
    assert!((found.scatter - known.scatter).abs() < 2e-4);
    // Three constants, seven maxima: at most 4 %.
    assert!(found.rms <= 0.04, "{}", found.rms);
    let left_out = leave_one_layout_out(&Bed::published()).unwrap();
    let errors: Vec<f64> = left_out.iter().flat_map(|l| [l.pins_error, l.device_error]).collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    assert!((rms - known.left_out_rms).abs() < 2e-4, "{rms} {left_out:?}");
}

/// Of the hypotheses about the tendon's path, the default alone contradicts no printed fact.
#[test]
fn the_default_hypothesis_survives_alone() {
    let findings: Vec<_> = hypotheses().iter().map(|h| h.test().unwrap()).collect();
    let surviving: Vec<_> = findings.iter().filter(|f| f.survives()).map(|f| f.hypothesis.bed).collect();
    assert_eq!(surviving, [Bed::published()]);
}

/// Bands hold the truth as often as they say: rigs with other constants and scattered maxima, fitted as the paper's.
#[test]
fn bands_cover_simulated_rigs() {
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let clean = published_maxima(|_| published::wrap_angle_rad());
    let bed = Bed::published();
    let other = device(PinPattern::even(4, 0.25)).with_bed(bed);
    let (mut held, mut cases) = (0, 0);
    for _ in 0..40 {
        let mut jitter = |sd: f64| (sd * random.sample::<f64, _>(StandardNormal)).exp();
        let truth = Constants {
            kappa_per_sqrt_n: 0.0237 * jitter(0.2),
            mu_silicone: 0.234 * jitter(0.1),
            flush_force_n: 8.5 * jitter(0.2),
        };
        let maxima: Vec<_> = clean
            .iter()
            .map(|m| {
                let friction = PhysicsSwitch::new(&m.contact, truth).friction_n(HEAVIEST_N).unwrap();
                let mut m = m.clone();
                m.friction_n = friction * jitter(0.05);
                m
            })
            .collect();
        let found = fit(&bed, &maxima.iter().collect::<Vec<_>>()).unwrap();
        let covariance = Matrix3::from_fn(|i, j| found.covariance[i][j]);
        for load in [20.0, HEAVIEST_N] {
            // The device as this rig would measure it: with the scatter of a condition of its own.
            let measured = PhysicsSwitch::new(&other, truth).friction_n(load).unwrap() * jitter(0.05);
            let at = found.constants.logarithms();
            let log_friction = |at: Vector3<f64>| {
                PhysicsSwitch::new(&other, Constants::from_logarithms(&at)).friction_n(load).unwrap().ln()
            };
            let base = log_friction(at);
            let slope = Vector3::from_fn(|k, _| {
                let mut moved = at;
                moved[k] += 1e-3;
                (log_friction(moved) - base) / 1e-3
            });
            let variance = (slope.transpose() * covariance * slope)[(0, 0)] + found.scatter.powi(2);
            held += usize::from((measured.ln() - base).abs() <= 2.776 * variance.sqrt());
            cases += 1;
        }
    }
    // Binomial: below 70 of 80 at a true 95 % happens once in a thousand.
    assert!(held * 80 >= 70 * cases, "{held} of {cases}");
}

/// The short cut of the curve's sensitivities, against the long way.
#[test]
fn bands_follow_the_sensitivities() {
    let contact = device(layout(1));
    let curve = physics_curve(&contact, &[10.0, 30.0, HEAVIEST_N]).unwrap();
    assert_eq!(curve.law, Law::Physics);
    let covariance = Matrix3::from_row_slice(&PUBLISHED_FIT.covariance.concat());
    for (i, load) in curve.load_n.iter().enumerate() {
        let at = Constants::published().logarithms();
        let log_friction = |at: &Vector3<f64>| {
            PhysicsSwitch::new(&contact, Constants::from_logarithms(at)).friction_n(*load).unwrap().ln()
        };
        let slope = Vector3::from_fn(|k, _| {
            let mut moved = at;
            moved[k] += 1e-3;
            (log_friction(&moved) - log_friction(&at)) / 1e-3
        });
        let exact =
            2.776 * ((slope.transpose() * covariance * slope)[(0, 0)] + PUBLISHED_FIT.scatter.powi(2)).sqrt();
        let drawn = (curve.band_high_n[i] / curve.friction_n[i]).ln();
        assert!((drawn / exact - 1.0).abs() < 0.1, "at {load} N: {drawn} for {exact}");
    }
}

#[test]
fn a_single_pin_gets_a_band_that_covers_both_readings_of_its_free_spans() {
    let curve = physics_curve(&device(PinPattern::new(vec![0.0])), &[HEAVIEST_N]).unwrap();
    assert!(curve.reasons.iter().any(|r| r.contains("outside the outermost pin")), "{:?}", curve.reasons);
    assert!(curve.band_high_n[0] > curve.friction_n[0]);
}

fn patterns() -> impl Strategy<Value = PinPattern> {
    prop::collection::btree_set(-5i32..=5, 1..9)
        .prop_map(|steps| PinPattern::new(steps.iter().map(|s| f64::from(*s) * 0.10408).collect()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn turns_sum_and_forces_balance(
        pins in patterns(), load in 0.5..120.0f64, bending in prop_oneof![Just(0.0), 0.0..150.0f64], free: bool
    ) {
        let outside = if free { OutsidePins::Free } else { OutsidePins::OnSilicone };
        let contact = device(pins).with_bed(Bed { outside, bending_n_mm2: bending, ..Bed::published() });
        let wrap = contact.wrap_rad();
        let grid = Grid::new(wrap, contact.pins().angles_rad(), contact.bed(), 120);
        let supports = Supports { grid: &grid, bed: contact.bed(), flush_force_n: 8.5 };
        for direction in [Direction::Eccentric, Direction::Concentric] {
            let found = slid(supports, &Constants::published(), wrap, load, direction);
            let turned: f64 = found.silicone_turn_rad + found.pin_turn_rad.iter().sum::<f64>();
            prop_assert!((turned - wrap).abs() < 1e-9);
            // What carries the tendon balances what presses it, T/Rc over the wrap less the string's own term.
            let rc = contact.bed().axis_radius_mm();
            let carried: f64 = found.shape.silicone_n.iter().chain(&found.shape.pin_n).sum();
            let stiff = contact.bed().bending_n_mm2;
            if stiff == 0.0 {
                let pressed: f64 = (0..grid.len())
                    .map(|i| found.tension_n[i] * grid.share_mm[i] / rc * (1.0 - found.shape.gap_mm[i] / rc))
                    .sum();
                prop_assert!((carried / pressed - 1.0).abs() < 1e-4, "{carried} N carry {pressed} N");
            }
            prop_assert!(found.shape.pin_n.iter().all(|n| *n >= 0.0));
            let monotone = found.tension_n.windows(2).all(|t| direction.sign() * (t[1] - t[0]) >= -1e-12);
            prop_assert!(monotone);
        }
    }

    #[test]
    fn mirrored_layouts_mirror(pins in patterns(), load in 1.0..80.0f64) {
        let mirrored = PinPattern::new(pins.angles_rad().iter().map(|a| -a).collect());
        let at = |p: PinPattern| {
            let contact = device(p);
            let grid = Grid::new(contact.wrap_rad(), contact.pins().angles_rad(), contact.bed(), 120);
            let supports = Supports { grid: &grid, bed: contact.bed(), flush_force_n: 8.5 };
            supports.equilibrium(&vec![load; grid.len()], None).unwrap()
        };
        let (a, b) = (at(pins), at(mirrored));
        for (x, y) in a.pin_n.iter().zip(b.pin_n.iter().rev()) {
            prop_assert!((x - y).abs() < 1e-5 * load, "{:?} {:?}", a.pin_n, b.pin_n);
        }
    }

    #[test]
    fn any_pattern_gives_an_ordered_curve(pins in patterns()) {
        let loads: Vec<f64> = (1..=12).map(|i| 5.0 * f64::from(i)).collect();
        let curve = physics_curve(&device(pins), &loads).unwrap();
        for (i, load) in loads.iter().enumerate() {
            prop_assert!(curve.eccentric_n[i] <= *load && *load <= curve.concentric_n[i]);
            prop_assert!(curve.band_low_n[i] <= curve.friction_n[i] && curve.friction_n[i] <= curve.band_high_n[i]);
            prop_assert!(i == 0 || curve.friction_n[i] > curve.friction_n[i - 1]);
        }
    }
}
