//! Curves without bands, and the values of the target quantities.

use pinswitch_friction::FrictionCurve;

use crate::request::Quantity;

/// Half of the logarithm of the ratio of loads over which the stiffness is computed: the curve from
/// 15 % below to 15 % above the threshold. A narrower range shows the mesh of the physics, and a
/// wider one cuts off the knee.
const STIFFNESS_HALF_SPAN: f64 = 0.14;

/// Friction and share of the silicone at ascending loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Loads, N, ascending.
    pub load_n: Vec<f64>,
    /// Friction, N.
    pub friction_n: Vec<f64>,
    /// Share of the friction that silicone carries.
    pub silicone_share: Vec<f64>,
}

/// The threshold of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switching {
    /// Load at which silicone carries half of the friction, N. If no load reaches this share, an
    /// extrapolated load that is monotonic in the share at the end of the curve.
    pub threshold_n: f64,
    /// Whether the threshold is within the loads of the curve.
    pub is_found: bool,
}

impl From<&FrictionCurve> for Curve {
    fn from(curve: &FrictionCurve) -> Self {
        Self {
            load_n: curve.load_n.clone(),
            friction_n: curve.friction_n.clone(),
            silicone_share: curve.silicone_share.clone(),
        }
    }
}

impl Curve {
    /// Returns the friction at `load_n`, interpolated linearly in logarithms.
    pub fn friction_at(&self, load_n: f64) -> f64 {
        interpolate(&self.load_n, &self.friction_n, load_n)
    }

    /// Returns the threshold.
    pub fn switching(&self) -> Switching {
        let share = &self.silicone_share;
        let result = |threshold_n, is_found| Switching { threshold_n, is_found };
        let (Some(first), Some(last)) = (share.first(), share.last()) else { return result(1.0, false) };
        let (lightest, heaviest) = (self.load_n[0], self.load_n[self.load_n.len() - 1]);
        if *first >= 0.5 {
            return result(lightest * 0.5 / first, false);
        }
        match share.iter().position(|s| *s >= 0.5) {
            Some(i) => {
                let part = (0.5 - share[i - 1]) / (share[i] - share[i - 1]);
                result(self.load_n[i - 1] * libm::pow(self.load_n[i] / self.load_n[i - 1], part), true)
            }
            None => result(heaviest * 0.5 / last.max(0.05), false),
        }
    }

    /// Returns the value of `quantity`; `range_n` contains the lightest and the heaviest load.
    pub fn value(&self, quantity: Quantity, range_n: (f64, f64)) -> f64 {
        match quantity {
            Quantity::Threshold => self.switching().threshold_n,
            Quantity::Friction { load_n } => self.friction_at(load_n),
            Quantity::LowLoadFriction => self.friction_at(range_n.0),
            Quantity::MaxFriction => self.friction_at(range_n.1),
            Quantity::Stiffness => self.stiffness(self.switching().threshold_n),
        }
    }

    /// Returns `d ln D / d ln F` around `load_n`.
    fn stiffness(&self, load_n: f64) -> f64 {
        let (first, last) = (self.load_n[0], self.load_n[self.load_n.len() - 1]);
        let low = (load_n * libm::exp(-STIFFNESS_HALF_SPAN)).clamp(first, last);
        let high = (load_n * libm::exp(STIFFNESS_HALF_SPAN)).clamp(first, last);
        if high <= low * 1.0001 {
            return 1.0;
        }
        libm::log(self.friction_at(high) / self.friction_at(low)) / libm::log(high / low)
    }

    /// Returns the curve with the friction at each load multiplied by `exp(error)`.
    #[must_use]
    pub fn scaled(mut self, errors: impl Iterator<Item = f64>) -> Self {
        self.friction_n.iter_mut().zip(errors).for_each(|(d, error)| *d *= libm::exp(error));
        self
    }
}

/// Returns `column` at `load_n`, interpolated linearly in the logarithms of both, and constant
/// beyond the ends.
fn interpolate(loads_n: &[f64], column: &[f64], load_n: f64) -> f64 {
    let i = loads_n.partition_point(|l| *l < load_n);
    let Some(last) = loads_n.len().checked_sub(1) else { return 0.0 };
    if i == 0 || i > last {
        return column[i.min(last)];
    }
    let (l0, l1, c0, c1) = (loads_n[i - 1], loads_n[i], column[i - 1].max(1e-9), column[i].max(1e-9));
    if load_n == l1 {
        return column[i];
    }
    c0 * libm::pow(c1 / c0, libm::log(load_n / l0) / libm::log(l1 / l0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> Curve {
        let load_n: Vec<f64> = (0..40).map(|i| 2.0 * 1.1f64.powi(i)).collect();
        Curve {
            friction_n: load_n.iter().map(|l| 0.01 * libm::pow(*l, 1.5)).collect(),
            silicone_share: load_n.iter().map(|l| l / (l + 20.0)).collect(),
            load_n,
        }
    }

    #[test]
    fn quantities_of_a_power_law() {
        let c = curve();
        assert!((c.friction_at(33.3) - 0.01 * libm::pow(33.3f64, 1.5)).abs() < 1e-9);
        let switching = c.switching();
        assert!(switching.is_found && (switching.threshold_n - 20.0).abs() < 0.05, "{switching:?}");
        assert!((c.value(Quantity::Stiffness, (2.0, 50.0)) - 1.5).abs() < 1e-6);
    }

    #[test]
    fn a_threshold_beyond_the_loads_lies_beyond_them() {
        let mut c = curve();
        c.silicone_share.iter_mut().for_each(|s| *s *= 0.3);
        let after = c.switching();
        assert!(!after.is_found && after.threshold_n > c.load_n[39]);
        c.silicone_share.iter_mut().for_each(|s| *s = 0.9);
        let before = c.switching();
        assert!(!before.is_found && before.threshold_n < c.load_n[0]);
    }
}
