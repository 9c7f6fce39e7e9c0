//! Predictions: the default law, a chosen one, and the others for comparison.

use pinswitch_diagnostic::Diagnostic;

use crate::band::Band;
use crate::band_source::BandSource;
use crate::contact::Contact;
use crate::curve::FrictionCurve;
use crate::law::{Law, LawError, paper};
use crate::published;
use crate::status::{PredictionStatus, prediction_status};

/// Predicts tension and friction of `contact` at `loads_n` newtons by this law.
///
/// ```
/// use pinswitch_friction::{Contact, Law, PinPattern, Substrate, predict_by};
///
/// let uneven = PinPattern::new(vec![-0.3, 0.0, 0.2]);
/// let contact = Contact::new(Substrate::Silicone, uneven, 1.115)?;
/// assert!(predict_by(Law::Paper, &contact, &[20.0]).is_err(), "the paper measured no such layout");
/// let curve = predict_by(Law::Physics, &contact, &[20.0])?;
/// assert!(curve.friction_n[0] > 1.0 && curve.law.as_str() == "physics");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LawError`] if the law does not apply or has no solution.
pub fn predict_by(law: Law, contact: &Contact, loads_n: &[f64]) -> Result<FrictionCurve, LawError> {
    let states = law.states(contact, loads_n)?;
    let band = Band::of(law, contact, loads_n)?;
    let (status, mut reasons) = prediction_status(contact, &band.deviations, loads_n);
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
    Ok(FrictionCurve::of(law, status, reasons, &states, &band))
}

/// Ratio of two laws' frictions that a curve's reasons name.
const NOTEWORTHY: f64 = 1.25;

/// Predicts by [`Law::DEFAULT`], the same law for every contact. Should it have no solution, the layout law or the
/// paper's capstan stands in, and the curve says so in its reasons and in its law.
///
/// ```
/// use pinswitch_friction::{Contact, Law, PinPattern, Substrate, PredictionStatus, predict, published};
///
/// // Four pins, 14 degrees apart: between the layouts that the paper measured.
/// let pins = PinPattern::even(4, 14f64.to_radians());
/// let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
/// let curve = predict(&contact, &[10.0, 40.0]);
/// assert_eq!((curve.law, curve.status), (Law::Physics, PredictionStatus::Interpolated));
/// assert!(curve.band_low_n[1] < curve.friction_n[1] && curve.friction_n[1] < curve.band_high_n[1]);
/// # Ok::<(), pinswitch_friction::ContactError>(())
/// ```
pub fn predict(contact: &Contact, loads_n: &[f64]) -> FrictionCurve {
    let error = match predict_by(Law::DEFAULT, contact, loads_n) {
        Ok(curve) => return curve,
        Err(error) => error,
    };
    let mut curve = predict_by(Law::Layout, contact, loads_n)
        .or_else(|_| predict_by(Law::Paper, contact, loads_n))
        .unwrap_or_else(|_| capstan_curve(contact, loads_n));
    let problem = Diagnostic::from(error);
    curve.reasons.push(format!("{} is the fallback: {}", curve.law.title(), problem.problem()));
    curve
}

/// The paper's capstan on one material, for a contact that nothing else describes; its band is a factor e.
fn capstan_curve(contact: &Contact, loads_n: &[f64]) -> FrictionCurve {
    let bare = contact.pins().count() == 0;
    let (mu, share) = if bare { (published::MU_SILICONE, 1.0) } else { (published::MU_PINS, 0.0) };
    let states = paper::capstan(contact, mu, share, loads_n);
    let band = Band {
        load_n: vec![published::heaviest_load_n()],
        sources: vec![BandSource::even("model", vec![1.0])],
        rivals: Vec::new(),
        deviations: Vec::new(),
    };
    FrictionCurve::of(Law::Paper, PredictionStatus::Extrapolated, contact.remarks(), &states, &band)
}

/// The curves of all other laws that apply, for comparison; never mixed into the main one.
pub fn other_laws(main: Law, contact: &Contact, loads_n: &[f64]) -> Vec<FrictionCurve> {
    Law::predictive()
        .filter(|law| *law != main)
        .filter_map(|law| predict_by(law, contact, loads_n).ok())
        .collect()
}
