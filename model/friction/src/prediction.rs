//! Predictions by the default law, by a chosen law, and by all others for comparison.

use pinswitch_diagnostic::Diagnostic;

use crate::band::Band;
use crate::band_physics::BandPhysics;
use crate::band_source::BandSource;
use crate::contact::Contact;
use crate::curve::FrictionCurve;
use crate::law::{Law, LawError, paper};
use crate::published;
use crate::status::{PredictionStatus, prediction_status};
use crate::switch::SwitchState;

/// Smallest ratio of the frictions of two laws that the reasons of a curve mention.
const NOTEWORTHY: f64 = 1.25;

/// Predicts tension and friction of `contact` at `loads_n` newtons by `law`.
///
/// ```
/// use pinswitch_friction::{Contact, Law, PinPattern, Substrate, predict_by};
///
/// let uneven = PinPattern::new(vec![-0.3, 0.0, 0.2]);
/// let contact = Contact::new(Substrate::Silicone, uneven, 1.115)?;
/// assert!(predict_by(Law::Paper, &contact, &[20.0]).is_err(), "not a published layout");
/// let curve = predict_by(Law::Physics, &contact, &[20.0])?;
/// assert!(curve.friction_n[0] > 1.0 && curve.law.as_str() == "physics");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LawError`] if the law does not apply, or the physics does not converge.
pub fn predict_by(law: Law, contact: &Contact, loads_n: &[f64]) -> Result<FrictionCurve, LawError> {
    predict_by_with_physics(law, contact, loads_n).map(|(curve, _)| curve)
}

/// Predicts a curve as [`predict_by`], and returns the physics of its band for other laws.
fn predict_by_with_physics(
    law: Law,
    contact: &Contact,
    loads_n: &[f64],
) -> Result<(FrictionCurve, BandPhysics), LawError> {
    let (states, physics) = match law {
        Law::Physics => BandPhysics::with_states(contact, loads_n)?,
        _ => (law.states(contact, loads_n)?, BandPhysics::new(contact, loads_n)),
    };
    Ok((curve_of_states(law, contact, &states, &physics)?, physics))
}

/// Returns the curve of `states` with the band of `law`.
fn curve_of_states(
    law: Law,
    contact: &Contact,
    states: &[SwitchState],
    physics: &BandPhysics,
) -> Result<FrictionCurve, LawError> {
    let band = Band::from_physics(law, contact, physics)?;
    let loads_n: Vec<f64> = states.iter().map(|s| s.load_n).collect();
    let (status, mut reasons) = prediction_status(contact, &band.deviations, &loads_n);
    if let Some((rival, load_n, ratio)) = band.widest_rival(NOTEWORTHY) {
        let law = law.title();
        reasons.push(if ratio > 1.0 {
            format!(
                "the laws disagree: at {load_n:.2} N {rival} gives {ratio:.1} times the friction of {law}"
            )
        } else {
            format!(
                "the laws disagree: at {load_n:.2} N {law} gives {:.1} times the friction of {rival}",
                1.0 / ratio
            )
        });
    }
    reasons.extend(law.remark(contact));
    Ok(FrictionCurve::from_states(law, status, reasons, states, &band))
}

/// Predicts tension and friction of `contact` at `loads_n` newtons by [`Law::DEFAULT`].
///
/// If the default law does not converge, the layout law or the capstan of the paper is the
/// fallback. The curve then has the fallback's law, and a reason explains it.
///
/// ```
/// use pinswitch_friction::published::wrap_angle_rad;
/// use pinswitch_friction::{Contact, Law, PinPattern, PredictionStatus, Substrate, predict};
///
/// // Four pins, 14 degrees apart: between the measured layouts.
/// let pins = PinPattern::even(4, 14f64.to_radians());
/// let contact = Contact::new(Substrate::Silicone, pins, wrap_angle_rad())?;
/// let curve = predict(&contact, &[10.0, 40.0]);
/// assert_eq!((curve.law, curve.status), (Law::Physics, PredictionStatus::Interpolated));
/// assert!(curve.band_low_n[1] < curve.friction_n[1]);
/// assert!(curve.friction_n[1] < curve.band_high_n[1]);
/// # Ok::<(), pinswitch_friction::ContactError>(())
/// ```
pub fn predict(contact: &Contact, loads_n: &[f64]) -> FrictionCurve {
    predict_with_physics(contact, loads_n).0
}

/// Predicts a curve as [`predict`], and returns the physics of its band, if the default law
/// converges.
pub fn predict_with_physics(contact: &Contact, loads_n: &[f64]) -> (FrictionCurve, Option<BandPhysics>) {
    let error = match predict_by_with_physics(Law::DEFAULT, contact, loads_n) {
        Ok((curve, physics)) => return (curve, Some(physics)),
        Err(error) => error,
    };
    let mut curve = predict_by(Law::Layout, contact, loads_n)
        .or_else(|_| predict_by(Law::Paper, contact, loads_n))
        .unwrap_or_else(|_| capstan_curve(contact, loads_n));
    let problem = Diagnostic::from(error);
    curve.reasons.push(format!("{} is the fallback: {}", curve.law.title(), problem.problem()));
    (curve, None)
}

/// Returns the capstan of the paper on one material, the fallback for any contact; its band is a
/// factor e.
fn capstan_curve(contact: &Contact, loads_n: &[f64]) -> FrictionCurve {
    let bare = contact.pins().count() == 0;
    let (mu, share) = if bare { (published::MU_SILICONE, 1.0) } else { (published::MU_PINS, 0.0) };
    let states = paper::capstan(contact, mu, share, loads_n);
    let band = Band {
        load_n: vec![published::heaviest_load_n()],
        sources: vec![BandSource::symmetric("model", vec![1.0])],
        rivals: Vec::new(),
        deviations: Vec::new(),
    };
    FrictionCurve::from_states(Law::Paper, PredictionStatus::Extrapolated, contact.remarks(), &states, &band)
}

/// Returns the curves of all other laws that apply, for comparison with that of `main`.
pub fn other_laws(main: Law, contact: &Contact, loads_n: &[f64]) -> Vec<FrictionCurve> {
    other_laws_with_physics(main, contact, loads_n, None)
}

/// Returns the curves of [`other_laws`]; `physics` is that of a band of the same contact, for
/// instance that of `main`, and is used if it is over the same range of loads.
pub fn other_laws_with_physics(
    main: Law,
    contact: &Contact,
    loads_n: &[f64],
    physics: Option<&BandPhysics>,
) -> Vec<FrictionCurve> {
    let others: Vec<Law> = Law::predictive().filter(|law| *law != main).collect();
    let mut by_physics = None;
    let computed;
    let physics = match physics.filter(|physics| physics.covers(loads_n)) {
        Some(physics) => physics,
        None if others.contains(&Law::Physics) => match BandPhysics::with_states(contact, loads_n) {
            Ok((states, physics)) => {
                by_physics = Some(states);
                computed = physics;
                &computed
            }
            Err(_) => {
                computed = BandPhysics::new(contact, loads_n);
                &computed
            }
        },
        None => {
            computed = BandPhysics::new(contact, loads_n);
            &computed
        }
    };
    others
        .into_iter()
        .filter_map(|law| {
            let states = match by_physics.take_if(|_| law == Law::Physics) {
                Some(states) => states,
                None => law.states(contact, loads_n).ok()?,
            };
            curve_of_states(law, contact, &states, physics).ok()
        })
        .collect()
}
