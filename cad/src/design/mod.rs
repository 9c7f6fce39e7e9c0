//! A design: a configuration that can be built, printed and assembled, with every dimension that follows from it.

mod bounds;
mod warnings;

use pinswitch_model::physics::{Bed, modulus_of_shore_a_mpa};
use pinswitch_model::{Contact, PinPattern, Substrate};

use crate::config::{ConfigError, Configuration, SlotKind, Slots, SubstrateKind};
use crate::profile::ChordTolerance;

/// Grid to which pins are cut, mm.
const PIN_LENGTH_STEP_MM: f64 = 0.5;

/// A validated configuration and what follows from it. Lengths in mm, angles in radians; see geometry.md.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    configuration: Configuration,
    tolerance: ChordTolerance,
    contact: Contact,
}

/// A slot of a side support, in the radial direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Width: pin and clearance.
    pub width_mm: f64,
    /// Radius at which a pin's centre ends when it is sunk flush, less the margin.
    pub inner_mm: f64,
    /// Radius of a resting pin's centre.
    pub outer_mm: f64,
    /// Depth from the plate's inner face.
    pub depth_mm: f64,
}

impl Design {
    /// Checks that `configuration` can be built.
    ///
    /// # Errors
    /// [`ConfigError`] names the field, its value, the bound and the remedy.
    pub fn new(configuration: Configuration) -> Result<Self, ConfigError> {
        bounds::check(&configuration)?;
        let tolerance = ChordTolerance::new(configuration.mesh.chord_tolerance_mm).map_err(|e| {
            ConfigError::new(
                "mesh.chord_tolerance_mm",
                configuration.mesh.chord_tolerance_mm.to_string(),
                e.to_string(),
            )
        })?;
        let contact = contact(&configuration)?;
        Ok(Self { configuration, tolerance, contact })
    }

    /// The values that the user may set.
    pub fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    /// The chord tolerance of every mesh.
    pub fn tolerance(&self) -> ChordTolerance {
        self.tolerance
    }

    /// What printed but is not ideal: see the `warnings` module.
    pub fn warnings(&self) -> Vec<String> {
        warnings::of(&self.configuration)
    }

    /// Angles of all groove centres, ascending.
    pub fn groove_angles_rad(&self) -> Vec<f64> {
        groove_angles_rad(&self.configuration)
    }

    /// Angles of the occupied grooves, ascending.
    pub fn pin_angles_rad(&self) -> Vec<f64> {
        pin_angles_rad(&self.configuration)
    }

    /// Half of the grooved span.
    pub fn half_span_rad(&self) -> f64 {
        self.configuration.segment.span_deg.to_radians() / 2.0
    }

    /// Inner radius of shell, supports and mould core.
    pub fn inner_radius_mm(&self) -> f64 {
        self.configuration.shell.outer_radius_mm - self.configuration.shell.wall_mm
    }

    /// Radius of the shell's outer face, on which the silicone lies.
    pub fn shell_radius_mm(&self) -> f64 {
        self.configuration.shell.outer_radius_mm
    }

    /// Radius of the silicone's surface, which the tendon touches.
    pub fn contact_radius_mm(&self) -> f64 {
        contact_radius_mm(&self.configuration)
    }

    /// Width of the silicone layer along the axis.
    pub fn layer_width_mm(&self) -> f64 {
        self.configuration.shell.width_mm - 2.0 * self.configuration.silicone.side_clearance_mm
    }

    /// Outer diameter of the coated tendon.
    pub fn tendon_diameter_mm(&self) -> f64 {
        tendon_diameter_mm(&self.configuration)
    }

    /// The slots of the side supports.
    pub fn slot(&self) -> Slot {
        slot(&self.configuration)
    }

    /// Angles of the grooves that get a slot.
    pub fn slot_angles_rad(&self) -> Vec<f64> {
        match self.configuration.support.slots {
            Slots::All => self.groove_angles_rad(),
            Slots::Occupied => self.pin_angles_rad(),
        }
    }

