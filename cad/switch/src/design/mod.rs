//! Designs: configurations that satisfy all rules, with every derived dimension.

mod clearance;
mod dimensions;
mod fastening;
mod joint;
pub(crate) mod mould_keys;
pub(crate) mod mould_tray;
mod mounting;
pub(crate) mod rig;
pub mod rules;
mod tendon_ends;

use pinswitch_diagnostic::codes;
use pinswitch_friction::physics::{Bed, modulus_of_shore_a_mpa};
use pinswitch_friction::{Contact, ContactError, PinPattern, Substrate};

use crate::config::{Choice, Configuration, Diagnostic, Location};
use crate::process::Process;
use crate::warnings::Warning;
use pinswitch_solid::profile::ChordTolerance;

pub(crate) use clearance::{clearance, clearance_grade};
pub use dimensions::{Dimensions, Slot};
pub(crate) use fastening::{AXLE_HEAD_MM, STOP_SCREW, axle_recess, stop_recess};
pub use fastening::{Fastening, Recess, Thread};
pub use joint::{AxleBolt, Joint, JointContact, JointLevels, Link};
pub(crate) use mounting::{BEARING_SEAT_MM, PULLEY_RADIUS_MM, pulley_outer_mm, pulley_width_mm};
pub use mounting::{Hole, Mounting, SheathStop};
pub use rig::{BoardJoint, RigLayout};

/// A configuration that satisfies all rules, with its [`Dimensions`], the tolerance of its meshes, and the contact of the
/// tendon.
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
/// assert_eq!(
///     error.to_string(),
///     "segment.grooves = 40: grooves overlap (0.781 mm apart, at least 1.450 mm needed)"
/// );
/// # Ok::<(), pinswitch_diagnostic::Diagnostic>(())
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
    /// Checks the rules of `configuration`.
    ///
    /// # Errors
    /// A [`Diagnostic`] of the first broken rule: field, value, problem and bound. It contains no
    /// help, since [`crate::feasibility::design`] needs more time to find the nearest feasible
    /// values.
    pub fn new(configuration: Configuration) -> Result<Self, Diagnostic> {
        let dimensions = Dimensions::new(configuration);
        rules::check(&dimensions)?;
        let tolerance_mm = dimensions.configuration().mesh.chord_tolerance_mm;
        let tolerance = ChordTolerance::new(tolerance_mm).map_err(|e| {
            let location = Location::field("mesh.chord_tolerance_mm", tolerance_mm.to_string());
            Diagnostic::from(e).with_location(location)
        })?;
        let contact = contact(&dimensions)?;
        Ok(Self { dimensions, tolerance, contact })
    }

    /// Returns the chord tolerance of every mesh.
    pub const fn tolerance(&self) -> ChordTolerance {
        self.tolerance
    }

    /// Returns the warnings of the rules, each with the parameter to change.
    pub fn warnings(&self) -> Vec<Warning> {
        rules::warnings(&self.dimensions)
    }

    /// Returns the same design with another contact: that of the parts as made.
    #[must_use]
    pub(crate) fn with_contact(&self, contact: Contact) -> Self {
        Self { contact, ..self.clone() }
    }

    /// Returns the contact of the tendon, the input of the friction model.
    pub const fn contact(&self) -> &Contact {
        &self.contact
    }
}

/// Whether [`Design::new`] accepts `configuration`. Cheaper, for searches.
pub(crate) fn is_accepted(configuration: Configuration) -> bool {
    let dimensions = Dimensions::new(configuration);
    let tolerance = ChordTolerance::new(dimensions.configuration().mesh.chord_tolerance_mm);
    rules::are_satisfied(&dimensions) && tolerance.is_ok() && contact(&dimensions).is_ok()
}

/// Returns the contact of the tendon of `configuration`, which may break rules: searches check them separately.
pub(crate) fn contact_of(configuration: Configuration) -> Result<Contact, Diagnostic> {
    contact(&Dimensions::new(configuration))
}

fn contact(dimensions: &Dimensions) -> Result<Contact, Diagnostic> {
    let c = dimensions.configuration();
    let pins = PinPattern::new(dimensions.pin_angles_rad());
    Contact::new(c.layout.substrate, pins, c.layout.wrap_angle_deg.to_radians())
        .map(|contact| {
            contact
                .with_unmodelled(unmodelled(c))
                .with_six_single_threshold(c.friction.six_single_threshold)
                .with_bed(bed(dimensions))
                .with_modulus_scatter(Process::of(c).modulus_scatter())
        })
        .map_err(|e| {
            let error = match e {
                ContactError::NoPinInWrap { degrees } => Diagnostic::new(codes::NO_SUPPORT, format!(
                    "no pin within the wrap of {degrees:.2} deg, and the rigid proxy carries load on its pins only"
                )),
                other => Diagnostic::from(other),
            };
            error.with_location(Location::field("layout.pins", format!("{:?}", c.layout.pins)))
        })
}

/// Returns the bed under the tendon, for the physics.
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

/// Describes departures from the measured part that the friction model does not cover. The model finds all others in the
/// dimensions of the bed.
fn unmodelled(c: &Configuration) -> Vec<String> {
    let default = Configuration::default();
    let no_law = |field: &str, ours: &str, measured: &str, effect: &str| {
        format!("{field} is {ours}, the measured one is {measured}; no law models {effect}")
    };
    let mut all = Vec::new();
    let is_cast = c.layout.substrate == Substrate::Silicone;
    let product = c.process.silicone;
    if is_cast && product.data().is_none_or(|silicone| silicone.mix_ratio.is_none()) {
        let (ours, published) = (c.silicone.mix_ratio, default.silicone.mix_ratio);
        let effect = "its effect beyond the given hardness";
        if ours != published {
            all.push(no_law("silicone.mix_ratio", &ours.to_string(), &published.to_string(), effect));
        }
    }
    let effect = "the coefficient of friction of another one";
    if is_cast && product != default.process.silicone {
        all.push(no_law("process.silicone", product.as_str(), default.process.silicone.as_str(), effect));
    }
    let material = c.process.material;
    if !is_cast && material != default.process.material {
        all.push(no_law("process.material", material.as_str(), default.process.material.as_str(), effect));
    }
    let (pins, coating) = (c.process.pins, crate::process::coating(c));
    if pins != default.process.pins && !c.layout.pins.is_empty() {
        all.push(no_law("process.pins", pins.as_str(), default.process.pins.as_str(), effect));
    }
    if coating != default.process.coating {
        all.push(no_law("process.coating", coating.as_str(), default.process.coating.as_str(), effect));
    }
    all.extend(Process::of(c).conflicts.into_iter().map(|conflict| conflict.problem));
    all
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
    fn labels_identify_layouts() {
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
