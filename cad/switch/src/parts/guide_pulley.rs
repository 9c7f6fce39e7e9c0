//! The rig's guide pulley: radius 22 mm, with a seat for a 608 bearing (cad/doc/dimensions.md).

use super::{Part, Role, offset_error};
use crate::config::ConfigError;
use crate::design::Design;
use pinswitch_solid::profile::{Contour, Point2};
use pinswitch_solid::solid::{Facing, Solid};

/// Radius at the bottom of the rope groove (paper).
const RADIUS_MM: f64 = 22.0;
/// 608 bearing: outer diameter 22 mm and width 7 mm, with a press-fit allowance on the diameter.
const SEAT_RADIUS_MM: f64 = 11.05;
/// Depth of the seat.
const SEAT_MM: f64 = 7.0;
/// Ledge under the outer ring; the inner ring must turn freely.
const LEDGE_RADIUS_MM: f64 = 9.0;
/// Width of each flange's rim.
const RIM_MM: f64 = 1.2;

/// Rings from the bottom up: rim, slope of 45 degrees into the groove, flat bottom, slope out, rim.
pub(super) fn guide_pulley(design: &Design) -> Result<Part, ConfigError> {
    let tendon = design.tendon_diameter_mm();
    let depth = 1.5 * tendon;
    let flat = 1.2 * tendon;
    let outer = RADIUS_MM + depth;
    let width = (2.0 * (RIM_MM + depth) + flat).max(SEAT_MM + 1.5);
    let rim = (width - 2.0 * depth - flat) / 2.0;
    let chamfer = design.configuration().print.elephant_foot_mm;
    let circle = |radius: f64| Contour::circle(Point2::origin(), radius);
    let mut solid = Solid::new();
    let foot = offset_error("print.elephant_foot_mm");
    let (bottom, lower_rim) = solid.extrude_chamfered(&circle(outer), 0.0, rim, chamfer).map_err(&foot)?;
    let (groove_foot, groove_head) = solid.extrude(&circle(RADIUS_MM), rim + depth, rim + depth + flat);
    let (upper_rim, top) = solid.extrude(&circle(outer), rim + 2.0 * depth + flat, width);
    solid.wall(lower_rim, groove_foot);
    solid.wall(groove_head, upper_rim);
    let seat = width - SEAT_MM;
    let bore = circle(LEDGE_RADIUS_MM).reversed();
    let (bore_foot, bore_head) = solid.extrude_chamfered(&bore, 0.0, seat, chamfer).map_err(&foot)?;
    let (seat_foot, seat_head) = solid.extrude(&circle(SEAT_RADIUS_MM).reversed(), seat, width);
    solid.cap(Facing::Down, bottom, &[bore_foot]);
    solid.cap(Facing::Up, seat_foot, &[bore_head]);
    solid.cap(Facing::Up, top, &[seat_head]);
    Ok(Part::new("guide-pulley", Role::Accessory, solid, None))
}
