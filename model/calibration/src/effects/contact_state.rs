//! Contact of one row, which the effects change, and its tension.

use pinswitch_friction::Substrate;

use crate::table::{Condition, Point};

/// Reference load `F0` of `model/doc/effect-catalogue.md` in newtons.
pub const REFERENCE_LOAD_N: f64 = 50.0;

/// Quantities that determine the tension of one row. Effects change them before
/// [`ContactState::tension_n`] is called.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState {
    /// True load in newtons.
    pub load_n: f64,
    /// Wrap angle in radians; 1 for `plain`.
    pub wrap_rad: f64,
    /// Friction coefficient on the pins.
    pub mu_pins: f64,
    /// Friction coefficient on the silicone; the free exponent for `plain`.
    pub mu_silicone: f64,
    /// Friction exponent of the pins in addition to `mu_pins` times the wrap.
    pub extra_exponent_pins: f64,
    /// Factor on every friction exponent.
    pub exponent_factor: f64,
    /// Threshold of a device in newtons.
    pub half_load_n: f64,
    /// Steepness `s` of the transition, dimensionless.
    pub steepness: f64,
    /// Whether the transition follows the mean tension over the wrap instead of the load.
    pub local_tension: bool,
    /// Constant friction force in newtons, in proportion to the silicone's share.
    pub adhesion_n: f64,
    /// Constant friction force in newtons in every condition.
    pub drag_n: f64,
}

impl ContactState {
    /// Returns the tension in newtons: the capstan equation for one material; eq. 4 for a device,
    /// applied to `T - F` in each direction (`model/doc/friction-laws.md`).
    pub fn tension_n(&self, condition: &Condition, point: &Point) -> f64 {
        let (f, d) = (self.load_n, point.sign);
        let x_pins = (self.mu_pins * self.wrap_rad + self.extra_exponent_pins) * self.exponent_factor;
        let x_silicone = self.mu_silicone * self.wrap_rad * self.exponent_factor;
        let drag = d * self.drag_n;
        if condition.device.is_some() {
            let (rise_p, rise_s) = (f * libm::expm1(d * x_pins), f * libm::expm1(d * x_silicone));
            let w = condition.weight;
            let mut switched = self.switched(f);
            let rise = |s: f64| (1.0 + w) * (1.0 - s) * rise_p + (1.0 - w) * s * rise_s;
            if self.local_tension && f > 0.0 {
                for _ in 0..3 {
                    switched = self.switched(mean_tension_n(f, 1.0 + rise(switched) / f));
                }
            }
            f + rise(switched) + d * self.adhesion_n * switched + drag
        } else if condition.substrate == Some(Substrate::Abs) {
            f + f * libm::expm1(d * x_pins) + drag
        } else {
            f + f * libm::expm1(d * x_silicone) + d * self.adhesion_n + drag
        }
    }

    /// Returns the silicone's share `S = 1/(1 + exp(-s (F/F_half - 1)))` at a load in newtons
    /// (`model/doc/friction-laws.md`).
    pub fn switched(&self, load_n: f64) -> f64 {
        1.0 / (1.0 + libm::exp(-self.steepness * (load_n / self.half_load_n - 1.0)))
    }
}

/// Returns the mean of `F exp(x phi/a)` over the wrap in newtons: `F (r - 1)/ln r` with `r = T/F`.
fn mean_tension_n(load_n: f64, ratio: f64) -> f64 {
    let ratio = ratio.max(1e-3);
    let x = libm::log(ratio);
    if x.abs() < 1e-6 { load_n * (1.0 + x / 2.0) } else { load_n * (ratio - 1.0) / x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_tension_is_between_the_ends() {
        for ratio in [0.7, 1.0, 1.3] {
            let mean = mean_tension_n(10.0, ratio);
            assert!(mean >= 10.0 * ratio.min(1.0) - 1e-9 && mean <= 10.0 * ratio.max(1.0) + 1e-9);
        }
    }
}
