//! Validation of the laws: errors on the seven published maxima, in sample and
//! leave-one-layout-out. The default law has the smallest leave-one-layout-out error.

use schemars::JsonSchema;
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

/// Relative errors of a law on one published maximum: predicted over measured, minus one.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MaximumError {
    /// Name of the maximum, such as `three-double, device`.
    pub maximum: String,
    /// Error with the constants of the law; `None` if it does not describe the condition.
    pub in_sample: Option<f64>,
    /// Error with constants that are fitted without this layout; `None` if they are printed for the
    /// layout itself.
    pub left_out: Option<f64>,
}

/// Errors of a law on all seven maxima.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LawValidation {
    /// Law.
    pub law: Law,
    /// Errors by maximum.
    pub errors: Vec<MaximumError>,
    /// Root mean square of the in-sample errors, over the conditions that the law describes.
    pub rms_in_sample: Option<f64>,
    /// Root mean square of the leave-one-layout-out errors, over the conditions that the law then
    /// describes.
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

/// Validates every law that predicts from a contact alone.
///
/// ```no_run
/// for law in pinswitch_friction::validation::validate_laws()? {
///     println!("{}: {:.3?} left-out RMS error", law.law.as_str(), law.rms_left_out);
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

/// Returns the errors of the physics, fitted to all maxima and without each condition.
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

/// Returns the seven conditions in the order of [`fit_maxima`]: name, layout, substrate and
/// measured maximum in newtons.
fn conditions() -> Vec<(String, Option<usize>, Substrate, f64)> {
    let bare = ("silicone alone".to_owned(), None, Substrate::Silicone, published::SILICONE_ALONE_MAX_N);
    let layouts = LAYOUTS.iter().enumerate().flat_map(|(i, l)| {
        [(Substrate::Abs, "pins alone"), (Substrate::Silicone, "device")]
            .map(|(on, kind)| (format!("{}, {kind}", l.name), Some(i), on, l.max_n(on)))
    });
    std::iter::once(bare).chain(layouts).collect()
}

/// Returns the errors of a law whose constants are printed in the paper or follow from the printed
/// thresholds.
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
                // The printed coefficient of the pins is the same for all layouts and is not
                // refitted.
                (Law::Paper, Some(_), Substrate::Abs) => in_sample,
                // The paper prints thresholds and the coefficient of silicone for the same
                // condition.
                _ => None,
            };
            MaximumError { maximum, in_sample, left_out }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compared with each other law on the maxima that both predict. The default law must describe
    /// all of them.
    #[test]
    fn default_law_has_the_smallest_error() {
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
