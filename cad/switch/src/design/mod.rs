//! A design: a configuration that can be built, printed and assembled, with every dimension that follows from it.

mod clearance;
mod dimensions;
mod fastening;
pub(crate) mod mould_keys;
pub(crate) mod mould_tray;
mod mounting;
pub mod rules;
mod tendon_ends;

use pinswitch_friction::physics::{Bed, modulus_of_shore_a_mpa};
use pinswitch_friction::{Contact, PinPattern};

use crate::config::{ConfigError, Configuration};
use pinswitch_solid::profile::ChordTolerance;

pub(crate) use clearance::{clearance, clearance_grade};
pub use dimensions::{Dimensions, Slot};
pub(crate) use fastening::{AXLE_HEAD_MM, STOP_SCREW, axle_recess, stop_recess};
pub use fastening::{Fastening, Recess, Thread};
pub(crate) use mounting::{BEARING_SEAT_MM, PULLEY_RADIUS_MM, pulley_outer_mm, pulley_width_mm};
pub use mounting::{Hole, Mounting, SheathStop};

/// A validated configuration: all its [`Dimensions`], the tolerance of its meshes, and what the tendon touches.
///
/// ```
/// use pinswitch_switch::{config::{Configuration, assign}, design::Design};
///
/// let design = Design::new(Configuration::default())?;
/// assert_eq!(design.contact_radius_mm(), 22.0);
///
/// let mut crowded = Configuration::default();
/// assign(&mut crowded, "segment.grooves=40")?;
/// let error = Design::new(crowded).unwrap_err();
/// assert_eq!(error.field, "segment.grooves");
/// assert!(error.remedy.starts_with("lower it to 20"));
/// # Ok::<(), pinswitch_switch::config::ConfigError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    dimensions: Dimensions,
    tolerance: ChordTolerance,
    contact: Contact,
}

impl std::ops::Deref for Design {
    type Target = Dimensions;

    fn deref(&self) -> &Dimensions {
        &self.dimensions
    }
}

impl Design {
    /// Checks that `configuration` can be built.
    ///
    /// # Errors
    /// [`ConfigError`] names the field, its value, the bound and the remedy.
    pub fn new(configuration: Configuration) -> Result<Self, ConfigError> {
        let dimensions = Dimensions::new(configuration);
        rules::check(&dimensions)?;
        let tolerance_mm = dimensions.configuration().mesh.chord_tolerance_mm;
        let tolerance = ChordTolerance::new(tolerance_mm).map_err(|e| {
            ConfigError::new("mesh.chord_tolerance_mm", tolerance_mm.to_string(), e.to_string())
        })?;
        let contact = contact(&dimensions)?;
        Ok(Self { dimensions, tolerance, contact })
    }

    /// The chord tolerance of every mesh.
    pub const fn tolerance(&self) -> ChordTolerance {
        self.tolerance
    }

    /// What can be made but is not ideal, each with the parameter to change.
    pub fn warnings(&self) -> Vec<String> {
        rules::warnings(&self.dimensions)
    }

    /// What the tendon touches, for the friction model.
    pub const fn contact(&self) -> &Contact {
        &self.contact
    }
}

/// Whether [`Design::new`] accepts `configuration`: for a search, which asks often and shows no error.
pub(crate) fn is_accepted(configuration: Configuration) -> bool {
    let dimensions = Dimensions::new(configuration);
    let tolerance = ChordTolerance::new(dimensions.configuration().mesh.chord_tolerance_mm);
    rules::are_kept(&dimensions) && tolerance.is_ok() && contact(&dimensions).is_ok()
}

/// What the tendon touches by `configuration`, whether it can be built or not: a search looks past the rules, and asks them
/// for what it keeps.
pub(crate) fn contact_of(configuration: Configuration) -> Result<Contact, ConfigError> {
    contact(&Dimensions::new(configuration))
}

fn contact(dimensions: &Dimensions) -> Result<Contact, ConfigError> {
    let c = dimensions.configuration();
    let pins = PinPattern::new(dimensions.pin_angles_rad());
    Contact::new(c.layout.substrate, pins, c.layout.wrap_angle_deg.to_radians())
        .map(|contact| {
            contact
                .with_unmodelled(unmodelled(c))
                .with_six_single_threshold(c.friction.six_single_threshold)
                .with_bed(bed(dimensions))
        })
        .map_err(|e| ConfigError {
            field: "layout.pins".to_owned(),
            value: Some(format!("{:?}", c.layout.pins)),
            problem: "leaves nothing to predict".to_owned(),
            remedy: e.to_string(),
            changes: Vec::new(),
            place: None,
        })
}

/// What carries the tendon, for the physics.
fn bed(dimensions: &Dimensions) -> Bed {
    let c = dimensions.configuration();
    Bed {
        contact_radius_mm: dimensions.contact_radius_mm(),
        tendon_radius_mm: dimensions.tendon_diameter_mm() / 2.0,
        pin_diameter_mm: c.pins.diameter_mm,
        groove_radius_mm: c.segment.groove_radius_mm,
        layer_mm: c.silicone.thickness_mm,
        layer_width_mm: dimensions.layer_width_mm(),
        modulus_mpa: modulus_of_shore_a_mpa(c.silicone.hardness_shore_a),
        ..Bed::published()
    }
}

/// Ways in which a part departs from the one that was measured of which the friction model knows nothing. All others are
/// numbers of its bed, and the model finds them itself.
fn unmodelled(c: &Configuration) -> Vec<String> {
    let published = Configuration::default().silicone.mix_ratio;
    let ours = c.silicone.mix_ratio;
    (ours != published)
        .then(|| {
            format!(
                "silicone.mix_ratio is {ours}, measured was {published}; no law knows what it does beyond the hardness that is given"
            )
        })
        .into_iter()
        .collect()
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
