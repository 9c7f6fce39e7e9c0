//! The cell mount: a plate with a hole for the bolt of the drive, and a wall to which the load cell is bolted. The bolts of the
//! cell pass across the layers of the print, in slots that are open above, so that nothing needs support.

use super::super::{Part, Pose, Role, offset_error};
use super::{PLAY_MM, layout, middle_mm};
use crate::config::{CellKind, ConfigError, Configuration};
use crate::design::Design;
use crate::design::rig::{CELL_PLATE_MM, CELL_ROOM_MM, CELL_WALL_MM, flats_mm};
use pinswitch_solid::profile::{Contour, Point2};
use pinswitch_solid::solid::{Facing, RingId, Solid};

/// Distance of walls from the edge of the plate, mm: coincident walls would not be a solid.
const SETBACK_MM: f64 = 0.5;
/// Half of the least height of the wall across the tendon, and of the plate, mm.
const HALF_MM: f64 = 20.0;
/// Thickness of the side walls next to an S-beam's bolt, mm.
const SIDE_MM: f64 = 6.0;
/// Wall beyond the outermost bolt, mm.
const END_MM: f64 = 9.0;
/// Distance of the hole for the drive's bolt from the end of the plate, mm.
const LUG_MM: f64 = 12.0;

/// A bolt of the load cell, parallel to the tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CellBolt {
    /// Height above the tendon.
    pub up_mm: f64,
    /// Metric thread.
    pub thread_mm: f64,
}

/// Returns the bolts between cell and cell mount, from the tendon upward.
pub(crate) fn cell_bolts(c: &Configuration) -> Vec<CellBolt> {
    let rig = &c.rig;
    match rig.cell {
        CellKind::SBeam => vec![CellBolt { up_mm: 0.0, thread_mm: rig.s_beam_thread_mm }],
        CellKind::Bar => {
            // The eye bolt is in the outer hole of the lower end.
            let outer = rig.bar_length_mm - 2.0 * rig.bar_hole_inset_mm;
            let bolt = |up_mm| CellBolt { up_mm, thread_mm: rig.bar_screw_mm };
            vec![bolt(outer - rig.bar_hole_spacing_mm), bolt(outer)]
        }
    }
}

pub(in crate::parts) fn cell_mount(design: &Design) -> Result<Part, ConfigError> {
    let layout = layout(design)?;
    let pin = Point2::new(layout.pin_x_mm[0], layout.line_y_mm);
    let z_mm = middle_mm(design) - layout.cell_height_mm - CELL_PLATE_MM;
    let part = Part::new(
        "cell-mount",
        Role::Stand,
        solid(design, pin, layout.cell_height_mm)?,
        Some(Pose::upright(z_mm)),
    );
    Ok(Part { drawn: Some(solid(design, Point2::origin(), layout.cell_height_mm)?), ..part })
}

/// A rectangle from a point of its lower left to one of its upper right corner.
fn rectangle(pin: Point2, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2]) -> Contour {
    let at = |x: f64, y: f64| Point2::new(pin.x + x, pin.y + y);
    Contour::polygon(vec![at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)])
}

/// The solid with the axis of the drive's bolt at `pin`, and the tendon toward -x.
fn solid(design: &Design, pin: Point2, cell_mm: f64) -> Result<Solid, ConfigError> {
    let c = design.configuration();
    let bolts = cell_bolts(c);
    let wall = [-CELL_ROOM_MM - CELL_WALL_MM, -CELL_ROOM_MM];
    let thread = bolts.iter().map(|b| b.thread_mm).fold(0.0, f64::max);
    let first = bolts.iter().map(|b| b.up_mm).fold(f64::INFINITY, f64::min);
    let last = bolts.iter().map(|b| b.up_mm).fold(0.0, f64::max);
    let top = (last + thread / 2.0 + END_MM).max(HALF_MM);
    let plate = rectangle(pin, [wall[0] - SETBACK_MM, LUG_MM], [-HALF_MM - SETBACK_MM, top + SETBACK_MM]);
    let hole = Contour::circle(pin, (c.rig.clevis_pin_mm + PLAY_MM) / 2.0).reversed();
    let mut solid = Solid::new();
    let foot = offset_error("print.elephant_foot_mm");
    let chamfer = c.print.elephant_foot_mm;
    let (bottom, deck) = solid.extrude_chamfered(&plate, 0.0, CELL_PLATE_MM, chamfer).map_err(&foot)?;
    let (bottoms, mut standing) = solid.through_holes(&[hole], 0.0, CELL_PLATE_MM, chamfer).map_err(&foot)?;
    solid.cap(Facing::Down, bottom, &bottoms);
    let axis = CELL_PLATE_MM + cell_mm;
    let high = axis + flats_mm(thread) / 3f64.sqrt() + 2.0;
    let mut boss = |outline: &Contour, to: f64| -> RingId { solid.boss(outline, CELL_PLATE_MM, to) };
    let slot = (thread + PLAY_MM) / 2.0;
    // Walls below, between and above the slots.
    match c.rig.cell {
        CellKind::SBeam => {
            for side in [-1.0, 1.0] {
                let at = |x: f64, y: f64| Point2::new(pin.x + x, pin.y + side * y);
                let inner = HALF_MM - SIDE_MM;
                let corner = Contour::polygon(vec![
                    at(wall[0], slot),
                    at(wall[1], slot),
                    at(wall[1], inner),
                    at(-LUG_MM, inner),
                    at(-LUG_MM, HALF_MM),
                    at(wall[0], HALF_MM),
                ]);
                let corner = if corner.area_mm2() < 0.0 { corner.reversed() } else { corner };
                standing.push(boss(&corner, high));
            }
        }
        CellKind::Bar => {
            let mut from = first - thread / 2.0 - END_MM;
            for bolt in &bolts {
                standing.push(boss(&rectangle(pin, wall, [from, bolt.up_mm - slot]), high));
                from = bolt.up_mm + slot;
            }
            standing.push(boss(&rectangle(pin, wall, [from, top]), high));
        }
    }
    // A saddle in each slot carries its bolt at the height of the tendon.
    let saddle_mm = axis - thread / 2.0 - PLAY_MM / 2.0;
    if saddle_mm > CELL_PLATE_MM + 0.4 {
        for bolt in &bolts {
            let half = slot - SETBACK_MM;
            let outline = rectangle(pin, wall, [bolt.up_mm - half, bolt.up_mm + half]);
            standing.push(boss(&outline, saddle_mm));
        }
    }
    solid.cap(Facing::Up, deck, &standing);
    Ok(solid)
}
