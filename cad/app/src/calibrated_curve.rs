//! The curve of a design by a calibrated model, transferred to the design's dimensions by the
//! physics.

use pinswitch_calibration::ModelFile;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::physics::Bed;
use pinswitch_friction::{Contact, ContactError, FrictionCurve, PinPattern, Transfer, published};
use pinswitch_switch::design::Design;
use pinswitch_switch::prediction::loads_n;

/// Returns the curve of `design` by a calibrated model; `name` is the model's name in errors.
///
/// Effects of the switch are included, effects of the rig are not. Where the dimensions of the
/// design differ from the rig's, the physics gives the change.
///
/// # Errors
/// A [`Diagnostic`] if the model is invalid, if a pin lacks a counterpart on the rig, or if nothing
/// touches.
pub fn calibrated_curve(design: &Design, model: &ModelFile, name: &str) -> Result<FrictionCurve, Diagnostic> {
    calibrated_curve_at(design, model, name, &loads_n(design))
}

/// Returns the curve as [`calibrated_curve`], at ascending `loads_n` in newtons.
///
/// # Errors
/// As [`calibrated_curve`].
pub fn calibrated_curve_at(
    design: &Design,
    model: &ModelFile,
    name: &str,
    loads_n: &[f64],
) -> Result<FrictionCurve, Diagnostic> {
    let configuration = design.configuration();
    let (layout, grooves) = (&configuration.layout.pins, configuration.segment.grooves);
    let pins = rig_grooves(layout, grooves).ok_or_else(|| {
        Diagnostic::new(codes::MODEL_BEYOND_RIG, format!(
            "the calibrated rig has {} grooves, and some of these {grooves} have no counterpart at the same distance \
             from the middle",
            published::GROOVES
        ))
        .with_location(Location::field("layout.pins", format!("{layout:?}")))
        .with_help("use the published constants, without a model")
    })?;
    let substrate = design.contact().substrate();
    let curve = model.part_curve(substrate, &pins, loads_n, name)?;
    let rig = rig_contact(design.contact(), &pins).map_err(|e| Diagnostic::from(e).or_in_file(name))?;
    let transfer = Transfer::between(&rig, design.contact(), loads_n).map_err(Diagnostic::from)?;
    Ok(transfer.apply(curve))
}

/// Returns the rig's grooves, numbered from 1 and ascending, at the same distances from the middle
/// as `pins` among `grooves`; `None` if one lacks a counterpart.
fn rig_grooves(pins: &[usize], grooves: usize) -> Option<Vec<usize>> {
    let mut counterparts = pins
        .iter()
        .map(|pin| {
            // Doubled: with an even number of grooves the middle is between two of them.
            let doubled = (2 * pin + published::GROOVES).checked_sub(grooves)?;
            let groove = doubled / 2;
            (doubled % 2 == 0 && (1..=published::GROOVES).contains(&groove)).then_some(groove)
        })
        .collect::<Option<Vec<usize>>>()?;
    counterparts.sort_unstable();
    Some(counterparts)
}

/// Returns the contact of the calibrated rig with pins in these grooves, on the substrate of
/// `part`.
///
/// # Errors
/// [`ContactError`] if nothing touches.
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
    fn grooves_match_by_distance_from_middle() {
        assert_eq!(rig_grooves(&[11, 5, 8], 15), Some(vec![5, 8, 11]));
        assert_eq!(rig_grooves(&[4, 7, 10], 13), Some(vec![5, 8, 11]));
        assert_eq!(rig_grooves(&[1], 15), Some(vec![1]));
        assert_eq!(rig_grooves(&[1], 17), None, "outside the rig's grooves");
        assert_eq!(rig_grooves(&[5], 14), None, "between two of the rig's grooves");
    }
}
