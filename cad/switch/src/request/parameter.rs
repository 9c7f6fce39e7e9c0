//! The continuous parameters that a search may vary.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::config::Configuration;

/// A parameter that may vary; the names are those of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Parameter {
    /// Angle between neighbouring grooves, degrees: `segment.span_deg` over `segment.grooves`.
    PitchDeg,
    /// Thickness of the silicone, `silicone.thickness_mm`.
    LayerMm,
    /// Hardness of the silicone, `silicone.hardness_shore_a`.
    HardnessShoreA,
    /// Diameter of the pins, `pins.diameter_mm`; the grooves keep their clearance around the pin.
    PinDiameterMm,
    /// Radius of the shell, `shell.outer_radius_mm`.
    RadiusMm,
    /// Width of the shell, `shell.width_mm`.
    WidthMm,
    /// Wrap angle of the tendon, `layout.wrap_angle_deg`. Grooves are added to a sector that is too
    /// short for it.
    WrapDeg,
}

impl Parameter {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::PitchDeg,
        Self::LayerMm,
        Self::HardnessShoreA,
        Self::PinDiameterMm,
        Self::RadiusMm,
        Self::WidthMm,
        Self::WrapDeg,
    ];

    /// Returns its name in a request.
    pub const fn name(self) -> &'static str {
        match self {
            Self::PitchDeg => "pitch_deg",
            Self::LayerMm => "layer_mm",
            Self::HardnessShoreA => "hardness_shore_a",
            Self::PinDiameterMm => "pin_diameter_mm",
            Self::RadiusMm => "radius_mm",
            Self::WidthMm => "width_mm",
            Self::WrapDeg => "wrap_deg",
        }
    }

    /// Returns the parameter of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|p| p.name() == name)
    }

    /// Returns the path of the parameter of a configuration that it sets.
    pub const fn field(self) -> &'static str {
        match self {
            Self::PitchDeg => "segment.span_deg",
            Self::LayerMm => "silicone.thickness_mm",
            Self::HardnessShoreA => "silicone.hardness_shore_a",
            Self::PinDiameterMm => "pins.diameter_mm",
            Self::RadiusMm => "shell.outer_radius_mm",
            Self::WidthMm => "shell.width_mm",
            Self::WrapDeg => "layout.wrap_angle_deg",
        }
    }

    /// Returns the range in which it varies by default: values that can be printed, cast or bought, at which the
    /// assumptions of the physics are extended by a factor of two at most (`cad/doc/design.md`).
    pub const fn default_range(self) -> (f64, f64) {
        match self {
            Self::PitchDeg => (4.0, 9.0),
            Self::LayerMm => (1.2, 4.0),
            Self::HardnessShoreA => (20.0, 70.0),
            Self::PinDiameterMm => (0.6, 2.0),
            Self::RadiusMm => (14.0, 40.0),
            Self::WidthMm => (10.0, 24.0),
            Self::WrapDeg => (40.0, 120.0),
        }
    }

    /// Returns the range that a configuration accepts.
    pub const fn hard_range(self) -> (f64, f64) {
        match self {
            Self::PitchDeg => (0.5, 90.0),
            Self::LayerMm => (0.3, 10.0),
            Self::HardnessShoreA => (10.0, 80.0),
            Self::PinDiameterMm => (0.1, 5.0),
            Self::RadiusMm => (5.0, 150.0),
            Self::WidthMm => (2.0, 100.0),
            Self::WrapDeg => (1.0, 340.0),
        }
    }

    /// Returns the step to which values are rounded: finer ones cannot be printed, cast or measured.
    pub(crate) const fn step(self) -> f64 {
        match self {
            Self::PitchDeg | Self::LayerMm | Self::PinDiameterMm => 0.01,
            Self::RadiusMm | Self::WidthMm | Self::WrapDeg => 0.1,
            Self::HardnessShoreA => 0.5,
        }
    }

    /// Rounds a value to the step, within `range`.
    pub fn rounded(self, value: f64, range: (f64, f64)) -> f64 {
        let per_unit = (1.0 / self.step()).round();
        // Divided, since 0.01 is not exact: 227 / 100 is the number nearest to 2.27.
        ((value * per_unit).round() / per_unit).clamp(range.0, range.1.max(range.0))
    }

    /// Returns its value in a configuration.
    pub fn value(self, c: &Configuration) -> f64 {
        match self {
            Self::PitchDeg => c.segment.span_deg / c.segment.grooves as f64,
            Self::LayerMm => c.silicone.thickness_mm,
            Self::HardnessShoreA => c.silicone.hardness_shore_a,
            Self::PinDiameterMm => c.pins.diameter_mm,
            Self::RadiusMm => c.shell.outer_radius_mm,
            Self::WidthMm => c.shell.width_mm,
            Self::WrapDeg => c.layout.wrap_angle_deg,
        }
    }

    /// Sets it, with the dependent parameters. The rules may refuse the result.
    pub fn set(self, c: &mut Configuration, value: f64) {
        match self {
            Self::PitchDeg => c.segment.span_deg = (value * c.segment.grooves as f64 * 1e6).round() / 1e6,
            Self::LayerMm => c.silicone.thickness_mm = value,
            Self::HardnessShoreA => c.silicone.hardness_shore_a = value,
            Self::PinDiameterMm => {
                // The groove follows the pin: the clearance between them stays.
                let play_mm = c.segment.groove_radius_mm - c.pins.diameter_mm / 2.0;
                c.pins.diameter_mm = value;
                c.segment.groove_radius_mm = ((value / 2.0 + play_mm) * 1e4).round() / 1e4;
            }
            Self::RadiusMm => c.shell.outer_radius_mm = value,
            Self::WidthMm => c.shell.width_mm = value,
            Self::WrapDeg => {
                c.layout.wrap_angle_deg = value;
                grow_sector(c);
            }
        }
    }
}

