//! Dimensions of a made switch: those of its contact, with the position and the height of each pin.

use crate::bed::Bed;
use crate::contact::Contact;

/// Dimension of a switch on which its friction depends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// Wrap angle, rad.
    Wrap,
    /// Radius of the silicone's surface, mm.
    ContactRadius,
    /// Outer radius of the coated tendon, mm.
    TendonRadius,
    /// Diameter of all pins, mm.
    PinDiameter,
    /// Radius, and depth, of all grooves in the silicone, mm.
    GrooveRadius,
    /// Thickness of the silicone, mm, with the radius of its surface fixed.
    Layer,
    /// Width of the silicone along the pins, mm.
    LayerWidth,
    /// Young's modulus of the silicone, MPa.
    Modulus,
    /// Angle of one pin, by its index among all pins, rad.
    PinAngle(usize),
    /// Height of one pin over the silicone, by its index among all pins, mm.
    PinHeight(usize),
}

/// Dimensions of a made switch.
#[derive(Clone, Debug, PartialEq)]
pub struct MadeDimensions {
    /// Wrap angle, rad.
    pub wrap_rad: f64,
    /// Dimensions that all pins share.
    pub bed: Bed,
    /// Angle of each pin, rad, in the order of the contact's pins.
    pub pin_angles_rad: Vec<f64>,
    /// Deviation of the height of each pin from that of the bed, mm.
    pub pin_heights_mm: Vec<f64>,
}

impl MadeDimensions {
    /// Returns the nominal dimensions of `contact`.
    pub fn nominal(contact: &Contact) -> Self {
        let pin_angles_rad = contact.all_pins().angles_rad().to_vec();
        Self {
            wrap_rad: contact.wrap_rad(),
            bed: *contact.bed(),
            pin_heights_mm: vec![0.0; pin_angles_rad.len()],
            pin_angles_rad,
        }
    }

    /// Returns a dimension; zero for a pin that does not exist.
    pub fn get(&self, dimension: Dimension) -> f64 {
        let of_pin = |all: &[f64], pin: usize| all.get(pin).copied().unwrap_or_default();
        match dimension {
            Dimension::Wrap => self.wrap_rad,
            Dimension::ContactRadius => self.bed.contact_radius_mm,
            Dimension::TendonRadius => self.bed.tendon_radius_mm,
            Dimension::PinDiameter => self.bed.pin_diameter_mm,
            Dimension::GrooveRadius => self.bed.groove_radius_mm,
            Dimension::Layer => self.bed.layer_mm,
            Dimension::LayerWidth => self.bed.layer_width_mm,
            Dimension::Modulus => self.bed.modulus_mpa,
            Dimension::PinAngle(pin) => of_pin(&self.pin_angles_rad, pin),
            Dimension::PinHeight(pin) => of_pin(&self.pin_heights_mm, pin),
        }
    }

    /// Adds `by` to a dimension.
    pub fn add(&mut self, dimension: Dimension, by: f64) {
        let value = match dimension {
            Dimension::Wrap => Some(&mut self.wrap_rad),
            Dimension::ContactRadius => Some(&mut self.bed.contact_radius_mm),
            Dimension::TendonRadius => Some(&mut self.bed.tendon_radius_mm),
            Dimension::PinDiameter => Some(&mut self.bed.pin_diameter_mm),
            Dimension::GrooveRadius => Some(&mut self.bed.groove_radius_mm),
            Dimension::Layer => Some(&mut self.bed.layer_mm),
            Dimension::LayerWidth => Some(&mut self.bed.layer_width_mm),
            Dimension::Modulus => Some(&mut self.bed.modulus_mpa),
            Dimension::PinAngle(pin) => self.pin_angles_rad.get_mut(pin),
            Dimension::PinHeight(pin) => self.pin_heights_mm.get_mut(pin),
        };
        if let Some(value) = value {
            *value += by;
        }
    }
}
