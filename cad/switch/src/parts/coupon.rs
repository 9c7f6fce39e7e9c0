//! The fit coupon: slots with clearances of 0.10 to 0.40 mm and three grooves, to measure a printer.

use super::label::{Zone, engrave_text};
use super::{Part, Role, offset_error};
use crate::config::ConfigError;
use crate::design::Design;
use pinswitch_solid::profile::{Contour, Pen, Point2};
use pinswitch_solid::solid::{Facing, Solid};

/// Diametral clearances of the slots, hundredths of a millimetre. Each is engraved at its slot.
const CLEARANCES_HUNDREDTHS: [u32; 7] = [10, 15, 20, 25, 30, 35, 40];
/// Length of a slot over its width, in pin diameters.
const SLOT_TRAVEL: f64 = 1.5;
/// Height of the figures at each slot with their surroundings, mm.
const FIGURE_MM: f64 = 5.0;
/// Width of the same, mm.
const FIGURES_WIDE_MM: f64 = 7.5;
/// Number of grooves in the upper edge.
const GROOVES: usize = 3;
/// Wall around slots and grooves, mm.
const WALL_MM: f64 = 2.0;

pub(super) fn coupon(design: &Design) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let (pin, groove) = (c.pins.diameter_mm, c.segment.groove_radius_mm);
    let pitch = (pin + 0.4 + WALL_MM).max(FIGURES_WIDE_MM);
    let length = pitch * CLEARANCES_HUNDREDTHS.len() as f64 + WALL_MM;
    let slot_length = pin * SLOT_TRAVEL;
    let slot_middle = WALL_MM + FIGURE_MM + WALL_MM / 2.0 + (slot_length + pin + 0.4) / 2.0;
    let height = slot_middle + (slot_length + pin + 0.4) / 2.0 + WALL_MM + groove;
    let thickness = c.support.plate_mm;
    let chamfer = c.print.elephant_foot_mm;

    let mut solid = Solid::new();
    let foot = offset_error("print.elephant_foot_mm");
    let outline = strip(length, height, groove);
    let (bottom, top) = solid.extrude_chamfered(&outline, 0.0, thickness, chamfer).map_err(&foot)?;
    let place = |i: usize| WALL_MM / 2.0 + pitch * (i as f64 + 0.5);
    let slots: Vec<_> = CLEARANCES_HUNDREDTHS
        .iter()
        .enumerate()
        .map(|(i, clearance)| {
            let width = pin + f64::from(*clearance) / 100.0;
            slot(Point2::new(place(i), slot_middle), width, slot_length)
        })
        .collect();
    let (bottoms, mut tops) = solid.through_holes(&slots, 0.0, thickness, chamfer).map_err(&foot)?;
    solid.cap(Facing::Down, bottom, &bottoms);
    for (i, clearance) in CLEARANCES_HUNDREDTHS.iter().enumerate() {
        let zone = Zone::flat(Point2::new(place(i), WALL_MM + FIGURE_MM / 2.0), pitch, FIGURE_MM);
        tops.extend(engrave_text(&mut solid, design, &clearance.to_string(), &zone, thickness));
    }
    solid.cap(Facing::Up, top, &tops);
    Ok(Part::new("coupon", Role::Accessory, solid, None))
}

/// A rectangle with grooves in its upper edge, counter-clockwise.
fn strip(length_mm: f64, height_mm: f64, groove_radius_mm: f64) -> Contour {
    let mut pen = Pen::at(Point2::origin())
        .line_to(Point2::new(length_mm, 0.0))
        .line_to(Point2::new(length_mm, height_mm));
    for i in (0..GROOVES).rev() {
        let x = length_mm * (i as f64 + 1.0) / (GROOVES as f64 + 1.0);
        let at = |dx: f64| Point2::new(x + dx, height_mm);
        pen = pen.line_to(at(groove_radius_mm)).arc_to(at(0.0), at(-groove_radius_mm), false);
    }
    pen.line_to(Point2::new(0.0, height_mm)).close()
}

/// An upright slot with round ends, clockwise.
fn slot(middle: Point2, width_mm: f64, travel_mm: f64) -> Contour {
    let (half, reach) = (width_mm / 2.0, travel_mm / 2.0);
    let at = |x: f64, y: f64| Point2::new(middle.x + x, middle.y + y);
    Pen::at(at(half, -reach))
        .line_to(at(half, reach))
        .arc_to(at(0.0, reach), at(-half, reach), true)
        .line_to(at(-half, -reach))
        .arc_to(at(0.0, -reach), at(half, -reach), true)
        .close()
        .reversed()
}
