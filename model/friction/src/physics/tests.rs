//! Tests of the physics: regression values of `model/doc/friction-laws.md`, invariants, and the
//! published maxima.

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::constants::{Constants, PUBLISHED_FIT};
use super::equilibrium::Supports;
use super::fit::{fit, fit_maxima, leave_one_condition_out, leave_one_layout_out, published_maxima};
use super::grid::Grid;
use super::hypotheses::{self, hypotheses};
use super::made::Dimension;
use super::march::{self, Slide};
use super::switch::PhysicsSwitch;
use crate::bed::{Bed, OutsidePins};
use crate::capstan::Direction;
use crate::contact::Contact;
use crate::pattern::PinPattern;
use crate::published::{self, LAYOUTS};
use crate::substrate::Substrate;

const HEAVIEST_N: f64 = 49.671;

fn layout(i: usize) -> PinPattern {
    PinPattern::even(LAYOUTS[i].pins, LAYOUTS[i].pitch_rad())
}

fn device(pins: PinPattern) -> Contact {
    Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad()).unwrap()
}

/// Bed of the regression values of `model/doc/friction-laws.md`: a string of radius 0.6 mm, linear
/// pins of 200 N/mm, and silicone over the whole wrap.
fn regression_bed() -> Bed {
    Bed { tendon_radius_mm: 0.6, softening: 0.0, bending_n_mm2: 0.0, ..Bed::published() }
}

/// Computes the state of a tendon without a similar one.
fn sliding_state(
    supports: Supports<'_>,
    constants: &Constants,
    wrap_rad: f64,
    load_n: f64,
    direction: Direction,
) -> march::Sliding {
    march::slide(Slide { supports, constants, wrap_rad, load_n, direction }, None).unwrap()
}

/// `model/doc/friction-laws.md`: pin forces of half a layout and share of the silicone are [7.05
/// 10.05 10.20] N and 0 for six-single, [16.54 15.49] N and 0.118 for three-double, [13.93 10.53] N
/// and 0.302 for three-single.
#[test]
fn regression_values_are_reproduced() {
    let expected: [(&[f64], f64); 3] =
        [(&[7.05, 10.05, 10.20], 0.0), (&[16.54, 15.49], 0.118), (&[13.93, 10.53], 0.302)];
    let bed = regression_bed();
    for (i, (forces, share)) in expected.iter().enumerate() {
        // A few hundred nodes, as in `model/doc/friction-laws.md`.
        let grid = Grid::new(published::wrap_angle_rad(), layout(i).angles_rad(), &bed, 400);
        let supports =
            Supports { grid: &grid, bed: &bed, flush_force_n: 200.0 * bed.protrusion_mm(), heights_mm: &[] };
        let solved = supports.equilibrium(&vec![HEAVIEST_N; grid.len()], None).unwrap();
        for (n, expected) in solved.pin_n.iter().zip(*forces) {
            assert!((n - expected).abs() < 0.06, "{}: {:?}", LAYOUTS[i].name, solved.pin_n);
        }
        let silicone: f64 = solved.silicone_n.iter().sum();
        let solved_share = silicone / (silicone + solved.pin_n.iter().sum::<f64>());
        assert!((solved_share - share).abs() < 0.003, "{}: {solved_share}", LAYOUTS[i].name);
        assert!(solved.steps <= 15, "{} Newton steps", solved.steps);
    }
}

/// With one uniform material the result is the capstan: `T = F exp(mu a)`.
#[test]
fn uniform_material_gives_the_capstan() {
    let bed = regression_bed();
    let wrap = published::wrap_angle_rad();
    let grid = Grid::new(wrap, &[], &bed, 200);
    let supports = Supports { grid: &grid, bed: &bed, flush_force_n: 8.5, heights_mm: &[] };
    for direction in [Direction::Eccentric, Direction::Concentric] {
        let constants = Constants::published();
        let sliding = sliding_state(supports, &constants, wrap, 30.0, direction);
        assert!((sliding.silicone_exponent - constants.mu_silicone * wrap).abs() < 1e-9);
        let bare = PhysicsSwitch::new(&device(PinPattern::default()), constants).states(&[30.0]).unwrap();
        assert!((bare[0].concentric_n - 30.0 * libm::exp(constants.mu_silicone * wrap)).abs() < 1e-9);
    }
}

