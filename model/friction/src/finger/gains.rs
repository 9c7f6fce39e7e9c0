//! Gains and costs of a curve, load by load, with their bands and the measured values.

use schemars::JsonSchema;
use serde::Serialize;

use crate::contact::Contact;
use crate::curve::{FrictionCurve, published_points};

/// Gain or cost with its band, as a fraction (0.1 is 10 %).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Gain {
    /// Value of the curve.
    pub value: f64,
    /// Value at the lower edge of the curve's band.
    pub low: f64,
    /// Value at the upper edge of the curve's band.
    pub high: f64,
}

/// Gains and costs at one load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FingerPoint {
    /// Load, N.
    pub load_n: f64,
    /// Tension of the motor for holding it, N.
    pub holding_n: f64,
    /// Tension of the motor for pulling it, N.
    pub pulling_n: f64,
    /// Post-eccentric minus post-concentric force as a fraction of the output,
    /// `(T_c - T_e)/F = 2 D/F`; comparable with the 9 to 12 % of human fingers.
    pub force_difference: Gain,
    /// Load supported beyond the motor's tension, `F/T_e - 1`; about half the force difference.
    pub extra_holding: Gain,
    /// Motor mass saved for the same holding load, with mass proportional to torque, `1 - T_e/F`.
    pub motor_mass_saved: Gain,
    /// Tension lost to friction while pulling, `T_c/F - 1`.
    pub concentric_penalty: Gain,
}

/// Tensions and friction of a curve at one load, N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tensions {
    pub(super) eccentric_n: f64,
    pub(super) concentric_n: f64,
    pub(super) friction_n: f64,
    pub(super) low_n: f64,
    pub(super) high_n: f64,
}

impl Tensions {
    /// Returns the tensions of `curve` at load number `i`.
    pub(super) fn from_curve(curve: &FrictionCurve, i: usize) -> Option<Self> {
        Some(Self {
            eccentric_n: *curve.eccentric_n.get(i)?,
            concentric_n: *curve.concentric_n.get(i)?,
            friction_n: *curve.friction_n.get(i)?,
            low_n: *curve.band_low_n.get(i)?,
            high_n: *curve.band_high_n.get(i)?,
        })
    }

    /// Returns the tensions of a tendon that touches nothing.
    pub(super) const fn without_friction(load_n: f64) -> Self {
        Self { eccentric_n: load_n, concentric_n: load_n, friction_n: 0.0, low_n: 0.0, high_n: 0.0 }
    }

    /// Returns the gains at `load_n` newtons, or `None` without load or without holding tension.
    ///
    /// The band of the curve is that of `D`. The bands of the gains follow from the friction
    /// exponent: `D = F sinh(x)`, and the exponents of both directions, `ln(F/T_e)` and
    /// `ln(T_c/F)`, are proportional to `x` (`model/doc/finger.md`).
    pub(super) fn gains(self, load_n: f64) -> Option<FingerPoint> {
        if !(load_n > 0.0 && self.eccentric_n > 0.0) {
            return None;
        }
        let exponent = |friction_n: f64| libm::asinh(friction_n / load_n);
        let x = exponent(self.friction_n);
        let scale = |friction_n: f64| if x > 0.0 { exponent(friction_n) / x } else { 1.0 };
        let (low, high) = (scale(self.low_n), scale(self.high_n));
        let scaled = |exponent: f64, share: fn(f64) -> f64, value: f64| Gain {
            value,
            low: share(exponent * low),
            high: share(exponent * high),
        };
        let (holding, pulling) =
            (libm::log(load_n / self.eccentric_n), libm::log(self.concentric_n / load_n));
        Some(FingerPoint {
            load_n,
            holding_n: self.eccentric_n,
            pulling_n: self.concentric_n,
            force_difference: Gain {
                value: (self.concentric_n - self.eccentric_n) / load_n,
                low: 2.0 * self.low_n / load_n,
                high: 2.0 * self.high_n / load_n,
            },
            extra_holding: scaled(holding, libm::expm1, load_n / self.eccentric_n - 1.0),
            motor_mass_saved: scaled(holding, |x| -libm::expm1(-x), 1.0 - self.eccentric_n / load_n),
            concentric_penalty: scaled(pulling, libm::expm1, self.concentric_n / load_n - 1.0),
        })
    }
}

/// Returns the gains of a curve, load by load, without loads of zero.
///
/// ```
/// use pinswitch_friction::finger::finger;
/// use pinswitch_friction::{Contact, PinPattern, Substrate, predict, published};
///
/// let pins = PinPattern::default();
/// let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
/// let points = finger(&predict(&contact, &[25.0]));
/// assert!(points[0].holding_n < 25.0 && points[0].extra_holding.value > 0.2);
/// let difference = points[0].force_difference;
/// assert!(difference.low < difference.value && difference.value < difference.high);
/// # Ok::<(), pinswitch_friction::ContactError>(())
/// ```
pub fn finger(curve: &FrictionCurve) -> Vec<FingerPoint> {
    let point = |(i, load_n): (usize, &f64)| Tensions::from_curve(curve, i)?.gains(*load_n);
    curve.load_n.iter().enumerate().filter_map(point).collect()
}

/// Returns the extra holding `F/T_e - 1` of a force difference, if both directions have the same
/// friction exponent `x`: `exp(x) - 1`, where the force difference is `2 sinh(x)`.
///
/// ```
/// use pinswitch_friction::finger::extra_holding_of;
/// use pinswitch_friction::published;
///
/// let (low, high) = published::HUMAN_FORCE_DIFFERENCE;
/// let extra = [low, high].map(|d| format!("{:.1} %", 100.0 * extra_holding_of(d)));
/// assert_eq!(extra, ["4.6 %", "6.2 %"], "half of 9 to 12 %");
/// ```
pub fn extra_holding_of(force_difference: f64) -> f64 {
    libm::expm1(libm::asinh(force_difference / 2.0))
}

