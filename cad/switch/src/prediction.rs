//! The friction curve of a design, with what the other laws say beside it.

use crate::design::Design;
use pinswitch_friction::{FrictionCurve, Law, LawError, other_laws, predict, predict_by};

/// Loads at which the other laws are compared with a curve: enough for a line in a plot.
const COMPARISON_POINTS: usize = 26;

/// A curve, and those of the other laws that apply to the same layout: beside it, never mixed into it.
///
/// ```
/// use pinswitch_switch::{config::{Configuration, assign}, design::Design, prediction::Prediction};
///
/// let mut configuration = Configuration::default();
/// assign(&mut configuration, "layout.pins=[5, 8, 11]")?;
/// let prediction = Prediction::of(&Design::new(configuration)?);
/// let friction_n = prediction.curve.friction_n.last().unwrap();
/// assert_eq!(format!("{friction_n:.2}"), "10.01");
/// # Ok::<(), pinswitch_switch::config::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Prediction {
    /// The curve.
    pub curve: FrictionCurve,
    /// The other laws' curves over the same range of loads.
    pub others: Vec<FrictionCurve>,
}

impl Prediction {
    /// The prediction of `design` by the default law.
    pub fn of(design: &Design) -> Self {
        Self::with_curve(design, predicted_curve(design))
    }

    /// The prediction of `design` by `law`.
    ///
    /// # Errors
    /// [`LawError`] if the law does not apply to the layout.
    pub fn by(law: Law, design: &Design) -> Result<Self, LawError> {
        Ok(Self::with_curve(design, predict_by(law, design.contact(), &loads_n(design))?))
    }

    /// A curve made elsewhere, such as by a calibrated model, with the laws beside it.
    pub fn with_curve(design: &Design, curve: FrictionCurve) -> Self {
        let others = other_laws(curve.law, design.contact(), &spaced_loads_n(design, COMPARISON_POINTS));
        Self { curve, others }
    }
}

/// The curve of `design` by the default law, without the others.
pub fn predicted_curve(design: &Design) -> FrictionCurve {
    predict(design.contact(), &loads_n(design))
}

/// The loads of the curve of `design`, in newtons.
pub fn loads_n(design: &Design) -> Vec<f64> {
    spaced_loads_n(design, design.configuration().friction.points)
}

fn spaced_loads_n(design: &Design, points: usize) -> Vec<f64> {
    let f = &design.configuration().friction;
    let step = (f.load_max_n - f.load_min_n) / (points - 1) as f64;
    (0..points).map(|i| f.load_min_n + step * i as f64).collect()
}