    /// Outer radius of the side supports.
    pub fn support_radius_mm(&self) -> f64 {
        support_radius_mm(&self.configuration)
    }

    /// Length to which the pins are cut, rounded down to half a millimetre.
    pub fn pin_length_mm(&self) -> f64 {
        pin_length_mm(&self.configuration)
    }

    /// Angles of the fastener holes, ascending.
    pub fn fastener_angles_rad(&self) -> Vec<f64> {
        fastener_angles_rad(&self.configuration)
    }

    /// Radius on which the fastener holes lie: the middle of the wall under the grooves.
    pub fn fastener_radius_mm(&self) -> f64 {
        fastener_radius_mm(&self.configuration)
    }

    /// What the tendon touches, for the friction model.
    pub fn contact(&self) -> &Contact {
        &self.contact
    }

    /// The engraved label: the configured text, or pins x step / first groove.
    pub fn label(&self) -> String {
        let configuration = &self.configuration;
        if !configuration.label.text.is_empty() {
            return configuration.label.text.clone();
        }
        let mut pins = configuration.layout.pins.clone();
        pins.sort_unstable();
        let steps: Vec<_> = pins.windows(2).map(|w| w[1] - w[0]).collect();
        match (pins.first(), steps.first()) {
            (None, _) => "BARE".to_owned(),
            (Some(only), None) => format!("1/{only}"),
            (Some(first), Some(step)) if steps.iter().all(|s| s == step) => {
                format!("{}x{step}/{first}", pins.len())
            }
            // Any other pattern: its occupancy as a hexadecimal number, groove 1 the lowest bit.
            _ => format!("{:X}", pins.iter().fold(0u64, |bits, i| bits | 1 << (i - 1))),
        }
    }
}

fn contact(c: &Configuration) -> Result<Contact, ConfigError> {
    let substrate = match c.layout.substrate {
        SubstrateKind::Silicone => Substrate::Silicone,
        SubstrateKind::Abs => Substrate::Abs,
    };
    let pins = PinPattern::new(pin_angles_rad(c));
    Contact::new(substrate, pins, c.layout.wrap_angle_deg.to_radians())
        .map(|contact| {
            contact
                .with_departures(departures(c))
                .with_six_single_threshold(c.friction.six_single_threshold)
                .with_bed(bed(c))
        })
        .map_err(|e| ConfigError {
            field: "layout.pins".to_owned(),
            value: Some(format!("{:?}", c.layout.pins)),
            problem: "leaves nothing to predict".to_owned(),
            remedy: e.to_string(),
            place: None,
        })
}

/// What carries the tendon, for the physics.
fn bed(c: &Configuration) -> Bed {
    Bed {
        contact_radius_mm: contact_radius_mm(c),
        tendon_radius_mm: tendon_diameter_mm(c) / 2.0,
        pin_diameter_mm: c.pins.diameter_mm,
        groove_radius_mm: c.segment.groove_radius_mm,
        layer_mm: c.silicone.thickness_mm,
        layer_width_mm: c.shell.width_mm - 2.0 * c.silicone.side_clearance_mm,
        modulus_mpa: modulus_of_shore_a_mpa(c.silicone.hardness_shore_a),
        ..Bed::published()
    }
}

/// Ways in which a part departs from the one that was measured, in what the friction model depends on. The radius is
/// not among them: the paper does not give it.
fn departures(c: &Configuration) -> Vec<String> {
    const THAT_MATTER: [&str; 7] = [
        "segment.groove_radius_mm",
        "silicone.thickness_mm",
        "silicone.hardness_shore_a",
        "silicone.mix_ratio",
        "pins.diameter_mm",
        "tendon.rope_diameter_mm",
        "tendon.coating_mm",
    ];
    let measured = Configuration::default();
    Configuration::PARAMETERS
        .iter()
        .filter(|p| THAT_MATTER.contains(&p.path().as_str()))
        .filter_map(|p| {
            let (ours, theirs) = ((p.get)(c).to_string(), (p.get)(&measured).to_string());
            (ours != theirs).then(|| format!("{} is {ours}, measured was {theirs}", p.path()))
        })
        .collect()
}

