//! The drive: the foot of a linear actuator, or a crank with its foot, drum and knob.

use std::f64::consts::TAU;

use super::super::{Part, Pose, Role, offset_error};
use super::{PLAY_MM, layout, middle_mm};
use crate::config::ConfigError;
use crate::design::rig::{
    DRIVE_DEPTH_MM, DRUM_FACE_MM, DRUM_FLANGE_MM, DRUM_GROOVE_MM, DRUM_LENGTH_MM, DRUM_MIDDLE_MM, DRUM_MM,
    FOOT_BASE_MM, KNOB_LENGTH_MM, LOCK_MM, LOCKS, M6_HOLE_MM, WASHER_MM,
};
use crate::design::{Design, Hole};
use pinswitch_solid::profile::{Contour, Disc, Point2, hull, polar};
use pinswitch_solid::solid::{Facing, Solid};

/// Half of the width of the base on the table, and of the web, mm.
const BASE_HALF_MM: f64 = 45.0;
const WEB_HALF_MM: f64 = 14.0;
/// Hole for the M8 axle of the drum, mm.
pub(super) const AXLE_HOLE_MM: f64 = 8.4;
/// Hole for the locking pin, an M5 bolt, mm.
pub(super) const LOCK_HOLE_MM: f64 = 5.5;
/// Radius of the face plate of the drum, mm.
const FACE_RADIUS_MM: f64 = 37.0;
/// Radius of the end of the lever, mm.
const LEVER_END_MM: f64 = 8.0;
/// Hole for the knot of the tendon: radius and distance from the axis, mm.
const KNOT_MM: [f64; 2] = [1.5, 24.0];
/// Radius of the knob, mm.
const KNOB_RADIUS_MM: f64 = 11.0;

/// Returns the height of the front face of the foot of the drive in the assembly, mm.
pub(crate) fn front_mm(design: &Design, is_crank: bool) -> f64 {
    let half = if is_crank { DRUM_MIDDLE_MM } else { design.configuration().rig.clevis_mm / 2.0 };
    middle_mm(design) - half - WASHER_MM
}

/// The foot of the actuator's rear bolt.
pub(in crate::parts) fn actuator_foot(design: &Design) -> Result<Part, ConfigError> {
    let hole = (design.configuration().rig.clevis_pin_mm + PLAY_MM) / 2.0;
    drive_foot(design, "actuator-foot", false, &[(0.0, hole)])
}

/// The foot of the crank, with a hole for the locking pin below that for the axle.
pub(in crate::parts) fn crank_foot(design: &Design) -> Result<Part, ConfigError> {
    let holes = [(0.0, AXLE_HOLE_MM / 2.0), (-LOCK_MM, LOCK_HOLE_MM / 2.0)];
    drive_foot(design, "crank-foot", true, &holes)
}

/// A foot with holes at heights from its axis. Printed on its back.
fn drive_foot(
    design: &Design,
    name: &str,
    is_crank: bool,
    holes: &[(f64, f64)],
) -> Result<Part, ConfigError> {
    let layout = layout(design)?;
    let axis = layout.drive;
    let height = axis.y - layout.table_y_mm;
    let about = |axis: Point2| {
        let at = |x: f64, up: f64| Point2::new(axis.x + x, axis.y - height + up);
        let outline = Contour::polygon(vec![
            at(-BASE_HALF_MM, 0.0),
            at(BASE_HALF_MM, 0.0),
            at(BASE_HALF_MM, FOOT_BASE_MM),
            at(WEB_HALF_MM, FOOT_BASE_MM),
            at(WEB_HALF_MM, height + WEB_HALF_MM),
            at(-WEB_HALF_MM, height + WEB_HALF_MM),
            at(-WEB_HALF_MM, FOOT_BASE_MM),
            at(-BASE_HALF_MM, FOOT_BASE_MM),
        ]);
        let holes: Vec<Contour> = holes
            .iter()
            .map(|(up, radius)| Contour::circle(at(0.0, height + up), *radius).reversed())
            .collect();
        Solid::prism(&outline, &holes, 0.0, DRIVE_DEPTH_MM, design.configuration().print.elephant_foot_mm)
            .map_err(offset_error("print.elephant_foot_mm"))
    };
    let pose = Pose::upright(front_mm(design, is_crank) - DRIVE_DEPTH_MM);
    let part = Part::new(name, Role::Stand, about(axis)?, Some(pose));
    Ok(Part { drawn: Some(about(Point2::origin())?), ..part })
}

