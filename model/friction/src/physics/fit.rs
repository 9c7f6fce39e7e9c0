//! The constants, fitted to the seven published maxima, and how well they predict a layout that was left out.

use nalgebra::{Matrix3, Vector3};
use pinswitch_diagnostic::Diagnostic;
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
    /// The model has no solution for some of the constants that were tried.
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

/// One published maximum.
#[derive(Clone, Debug)]
pub(super) struct Maximum {
    /// `three-double, device`.
    pub(super) name: String,
    /// Which of the three layouts; `None` for silicone alone.
    pub(super) layout: Option<usize>,
    pub(super) contact: Contact,
    pub(super) friction_n: f64,
}

/// The seven maxima, all at the heaviest load; `wrap` returns the angle in radians over which the tendon turns.
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
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaximaFit {
    /// The constants.
    pub constants: Constants,
    /// Covariance of their logarithms, from the scatter of the maxima about the fit.
    pub covariance: [[f64; 3]; 3],
    /// Relative error of each maximum, model over measured less one: name and error.
    pub errors: Vec<(String, f64)>,
    /// Root mean square of the errors.
    pub rms: f64,
    /// Scatter of the maxima about the fit: the same sum over maxima less constants.
    pub scatter: f64,
}

/// The maxima of a layout, predicted by constants fitted to the others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutLeftOut {
    /// The layout.
    pub layout: &'static str,
    /// Constants fitted without it.
    pub constants: Constants,
    /// Relative error of its pins alone.
    pub pins_error: f64,
    /// Relative error of its device.
    pub device_error: f64,
}

fn error(maximum: &Maximum, bed: &Bed, constants: Constants) -> Result<f64, PhysicsError> {
    let contact = maximum.contact.clone().with_bed(*bed);
    let friction = PhysicsSwitch::new(&contact, constants).friction_n(published::heaviest_load_n())?;
    Ok(friction / maximum.friction_n - 1.0)
}

/// Least squares of the relative errors over these maxima.
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
/// [`FitError`] if the model cannot be solved or the maxima do not determine the constants.
pub fn fit_maxima(bed: &Bed) -> Result<MaximaFit, FitError> {
    let maxima = published_maxima(|_| published::wrap_angle_rad());
    fit(bed, &maxima.iter().collect::<Vec<_>>())
}

/// Relative error of each of the seven maxima, predicted by constants fitted to those of other conditions alone: without
/// both maxima of its layout, or without the bare silicone. Name and error, in the order of [`fit_maxima`].
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

/// Predicts the maxima of each layout from the others'.
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