/// Derivatives by the implicit function theorem agree with differences of curves that are converged
/// to the last digits: with the central one, or a one-sided one where a node is about to touch.
#[test]
fn sensitivities_match_differences() {
    const STEP: f64 = 2e-4;
    let groove = published::GROOVE_PITCH_DEG.to_radians();
    let uneven = PinPattern::new([3, 6, 7, 11].map(|g| f64::from(g - 8) * groove).to_vec());
    let soft = Bed { layer_mm: 3.0, contact_radius_mm: 25.0, ..Bed::published() };
    let free = Bed { outside: OutsidePins::Free, bending_n_mm2: 0.0, ..Bed::published() };
    let rigid = Contact::new(Substrate::Abs, layout(1), published::wrap_angle_rad()).unwrap();
    let contacts = [
        device(layout(0)),
        device(layout(1)),
        device(uneven.clone()),
        device(uneven).with_bed(soft),
        device(layout(2)).with_bed(free),
        device(PinPattern::default()),
        rigid,
    ];
    for (i, contact) in contacts.iter().enumerate() {
        for load in [4.0, 9.0, 21.0, 33.0, HEAVIEST_N] {
            let constants = Constants::published();
            let switch = PhysicsSwitch::new(contact, constants);
            let (_, slopes) = switch.states_and_sensitivities(&[load], |_| true).unwrap();
            for k in 0..4 {
                let log_friction = |by: f64| {
                    let mut at = constants.logarithms();
                    let mut bed = *contact.bed();
                    match k {
                        3 => bed.foundation_n_mm2 *= libm::exp(by),
                        _ => at[k] += by,
                    }
                    let elements = super::grid::elements(contact.wrap_rad(), contact.bed());
                    let constants = Constants::from_logarithms(&at);
                    let moved = PhysicsSwitch::with_elements(contact, bed, constants, elements);
                    libm::log(moved.precise_friction_n(load, 1e-10).unwrap())
                };
                let here = log_friction(0.0);
                let [back_2, back, ahead, ahead_2] =
                    [-2.0, -1.0, 1.0, 2.0].map(|steps| log_friction(steps * STEP) - here);
                let expected = [
                    (8.0 * (ahead - back) - (ahead_2 - back_2)) / (12.0 * STEP),
                    (4.0 * ahead - ahead_2) / (2.0 * STEP),
                    (back_2 - 4.0 * back) / (2.0 * STEP),
                ];
                let error = expected.map(|e| (slopes[0][k] - e).abs()).into_iter().fold(1.0, f64::min);
                let is_close = error < 1e-6 * slopes[0].norm();
                assert!(is_close, "contact {i}, {load} N, constant {k}: {} {expected:?}", slopes[0][k]);
            }
        }
    }
}

/// Finer elements change friction by less than 0.2 %, with layouts of all kinds and at all loads.
#[test]
fn refinement_converges() {
    let groove = published::GROOVE_PITCH_DEG.to_radians();
    let of = |grooves: &[i32]| PinPattern::new(grooves.iter().map(|g| f64::from(g - 8) * groove).collect());
    for pins in
        [layout(0), layout(1), layout(2), of(&[8]), of(&[3, 4, 5]), of(&[2, 3, 9]), of(&[4, 8, 12, 13])]
    {
        for load in [1.0, 3.0766, 5.0, 12.0, 25.0, HEAVIEST_N] {
            let contact = device(pins.clone());
            let usual = PhysicsSwitch::new(&contact, Constants::published()).friction_n(load).unwrap();
            let fine = PhysicsSwitch::with_elements(&contact, *contact.bed(), Constants::published(), 720);
            let fine = fine.friction_n(load).unwrap();
            assert!((usual / fine - 1.0).abs() < 2e-3, "{pins:?} at {load} N: {usual} {fine}");
        }
    }
}

