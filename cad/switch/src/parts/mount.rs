//! Mounting parts: the plate next to the left support, the spacer of the pulley of the rig, and the sheath stop
//! (cad/doc/dimensions.md, "Mounting").

use super::omission::LeftOut;
use super::{Part, Pose, Role, fastening, offset_error};
use crate::config::{ConfigError, Configuration, MountKind, field_location};
use crate::design::{Design, Hole, SheathStop, pulley_width_mm, stop_recess};
use pinswitch_diagnostic::codes;
use pinswitch_solid::profile::{Contour, Point2, Vector2, hull};
use pinswitch_solid::solid::{Facing, Solid};

/// Shoulder of a 608 bearing's inner ring, mm (ISO 15: bore 8, outer diameter 22, width 7).
const SPACER_RADIUS_MM: f64 = 6.0;
/// Play around the sheath and around the tendon in the sheath stop, mm.
const STOP_PLAY_MM: f64 = 0.2;
/// Share of the length of the sheath stop that contains the sheath.
const SHEATH_SHARE: f64 = 0.6;
/// Distance of its jaws from the edge of its base, mm: coincident walls would not be a solid.
const SETBACK_MM: f64 = 0.5;
/// Distance of a jaw from a hole, with the wall beyond the hole, mm: space for the head of an M3 screw.
const JAW_AIR_MM: f64 = 3.5;

/// Name of the spacer under the pulley on the side of the load, and begin of the name of the other one.
pub(crate) const SPACER: &str = "pulley-spacer";

/// Returns the name of the plate of a kind of mount other than the rig.
fn name(kind: MountKind) -> &'static str {
    match kind {
        MountKind::Flange | MountKind::Joint | MountKind::Rig | MountKind::None => "base-flange",
    }
}

pub(super) fn has_plate(c: &Configuration, kind: MountKind) -> bool {
    c.mount.kind == kind
}

pub(super) fn has_sheath_stop(c: &Configuration) -> bool {
    c.mount.kind != MountKind::None && c.tendon.sheath_diameter_mm > 0.0
}

/// Height of the inner face of the plate in the assembly, mm.
fn face_mm(design: &Design) -> f64 {
    -design.configuration().support.plate_mm
}

fn no_plate() -> ConfigError {
    ConfigError::new(codes::INTERNAL_ERROR, "no mounting plate").with_location(field_location("mount.kind"))
}

/// The plate: the convex hull of discs around its holes, printed on its outer face.
pub(super) fn plate(design: &Design) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let (thickness, chamfer) = (c.mount.plate_mm, c.print.elephant_foot_mm);
    let foot = offset_error("print.elephant_foot_mm");
    let mounting = design.mounting().ok_or_else(no_plate)?;
    let outline = hull(&mounting.discs).ok_or_else(no_plate)?;
    let circle = |h: &Hole| Contour::circle(h.centre, h.radius_mm).reversed();
    let holes: Vec<_> = mounting.holes.iter().map(circle).collect();
    let mut solid = Solid::new();
    let (bottom, top) = solid.extrude_chamfered(&outline, 0.0, thickness, chamfer).map_err(&foot)?;
    let mut mouths = solid.through_holes(&holes, 0.0, thickness, chamfer).map_err(&foot)?;
    let screws = mounting.sheath.iter().flat_map(|s| s.screws).map(|h| (h, stop_recess()));
    for (hole, recess) in screws {
        let (outline, seat) = (circle(&hole), (hole.centre, recess));
        fastening::seated_hole(&mut mouths, &mut solid, design, &outline, seat, thickness);
    }
    let (mut bottoms, mut tops) = mouths;
    let recess = design.fastening().mount_counterbore;
    let (screw_bottoms, screw_tops) =
        fastening::plate_holes(&mut solid, design, recess, thickness).map_err(&foot)?;
    bottoms.extend(screw_bottoms);
    tops.extend(screw_tops);
    solid.cap(Facing::Down, bottom, &bottoms);
    solid.cap(Facing::Up, top, &tops);
    let pose = Pose::upright(face_mm(design) - thickness);
    let kind = c.mount.kind;
    let mut part = Part::new(name(kind), Role::Mount, solid, Some(pose));
    part.left_out = left_out(design);
    Ok(part)
}

/// Returns the features that do not fit on the mounting plate.
pub(super) fn left_out(design: &Design) -> Vec<LeftOut> {
    let f = &design.configuration().fasteners;
    let is_lost = f.count > 0 && f.head_recess_mm > 0.0 && design.fastening().mount_counterbore.is_none();
    is_lost.then_some(LeftOut::PlateCounterbores).into_iter().collect()
}

/// Returns the length of the spacer between plate and bearing, mm, at which the groove of the pulley is level with the tendon.
pub fn spacer_mm(design: &Design) -> f64 {
    let c = design.configuration();
    c.support.plate_mm + c.shell.width_mm / 2.0 - pulley_width_mm(design.tendon_diameter_mm()) / 2.0
}

