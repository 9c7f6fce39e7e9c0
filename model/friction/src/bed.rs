//! The support of the tendon: dimensions and stiffness of pins, silicone and tendon.

use schemars::JsonSchema;
use serde::Serialize;

/// Part of the wrap outside the outermost pins where silicone can touch the tendon.
///
/// The paper does not describe the tendon's path there (14 to 20 degrees a side with three pins);
/// [`crate::physics::hypotheses`] compares the alternatives with the published facts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OutsidePins {
    /// None beyond the grooves of the outermost pins: free spans lead to the guide pulleys.
    Free,
    /// The span to the next groove beyond the outermost pins.
    NextGroove,
    /// The whole wrap.
    OnSilicone,
}

/// Dimensions and stiffness of the support under the tendon. Lengths are in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Bed {
    /// Radius of the silicone's surface.
    pub contact_radius_mm: f64,
    /// Outer radius of the coated tendon.
    pub tendon_radius_mm: f64,
    /// Diameter of a pin.
    pub pin_diameter_mm: f64,
    /// Radius of the grooves in which the pins rest.
    pub groove_radius_mm: f64,
    /// Thickness of the silicone.
    pub layer_mm: f64,
    /// Width of the silicone along the pins.
    pub layer_width_mm: f64,
    /// Young's modulus of the silicone in MPa; only its ratio to that of the published bed matters.
    pub modulus_mpa: f64,
    /// Foundation stiffness of the published bed, force per length and depth, in N/mm²;
    /// [`Bed::stiffness_n_mm2`] scales it to this bed. The published maxima do not determine it:
    /// from 50 to 1000 they change by less than their scatter.
    pub foundation_n_mm2: f64,
    /// Bending stiffness of the published tendon in N mm², 0 for a string;
    /// [`Bed::tendon_bending_n_mm2`] scales it to this bed.
    pub bending_n_mm2: f64,
    /// `b` of the pin's support, `N = N0 (1 + b) x/(1 + b x)` at a sinking of `x h0`: a hyperbolic
    /// p-y curve, as for a laterally loaded pile in soft ground. 0 is a linear spring.
    pub softening: f64,
    /// Part of the wrap outside the pins where silicone can touch the tendon.
    pub outside: OutsidePins,
}

/// Bending stiffness of the published tendon, with which three-double begins to switch at the
/// printed 15.31 N (a test checks it). The tube of the coating alone, 1.2 to 1.7 mm of PA12 at 1.4
/// GPa, would have 430 N mm² if perfectly bonded; slip of the strands and creep of the coating
/// reduce it.
const BENDING_N_MM2: f64 = 95.0;

/// Largest bending stiffness of a tendon, as a multiple of `T Rc^2`.
const MAX_BENDING: f64 = 0.5;

/// Returns Young's modulus in MPa of rubber of a Shore A hardness (Gent 1958,
/// doi:10.5254/1.3542351).
pub fn modulus_of_shore_a_mpa(shore_a: f64) -> f64 {
    0.0981 * (56.0 + 7.62336 * shore_a) / (0.137505 * (254.0 - 2.54 * shore_a))
}

/// Returns the Shore A hardness of rubber with this Young's modulus: the inverse of
/// [`modulus_of_shore_a_mpa`].
pub fn shore_a_of_modulus_mpa(modulus_mpa: f64) -> f64 {
    let scaled = modulus_mpa * 0.137505 / 0.0981;
    (254.0 * scaled - 56.0) / (7.62336 + 2.54 * scaled)
}

impl Bed {
    /// Returns the bed of the paper (`model/doc/friction-laws.md`): 2 mm of silicone on a shell of
    /// 20 mm radius, pins 0.94 mm in diameter, and a tendon 1.7 mm in diameter over its coating.
    pub fn published() -> Self {
        Self {
            contact_radius_mm: 22.0,
            tendon_radius_mm: 0.85,
            pin_diameter_mm: 0.94,
            groove_radius_mm: 0.5,
            layer_mm: 2.0,
            layer_width_mm: 13.6,
            modulus_mpa: modulus_of_shore_a_mpa(50.0),
            foundation_n_mm2: 200.0,
            bending_n_mm2: BENDING_N_MM2,
            softening: 2.0,
            outside: OutsidePins::OnSilicone,
        }
    }