/// Constants, covariance and errors in the code are those of the fit.
#[test]
fn published_constants_match_the_fit() {
    let fitted = fit_maxima(&Bed::published()).unwrap();
    let known = &PUBLISHED_FIT;
    let constants =
        [fitted.constants.kappa_per_sqrt_n, fitted.constants.mu_silicone, fitted.constants.flush_force_n];
    for (a, b) in constants.iter().zip(known.constants) {
        assert!((a / b - 1.0).abs() < 1e-3, "{fitted:?}");
    }
    for (a, b) in fitted.covariance.concat().iter().zip(known.covariance.concat()) {
        assert!((a - b).abs() < 2e-5, "{fitted:?}");
    }
    assert!((fitted.scatter - known.scatter).abs() < 2e-4);
    // Three constants, seven maxima: at most 4 %.
    assert!(fitted.rms <= 0.04, "{}", fitted.rms);
    let left_out = leave_one_layout_out(&Bed::published()).unwrap();
    let errors: Vec<f64> = left_out.iter().flat_map(|l| [l.pins_error, l.device_error]).collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    assert!((rms - known.left_out_rms).abs() < 2e-4, "{rms} {left_out:?}");
}

/// Two hypotheses about the tendon's path are about equally likely, the default and free spans
/// outside the pins. The others are much less likely.
#[test]
fn two_hypotheses_are_likely() {
    let findings: Vec<_> = hypotheses().iter().map(|h| h.test().unwrap()).collect();
    let weights = hypotheses::weights(&findings);
    let named: Vec<_> = findings.iter().map(|f| f.hypothesis).zip(&weights).collect();
    assert_eq!(findings[0].hypothesis.bed, Bed::published());
    assert!(*named[0].1 > 0.2, "{named:#?}");
    let free = named.iter().find(|(h, _)| h.bed.outside == OutsidePins::Free && h.bed.bending_n_mm2 == 0.0);
    assert!(*free.unwrap().1 > 0.2, "{named:#?}");
    assert!(named[0].1 + free.unwrap().1 > 0.95, "{named:#?}");
    // A fact that set a constant does not test it.
    assert!(findings[0].compared.iter().all(|c| !c.fact.contains("onset of")));
}

/// With the published bending stiffness, three-double begins to switch at the printed load.
#[test]
fn bending_stiffness_matches_the_onset() {
    let loads: Vec<f64> = (0..100).map(|i| 13.0 + 0.05 * f64::from(i)).collect();
    let states = PhysicsSwitch::new(&device(layout(1)), Constants::published()).states(&loads).unwrap();
    let onset = states.iter().find(|s| s.silicone_share >= 0.02).unwrap().load_n;
    assert!((onset - published::THREE_DOUBLE_ONSET_N).abs() < 0.5, "{onset} N");
}

/// The coverage of bands is at least nominal on simulated rigs with other constants and scattered
/// maxima, which are fitted like the published maxima.
#[test]
fn bands_cover_simulated_rigs() {
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let clean = published_maxima(|_| published::wrap_angle_rad());
    let bed = Bed::published();
    let other = device(PinPattern::even(4, 0.25)).with_bed(bed);
    let (mut covered, mut cases) = (0, 0);
    for _ in 0..40 {
        let mut jitter = |sd: f64| libm::exp(sd * random.sample::<f64, _>(StandardNormal));
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
        let fitted = fit(&bed, &maxima.iter().collect::<Vec<_>>()).unwrap();
        let covariance = Matrix3::from_fn(|i, j| fitted.covariance[i][j]);
        for load in [20.0, HEAVIEST_N] {
            // The measurement of a device on this rig has the scatter of a condition.
            let measured = PhysicsSwitch::new(&other, truth).friction_n(load).unwrap() * jitter(0.05);
            let at = fitted.constants.logarithms();
            let log_friction = |at: Vector3<f64>| {
                libm::log(
                    PhysicsSwitch::new(&other, Constants::from_logarithms(&at)).friction_n(load).unwrap(),
                )
            };
            let base = log_friction(at);
            let slope = Vector3::from_fn(|k, _| {
                let mut moved = at;
                moved[k] += 1e-3;
                (log_friction(moved) - base) / 1e-3
            });
            let variance = (slope.transpose() * covariance * slope)[(0, 0)] + fitted.scatter.powi(2);
            covered += usize::from((libm::log(measured) - base).abs() <= 2.776 * variance.sqrt());
            cases += 1;
        }
    }
    // Binomial: with a coverage of 95 %, the probability of fewer than 70 of 80 is 0.001.
    assert!(covered * 80 >= 70 * cases, "{covered} of {cases}");
}

