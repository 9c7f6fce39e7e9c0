//! The switch of the paper (eq. 4): a transition from the friction of the pins to that of the
//! silicone.

use crate::capstan::{Direction, capstan_friction_n, capstan_tension_n};
use crate::published::{self, PublishedLayout};

/// State of a switch at one load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwitchState {
    /// Load on the tendon in newtons.
    pub load_n: f64,
    /// Tension while the load is released, in newtons.
    pub eccentric_n: f64,
    /// Tension while the load is pulled, in newtons.
    pub concentric_n: f64,
    /// Friction `D` in newtons.
    pub friction_n: f64,
    /// Share of the friction that comes from the silicone, 0 to 1.
    pub silicone_share: f64,
}

/// Transition function of a device, which eq. 4 turns into tension and friction.
pub trait Switch {
    /// Returns `S` of eq. 4 at `load_n` newtons: 0 on the pins, 1 on the silicone.
    fn switched(&self, load_n: f64) -> f64;

    /// Returns the weight `w` of eq. 4, dimensionless.
    fn weight(&self) -> f64;

    /// Returns the state at `load_n` newtons over a wrap of `wrap_rad` radians: eq. 4, applied to
    /// `T - F` of each branch (`model/doc/friction-laws.md`).
    fn state(&self, load_n: f64, wrap_rad: f64) -> SwitchState {
        let (s, w) = (self.switched(load_n), self.weight());
        let (low, high) = ((1.0 + w) * (1.0 - s), (1.0 - w) * s);
        let (x_pins, x_silicone) = (published::MU_PINS * wrap_rad, published::MU_SILICONE * wrap_rad);
        let tension = |direction| {
            let rise = |x| capstan_tension_n(load_n, x, direction) - load_n;
            load_n + low * rise(x_pins) + high * rise(x_silicone)
        };
        let (from_pins, from_silicone) =
            (low * capstan_friction_n(load_n, x_pins), high * capstan_friction_n(load_n, x_silicone));
        let friction_n = from_pins + from_silicone;
        SwitchState {
            load_n,
            eccentric_n: tension(Direction::Eccentric),
            concentric_n: tension(Direction::Concentric),
            friction_n,
            silicone_share: if friction_n > 0.0 { from_silicone / friction_n } else { 0.0 },
        }
    }
}

/// Switch of a published layout, exactly as eq. 4 is printed.
///
/// ```
/// use pinswitch_friction::{PaperSwitch, Switch, published};
///
/// let three_double = PaperSwitch::new(published::LAYOUTS[1]);
/// let state = three_double.state(published::heaviest_load_n(), published::wrap_angle_rad());
/// assert_eq!(format!("{:.2}", state.friction_n), "10.01");
/// assert!(state.eccentric_n < state.load_n && state.load_n < state.concentric_n);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperSwitch {
    layout: PublishedLayout,
}

impl PaperSwitch {
    /// Creates the switch of a published layout.
    pub fn new(layout: PublishedLayout) -> Self {
        Self { layout }
    }

    /// Returns `F_r`: the load, mapped linearly from the tested range onto the interval of the
    /// layout.
    pub fn reduced_load(&self, load_n: f64) -> f64 {
        let (from, to) = self.layout.reduced_load;
        let (lightest, heaviest) = (published::lightest_load_n(), published::heaviest_load_n());
        from + (to - from) * (load_n - lightest) / (heaviest - lightest)
    }
}

impl Switch for PaperSwitch {
    fn switched(&self, load_n: f64) -> f64 {
        1.0 / (1.0 + libm::exp(self.layout.threshold - self.reduced_load(load_n)))
    }

    fn weight(&self) -> f64 {
        self.layout.weight
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `model/doc/friction-laws.md`: "D at max load" and its error, to the printed digits.
    #[test]
    fn published_table_is_reproduced() {
        let rows: Vec<_> = published::LAYOUTS
            .iter()
            .map(|l| {
                let d = PaperSwitch::new(*l)
                    .state(published::heaviest_load_n(), published::wrap_angle_rad())
                    .friction_n;
                format!("{} {d:.2} {:+.1}", l.name, (d / l.device_max_n - 1.0) * 100.0)
            })
            .collect();
        assert_eq!(rows, ["six-single 4.07 -20.2", "three-double 10.01 +3.5", "three-single 8.90 +4.7"]);
    }

    #[test]
    fn branches_agree_with_the_friction() {
        let switch = PaperSwitch::new(published::LAYOUTS[1]);
        for load in [3.0, 15.0, 30.0, 49.0] {
            let state = switch.state(load, published::wrap_angle_rad());
            let half_gap = (state.concentric_n - state.eccentric_n) / 2.0;
            assert!((half_gap - state.friction_n).abs() < 1e-12);
        }
    }

    #[test]
    fn tested_loads_map_onto_the_interval() {
        let switch = PaperSwitch::new(published::LAYOUTS[0]);
        assert!((switch.reduced_load(published::lightest_load_n()) + 2.0).abs() < 1e-12);
        assert!((switch.reduced_load(published::heaviest_load_n()) - 3.5).abs() < 1e-12);
    }
}
