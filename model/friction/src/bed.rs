//! What carries the tendon: dimensions and stiffness of pins, silicone and tendon.

use serde::Serialize;

/// Where, outside the outermost pins, the silicone can touch the tendon. The paper does not describe the tendon's path
/// there (14 to 20 degrees a side with three pins); [`crate::physics::hypotheses`] weighs what its own facts say.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OutsidePins {
    /// Nowhere beyond the grooves of the outermost pins: free spans lead to the guide pulleys.
    Free,
    /// As far as the next groove beyond the outermost pins.
    NextGroove,
    /// Over the whole wrap.
    OnSilicone,
}

/// Dimensions and stiffness of what the tendon lies on. Lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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
    /// Young's modulus of the silicone in MPa; only its ratio to the published bed's counts.
    pub modulus_mpa: f64,
    /// Foundation stiffness of the published bed, force per length and depth, in N/mm²; [`Bed::stiffness_n_mm2`] is this
    /// bed's. The published maxima do not resolve it: from 50 to 1000 they change by less than their scatter.
    pub foundation_n_mm2: f64,
    /// Bending stiffness of the published tendon in N mm², 0 for a string; [`Bed::tendon_bending_n_mm2`] is this bed's.
    pub bending_n_mm2: f64,
    /// `b` of the pin's support, `N = N0 (1 + b) x/(1 + b x)` at sinking `x h0`: a hyperbolic p-y curve, as of a pile
    /// pushed sideways into soft ground. 0 is a linear spring.
    pub softening: f64,
    /// Where the silicone touches outside the pins.
    pub outside: OutsidePins,
}

/// Bending stiffness of the published tendon: puts the onset of three-double at the printed 15.31 N (a test). The
/// coating's tube alone, 1.2 to 1.7 mm of PA12 at 1.4 GPa, would have 430 N mm² when perfectly bonded; strands that slip
/// and a coating that creeps leave less.
const BENDING_N_MM2: f64 = 95.0;

/// Bending stiffness over `T Rc^2` at which a tendon gives way.
const MOST_BENDING: f64 = 0.5;

/// Young's modulus in MPa of rubber of this hardness (Gent 1958, doi:10.5254/1.3542351).
pub fn modulus_of_shore_a_mpa(shore_a: f64) -> f64 {
    0.0981 * (56.0 + 7.62336 * shore_a) / (0.137505 * (254.0 - 2.54 * shore_a))
}

/// Hardness in Shore A of rubber of this Young's modulus: the inverse of [`modulus_of_shore_a_mpa`].
pub fn shore_a_of_modulus_mpa(modulus_mpa: f64) -> f64 {
    let scaled = modulus_mpa * 0.137505 / 0.0981;
    (254.0 * scaled - 56.0) / (7.62336 + 2.54 * scaled)
}

impl Bed {
    /// The bed of the paper (`model/doc/friction-laws.md`): 2 mm of silicone on a shell of 20 mm, pins of 0.94 mm,
    /// tendon of 1.7 mm over its coating.
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

    /// `Rc`: radius of the tendon's axis when its underside lies on the undeformed silicone.
    pub fn axis_radius_mm(&self) -> f64 {
        self.contact_radius_mm + self.tendon_radius_mm
    }

    /// `h0`: height of a resting pin's top over the silicone. A pin that lies below its surface counts as a hair above
    /// it, a thousandth of its diameter: it carries next to nothing.
    pub fn protrusion_mm(&self) -> f64 {
        (self.pin_diameter_mm - self.groove_radius_mm).max(1e-3 * self.pin_diameter_mm)
    }

    /// Force that sinks a pin flush, against the published bed: a strip of the pin's width on a layer, `E d w h0/t`.
    /// An assumption for beds that nobody measured.
    pub fn flush_force_ratio(&self) -> f64 {
        let strip =
            |b: &Self| b.modulus_mpa * b.pin_diameter_mm * b.layer_width_mm * b.protrusion_mm() / b.layer_mm;
        strip(self) / strip(&Self::published())
    }

    /// `kappa` against the published bed. A cylinder ploughs with a coefficient that follows the half width `b` of the
    /// contact over its radius (Greenwood & Tabor 1958, doi:10.1088/0370-1328/71/6/312). By Hertz `b^2 = 4 N' r/(pi E)`
    /// under a line load `N'`; the pin's force spreads over a length that goes with the tendon's radius. So `mu` goes
    /// with `sqrt(N/(E r_pin r_tendon))`, and `kappa` with the root of one over both radii: a dimensionless coefficient,
    /// as similarity asks for. The coating's modulus `E` is taken as the published tendon's.
    pub fn ploughing_ratio(&self) -> f64 {
        let radii = |b: &Self| b.pin_diameter_mm * b.tendon_radius_mm;
        (radii(&Self::published()) / radii(self)).sqrt()
    }

    /// Stiffness of this bed's foundation in N/mm²: a strip as wide as the tendon on a layer, `E w/t`.
    pub fn stiffness_n_mm2(&self) -> f64 {
        let strip = |b: &Self| b.modulus_mpa * b.tendon_radius_mm / b.layer_mm;
        self.foundation_n_mm2 * strip(self) / strip(&Self::published())
    }

    /// Bending stiffness of this bed's tendon under a tension of `tension_n` newtons, in N mm²: a round section of the
    /// same build, `E I ~ r^4`, that gives way where it would stand off the pulley. A rope's strands slip under bending
    /// (Papailiou 1997, doi:10.1109/61.634188), and the bending of a tendon that is light against `EI/Rc^2` is not small;
    /// at the published loads this takes off 1 to 11 %.
    pub fn tendon_bending_n_mm2(&self, tension_n: f64) -> f64 {
        let whole = self.bending_n_mm2 * (self.tendon_radius_mm / Self::published().tendon_radius_mm).powi(4);
        whole / (1.0 + whole / (MOST_BENDING * tension_n * self.axis_radius_mm().powi(2)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_bed_is_its_own_reference() {
        let bed = Bed::published();
        assert!((bed.axis_radius_mm() - 22.85).abs() < 1e-12);
        assert!((bed.protrusion_mm() - 0.44).abs() < 1e-12);
        assert_eq!(
            (bed.flush_force_ratio(), bed.ploughing_ratio(), bed.stiffness_n_mm2()),
            (1.0, 1.0, 200.0)
        );
    }

    /// Gent's table: 50 Shore A is about 2.5 MPa.
    #[test]
    fn harder_rubber_is_stiffer() {
        assert!((modulus_of_shore_a_mpa(50.0) - 2.5).abs() < 0.2);
        assert!(modulus_of_shore_a_mpa(60.0) > modulus_of_shore_a_mpa(50.0));
    }
}
