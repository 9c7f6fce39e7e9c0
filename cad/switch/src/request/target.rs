//! Targets: a quantity of the curve and a requirement on it.

use schemars::JsonSchema;
use serde::Serialize;

use crate::config::Diagnostic;
use pinswitch_diagnostic::{codes, short_number};

/// A quantity of a friction curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "quantity", rename_all = "snake_case")]
pub enum Quantity {
    /// Load at which silicone carries half of the friction, N.
    Threshold,
    /// Friction `D` at a load, N.
    Friction {
        /// The load, N.
        load_n: f64,
    },
    /// Friction `D` at the lightest load, N.
    LowLoadFriction,
    /// Friction `D` at the heaviest load, N.
    MaxFriction,
    /// Stiffness of switching: `d ln D / d ln F` at the threshold. 1 is friction in proportion to load, as of one
    /// material; 1.5 is the value of ploughing pins; a switch has more.
    Stiffness,
}

impl Quantity {
    /// Returns the unit; `1` for a dimensionless number.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Stiffness => "1",
            _ => "N",
        }
    }

    /// Returns the range of values that can be required; no model is valid beyond it.
    pub const fn range(self) -> (f64, f64) {
        match self {
            Self::Threshold => (0.2, 1000.0),
            Self::Stiffness => (0.1, 20.0),
            _ => (1e-4, 1000.0),
        }
    }

    /// Returns the load of a friction, N; `None` for any other quantity.
    pub const fn friction_load_n(self, (lightest, heaviest): (f64, f64)) -> Option<f64> {
        match self {
            Self::Friction { load_n } => Some(load_n),
            Self::LowLoadFriction => Some(lightest),
            Self::MaxFriction => Some(heaviest),
            Self::Threshold | Self::Stiffness => None,
        }
    }
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Threshold => f.write_str("threshold"),
            Self::Friction { load_n } => write!(f, "friction at {} N", short_number(*load_n)),
            Self::LowLoadFriction => f.write_str("friction at the lightest load"),
            Self::MaxFriction => f.write_str("friction at the heaviest load"),
            Self::Stiffness => f.write_str("stiffness of switching"),
        }
    }
}

/// A requirement on a quantity. All values are above zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Requirement {
    /// No more than this.
    AtMost(f64),
    /// No less than this.
    AtLeast(f64),
    /// From the first to the second.
    Between(f64, f64),
    /// This value, with a relative tolerance of `within`.
    About {
        /// The nominal value.
        value: f64,
        /// Relative tolerance, such as 0.1 for 10 %.
        within: f64,
    },
}

impl Requirement {
    /// Returns the interval of values that meet it, both ends included.
    pub fn interval(self) -> (f64, f64) {
        match self {
            Self::AtMost(high) => (0.0, high),
            Self::AtLeast(low) => (low, f64::INFINITY),
            Self::Between(low, high) => (low, high),
            Self::About { value, within } => (value * (1.0 - within), value * (1.0 + within)),
        }
    }

    /// Whether `value` meets it.
    pub fn is_met(self, value: f64) -> bool {
        let (low, high) = self.interval();
        // Tolerates rounding: a design placed on the bound meets it.
        value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9)
    }

    /// Returns the logarithm of the ratio of `value` to the violated bound: positive above the interval, negative below
    /// it, zero inside.
    pub fn excess(self, value: f64) -> f64 {
        let (low, high) = self.interval();
        let value = value.max(1e-9);
        if self.is_met(value) {
            0.0
        } else if value > high {
            libm::log(value / high)
        } else {
            libm::log(value / low)
        }
    }

    /// Returns the bound nearest to `value`.
    pub fn nearest_bound(self, value: f64) -> f64 {
        let (low, high) = self.interval();
        if low <= 0.0
            || (high.is_finite()
                && libm::log(high / value.max(1e-9)).abs() < libm::log(low / value.max(1e-9)).abs())
        {
            high
        } else {
            low
        }
    }
}

