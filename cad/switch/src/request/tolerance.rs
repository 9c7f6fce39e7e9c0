//! Manufacturing tolerances: distributions of the deviations of printed, cast and assembled parts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use pinswitch_friction::physics::{Bed, modulus_of_shore_a_mpa};

/// Number of sources, in the order of [`Tolerances::NAMES`].
pub const SOURCES: usize = 5;

/// Standard deviations of normal distributions about the configured values; `cad/doc/design.md` gives the sources.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Tolerances {
    /// Standard deviation of the diameter of the pins, mm.
    pub pin_diameter_mm: f64,
    /// Standard deviation of the diameter of the grooves, mm.
    pub groove_diameter_mm: f64,
    /// Standard deviation of the radius of the shell, mm.
    pub radius_mm: f64,
    /// Standard deviation of the thickness of the silicone, mm.
    pub layer_mm: f64,
    /// Standard deviation of the hardness of the silicone, Shore A.
    pub hardness_shore_a: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self {
            pin_diameter_mm: 0.005,
            groove_diameter_mm: 0.05,
            radius_mm: 0.1,
            layer_mm: 0.05,
            hardness_shore_a: 2.5,
        }
    }
}

impl Tolerances {
    /// Names of the sources, in order.
    pub const NAMES: [&'static str; SOURCES] =
        ["pin diameter", "groove diameter", "radius", "layer thickness", "hardness"];

    /// Returns the standard deviations in the order of [`Self::NAMES`].
    pub const fn sd(&self) -> [f64; SOURCES] {
        [self.pin_diameter_mm, self.groove_diameter_mm, self.radius_mm, self.layer_mm, self.hardness_shore_a]
    }

    /// Fields in the order of [`Self::NAMES`], for errors.
    pub const FIELDS: [&'static str; SOURCES] =
        ["pin_diameter_mm", "groove_diameter_mm", "radius_mm", "layer_mm", "hardness_shore_a"];

    /// Returns the bed of a made part: that of its configuration at `hardness_shore_a`, with deviations of `z` standard
    /// deviations.
    pub fn made(&self, bed: &Bed, hardness_shore_a: f64, z: &[f64; SOURCES]) -> Bed {
        let [pin, groove, radius, layer, hardness] = self.sd();
        let layer_mm = (bed.layer_mm + layer * z[3]).max(0.05);
        Bed {
            pin_diameter_mm: (bed.pin_diameter_mm + pin * z[0]).max(0.02),
            groove_radius_mm: (bed.groove_radius_mm + groove / 2.0 * z[1]).max(0.01),
            // The contact is on the surface of the cast layer, whose thickness deviates.
            contact_radius_mm: (bed.contact_radius_mm + radius * z[2] + layer_mm - bed.layer_mm).max(1.0),
            layer_mm,
            modulus_mpa: modulus_of_shore_a_mpa((hardness_shore_a + hardness * z[4]).clamp(1.0, 95.0)),
            ..*bed
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_without_deviations_is_nominal() {
        let bed = Bed::published();
        assert_eq!(Tolerances::default().made(&bed, 50.0, &[0.0; SOURCES]), bed);
        let thick = Tolerances::default().made(&bed, 50.0, &[0.0, 0.0, 0.0, 2.0, 0.0]);
        assert!((thick.layer_mm - 2.1).abs() < 1e-12 && (thick.contact_radius_mm - 22.1).abs() < 1e-12);
    }
}