    /// Returns `Rc`, the radius of the tendon's axis when its underside is on the undeformed
    /// silicone.
    pub fn axis_radius_mm(&self) -> f64 {
        self.contact_radius_mm + self.tendon_radius_mm
    }

    /// Returns `h0`, the height of a resting pin's top over the silicone. It is at least a
    /// thousandth of the pin's diameter, so that the support of a pin below the surface is small
    /// but defined.
    pub fn protrusion_mm(&self) -> f64 {
        (self.pin_diameter_mm - self.groove_radius_mm).max(1e-3 * self.pin_diameter_mm)
    }

    /// Returns the force that sinks a pin flush, relative to the published bed: a strip of the
    /// pin's width on a layer, `E d w h0/t`. This scaling is assumed, not measured.
    pub fn flush_force_ratio(&self) -> f64 {
        let strip =
            |b: &Self| b.modulus_mpa * b.pin_diameter_mm * b.layer_width_mm * b.protrusion_mm() / b.layer_mm;
        strip(self) / strip(&Self::published())
    }

    /// Returns `kappa` relative to the published bed.
    ///
    /// The ploughing coefficient of a cylinder is proportional to the half width `b` of the contact
    /// over its radius (Greenwood & Tabor 1958, doi:10.1088/0370-1328/71/6/312). By Hertz,
    /// `b^2 = 4 N' r/(pi E)` under a line load `N'`, and the pin's force spreads over a length
    /// proportional to the tendon's radius. So `mu` is proportional to
    /// `sqrt(N/(E r_pin r_tendon))`, and `kappa` to the inverse root of both radii, which satisfies
    /// similarity. The coating is assumed to have the modulus `E` of the published tendon.
    pub fn ploughing_ratio(&self) -> f64 {
        let radii = |b: &Self| b.pin_diameter_mm * b.tendon_radius_mm;
        (radii(&Self::published()) / radii(self)).sqrt()
    }

    /// Returns the foundation stiffness of this bed in N/mm²: a strip as wide as the tendon on a
    /// layer, `E w/t`.
    pub fn stiffness_n_mm2(&self) -> f64 {
        let strip = |b: &Self| b.modulus_mpa * b.tendon_radius_mm / b.layer_mm;
        self.foundation_n_mm2 * strip(self) / strip(&Self::published())
    }

    /// Returns the bending stiffness of the tendon in N mm² under a tension of `tension_n` newtons.
    ///
    /// It scales as a round section of the same build, `E I ~ r^4`, and is limited at low tension,
    /// where a stiff tendon would lift off the pulley: the strands of a rope slip under bending
    /// (Papailiou 1997, doi:10.1109/61.634188). At the published loads the limit reduces it by 1 to
    /// 11 %.
    pub fn tendon_bending_n_mm2(&self, tension_n: f64) -> f64 {
        let whole = self.bending_n_mm2 * (self.tendon_radius_mm / Self::published().tendon_radius_mm).powi(4);
        whole / (1.0 + whole / (MAX_BENDING * tension_n * self.axis_radius_mm().powi(2)))
    }

    /// Returns the derivative of [`Bed::tendon_bending_n_mm2`] with respect to the logarithm of the
    /// tension, from the bending stiffness at that tension.
    pub(crate) fn tendon_bending_slope_n_mm2(&self, bending_n_mm2: f64, tension_n: f64) -> f64 {
        bending_n_mm2 * bending_n_mm2 / (MAX_BENDING * tension_n * self.axis_radius_mm().powi(2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_bed_is_the_reference() {
        let bed = Bed::published();
        assert!((bed.axis_radius_mm() - 22.85).abs() < 1e-12);
        assert!((bed.protrusion_mm() - 0.44).abs() < 1e-12);
        assert_eq!(
            (bed.flush_force_ratio(), bed.ploughing_ratio(), bed.stiffness_n_mm2()),
            (1.0, 1.0, 200.0)
        );
    }

    /// By Gent's table, 50 Shore A is about 2.5 MPa.
    #[test]
    fn harder_rubber_is_stiffer() {
        assert!((modulus_of_shore_a_mpa(50.0) - 2.5).abs() < 0.2);
        assert!(modulus_of_shore_a_mpa(60.0) > modulus_of_shore_a_mpa(50.0));
    }
}
