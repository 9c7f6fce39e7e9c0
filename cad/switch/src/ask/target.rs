//! One target: a quantity of the curve, and what is wanted of it.

use serde::Serialize;

use super::phrase::short;

/// What a target is about.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "quantity", rename_all = "snake_case")]
pub enum Quantity {
    /// Load at which silicone makes half of the friction, N.
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
    /// material; 1.5 is ploughing pins; more is a switch.
    Stiffness,
}

impl Quantity {
    /// Its unit; `1` for a plain number.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Stiffness => "1",
            _ => "N",
        }
    }

    /// The values that can be asked of it: no model says anything beyond.
    pub const fn range(self) -> (f64, f64) {
        match self {
            Self::Threshold => (0.2, 1000.0),
            Self::Stiffness => (0.1, 20.0),
            _ => (1e-4, 1000.0),
        }
    }

    /// The load at which it is a friction, N, if it is one.
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
            Self::Friction { load_n } => write!(f, "friction at {} N", short(*load_n)),
            Self::LowLoadFriction => f.write_str("friction at the lightest load"),
            Self::MaxFriction => f.write_str("friction at the heaviest load"),
            Self::Stiffness => f.write_str("stiffness of switching"),
        }
    }
}

/// What is wanted of a quantity. All values are above zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Wish {
    /// No more than this.
    AtMost(f64),
    /// No less than this.
    AtLeast(f64),
    /// From the first to the second.
    Between(f64, f64),
    /// This, by a share of `within` more or less.
    About {
        /// The value in the middle.
        value: f64,
        /// Share, such as 0.1 for 10 %.
        within: f64,
    },
}

impl Wish {
    /// The values that meet it, both ends included.
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
        // A hair, so that a design that was put on the bound is not refused for the last digit.
        value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9)
    }

    /// How far `value` lies outside, as a logarithm of the ratio to the bound: positive above, negative below, zero
    /// inside.
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

    /// The bound that is nearest to `value`.
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

impl std::fmt::Display for Wish {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::AtMost(high) => write!(f, "at most {}", short(*high)),
            Self::AtLeast(low) => write!(f, "at least {}", short(*low)),
            Self::Between(low, high) => write!(f, "between {} and {}", short(*low), short(*high)),
            // Rounded, since 0.1 of a percentage is not exact.
            Self::About { value, within } => {
                write!(f, "about {} (within {} %)", short(*value), (within * 1e5).round() / 1e3)
            }
        }
    }
}

/// A quantity and what is wanted of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Target {
    /// What it is about.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// What is wanted.
    pub wish: Wish,
}

impl std::fmt::Display for Target {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let unit = if self.quantity.unit() == "N" { " N" } else { "" };
        // The unit stands with the value, before what is said of its width.
        let wish = self.wish.to_string();
        match wish.split_once(" (") {
            Some((value, width)) => write!(f, "{} {value}{unit} ({width}", self.quantity),
            None => write!(f, "{} {wish}{unit}", self.quantity),
        }
    }
}

/// Lightest and heaviest load of a friction that can be asked for, N.
const LOADS_N: (f64, f64) = (0.01, 1000.0);

impl Target {
    /// Checks that load and values are of a magnitude that a switch can have.
    pub(super) fn check_magnitude(&self) -> Result<(), String> {
        let outside = |value: f64, (least, most): (f64, f64)| !(least..=most).contains(&value);
        if let Quantity::Friction { load_n } = self.quantity
            && outside(load_n, LOADS_N)
        {
            let (least, most) = LOADS_N;
            return Err(format!(
                "'{self}': a load of {} N is outside {least} to {most} N; give a load within",
                short(load_n)
            ));
        }
        let values = match self.wish {
            Wish::AtMost(value) | Wish::AtLeast(value) | Wish::About { value, .. } => [value; 2],
            Wish::Between(low, high) => [low, high],
        };
        let (least, most) = self.quantity.range();
        match values.into_iter().find(|v| outside(*v, (least, most))) {
            Some(value) => {
                Err(format!("'{self}': {} is outside {least} to {most}; give a value within", short(value)))
            }
            None => Ok(()),
        }
    }

    /// Whether no value can meet both.
    pub fn contradicts(&self, other: &Self) -> bool {
        let ((a, b), (c, d)) = (self.wish.interval(), other.wish.interval());
        self.quantity == other.quantity && a.max(c) > b.min(d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_wish_is_met_up_to_its_bounds() {
        assert!(Wish::AtMost(8.0).is_met(8.0) && !Wish::AtMost(8.0).is_met(8.01));
        assert!(Wish::AtLeast(8.0).is_met(8.0) && !Wish::AtLeast(8.0).is_met(7.99));
        let about = Wish::About { value: 20.0, within: 0.1 };
        assert!(about.is_met(18.0) && about.is_met(22.0) && !about.is_met(22.1));
        assert!((Wish::AtMost(8.0).excess(8.8) - libm::log(1.1f64)).abs() < 1e-12);
        assert!((Wish::AtLeast(8.0).excess(4.0) + libm::log(2f64)).abs() < 1e-12);
        assert_eq!(about.nearest_bound(30.0), 22.0);
    }

    #[test]
    fn contradictions_are_of_one_quantity() {
        let friction = |load_n, wish| Target { quantity: Quantity::Friction { load_n }, wish };
        let (a, b) = (friction(50.0, Wish::AtMost(3.0)), friction(50.0, Wish::AtLeast(5.0)));
        assert!(a.contradicts(&b) && b.contradicts(&a));
        assert!(!a.contradicts(&friction(40.0, Wish::AtLeast(5.0))));
        assert!(!a.contradicts(&friction(50.0, Wish::AtLeast(2.0))));
    }

    proptest! {
        #[test]
        fn what_meets_a_wish_exceeds_it_by_nothing(value in 0.01..100.0f64, low in 0.1..20.0f64, wide in 0.0..20.0f64) {
            for wish in [Wish::AtMost(low), Wish::AtLeast(low), Wish::Between(low, low + wide), Wish::About { value: low, within: 0.1 }] {
                prop_assert_eq!(wish.is_met(value), wish.excess(value) == 0.0);
            }
        }
    }
}
