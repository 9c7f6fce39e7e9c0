//! Size of a motor that holds a load with the help of friction.

use schemars::JsonSchema;
use serde::Serialize;

use super::gains::{FingerPoint, Gain};

/// Motor that is just strong enough to hold the heaviest load of a curve.
///
/// Assumptions: mass is proportional to torque, with the same drum; the motor holds by its torque,
/// without a brake or a self-locking gear; friction supports its full share while the load is held
/// (`model/doc/finger.md`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MotorSizing {
    /// Load that it can hold, N.
    pub holds_n: f64,
    /// Tension for holding that load, N.
    pub tension_n: f64,
    /// Mass saved compared with the motor of a tendon without friction, a fraction.
    pub mass_saved: Gain,
    /// Heaviest load that it can pull against friction, N.
    pub pulls_n: f64,
}

impl MotorSizing {
    /// Sizes the motor for the last of `points`, which have ascending loads. Returns `None` without
    /// points.
    ///
    /// ```
    /// use pinswitch_friction::finger::{MotorSizing, finger};
    /// use pinswitch_friction::{Contact, PinPattern, Substrate, predict, published};
    ///
    /// let pins = PinPattern::default();
    /// let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
    /// let motor = MotorSizing::of(&finger(&predict(&contact, &[10.0, 50.0]))).ok_or("no load")?;
    /// assert!(motor.pulls_n < motor.tension_n && motor.tension_n < motor.holds_n);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(points: &[FingerPoint]) -> Option<Self> {
        let heaviest = points.last()?;
        let tension_n = heaviest.holding_n;
        // Linear interpolation between the loads of the curve, starting at zero load and tension.
        let mut before = (0.0, 0.0);
        let mut pulls_n = 0.0;
        for point in points {
            let (load_n, pulling_n) = (point.load_n, point.pulling_n);
            if pulling_n > tension_n {
                let share = (tension_n - before.1) / (pulling_n - before.1).max(f64::MIN_POSITIVE);
                pulls_n = before.0 + (load_n - before.0) * share.clamp(0.0, 1.0);
                break;
            }
            before = (load_n, pulling_n);
            pulls_n = load_n;
        }
        Some(Self { holds_n: heaviest.load_n, tension_n, mass_saved: heaviest.motor_mass_saved, pulls_n })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contact;
    use crate::finger::gains::finger;
    use crate::pattern::PinPattern;
    use crate::prediction::predict;
    use crate::published;
    use crate::substrate::Substrate;

    /// With one material, a motor that holds `F` with a tension of `F exp(-x)` pulls `F exp(-2 x)`.
    #[test]
    fn capstan_motor_has_a_closed_form() {
        let contact =
            Contact::new(Substrate::Silicone, PinPattern::default(), published::wrap_angle_rad()).unwrap();
        let loads: Vec<f64> = (1..=100).map(|i| 0.5 * f64::from(i)).collect();
        let motor = MotorSizing::of(&finger(&predict(&contact, &loads))).unwrap();
        let x = libm::log(motor.holds_n / motor.tension_n);
        assert!((motor.pulls_n - motor.holds_n * libm::exp(-2.0 * x)).abs() < 1e-9);
        assert!((motor.mass_saved.value + libm::expm1(-x)).abs() < 1e-12);
        assert_eq!(MotorSizing::of(&[]), None);
    }
}
