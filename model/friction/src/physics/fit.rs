//! Fits of the constants to the seven published maxima, with cross-validation.

use nalgebra::{Matrix3, Vector3};
use pinswitch_diagnostic::Diagnostic;
use schemars::JsonSchema;
use serde::Serialize;

use super::constants::{Constants, PUBLISHED_FIT};
use super::error::PhysicsError;
use super::switch::PhysicsSwitch;
use crate::bed::Bed;
use crate::contact::Contact;
use crate::least_squares::{self, LeastSquaresError};
use crate::pattern::PinPattern;
use crate::published::{self, LAYOUTS};
use crate::substrate::Substrate;

/// Reason why the constants cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// The model does not converge for some of the evaluated constants.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
    /// The maxima do not determine the constants.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
}

impl From<FitError> for Diagnostic {
    fn from(error: FitError) -> Self {
        match error {
            FitError::Physics(error) => error.into(),
            FitError::LeastSquares(error) => error.into(),
        }
    }
}

/// Published maximum of a condition.
#[derive(Clone, Debug)]
pub(super) struct Maximum {
    /// Name, such as `three-double, device`.
    pub(super) name: String,
    /// Index of the layout; `None` for silicone alone.
    pub(super) layout: Option<usize>,
    /// Contact of the condition.
    pub(super) contact: Contact,
    /// Measured friction at the heaviest load, N.
    pub(super) friction_n: f64,
}

/// Returns the seven maxima, all at the heaviest load; `wrap` returns the wrap angle of a pattern
/// in radians.
pub(super) fn published_maxima(wrap: impl Fn(&PinPattern) -> f64) -> Vec<Maximum> {
    let of = |name: String, layout, substrate, pins: PinPattern, friction_n| {
        let wrap = wrap(&pins);
        let contact = Contact::new(substrate, pins, wrap).ok()?;
        Some(Maximum { name, layout, contact, friction_n })
    };
    let bare = of(
        "silicone alone".to_owned(),
        None,
        Substrate::Silicone,
        PinPattern::default(),
        published::SILICONE_ALONE_MAX_N,
    );
    let layouts = LAYOUTS.iter().enumerate().flat_map(|(i, l)| {
        [(Substrate::Abs, "pins alone"), (Substrate::Silicone, "device")].map(|(substrate, kind)| {
            let pins = PinPattern::even(l.pins, l.pitch_rad());
            of(format!("{}, {kind}", l.name), Some(i), substrate, pins, l.max_n(substrate))
        })
    });
    std::iter::once(bare).chain(layouts).flatten().collect()
}

/// Constants fitted to published maxima.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MaximaFit {
    /// Fitted constants.
    pub constants: Constants,
    /// Covariance of their logarithms, from the scatter of the maxima about the fit.
    pub covariance: [[f64; 3]; 3],
    /// Name and relative error of each maximum: predicted over measured, minus one.
    pub errors: Vec<(String, f64)>,
    /// Root mean square of the errors.
    pub rms: f64,
    /// Scatter of the maxima about the fit: root of the sum of squared errors over the degrees of
    /// freedom.
    pub scatter: f64,
}

/// Errors of the maxima of a layout, predicted with constants that are fitted to the others.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LayoutLeftOut {
    /// Name of the layout.
    pub layout: &'static str,
    /// Constants fitted without the layout.
    pub constants: Constants,
    /// Relative error of the pins alone.
    pub pins_error: f64,
    /// Relative error of the device.
    pub device_error: f64,
}

/// Returns the relative error of a maximum: predicted over measured, minus one.
fn error(maximum: &Maximum, bed: &Bed, constants: Constants) -> Result<f64, PhysicsError> {
    let contact = maximum.contact.clone().with_bed(*bed);
    let friction = PhysicsSwitch::new(&contact, constants).friction_n(published::heaviest_load_n())?;
    Ok(friction / maximum.friction_n - 1.0)
}

/// Fits the constants by least squares of the relative errors of these maxima.
pub(super) fn fit(bed: &Bed, maxima: &[&Maximum]) -> Result<MaximaFit, FitError> {
    let start = PUBLISHED_FIT.constants().logarithms();
    let errors = |at: &[f64]| -> Result<Vec<f64>, PhysicsError> {
        let constants = Constants::from_logarithms(&Vector3::from_column_slice(at));
        maxima.iter().map(|m| error(m, bed, constants)).collect()
    };
    let solution = least_squares::minimise(start.as_slice(), 1e-4, errors)??;
    let constants = Constants::from_logarithms(&Vector3::from_column_slice(&solution.at));
    let sum: f64 = solution.residuals.iter().map(|e| e * e).sum();
    let freedom = maxima.len().saturating_sub(3).max(1) as f64;
    let covariance = Matrix3::from_column_slice(solution.inverse_normal.as_slice()) * (sum / freedom);
    Ok(MaximaFit {
        constants,
        covariance: [0, 1, 2].map(|i| [0, 1, 2].map(|j| covariance[(i, j)])),
        errors: maxima.iter().map(|m| m.name.clone()).zip(solution.residuals).collect(),
        rms: (sum / maxima.len() as f64).sqrt(),
        scatter: (sum / freedom).sqrt(),
    })
}

/// Fits the three constants to the seven published maxima on `bed`.
///
/// # Errors
/// [`FitError`] if the model does not converge, or the maxima do not determine the constants.
pub fn fit_maxima(bed: &Bed) -> Result<MaximaFit, FitError> {
    let maxima = published_maxima(|_| published::wrap_angle_rad());
    fit(bed, &maxima.iter().collect::<Vec<_>>())
}

/// Returns name and relative error of each of the seven maxima, in the order of [`fit_maxima`],
/// with constants that are fitted without its condition: without both maxima of its layout, or
/// without the bare silicone.
///
/// # Errors
/// As [`fit_maxima`].
pub fn leave_one_condition_out(bed: &Bed) -> Result<Vec<(String, f64)>, FitError> {
    let maxima = published_maxima(|_| published::wrap_angle_rad());
    maxima
        .iter()
        .map(|left_out| {
            let others: Vec<_> = maxima.iter().filter(|m| m.layout != left_out.layout).collect();
            let constants = fit(bed, &others)?.constants;
            Ok((left_out.name.clone(), error(left_out, bed, constants)?))
        })
        .collect()
}

/// Predicts the maxima of each layout with constants that are fitted to the others.
///
/// # Errors
/// As [`fit_maxima`].
pub fn leave_one_layout_out(bed: &Bed) -> Result<Vec<LayoutLeftOut>, FitError> {
    let maxima = published_maxima(|_| published::wrap_angle_rad());
    LAYOUTS
        .iter()
        .enumerate()
        .map(|(i, layout)| {
            let others: Vec<_> = maxima.iter().filter(|m| m.layout != Some(i)).collect();
            let constants = fit(bed, &others)?.constants;
            let of = |substrate| {
                maxima
                    .iter()
                    .find(|m| m.layout == Some(i) && m.contact.substrate() == substrate)
                    .map_or(Ok(f64::NAN), |m| error(m, bed, constants))
            };
            Ok(LayoutLeftOut {
                layout: layout.name,
                constants,
                pins_error: of(Substrate::Abs)?,
                device_error: of(Substrate::Silicone)?,
            })
        })
        .collect()
}