/// Each of the seven maxima is well within its band from the fit without its condition.
#[test]
fn left_out_maxima_are_covered() {
    let half = 2.776 * PUBLISHED_FIT.left_out_rms;
    for (name, error) in leave_one_condition_out(&Bed::published()).unwrap() {
        assert!(libm::log1p(error).abs() < 0.75 * half, "{name}: {error} of {half}");
    }
}

/// With equal moduli, all lengths times L and all loads times L^2 give the same D/F.
#[test]
fn similar_switches_have_similar_friction() {
    for (pins, scale) in
        [(layout(1), 2.0), (PinPattern::new(vec![-0.3, 0.1, 0.2, 0.5]), 0.37), (layout(0), 5.3)]
    {
        let contact = device(pins);
        let b = *contact.bed();
        let scaled = contact.clone().with_bed(Bed {
            contact_radius_mm: scale * b.contact_radius_mm,
            tendon_radius_mm: scale * b.tendon_radius_mm,
            pin_diameter_mm: scale * b.pin_diameter_mm,
            groove_radius_mm: scale * b.groove_radius_mm,
            layer_mm: scale * b.layer_mm,
            layer_width_mm: scale * b.layer_width_mm,
            ..b
        });
        for load in [2.0, 12.0, HEAVIEST_N] {
            let share = |contact: &Contact, load: f64| {
                PhysicsSwitch::new(contact, Constants::published()).friction_n(load).unwrap() / load
            };
            let (small, large) = (share(&contact, load), share(&scaled, scale * scale * load));
            assert!((large / small - 1.0).abs() < 1e-6, "L = {scale}, {load} N: {small} {large}");
        }
    }
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
        let supports = Supports { grid: &grid, bed: contact.bed(), flush_force_n: 8.5, heights_mm: &[] };
        for direction in [Direction::Eccentric, Direction::Concentric] {
            let state = sliding_state(supports, &Constants::published(), wrap, load, direction);
            let turn: f64 = state.silicone_turn_rad + state.pin_turn_rad.iter().sum::<f64>();
            prop_assert!((turn - wrap).abs() < 1e-9);
            // The support forces balance the pressure T/Rc, minus the string's own term, minus the
            // pull of both ends.
            let rc = contact.bed().axis_radius_mm();
            let supported: f64 = state.shape.silicone_n.iter().chain(&state.shape.pin_n).sum();
            if contact.bed().bending_n_mm2 == 0.0 {
                let off = |i: usize| 1.0 - state.shape.gap_mm[i] / rc;
                let pressed: f64 =
                    (0..grid.len()).map(|i| state.tension_n[i] * grid.share_mm[i] / rc * off(i)).sum();
                let pulled: f64 = [0, grid.len() - 1]
                    .map(|end| state.tension_n[end] * libm::tan(grid.reach_rad) * off(end))
                    .iter()
                    .sum();
                let ratio = supported / (pressed - pulled);
                prop_assert!((ratio - 1.0).abs() < 1e-4, "{supported} N for {pressed} - {pulled} N");
            }
            prop_assert!(state.shape.pin_n.iter().all(|n| *n >= 0.0));
            let monotone = state.tension_n.windows(2).all(|t| direction.sign() * (t[1] - t[0]) >= -1e-12);
            prop_assert!(monotone);
        }
    }

    #[test]
    fn mirrored_layouts_mirror(pins in patterns(), load in 1.0..80.0f64) {
        let mirrored = PinPattern::new(pins.angles_rad().iter().map(|a| -a).collect());
        let at = |p: PinPattern| {
            let contact = device(p);
            let grid = Grid::new(contact.wrap_rad(), contact.pins().angles_rad(), contact.bed(), 120);
            let supports = Supports { grid: &grid, bed: contact.bed(), flush_force_n: 8.5, heights_mm: &[] };
            supports.equilibrium(&vec![load; grid.len()], None).unwrap()
        };
        let (a, b) = (at(pins), at(mirrored));
        for (x, y) in a.pin_n.iter().zip(b.pin_n.iter().rev()) {
            prop_assert!((x - y).abs() < 1e-5 * load, "{:?} {:?}", a.pin_n, b.pin_n);
        }
    }
}

