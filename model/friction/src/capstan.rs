//! The capstan equation: tension across a wrapped contact.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Direction of the load's motion while the tension is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// The load is released, and friction reduces the tension (`d = -1`).
    Eccentric,
    /// The load is pulled, and friction adds to the tension (`d = +1`).
    Concentric,
}

impl Direction {
    /// Returns the word of tables and reports: `eccentric` or `concentric`.
    pub fn as_str(self) -> &'static str {
        match self {
            Direction::Eccentric => "eccentric",
            Direction::Concentric => "concentric",
        }
    }

    /// Returns `d` of the capstan equation: -1 for eccentric, +1 for concentric.
    pub fn sign(self) -> f64 {
        match self {
            Direction::Eccentric => -1.0,
            Direction::Concentric => 1.0,
        }
    }
}

/// Returns the tension in newtons that moves a load of `load_n` newtons, `T = F exp(d x)` (eq. 1 of
/// the paper).
///
/// `exponent` is the friction exponent `x = mu a`, dimensionless.
pub fn capstan_tension_n(load_n: f64, exponent: f64, direction: Direction) -> f64 {
    load_n * libm::exp(direction.sign() * exponent)
}

/// Returns the friction in newtons as the paper plots it, `D = (T_c - T_e)/2 = F sinh(x)`.
pub fn capstan_friction_n(load_n: f64, exponent: f64) -> f64 {
    load_n * libm::sinh(exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn friction_is_half_the_tension_difference(load in 0.0..100.0f64, x in 0.0..2.0f64) {
            let gap = capstan_tension_n(load, x, Direction::Concentric)
                - capstan_tension_n(load, x, Direction::Eccentric);
            prop_assert!((capstan_friction_n(load, x) - gap / 2.0).abs() <= 1e-12 * (1.0 + gap));
        }

        #[test]
        fn geometric_mean_tension_is_the_load(load in 0.1..100.0f64, x in 0.0..2.0f64) {
            let mean = (capstan_tension_n(load, x, Direction::Concentric)
                * capstan_tension_n(load, x, Direction::Eccentric)).sqrt();
            prop_assert!((mean / load - 1.0).abs() < 1e-12);
        }
    }
}
