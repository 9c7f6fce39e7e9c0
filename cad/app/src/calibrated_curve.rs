//! The curve of a design by a calibrated model, carried to the design's own dimensions by the physics.

use pinswitch_calibration::ModelFile;
use pinswitch_friction::physics::Bed;
use pinswitch_friction::{Contact, ContactError, FrictionCurve, PinPattern, Transfer, published};
use pinswitch_switch::design::Design;
use pinswitch_switch::prediction::loads_n;

/// The curve of `design` by a calibrated model, called `name` in errors: effects of the switch in, effects of the rig out,
/// and what the design's dimensions change as the physics says.
///
/// # Errors
/// The fault of the model, or what of the design the rig does not have.
pub fn calibrated_curve(design: &Design, model: &ModelFile, name: &str) -> Result<FrictionCurve, String> {
    let configuration = design.configuration();
    let pins = rig_grooves(&configuration.layout.pins, configuration.segment.grooves).ok_or_else(|| {
        format!(
            "layout.pins = {:?} of {} grooves: the calibrated rig has {} grooves, and some of these have no counterpart \
             there by their place from the middle; their curve is known by the published constants, without a model",
            configuration.layout.pins,
            configuration.segment.grooves,
            published::GROOVES
        )
    })?;
    let loads_n = loads_n(design);
    let substrate = design.contact().substrate();
    let curve = model.part_curve(substrate, &pins, &loads_n, name).map_err(|e| e.to_string())?;
    let rig = rig_contact(design.contact(), &pins).map_err(|e| format!("{name}: {e}"))?;
    let transfer = Transfer::between(&rig, design.contact(), &loads_n).map_err(|e| e.to_string())?;
    Ok(transfer.apply(curve))
}

/// The grooves of the rig, numbered from 1, that lie as far from its middle as these among `grooves`; ascending. `None` if
/// one has no counterpart.
fn rig_grooves(pins: &[usize], grooves: usize) -> Option<Vec<usize>> {
    // Twice the place from the middle, so that an even number of grooves has one, too.
    let mut found = pins
        .iter()
        .map(|pin| {
            let doubled = (2 * pin + published::GROOVES).checked_sub(grooves)?;
            let groove = doubled / 2;
            (doubled % 2 == 0 && (1..=published::GROOVES).contains(&groove)).then_some(groove)
        })
        .collect::<Option<Vec<usize>>>()?;
    found.sort_unstable();
    Some(found)
}

/// Pins in these grooves of the rig that was calibrated, on what `part` lies on.
///
/// # Errors
/// [`ContactError`] if nothing touches there.
pub(crate) fn rig_contact(part: &Contact, pins: &[usize]) -> Result<Contact, ContactError> {
    let middle = (published::GROOVES as f64 + 1.0) / 2.0;
    let pitch_rad = published::GROOVE_PITCH_DEG.to_radians();
    let angles = pins.iter().map(|pin| (*pin as f64 - middle) * pitch_rad).collect();
    let contact = Contact::new(part.substrate(), PinPattern::new(angles), published::wrap_angle_rad())?;
    Ok(contact.with_bed(Bed::published()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grooves_are_matched_by_their_place_from_the_middle() {
        assert_eq!(rig_grooves(&[11, 5, 8], 15), Some(vec![5, 8, 11]));
        assert_eq!(rig_grooves(&[4, 7, 10], 13), Some(vec![5, 8, 11]));
        assert_eq!(rig_grooves(&[1], 15), Some(vec![1]));
        assert_eq!(rig_grooves(&[1], 17), None, "beyond the rig's");
        assert_eq!(rig_grooves(&[5], 14), None, "between the rig's");
    }
}