/// Returns the contact with parameter number `which` multiplied by a factor.
fn moved(pins: &[f64], wrap: f64, bed: Bed, which: usize, factor: f64) -> Contact {
    let mut b = bed;
    let (mut wrap, mut spread) = (wrap, 1.0);
    match which {
        0 => b.contact_radius_mm *= factor,
        1 => b.tendon_radius_mm *= factor,
        2 => b.pin_diameter_mm *= factor,
        3 => b.groove_radius_mm *= factor,
        4 => b.layer_mm *= factor,
        5 => b.layer_width_mm *= factor,
        6 => b.modulus_mpa *= factor,
        7 => wrap *= factor,
        _ => spread = factor,
    }
    let pins = PinPattern::new(pins.iter().map(|p| p * spread).collect());
    Contact::new(Substrate::Silicone, pins, wrap).unwrap().with_bed(b)
}

/// A pin at the very end of the wrap leaves no short, stiff element: friction has no spike there.
#[test]
fn a_pin_at_the_end_makes_no_spike() {
    let published = Bed::published();
    let bed = Bed {
        contact_radius_mm: 28.897,
        tendon_radius_mm: 0.706,
        pin_diameter_mm: 0.971,
        groove_radius_mm: 0.35,
        layer_mm: 1.0,
        layer_width_mm: 6.0,
        modulus_mpa: 0.5 * published.modulus_mpa,
        ..published
    };
    let pins = [-0.147_183, 0.073_591, 0.515_140];
    let friction = |to_end_rad: f64| {
        let contact = moved(&pins, 2.0 * (pins[2] + to_end_rad), bed, 7, 1.0);
        PhysicsSwitch::new(&contact, Constants::published()).friction_n(3.0).unwrap()
    };
    let at_the_end = friction(0.0);
    for exponent in -9..=-3 {
        let offset = libm::pow(10.0, f64::from(exponent));
        for to_end_rad in [-offset, offset] {
            let change = friction(to_end_rad) / at_the_end - 1.0;
            assert!(change.abs() < 1e-3 + 5.0 * offset / pins[2], "{change} at {to_end_rad} rad");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]

    /// A step of 1 % in a parameter changes friction by less than 2 %, or by a steep slope, for
    /// instance where the tendon meets the silicone: then no twentieth of the step makes a quarter
    /// of the change. Some cases have pins that pass the end of the wrap.
    #[test]
    fn friction_is_continuous_in_every_parameter(
        pins in prop::collection::btree_set(-7i32..=7, 1..8),
        (pitch, wrap) in (0.06..0.14f64, 0.5..1.8f64),
        (radius, tendon, pin, groove) in (15.0..40.0f64, 0.5..1.2f64, 0.8..1.3f64, 0.35..0.6f64),
        (layer, width, modulus) in (1.0..4.0f64, 6.0..25.0f64, 0.5..2.0f64),
        load in 3.0..60.0f64,
        which in 0usize..9,
    ) {
        let angles: Vec<f64> = pins.iter().map(|step| f64::from(*step) * pitch).collect();
        let published = Bed::published();
        let bed = Bed {
            contact_radius_mm: radius,
            tendon_radius_mm: tendon,
            pin_diameter_mm: pin,
            groove_radius_mm: groove,
            layer_mm: layer,
            layer_width_mm: width,
            modulus_mpa: modulus * published.modulus_mpa,
            ..published
        };
        let friction = |factor: f64| {
            PhysicsSwitch::new(&moved(&angles, wrap, bed, which, factor), Constants::published()).friction_n(load)
        };
        let whole = libm::log(friction(1.01)? / friction(1.0)?).abs();
        if whole > 0.02 {
            let mut before = friction(1.0)?;
            for part in 1..=20 {
                let after = friction(libm::pow(1.01f64, f64::from(part) / 20.0))?;
                prop_assert!(libm::log(after / before).abs() < 0.25 * whole, "a jump at part {part} of {whole}");
                before = after;
            }
        }
    }
}

/// Uneven switch with a pin beyond the wrap, and every dimension on which its friction depends.
fn uneven_switch() -> (PhysicsSwitch, Vec<Dimension>) {
    let pins = PinPattern::new(vec![-0.35, -0.02, 0.21, 0.575]);
    let switch = PhysicsSwitch::new(&device(pins), Constants::published());
    let each = |of: fn(usize) -> Dimension| (0..4).map(of);
    let mut all = vec![
        Dimension::Wrap,
        Dimension::ContactRadius,
        Dimension::TendonRadius,
        Dimension::PinDiameter,
        Dimension::GrooveRadius,
        Dimension::Layer,
        Dimension::LayerWidth,
        Dimension::Modulus,
    ];
    all.extend(each(Dimension::PinAngle).chain(each(Dimension::PinHeight)));
    (switch, all)
}

/// Returns the threshold of a switch with one dimension changed.
fn moved_threshold_n(switch: &PhysicsSwitch, dimension: Dimension, by: f64) -> f64 {
    let mut dimensions = switch.dimensions();
    dimensions.add(dimension, by);
    switch.made(&dimensions).unwrap().threshold_n((3.0, 80.0)).unwrap().unwrap()
}

/// The implicit derivatives of the threshold agree with central differences of thresholds that are
/// computed from scratch.
#[test]
fn threshold_slopes_match_differences() {
    let (switch, all) = uneven_switch();
    let threshold_n = switch.threshold_n((3.0, 80.0)).unwrap().unwrap();
    let slopes = switch.threshold_slopes(threshold_n, &all).unwrap();
    for (dimension, slope) in all.iter().zip(slopes) {
        let step = match dimension {
            Dimension::PinAngle(_) | Dimension::PinHeight(_) => 1e-5,
            _ => 1e-5 * switch.dimensions().get(*dimension),
        };
        let difference = (moved_threshold_n(&switch, *dimension, step)
            - moved_threshold_n(&switch, *dimension, -step))
            / (2.0 * step);
        assert!(
            (slope - difference).abs() < 1e-4 * difference.abs() + 1e-3,
            "{dimension:?}: {slope} for {difference}"
        );
    }
}

/// Pins that are all higher by the same amount are pins in shallower grooves.
#[test]
fn equal_pin_heights_act_like_the_bed() {
    let (switch, _) = uneven_switch();
    let mut higher = switch.dimensions();
    higher.pin_heights_mm.fill(0.05);
    let mut shallower = switch.dimensions();
    shallower.bed.groove_radius_mm -= 0.05;
    let thresholds_n = [higher, shallower]
        .map(|dimensions| switch.made(&dimensions).unwrap().threshold_n((3.0, 80.0)).unwrap().unwrap());
    assert!((thresholds_n[0] / thresholds_n[1] - 1.0).abs() < 2e-3, "{thresholds_n:?}");
}

/// The threshold from a similar switch is that of the scan.
#[test]
fn thresholds_do_not_depend_on_the_start() {
    let (switch, _) = uneven_switch();
    let threshold_n = switch.threshold_n((3.0, 80.0)).unwrap().unwrap();
    for near_n in [10.0, 0.9 * threshold_n, 1.2 * threshold_n, 70.0] {
        let near = switch.threshold_near_n(near_n, (3.0, 80.0)).unwrap().unwrap();
        assert!((near / threshold_n - 1.0).abs() < 1e-6, "{near} for {threshold_n} from {near_n}");
    }
    assert_eq!(switch.threshold_near_n(threshold_n, (3.0, 0.9 * threshold_n)).unwrap(), None);
}