impl std::fmt::Display for Requirement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::AtMost(high) => write!(f, "at most {}", short_number(*high)),
            Self::AtLeast(low) => write!(f, "at least {}", short_number(*low)),
            Self::Between(low, high) => {
                write!(f, "between {} and {}", short_number(*low), short_number(*high))
            }
            // Rounded: shares such as 0.15 are not exact.
            Self::About { value, within } => {
                write!(f, "about {} (within {} %)", short_number(*value), (within * 1e5).round() / 1e3)
            }
        }
    }
}

/// A quantity with a requirement on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Target {
    /// The quantity.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// The requirement.
    pub requirement: Requirement,
}

impl std::fmt::Display for Target {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let unit = if self.quantity.unit() == "N" { " N" } else { "" };
        // The unit follows the value, before the tolerance.
        let requirement = self.requirement.to_string();
        match requirement.split_once(" (") {
            Some((value, tolerance)) => write!(f, "{} {value}{unit} ({tolerance}", self.quantity),
            None => write!(f, "{} {requirement}{unit}", self.quantity),
        }
    }
}

/// Lightest and heaviest load at which a friction can be required, N.
const LOADS_N: (f64, f64) = (0.01, 1000.0);

impl Target {
    /// Checks that load and values have a magnitude that is possible for a switch.
    pub(super) fn check_magnitude(&self) -> Result<(), Diagnostic> {
        let invalid = |what: &str, value: f64, (least, most): (f64, f64)| {
            Diagnostic::new(
                codes::OUT_OF_RANGE,
                format!("'{self}': {what}{} is outside {least} to {most}", short_number(value)),
            )
            .with_help("give a value in the range")
        };
        let outside = |value: f64, (least, most): (f64, f64)| !(least..=most).contains(&value);
        if let Quantity::Friction { load_n } = self.quantity
            && outside(load_n, LOADS_N)
        {
            return Err(invalid("load ", load_n, LOADS_N));
        }
        let values = match self.requirement {
            Requirement::AtMost(value) | Requirement::AtLeast(value) | Requirement::About { value, .. } => {
                [value; 2]
            }
            Requirement::Between(low, high) => [low, high],
        };
        let range = self.quantity.range();
        match values.into_iter().find(|v| outside(*v, range)) {
            Some(value) => Err(invalid("", value, range)),
            None => Ok(()),
        }
    }

    /// Whether no value meets both targets.
    pub fn contradicts(&self, other: &Self) -> bool {
        let ((a, b), (c, d)) = (self.requirement.interval(), other.requirement.interval());
        self.quantity == other.quantity && a.max(c) > b.min(d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn requirements_include_their_bounds() {
        assert!(Requirement::AtMost(8.0).is_met(8.0) && !Requirement::AtMost(8.0).is_met(8.01));
        assert!(Requirement::AtLeast(8.0).is_met(8.0) && !Requirement::AtLeast(8.0).is_met(7.99));
        let about = Requirement::About { value: 20.0, within: 0.1 };
        assert!(about.is_met(18.0) && about.is_met(22.0) && !about.is_met(22.1));
        assert!((Requirement::AtMost(8.0).excess(8.8) - libm::log(1.1f64)).abs() < 1e-12);
        assert!((Requirement::AtLeast(8.0).excess(4.0) + libm::log(2f64)).abs() < 1e-12);
        assert_eq!(about.nearest_bound(30.0), 22.0);
    }

    #[test]
    fn contradictions_concern_one_quantity() {
        let friction = |load_n, requirement| Target { quantity: Quantity::Friction { load_n }, requirement };
        let (a, b) = (friction(50.0, Requirement::AtMost(3.0)), friction(50.0, Requirement::AtLeast(5.0)));
        assert!(a.contradicts(&b) && b.contradicts(&a));
        assert!(!a.contradicts(&friction(40.0, Requirement::AtLeast(5.0))));
        assert!(!a.contradicts(&friction(50.0, Requirement::AtLeast(2.0))));
    }

    proptest! {
        #[test]
        fn met_requirements_have_no_excess(value in 0.01..100.0f64, low in 0.1..20.0f64, wide in 0.0..20.0f64) {
            for requirement in [Requirement::AtMost(low), Requirement::AtLeast(low), Requirement::Between(low, low + wide), Requirement::About { value: low, within: 0.1 }] {
                prop_assert_eq!(requirement.is_met(value), requirement.excess(value) == 0.0);
            }
        }
    }
}
