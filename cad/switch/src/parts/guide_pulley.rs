//! The rig's guide pulley: radius 22 mm, with a seat for a 608 bearing (cad/doc/dimensions.md).

use super::{Part, Pose, Role, offset_error};
use crate::config::ConfigError;
use crate::design::{BEARING_SEAT_MM, Design, PULLEY_RADIUS_MM, pulley_outer_mm, pulley_width_mm};
use pinswitch_solid::profile::{Contour, Point2};
use pinswitch_solid::solid::{Facing, Solid};

/// Depth of the seat: the width of a 608 bearing (ISO 15).
const SEAT_MM: f64 = 7.0;
/// Radius of the bore under the seat: the ledge carries the outer ring, and the inner ring turns freely.
const LEDGE_RADIUS_MM: f64 = 9.0;

/// The pulley on the side of the drive of the rig.
pub(super) fn drive_pulley(design: &Design) -> Result<Part, ConfigError> {
    let axle = design.mounting().and_then(|m| m.drive_axle).map(|a| a.centre);
    pulley(design, "guide-pulley-2", axle)
}

/// The pulley on the side of the load of the rig, or a separate one.
pub(super) fn guide_pulley(design: &Design) -> Result<Part, ConfigError> {
    let axle = design.mounting().and_then(|m| m.axle).map(|a| a.centre);
    pulley(design, "guide-pulley", axle)
}

/// The pulley. From below: rim, slope of 45 degrees into the groove, flat bottom, slope, rim. On the rig, its bearing faces the
/// plate, and its axis is that of the axle.
fn pulley(design: &Design, name: &str, axle: Option<Point2>) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let tendon = design.tendon_diameter_mm();
    let outer = pulley_outer_mm(tendon);
    let depth = outer - PULLEY_RADIUS_MM;
    let flat = 1.2 * tendon;
    let width = pulley_width_mm(tendon);
    let rim = (width - 2.0 * depth - flat) / 2.0;
    let chamfer = c.print.elephant_foot_mm;
    // Its pose rotates it by 180 degrees about y.
    let middle = axle.map_or(Point2::origin(), |p| Point2::new(-p.x, p.y));
    let circle = |radius: f64| Contour::circle(middle, radius);
    let mut solid = Solid::new();
    let foot = offset_error("print.elephant_foot_mm");
    let (bottom, lower_rim) = solid.extrude_chamfered(&circle(outer), 0.0, rim, chamfer).map_err(&foot)?;
    let (groove_foot, groove_head) =
        solid.extrude(&circle(PULLEY_RADIUS_MM), rim + depth, rim + depth + flat);
    let (upper_rim, top) = solid.extrude(&circle(outer), rim + 2.0 * depth + flat, width);
    solid.wall(lower_rim, groove_foot);
    solid.wall(groove_head, upper_rim);
    let seat = width - SEAT_MM;
    let bore = circle(LEDGE_RADIUS_MM).reversed();
    let (bore_foot, bore_head) = solid.extrude_chamfered(&bore, 0.0, seat, chamfer).map_err(&foot)?;
    let (seat_foot, seat_head) = solid.extrude(&circle(BEARING_SEAT_MM / 2.0).reversed(), seat, width);
    solid.cap(Facing::Down, bottom, &[bore_foot]);
    solid.cap(Facing::Up, seat_foot, &[bore_head]);
    solid.cap(Facing::Up, top, &[seat_head]);
    let pose = axle.map(|_| Pose { flipped: true, z_mm: c.shell.width_mm / 2.0 + width / 2.0 });
    Ok(Part::new(name, Role::Accessory, solid, pose))
}
