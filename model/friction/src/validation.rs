//! What each law is worth: its error on the seven published maxima, in sample and on layouts left out with nothing of
//! theirs given. The default law is chosen by this table.

use serde::Serialize;

use crate::bed::Bed;
use crate::contact::Contact;
use crate::law::Law;
use crate::law::layout::{LayoutLaw, ThresholdRule};
use crate::pattern::PinPattern;
use crate::physics::{FitError, fit_maxima, leave_one_condition_out};
use crate::published::{self, LAYOUTS};
use crate::substrate::Substrate;
use crate::switch::Switch;

/// A law's error on one published maximum, relative: predicted over measured, less one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaximumError {
    /// The maximum, such as `three-double, device`.
    pub maximum: String,
    /// With the constants that the law uses; `None` if it does not describe the condition.
    pub in_sample: Option<f64>,
    /// With constants to which nothing of this layout contributed; `None` if the law then has none.
    pub left_out: Option<f64>,
}

/// A law's errors on all seven maxima.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LawValidation {
    /// The law.
    pub law: Law,
    /// Its error on each maximum.
    pub errors: Vec<MaximumError>,
    /// Root mean square in sample, over those that it describes.
    pub rms_in_sample: Option<f64>,
    /// Root mean square left out, over those that it then predicts.
    pub rms_left_out: Option<f64>,
}

impl LawValidation {
    fn new(law: Law, errors: Vec<MaximumError>) -> Self {
        let rms = |errors: Vec<f64>| {
            let count = errors.len() as f64;
            (count > 0.0).then(|| (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt())
        };
        Self {
            law,
            rms_in_sample: rms(errors.iter().filter_map(|e| e.in_sample).collect()),
            rms_left_out: rms(errors.iter().filter_map(|e| e.left_out).collect()),
            errors,
        }
    }
}

/// The evidence of every law that predicts from a contact alone, made anew.
///
/// ```no_run
/// for law in pinswitch_friction::validation::validate_laws()? {
///     println!("{}: {:.1?} % left out", law.law.as_str(), law.rms_left_out.map(|rms| 100.0 * rms));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FitError`] if the physics cannot be fitted.
pub fn validate_laws() -> Result<Vec<LawValidation>, FitError> {
    let physics = physics_errors()?;
    Ok(Law::predictive()
        .map(|law| match law {
            Law::Physics => LawValidation::new(law, physics.clone()),
            _ => LawValidation::new(law, printed_errors(law)),
        })
        .collect())
}

fn physics_errors() -> Result<Vec<MaximumError>, FitError> {
    let bed = Bed::published();
    let fitted = fit_maxima(&bed)?;
    let left_out = leave_one_condition_out(&bed)?;
    Ok(fitted
        .errors
        .into_iter()
        .zip(left_out)
        .map(|((maximum, in_sample), (_, left_out))| MaximumError {
            maximum,
            in_sample: Some(in_sample),
            left_out: Some(left_out),
        })
        .collect())
}

/// The seven conditions, in the order of the physics' fit: name, contact and measured maximum.
fn conditions() -> Vec<(String, Option<usize>, Substrate, f64)> {
    let bare = ("silicone alone".to_owned(), None, Substrate::Silicone, published::SILICONE_ALONE_MAX_N);
    let layouts = LAYOUTS.iter().enumerate().flat_map(|(i, l)| {
        [(Substrate::Abs, "pins alone"), (Substrate::Silicone, "device")]
            .map(|(on, kind)| (format!("{}, {kind}", l.name), Some(i), on, l.max_n(on)))
    });
    std::iter::once(bare).chain(layouts).collect()
}

/// The laws whose constants are printed in the paper or follow from its thresholds.
fn printed_errors(law: Law) -> Vec<MaximumError> {
    let (wrap, heaviest) = (published::wrap_angle_rad(), published::heaviest_load_n());
    conditions()
        .into_iter()
        .map(|(maximum, layout, substrate, measured)| {
            let pins =
                layout.map(|i| PinPattern::even(LAYOUTS[i].pins, LAYOUTS[i].pitch_rad())).unwrap_or_default();
            let contact = Contact::new(substrate, pins, wrap).ok();
            let error = |friction: f64| friction / measured - 1.0;
            let in_sample =
                contact.as_ref().and_then(|c| Some(error(*law.friction_n(c, &[heaviest]).ok()?.first()?)));
            let left_out = match (law, layout, substrate) {
                (Law::Layout, Some(left_out), Substrate::Silicone) => {
                    let others: Vec<_> =
                        (0..LAYOUTS.len()).filter(|i| *i != left_out).map(|i| LAYOUTS[i]).collect();
                    contact.as_ref().and_then(|c| {
                        let rule = ThresholdRule::fitted(&others)?;
                        let law = LayoutLaw::by_rule(c.pins(), wrap, rule)?;
                        Some(error(law.state(heaviest, wrap).friction_n))
                    })
                }
                // The coefficient of the pins is one for all layouts, printed; it is not refitted.
                (Law::Paper, Some(_), Substrate::Abs) => in_sample,
                // Thresholds and the silicone's coefficient are printed for the very condition.
                _ => None,
            };
            MaximumError { maximum, in_sample, left_out }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The default law is the one that misses least of what it was told nothing of, among those that describe all.
    #[test]
    fn the_default_law_is_the_best_on_layouts_left_out() {
        let all = validate_laws().unwrap();
        let of = |law| all.iter().find(|e| e.law == law).unwrap();
        let default = of(Law::DEFAULT);
        assert!(default.errors.iter().all(|e| e.in_sample.is_some() && e.left_out.is_some()));
        for other in all.iter().filter(|e| e.law != Law::DEFAULT) {
            let (ours, theirs): (Vec<f64>, Vec<f64>) = default
                .errors
                .iter()
                .zip(&other.errors)
                .filter_map(|(a, b)| Some((a.left_out?.powi(2), b.left_out?.powi(2))))
                .unzip();
            assert!(ours.iter().sum::<f64>() < theirs.iter().sum::<f64>(), "{:?}: {other:?}", default.errors);
        }
        assert_eq!(format!("{:.0}", 100.0 * of(Law::Paper).rms_in_sample.unwrap()), "31");
    }
}
