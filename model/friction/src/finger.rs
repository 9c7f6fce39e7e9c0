//! What a switch buys at the system level, as the paper argues it: a finger holds more than its motor pulls.
//!
//! In eccentric use (holding, giving way) friction carries a part of the load: a motor of tension `T` holds `F > T`. In
//! concentric use (pulling) it must overcome the friction. A switch has little friction when light and much when heavy:
//! quick to move, strong to hold.

use serde::Serialize;

use crate::FrictionCurve;

/// How much stronger the human finger holds than it pulls, because of friction in its sheath: 9 to 12 %. The reference
/// that the paper names.
pub const HUMAN_FINGER: (f64, f64) = (0.09, 0.12);

/// Gains and costs at one load. Ratios are fractions: 0.1 is 10 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FingerPoint {
    /// Load held or pulled, N.
    pub load_n: f64,
    /// Tension that the motor holds it with, N.
    pub holding_n: f64,
    /// Tension that the motor pulls it with, N.
    pub pulling_n: f64,
    /// Load held beyond the motor's tension, at no cost of the motor: `F/T_e - 1`.
    pub extra_holding: f64,
    /// Motor mass saved for the same holding load, with mass in proportion to torque: `1 - T_e/F`.
    pub motor_mass_saved: f64,
    /// Tension lost to friction when pulling: `T_c/F - 1`.
    pub concentric_penalty: f64,
}

/// The gains of a curve, load by load. Loads of zero are left out.
///
/// ```
/// use pinswitch_friction::finger::finger;
/// use pinswitch_friction::{Contact, PinPattern, Substrate, predict, published};
///
/// let contact = Contact::new(Substrate::Silicone, PinPattern::default(), published::wrap_angle_rad())?;
/// let points = finger(&predict(&contact, &[25.0]));
/// assert!(points[0].holding_n < 25.0 && points[0].extra_holding > 0.2, "bare silicone holds a third more");
/// # Ok::<(), pinswitch_friction::ContactError>(())
/// ```
pub fn finger(curve: &FrictionCurve) -> Vec<FingerPoint> {
    curve
        .load_n
        .iter()
        .zip(curve.eccentric_n.iter().zip(&curve.concentric_n))
        .filter(|(load, (e, _))| **load > 0.0 && **e > 0.0)
        .map(|(&load_n, (&holding_n, &pulling_n))| FingerPoint {
            load_n,
            holding_n,
            pulling_n,
            extra_holding: load_n / holding_n - 1.0,
            motor_mass_saved: 1.0 - holding_n / load_n,
            concentric_penalty: pulling_n / load_n - 1.0,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Contact, Law, PinPattern, Substrate, predict, predict_by, published};

    /// On bare silicone the capstan gives all three in closed form.
    #[test]
    fn a_capstan_gains_and_costs_its_exponent() {
        let wrap = published::wrap_angle_rad();
        let contact = Contact::new(Substrate::Silicone, PinPattern::default(), wrap).unwrap();
        let x = published::MU_SILICONE * wrap;
        let all = finger(&predict_by(Law::Paper, &contact, &[0.0, 10.0, 50.0]).unwrap());
        assert_eq!(all.len(), 2);
        for point in all {
            assert!((point.extra_holding - x.exp_m1()).abs() < 1e-12);
            assert!((point.concentric_penalty - x.exp_m1()).abs() < 1e-12);
            assert!((point.motor_mass_saved + (-x).exp_m1()).abs() < 1e-12);
        }
    }

    /// The point of a switch: light loads cost less than on silicone, heavy loads hold nearly as much.
    #[test]
    fn a_switch_is_quick_when_light_and_strong_when_heavy() {
        let wrap = published::wrap_angle_rad();
        let of = |pins| {
            let contact = Contact::new(Substrate::Silicone, pins, wrap).unwrap();
            finger(&predict(&contact, &[3.0766, 49.671]))
        };
        let (bare, switch) =
            (of(PinPattern::default()), of(PinPattern::even(3, published::LAYOUTS[1].pitch_rad())));
        assert!(switch[0].concentric_penalty < 0.3 * bare[0].concentric_penalty);
        assert!(switch[1].extra_holding > 0.6 * bare[1].extra_holding);
    }
}