/// Adds grooves at both ends of the sector until it spans the wrap; the pins keep their positions and are renumbered.
fn grow_sector(c: &mut Configuration) {
    const MOST_GROOVES: usize = 60;
    let pitch_deg = c.segment.span_deg / c.segment.grooves as f64;
    while c.segment.span_deg < c.layout.wrap_angle_deg && c.segment.grooves + 2 <= MOST_GROOVES {
        c.segment.grooves += 2;
        c.segment.span_deg = (pitch_deg * c.segment.grooves as f64 * 1e6).round() / 1e6;
        c.layout.pins.iter_mut().for_each(|pin| *pin += 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::assign;

    #[test]
    fn values_are_set_and_read_back() {
        for p in Parameter::ALL {
            assert_eq!(Parameter::from_name(p.name()), Some(p));
            let mut c = Configuration::default();
            let (low, high) = p.default_range();
            for value in [low, high] {
                p.set(&mut c, value);
                assert!((p.value(&c) - value).abs() < 1e-6, "{}", p.name());
            }
            let (least, most) = p.hard_range();
            assert!(least <= low && high <= most);
            // The hard ranges are those of the configuration; the pitch has none of its own.
            if p != Parameter::PitchDeg {
                assert!(assign(&mut c, &format!("{}={most:?}", p.field())).is_ok());
                assert!(assign(&mut c, &format!("{}={:?}", p.field(), most * 1.01)).is_err());
                assert!(assign(&mut c, &format!("{}={:?}", p.field(), least * 0.99)).is_err());
            }
        }
    }

    #[test]
    fn the_sector_grows_around_its_pins() {
        let mut c = Configuration::default();
        c.layout.pins = vec![5, 8, 11];
        let pitch = Parameter::PitchDeg.value(&c);
        Parameter::WrapDeg.set(&mut c, 120.0);
        assert_eq!((c.segment.grooves, &c.layout.pins[..]), (21, &[8, 11, 14][..]));
        assert!(c.segment.span_deg >= 120.0 && (Parameter::PitchDeg.value(&c) - pitch).abs() < 1e-6);
    }

    #[test]
    fn the_groove_follows_the_pin() {
        let mut c = Configuration::default();
        Parameter::PinDiameterMm.set(&mut c, 1.5);
        assert!((c.segment.groove_radius_mm - 0.78).abs() < 1e-9);
    }
}