/// Force difference from a measurement of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MeasuredGain {
    /// Load, N.
    pub load_n: f64,
    /// `2 D/F` of the measured friction, a fraction.
    pub force_difference: f64,
    /// `F/T_e - 1`, a fraction. Derived with the same friction exponent for both directions,
    /// because the paper prints half of their difference only.
    pub extra_holding: f64,
}

/// Returns the measurements of the paper for this contact; empty if it was not measured.
///
/// ```
/// use pinswitch_friction::finger::measured_gains;
/// use pinswitch_friction::{Contact, PinPattern, Substrate, published};
///
/// let pins = PinPattern::even(3, published::LAYOUTS[1].pitch_rad());
/// let contact = Contact::new(Substrate::Silicone, pins, published::wrap_angle_rad())?;
/// let measured = measured_gains(&contact);
/// assert_eq!(format!("{:.1} %", 100.0 * measured[0].force_difference), "38.9 %");
/// # Ok::<(), pinswitch_friction::ContactError>(())
/// ```
pub fn measured_gains(contact: &Contact) -> Vec<MeasuredGain> {
    published_points(contact)
        .iter()
        .filter_map(|point| {
            let force_difference = 2.0 * point.friction_n? / point.load_n;
            Some(MeasuredGain {
                load_n: point.load_n,
                force_difference,
                extra_holding: extra_holding_of(force_difference),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::PinPattern;
    use crate::prediction::predict;
    use crate::published;
    use crate::substrate::Substrate;
    use proptest::prelude::*;

    fn contact(pins: PinPattern, wrap_rad: f64) -> Contact {
        Contact::new(Substrate::Silicone, pins, wrap_rad).unwrap()
    }

    /// On bare silicone the capstan gives all four gains and their bands in closed form.
    #[test]
    fn capstan_gains_have_closed_forms() {
        let wrap = published::wrap_angle_rad();
        let curve = predict(&contact(PinPattern::default(), wrap), &[0.0, 5.0, 50.0]);
        let points = finger(&curve);
        assert_eq!(points.len(), 2, "the load of zero has no gains");
        for (i, point) in points.iter().enumerate() {
            let exponent = |d: f64| libm::asinh(d / point.load_n);
            let (x, low) = (exponent(curve.friction_n[i + 1]), exponent(curve.band_low_n[i + 1]));
            assert!((x / (published::MU_SILICONE * wrap) - 1.0).abs() < 0.2);
            assert!((point.force_difference.value - 2.0 * libm::sinh(x)).abs() < 1e-12);
            assert!((point.extra_holding.value - libm::expm1(x)).abs() < 1e-12);
            assert!((point.concentric_penalty.value - libm::expm1(x)).abs() < 1e-12);
            assert!((point.motor_mass_saved.value + libm::expm1(-x)).abs() < 1e-12);
            assert!((point.extra_holding.low - libm::expm1(low)).abs() < 1e-9);
            assert!(
                (point.extra_holding.value - extra_holding_of(point.force_difference.value)).abs() < 1e-12
            );
        }
    }

    /// Compared with bare silicone: a small penalty at light load, and more than half of the
    /// holding at heavy load.
    #[test]
    fn switches_cost_little_at_light_load() {
        let of = |pins| finger(&predict(&contact(pins, published::wrap_angle_rad()), &[3.0766, 49.671]));
        let (bare, switch) =
            (of(PinPattern::default()), of(PinPattern::even(3, published::LAYOUTS[1].pitch_rad())));
        assert!(switch[0].concentric_penalty.value < 0.4 * bare[0].concentric_penalty.value);
        assert!(switch[1].extra_holding.value > 0.5 * bare[1].extra_holding.value);
    }

    #[test]
    fn unmeasured_contacts_have_no_measured_gains() {
        let wrap = published::wrap_angle_rad();
        let differences: Vec<f64> = published::LAYOUTS
            .iter()
            .map(|l| {
                measured_gains(&contact(PinPattern::even(l.pins, l.pitch_rad()), wrap))[0].force_difference
            })
            .collect();
        for (difference, layout) in differences.iter().zip(&published::LAYOUTS) {
            assert!((difference - 2.0 * layout.device_max_n / published::heaviest_load_n()).abs() < 1e-12);
        }
        assert_eq!(measured_gains(&contact(PinPattern::even(4, 0.2), wrap)), []);
    }

    proptest! {
        #[test]
        fn bands_contain_the_gains(
            count in 0usize..8, pitch in 0.05..0.4f64, load in 0.1..80.0f64, wrap in 0.2..2.0f64
        ) {
            let curve = predict(&contact(PinPattern::even(count, pitch), wrap), &[load]);
            let point = finger(&curve)[0];
            prop_assert!((point.force_difference.value - 2.0 * curve.friction_n[0] / load).abs() < 1e-9);
            for gain in [
                point.force_difference, point.extra_holding, point.motor_mass_saved, point.concentric_penalty
            ] {
                prop_assert!(0.0 <= gain.low && gain.low <= gain.value + 1e-12, "{gain:?}");
                prop_assert!(gain.value <= gain.high + 1e-12, "{gain:?}");
            }
            prop_assert!(point.extra_holding.value < point.force_difference.value);
            prop_assert!(point.motor_mass_saved.high < 1.0);
        }
    }
}
