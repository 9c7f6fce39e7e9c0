//! Predicted friction curves of a design, by its law and by the other laws.

use crate::design::Design;
use pinswitch_friction::{
    BandPhysics, FrictionCurve, Law, LawError, other_laws_with_physics, predict, predict_by,
    predict_with_physics,
};

/// Number of loads of the curves of other laws, enough for a line in a plot.
const COMPARISON_POINTS: usize = 26;

/// The predicted curve of a design, and those of the other laws that apply to its layout.
///
/// ```
/// use pinswitch_switch::{config::{Configuration, assign}, design::Design, prediction::Prediction};
///
/// let mut configuration = Configuration::default();
/// assign(&mut configuration, "layout.pins=[5, 8, 11]")?;
/// let prediction = Prediction::of(&Design::new(configuration)?);
/// let friction_n = *prediction.curve.friction_n.last().unwrap();
/// assert!(friction_n > 8.0 && friction_n < 10.0);
/// # Ok::<(), pinswitch_switch::config::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Prediction {
    /// The curve.
    pub curve: FrictionCurve,
    /// Curves of the other laws over the same range of loads.
    pub others: Vec<FrictionCurve>,
}

impl Prediction {
    /// Predicts the friction of a design by the default law.
    pub fn of(design: &Design) -> Self {
        Self::of_curve(design, &PredictedCurve::of(design))
    }

    /// Adds the curves of the other laws to the curve of a design by the default law.
    pub fn of_curve(design: &Design, predicted: &PredictedCurve) -> Self {
        let PredictedCurve { curve, physics } = predicted;
        Self::with_physics(design, curve.clone(), physics.as_ref())
    }

    /// Predicts the friction of a design by `law`.
    ///
    /// # Errors
    /// [`LawError`] if the law does not apply to the layout.
    pub fn by(law: Law, design: &Design) -> Result<Self, LawError> {
        Ok(Self::with_curve(design, predict_by(law, design.contact(), &loads_n(design))?))
    }

    /// Adds the curves of the other laws to a curve, such as that of a calibrated model.
    pub fn with_curve(design: &Design, curve: FrictionCurve) -> Self {
        Self::with_physics(design, curve, None)
    }

    fn with_physics(design: &Design, curve: FrictionCurve, physics: Option<&BandPhysics>) -> Self {
        let loads_n = spaced_loads_n(design, COMPARISON_POINTS);
        let others = other_laws_with_physics(curve.law, design.contact(), &loads_n, physics);
        Self { curve, others }
    }
}

/// The curve of a design by the default law, with what the curves of the other laws share with it.
#[derive(Clone, Debug)]
pub struct PredictedCurve {
    /// The curve.
    pub curve: FrictionCurve,
    physics: Option<BandPhysics>,
}

impl PredictedCurve {
    /// Predicts the friction of a design by the default law.
    pub fn of(design: &Design) -> Self {
        let (curve, physics) = predict_with_physics(design.contact(), &loads_n(design));
        Self { curve, physics }
    }
}

/// Returns the curve of a design by the default law.
pub fn predicted_curve(design: &Design) -> FrictionCurve {
    predict(design.contact(), &loads_n(design))
}

/// Returns the loads of the curve of a design, N.
pub fn loads_n(design: &Design) -> Vec<f64> {
    spaced_loads_n(design, design.configuration().friction.points)
}

fn spaced_loads_n(design: &Design, points: usize) -> Vec<f64> {
    let f = &design.configuration().friction;
    evenly((f.load_min_n, f.load_max_n), points)
}

/// Returns `points` evenly spaced loads from the lightest to the heaviest.
pub(crate) fn evenly((from, to): (f64, f64), points: usize) -> Vec<f64> {
    let step = (to - from) / (points - 1) as f64;
    (0..points).map(|i| from + step * i as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Configuration, assign};

    /// Every numeric parameter that changes friction by 2 % changes the status or its reasons.
    #[test]
    fn changes_of_friction_change_the_status() {
        let base = || {
            let mut c = Configuration::default();
            assign(&mut c, "layout.pins=[5, 8, 11]").unwrap();
            assign(&mut c, "friction.points=3").unwrap();
            c
        };
        let at_heaviest = |c: Configuration| {
            let curve = predicted_curve(&Design::new(c).ok()?);
            Some((*curve.friction_n.last()?, curve.status, curve.reasons))
        };
        let published = at_heaviest(base()).unwrap();
        assert_eq!(published.1, pinswitch_friction::PredictionStatus::Published);
        let mut moving = Vec::new();
        // The end of the curve is not a property of the part.
        for parameter in Configuration::PARAMETERS.iter().filter(|p| p.path() != "friction.load_max_n") {
            let value = (parameter.get)(&base()).to_string();
            let Ok(number) = value.parse::<f64>() else { continue };
            for factor in [0.8, 0.9, 0.95, 1.05, 1.1, 1.25] {
                let mut changed = base();
                let whole = value.parse::<i64>().is_ok();
                let new = if whole { (number * factor).round() } else { number * factor };
                if assign(&mut changed, &format!("{}={new:?}", parameter.path())).is_err()
                    && assign(&mut changed, &format!("{}={}", parameter.path(), new as i64)).is_err()
                {
                    continue;
                }
                let Some(there) = at_heaviest(changed) else { continue };
                if (there.0 / published.0 - 1.0).abs() >= 0.02 {
                    moving.push(parameter.path());
                    let same = (&there.1, &there.2) == (&published.1, &published.2);
                    assert!(
                        !same,
                        "{} = {new} gives {:.3} N for {:.3} N",
                        parameter.path(),
                        there.0,
                        published.0
                    );
                }
            }
        }
        moving.dedup();
        for known in
            ["silicone.hardness_shore_a", "silicone.thickness_mm", "shell.width_mm", "pins.diameter_mm"]
        {
            assert!(moving.iter().any(|p| p == known), "{known} should move friction: {moving:?}");
        }
    }
}