fn pin_angles_rad(c: &Configuration) -> Vec<f64> {
    let all = groove_angles_rad(c);
    let mut pins = c.layout.pins.clone();
    pins.sort_unstable();
    pins.iter().map(|i| all[i - 1]).collect()
}

fn groove_angles_rad(c: &Configuration) -> Vec<f64> {
    let span = c.segment.span_deg.to_radians();
    let pitch = span / c.segment.grooves as f64;
    (0..c.segment.grooves).map(|i| -span / 2.0 + (i as f64 + 0.5) * pitch).collect()
}

fn pitch_rad(c: &Configuration) -> f64 {
    c.segment.span_deg.to_radians() / c.segment.grooves as f64
}

fn contact_radius_mm(c: &Configuration) -> f64 {
    c.shell.outer_radius_mm + c.silicone.thickness_mm
}

fn tendon_diameter_mm(c: &Configuration) -> f64 {
    c.tendon.rope_diameter_mm + 2.0 * c.tendon.coating_mm
}

fn slot(c: &Configuration) -> Slot {
    let outer_mm = contact_radius_mm(c);
    Slot {
        width_mm: c.pins.diameter_mm + c.support.slot_clearance_mm,
        inner_mm: outer_mm - c.pins.diameter_mm / 2.0 - c.support.travel_margin_mm,
        outer_mm,
        depth_mm: match c.support.slot_kind {
            SlotKind::Blind => c.support.plate_mm - c.support.slot_floor_mm,
            SlotKind::Through => c.support.plate_mm,
        },
    }
}

fn support_radius_mm(c: &Configuration) -> f64 {
    contact_radius_mm(c) + c.pins.diameter_mm / 2.0 + c.support.rise_mm
}

fn pin_length_mm(c: &Configuration) -> f64 {
    let room = c.shell.width_mm + 2.0 * slot(c).depth_mm - c.pins.end_play_mm;
    // A hair more, so that 18.0 computed as 17.999... is still 18.0.
    ((room + 1e-9) / PIN_LENGTH_STEP_MM).floor() * PIN_LENGTH_STEP_MM
}

fn fastener_radius_mm(c: &Configuration) -> f64 {
    c.shell.outer_radius_mm - (c.shell.wall_mm + c.segment.groove_radius_mm) / 2.0
}

fn fastener_angles_rad(c: &Configuration) -> Vec<f64> {
    let outermost =
        c.segment.span_deg.to_radians() / 2.0 - c.fasteners.end_distance_mm / fastener_radius_mm(c);
    match c.fasteners.count {
        0 => Vec::new(),
        1 => vec![0.0],
        n => (0..n).map(|i| outermost * (2.0 * i as f64 / (n as f64 - 1.0) - 1.0)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_design_has_the_published_dimensions() {
        let design = Design::new(Configuration::default()).unwrap();
        let angles = design.groove_angles_rad();
        assert_eq!(angles.len(), 15);
        assert!((angles[1] - angles[0] - 5.963_333_f64.to_radians()).abs() < 1e-7);
        assert!(angles[7].abs() < 1e-12);
        assert_eq!(design.contact_radius_mm(), 22.0);
        assert_eq!(design.pin_length_mm(), 18.0);
        assert!((design.tendon_diameter_mm() - 1.7).abs() < 1e-12);
        assert_eq!(*design.contact().bed(), Bed::published());
    }

    #[test]
    fn labels_tell_layouts_apart() {
        let label = |pins: &[usize]| {
            let mut c = Configuration::default();
            c.layout.pins = pins.to_vec();
            Design::new(c).unwrap().label()
        };
        assert_eq!(label(&[5, 8, 11]), "3x3/5");
        assert_eq!(label(&[11, 5, 8]), "3x3/5");
        assert_eq!(label(&[3, 5, 7, 9, 11, 13]), "6x2/3");
        assert_eq!(label(&[4]), "1/4");
        assert_eq!(label(&[]), "BARE");
        assert_eq!(label(&[1, 2, 4]), "B");
    }
}