/// The spacer under the pulley on the side of the load.
pub(super) fn spacer(design: &Design) -> Result<Part, ConfigError> {
    spacer_on(design, SPACER, design.mounting().and_then(|m| m.axle))
}

/// The spacer under the pulley on the side of the drive.
pub(super) fn drive_spacer(design: &Design) -> Result<Part, ConfigError> {
    spacer_on(design, "pulley-spacer-2", design.mounting().and_then(|m| m.drive_axle))
}

fn spacer_on(design: &Design, name: &str, axle: Option<Hole>) -> Result<Part, ConfigError> {
    let axle = axle.ok_or_else(no_plate)?;
    let chamfer = design.configuration().print.elephant_foot_mm;
    let about = |centre: Point2| {
        let ring = Contour::circle(centre, SPACER_RADIUS_MM);
        let bore = Contour::circle(centre, axle.radius_mm).reversed();
        Solid::prism(&ring, &[bore], 0.0, spacer_mm(design), chamfer)
            .map_err(offset_error("print.elephant_foot_mm"))
    };
    let pose = Some(Pose::upright(face_mm(design)));
    let part = Part::new(name, Role::Mount, about(axle.centre)?, pose);
    Ok(Part { drawn: Some(about(Point2::origin())?), ..part })
}

/// A point of the sheath stop: along the tendon from its start, and outward from the tendon's axis.
fn at(stop: &SheathStop, along_mm: f64, outward_mm: f64) -> Point2 {
    let outwards = Vector2::new(-stop.along.y, stop.along.x);
    stop.start + stop.along * along_mm + outwards * outward_mm
}

/// The sheath stop: a base with two jaws. The channel between them is narrow for the tendon, and wider for the sheath over
/// [`SHEATH_SHARE`] of the length; the end of the sheath rests on the step. It is open above to insert the tendon.
pub(super) fn sheath_stop(design: &Design) -> Result<Part, ConfigError> {
    let mounting = design.mounting().ok_or_else(no_plate)?;
    let stop = mounting.sheath.ok_or_else(no_plate)?;
    let pose = Some(Pose::upright(face_mm(design)));
    let part = Part::new("sheath-stop", Role::Mount, stop_solid(design, &stop)?, pose);
    Ok(Part { drawn: Some(stop_solid(design, &stop.along_the_paper())?), ..part })
}

fn stop_solid(design: &Design, stop: &SheathStop) -> Result<Solid, ConfigError> {
    let c = design.configuration();
    let foot = offset_error("print.elephant_foot_mm");
    let (length, half, chamfer) = (stop.length_mm, stop.half_width_mm, c.print.elephant_foot_mm);
    let (tendon, sheath) = (design.tendon_diameter_mm() / 2.0, c.tendon.sheath_diameter_mm / 2.0);
    // The axis of the tendon is in the middle of the width of the switch.
    let axis = c.support.plate_mm + c.shell.width_mm / 2.0;
    let floor = design.sheath_floor_mm();
    let top = axis + sheath;
    let quad = |points: [(f64, f64); 4]| Contour::polygon(points.map(|(x, y)| at(stop, x, y)).to_vec());
    let base = quad([(0.0, -half), (length, -half), (length, half), (0.0, half)]);
    let screws: Vec<_> =
        stop.screws.iter().map(|h| Contour::circle(h.centre, h.radius_mm).reversed()).collect();
    let mut solid = Solid::new();
    let (bottom, deck) = solid.extrude_chamfered(&base, 0.0, floor, chamfer).map_err(&foot)?;
    let (bottoms, mut standing) = solid.through_holes(&screws, 0.0, floor, chamfer).map_err(&foot)?;
    solid.cap(Facing::Down, bottom, &bottoms);
    let step = length * (1.0 - SHEATH_SHARE);
    let jaw_half = stop.half_width_mm - 2.0 * stop.screws[0].radius_mm - JAW_AIR_MM;
    for side in [-1.0, 1.0] {
        let jaw = |x: f64, y: f64| at(stop, x, side * y);
        let points = [
            jaw(SETBACK_MM, tendon + STOP_PLAY_MM),
            jaw(step, tendon + STOP_PLAY_MM),
            jaw(step, sheath + STOP_PLAY_MM),
            jaw(length - SETBACK_MM, sheath + STOP_PLAY_MM),
            jaw(length - SETBACK_MM, jaw_half),
            jaw(SETBACK_MM, jaw_half),
        ];
        let outline = Contour::polygon(points.to_vec());
        let outline = if outline.area_mm2() < 0.0 { outline.reversed() } else { outline };
        standing.push(solid.boss(&outline, floor, top));
    }
    solid.cap(Facing::Up, deck, &standing);
    Ok(solid)
}
