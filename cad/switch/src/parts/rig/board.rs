//! The upright board with the switch and the axles of the guide pulleys, in one part or two, and the splice behind two.

use super::super::{Part, Pose, Role, fastening, mount, offset_error};
use super::layout;
use crate::config::{ConfigError, field_location};
use crate::design::{Design, Hole, axle_recess, stop_recess};
use pinswitch_diagnostic::codes;
use pinswitch_solid::profile::{Contour, Disc, hull};
use pinswitch_solid::solid::{Facing, Solid};

/// The whole board, or its left part.
pub(in crate::parts) fn left_board(design: &Design) -> Result<Part, ConfigError> {
    board(design, 0)
}

/// The right part of the board.
pub(in crate::parts) fn right_board(design: &Design) -> Result<Part, ConfigError> {
    board(design, 1)
}

fn no_board() -> ConfigError {
    ConfigError::new(codes::INTERNAL_ERROR, "no board").with_location(field_location("mount.kind"))
}

fn hole(h: &Hole) -> Contour {
    Contour::circle(h.centre, h.radius_mm).reversed()
}

/// Printed on its outer face, away from the switch, which has the recesses for the heads.
fn board(design: &Design, index: usize) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let (thickness, chamfer) = (c.mount.plate_mm, c.print.elephant_foot_mm);
    let foot = offset_error("print.elephant_foot_mm");
    let layout = layout(design)?;
    let mounting = design.mounting().ok_or_else(no_board)?;
    let parts = design.board_parts(&layout);
    let outline = parts.get(index).and_then(|discs| hull(discs)).ok_or_else(no_board)?;
    let (low, high) = outline.bounds();
    let is_ours = |h: &Hole| h.centre.x > low.x && h.centre.x < high.x;
    let holes: Vec<_> = mounting.holes.iter().filter(|h| is_ours(h)).map(hole).collect();
    let mut solid = Solid::new();
    let (bottom, top) = solid.extrude_chamfered(&outline, 0.0, thickness, chamfer).map_err(&foot)?;
    let mut mouths = solid.through_holes(&holes, 0.0, thickness, chamfer).map_err(&foot)?;
    let axles = mounting.axles().map(|h| (h, axle_recess()));
    let screws = mounting.sheath.iter().flat_map(|s| s.screws).map(|h| (h, stop_recess()));
    for (h, recess) in axles.chain(screws).filter(|(h, _)| is_ours(h)) {
        fastening::seated_hole(&mut mouths, &mut solid, design, &hole(&h), (h.centre, recess), thickness);
    }
    let (mut bottoms, mut tops) = mouths;
    // The switch is on the first part.
    if index == 0 {
        let recess = design.fastening().mount_counterbore;
        let screws = fastening::plate_holes(&mut solid, design, recess, thickness).map_err(&foot)?;
        bottoms.extend(screws.0);
        tops.extend(screws.1);
    }
    solid.cap(Facing::Down, bottom, &bottoms);
    solid.cap(Facing::Up, top, &tops);
    let pose = Pose::upright(-c.support.plate_mm - thickness);
    let name = if index == 0 { "rig-plate" } else { "rig-plate-2" };
    let mut part = Part::new(name, Role::Mount, solid, Some(pose));
    if index == 0 {
        part.left_out = mount::left_out(design);
    }
    Ok(part)
}

/// The splice behind the joint of a board in two parts.
pub(in crate::parts) fn splice(design: &Design) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let joint = layout(design)?.joint.ok_or_else(no_board)?;
    let holes: Vec<Hole> = joint.left.into_iter().chain(joint.right).collect();
    let discs: Vec<Disc> =
        holes.iter().map(|h| Disc { centre: h.centre, radius_mm: h.radius_mm + c.mount.rim_mm }).collect();
    let outline = hull(&discs).ok_or_else(no_board)?;
    let holes: Vec<Contour> = holes.iter().map(hole).collect();
    let solid = Solid::prism(&outline, &holes, 0.0, c.mount.plate_mm, c.print.elephant_foot_mm)
        .map_err(offset_error("print.elephant_foot_mm"))?;
    let pose = Pose::upright(-c.support.plate_mm - 2.0 * c.mount.plate_mm);
    Ok(Part::new("rig-splice", Role::Mount, solid, Some(pose)))
}
