//! Core (base and inner wall) and ring (ribbed outer wall and end walls) of the split mould.

use super::super::label::{Zone, engrave, is_left_out};
use super::super::sector::{End, grooved_face};
use super::super::{Part, Pose, Role, Sector, offset_error};
use super::{Cavity, keys};
use crate::config::ConfigError;
use crate::design::Design;
use pinswitch_solid::profile::{Contour, Pen, Point2};
use pinswitch_solid::solid::{Facing, Solid};

/// Width of the base beyond the parts on it, mm.
const BASE_MARGIN_MM: f64 = 1.0;
/// Largest shift of the ends of the base as a share of its inner radius. With more, the inner corners are sharper than
/// 45 degrees and break off.
const BLUNT_SHARE: f64 = 0.65;
/// Largest chamfer of the ring as a share of the radius of its ribs. It leaves a foot of 0.9 radii; a chamfer of half the
/// radius would leave nothing of a rib on the bed.
const RIB_SHARE: f64 = 0.4;
/// Least thickness of the block, or that of the wall of the mould if it is thinner, mm.
const LEAST_BLOCK_MM: f64 = 3.0;

/// Inner radius of the core, mm: that of the shell, or more if the corners of the base would be sharp.
fn core_inner_mm(design: &Design, cavity: &Cavity) -> f64 {
    let wall_mm = design.configuration().mould.wall_mm;
    let shift = cavity.sector.end_shift_mm + wall_mm + BASE_MARGIN_MM;
    let blunt = BASE_MARGIN_MM + shift / BLUNT_SHARE;
    let block_mm = wall_mm.min(LEAST_BLOCK_MM);
    design.inner_radius_mm().max(blunt.min(cavity.sector.inner_mm - block_mm))
}

/// The chamfer of the ring, mm: that of all parts, or less for thin ribs.
fn ring_chamfer_mm(design: &Design, cavity: &Cavity) -> f64 {
    design.configuration().print.elephant_foot_mm.min(RIB_SHARE * cavity.groove_radius_mm)
}

/// The block that shapes the smooth inner face of the layer. The end walls of the ring touch its face beyond the cavity.
fn core_sector(design: &Design, cavity: &Cavity) -> Sector {
    Sector {
        inner_mm: core_inner_mm(design, cavity),
        outer_mm: cavity.sector.inner_mm,
        end_shift_mm: cavity.sector.end_shift_mm + design.configuration().mould.wall_mm,
        ..cavity.sector
    }
}

/// The base under core and ring, and the lid above them.
pub(super) fn plate_sector(design: &Design, cavity: &Cavity) -> Sector {
    Sector { outer_mm: cavity.sector.outer_mm + keys::wall_of_ring_mm(design), ..core_sector(design, cavity) }
}

pub(in crate::parts) fn core(design: &Design) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let cavity = Cavity::of(design);
    let base = plate_sector(design, &cavity).grown(
        BASE_MARGIN_MM.min(core_inner_mm(design, &cavity) / 2.0),
        BASE_MARGIN_MM,
        BASE_MARGIN_MM,
    );
    let (floor, top) = (c.mould.floor_mm, c.mould.floor_mm + cavity.depth_mm);
    let mut solid = Solid::new();
    let (bottom, deck) = solid
        .extrude_chamfered(&base.outline(), 0.0, floor, c.print.elephant_foot_mm)
        .map_err(offset_error("print.elephant_foot_mm"))?;
    solid.cap(Facing::Down, bottom, &[]);
    let mut standing = keys::pegs(&mut solid, design, floor).map_err(offset_error("mould.key_height_mm"))?;
    let (foot, head) = solid.extrude(&core_sector(design, &cavity).outline(), floor, top);
    standing.push(foot);
    solid.cap(Facing::Up, deck, &standing);
    let engraved = engrave(&mut solid, design, &[vec![label_zone(design, &cavity)]], top);
    solid.cap(Facing::Up, head, &engraved.rings);
    let mut part = Part::new("mould-core", Role::Mould, solid, None);
    part.tool_pose = Some(Pose::upright(0.0));
    part.left_out = engraved.left_out;
    part.engraved = engraved.lines;
    Ok(part)
}

/// The zone of the label on the core.
fn label_zone(design: &Design, cavity: &Cavity) -> Zone {
    Zone::Arc {
        inner_mm: core_inner_mm(design, cavity),
        outer_mm: cavity.sector.inner_mm,
        from_rad: -design.half_span_rad(),
        to_rad: design.half_span_rad(),
    }
}

/// Returns whether the label does not fit on the core.
pub(in crate::parts) fn core_has_lost_label(design: &Design) -> bool {
    let cavity = Cavity::of(design);
    let top = design.configuration().mould.floor_mm + cavity.depth_mm;
    is_left_out(design, &[vec![label_zone(design, &cavity)]], top)
}

pub(in crate::parts) fn ring(design: &Design) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let cavity = Cavity::of(design);
    let height = cavity.depth_mm;
    let key = offset_error("mould.key_height_mm");
    let mut solid = Solid::new();
    let (bottom, top) = solid
        .extrude_chamfered(&ring_outline(design, &cavity), 0.0, height, ring_chamfer_mm(design, &cavity))
        .map_err(offset_error("print.elephant_foot_mm"))?;
    let mouths = keys::blind_holes(&mut solid, design, 0.0).map_err(&key)?;
    solid.cap(Facing::Down, bottom, &mouths);
    let pegs = keys::pegs(&mut solid, design, height).map_err(&key)?;
    solid.cap(Facing::Up, top, &pegs);
    let mut part = Part::new("mould-ring", Role::Mould, solid, None);
    part.tool_pose = Some(Pose::upright(c.mould.floor_mm));
    Ok(part)
}

/// The outline of the ring, counter-clockwise: outer face, left end wall, ribs, right end wall. The end walls have the print
/// clearance to the core.
fn ring_outline(design: &Design, cavity: &Cavity) -> Contour {
    let outside = plate_sector(design, cavity);
    let inside = cavity.sector;
    let rest = inside.inner_mm + design.configuration().mould.clearance_mm;
    let axis = Point2::origin();
    let pen = Pen::at(outside.corner(rest, End::Positive))
        .line_to(outside.corner(outside.outer_mm, End::Positive))
        .arc_to(axis, outside.corner(outside.outer_mm, End::Negative), true)
        .line_to(outside.corner(rest, End::Negative))
        .arc_to(axis, inside.corner(rest, End::Negative), false)
        .line_to(inside.corner(inside.outer_mm, End::Negative));
    ribbed_face(pen, cavity)
        .line_to(inside.corner(rest, End::Positive))
        .arc_to(axis, outside.corner(rest, End::Positive), false)
        .close()
}

/// The face with the ribs that form the grooves of the layer, from negative to positive angles.
fn ribbed_face(pen: Pen, cavity: &Cavity) -> Pen {
    let (radius, last) =
        (cavity.sector.outer_mm, cavity.sector.corner(cavity.sector.outer_mm, End::Positive));
    grooved_face(pen, radius, &cavity.groove_angles_rad, cavity.groove_radius_mm, last, false)
}