/// The drum: a face plate with lever and locking holes, a groove for the tendon, and a flange.
pub(in crate::parts) fn crank_drum(design: &Design) -> Result<Part, ConfigError> {
    let axis = layout(design)?.drive;
    let pose = Pose::upright(middle_mm(design) - DRUM_MIDDLE_MM);
    let part = Part::new("crank-drum", Role::Stand, drum(design, axis)?, Some(pose));
    Ok(Part { drawn: Some(drum(design, Point2::origin())?), ..part })
}

/// Returns the holes for bolts: the bore, the hole for the knob, and the locking holes, of which one is below the axis, as in
/// the foot.
pub(super) fn drum_holes(design: &Design, axis: Point2) -> Vec<Hole> {
    let hole = |from: Point2, diameter: f64| Hole { centre: axis + from.coords, radius_mm: diameter / 2.0 };
    let locks = (0..LOCKS).map(|i| hole(polar(LOCK_MM, TAU * i as f64 / LOCKS as f64), LOCK_HOLE_MM));
    let lever = hole(polar(design.lever_mm(), 0.0), M6_HOLE_MM);
    [hole(Point2::origin(), AXLE_HOLE_MM), lever].into_iter().chain(locks).collect()
}

fn drum(design: &Design, axis: Point2) -> Result<Solid, ConfigError> {
    let foot = offset_error("print.elephant_foot_mm");
    let chamfer = design.configuration().print.elephant_foot_mm;
    let lever = axis + polar(design.lever_mm(), 0.0).coords;
    let discs = [
        Disc { centre: axis, radius_mm: FACE_RADIUS_MM },
        Disc { centre: lever, radius_mm: LEVER_END_MM + M6_HOLE_MM / 2.0 },
    ];
    let face = hull(&discs).unwrap_or_else(|| Contour::circle(axis, FACE_RADIUS_MM));
    let circle = |radius: f64| Contour::circle(axis, radius);
    let hole = |centre: Point2, radius: f64| Contour::circle(centre, radius).reversed();
    let knot = polar(KNOT_MM[1], TAU / (2.0 * LOCKS as f64)).coords;
    let bolts = drum_holes(design, axis);
    let holes: Vec<Contour> = bolts[1..]
        .iter()
        .map(|h| hole(h.centre, h.radius_mm))
        .chain([hole(axis + knot, KNOT_MM[0])])
        .collect();
    let mut solid = Solid::new();
    let (bottom, deck) = solid.extrude_chamfered(&face, 0.0, DRUM_FACE_MM, chamfer).map_err(&foot)?;
    let (mut bottoms, mut decks) = solid.through_holes(&holes, 0.0, DRUM_FACE_MM, chamfer).map_err(&foot)?;
    let slope = DRUM_FACE_MM + DRUM_GROOVE_MM;
    let rim = slope + DRUM_FLANGE_MM - DRUM_MM;
    let top = DRUM_LENGTH_MM;
    let (barrel, neck) = solid.extrude(&circle(DRUM_MM), DRUM_FACE_MM, slope);
    let (edge, upper) = solid.extrude(&circle(DRUM_FLANGE_MM), rim, top);
    solid.wall(neck, edge);
    decks.push(barrel);
    let bore = hole(axis, AXLE_HOLE_MM / 2.0);
    let (low, high) = solid.extrude_chamfered(&bore, 0.0, top, chamfer).map_err(&foot)?;
    bottoms.push(low);
    solid.cap(Facing::Down, bottom, &bottoms);
    solid.cap(Facing::Up, deck, &decks);
    solid.cap(Facing::Up, upper, &[high]);
    Ok(solid)
}

/// The knob on the lever. It turns on an M6 bolt.
pub(in crate::parts) fn crank_knob(design: &Design) -> Result<Part, ConfigError> {
    let axis = layout(design)?.drive;
    let about = |centre: Point2| {
        let bore = Contour::circle(centre, M6_HOLE_MM / 2.0).reversed();
        Solid::prism(
            &Contour::circle(centre, KNOB_RADIUS_MM),
            &[bore],
            0.0,
            KNOB_LENGTH_MM,
            design.configuration().print.elephant_foot_mm,
        )
        .map_err(offset_error("print.elephant_foot_mm"))
    };
    let z_mm = middle_mm(design) - DRUM_MIDDLE_MM + DRUM_FACE_MM + WASHER_MM;
    let lever = axis + polar(design.lever_mm(), 0.0).coords;
    let part = Part::new("crank-knob", Role::Stand, about(lever)?, Some(Pose::upright(z_mm)));
    Ok(Part { drawn: Some(about(Point2::origin())?), ..part })
}
