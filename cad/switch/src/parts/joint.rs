//! The links of a joint (cad/doc/dimensions.md, "Joint").
//!
//! The proximal link is a plate next to the left support with the stops and the guide of the tendon. The distal link is a
//! plate outside the right support, with a hub through the hollow of the shell and the anchor of the tendon. Both are
//! printed on their outer faces, without supports.

use super::mount::left_out;
use super::{Part, Pose, Role, fastening, offset_error};
use crate::config::{ConfigError, field_location};
use crate::design::{Design, Hole, Joint, Link};
use pinswitch_diagnostic::codes;
use pinswitch_solid::profile::{Contour, Point2, hull};
use pinswitch_solid::solid::{Facing, RingId, Solid};

/// Name of the link that carries the switch.
pub(crate) const PROXIMAL: &str = "link-proximal";
/// Name of the link that carries the load.
pub(crate) const DISTAL: &str = "link-distal";

fn joint_of(design: &Design) -> Result<Joint, ConfigError> {
    design.joint().ok_or_else(|| {
        ConfigError::new(codes::INTERNAL_ERROR, "no joint").with_location(field_location("mount.kind"))
    })
}

fn circle(hole: &Hole) -> Contour {
    Contour::circle(hole.centre, hole.radius_mm).reversed()
}

/// The outline of a link: the convex hull of the areas that it carries.
fn outline(design: &Design, joint: &Joint, is_proximal: bool) -> Result<Contour, ConfigError> {
    hull(&joint.outline_discs(design, is_proximal)).ok_or_else(|| {
        ConfigError::new(codes::INTERNAL_ERROR, "no outline").with_location(field_location("mount.kind"))
    })
}

/// Adds the block of guide or anchor: a base from `foot_mm` to `floor_mm`, and two jaws on it up to `top_mm`. Returns the
/// ring at its foot. The channel between the jaws is open above to insert the tendon.
fn block(
    solid: &mut Solid,
    [base, jaws @ ..]: [Contour; 3],
    [foot_mm, floor_mm, top_mm]: [f64; 3],
) -> RingId {
    let (foot, deck) = solid.extrude(&base, foot_mm, floor_mm);
    let feet: Vec<RingId> = jaws.iter().map(|jaw| solid.boss(jaw, floor_mm, top_mm)).collect();
    solid.cap(Facing::Up, deck, &feet);
    foot
}

/// Outlines of the base and the jaws of a link's block, as printed.
fn block_outlines(link: &Link, turned: impl Fn(Contour) -> Contour) -> [Contour; 3] {
    let [first, second] = link.jaws();
    [link.base(), first, second].map(turned)
}

/// The proximal link, printed on its outer face.
pub(super) fn proximal_link(design: &Design) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let joint = joint_of(design)?;
    let (plate, chamfer) = (c.mount.plate_mm, c.print.elephant_foot_mm);
    let foot = offset_error("print.elephant_foot_mm");
    let levels = &joint.levels;
    // Heights above the outer face.
    let above = |z_mm: f64| z_mm - levels.proximal_mm + plate;
    let outline = outline(design, &joint, true)?;
    let holes: Vec<Contour> = joint.proximal.holes.iter().map(circle).collect();
    let mut solid = Solid::new();
    let (bottom, top) = solid.extrude_chamfered(&outline, 0.0, plate, chamfer).map_err(&foot)?;
    let mut mouths = solid.through_holes(&holes, 0.0, plate, chamfer).map_err(&foot)?;
    let bore = Hole { centre: Point2::origin(), radius_mm: joint.hub.bore_mm };
    let seat = (bore.centre, joint.head_recess());
    fastening::seated_hole(&mut mouths, &mut solid, design, &circle(&bore), seat, plate);
    let (mut bottoms, mut tops) = mouths;
    let recess = design.fastening().mount_counterbore;
    let (screw_bottoms, screw_tops) =
        fastening::plate_holes(&mut solid, design, recess, plate).map_err(&foot)?;
    bottoms.extend(screw_bottoms);
    tops.extend(screw_tops);
    tops.extend(joint.hub.stops().iter().map(|stop| solid.boss(stop, plate, above(levels.stop_mm))));
    let [floor, jaws] = [-levels.channel_half_mm, levels.jaw_mm].map(|by| above(levels.tendon_mm + by));
    let outlines = block_outlines(&joint.proximal, |contour| contour);
    tops.push(block(&mut solid, outlines, [plate, floor, jaws]));
    solid.cap(Facing::Down, bottom, &bottoms);
    solid.cap(Facing::Up, top, &tops);
    let pose = Pose::upright(levels.proximal_mm - plate);
    let mut part = Part::new(PROXIMAL, Role::Mount, solid, Some(pose));
    part.left_out = left_out(design);
    Ok(part)
}

/// The distal link at the flexion of the assembly, printed on its outer face and therefore mirrored in its plan.
pub(super) fn distal_link(design: &Design) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let joint = joint_of(design)?;
    let (plate, chamfer) = (c.mount.plate_mm, c.print.elephant_foot_mm);
    let foot = offset_error("print.elephant_foot_mm");
    let levels = &joint.levels;
    let outer_mm = levels.distal_mm + plate;
    // Heights above the outer face, which is at the top of the assembly.
    let above = |z_mm: f64| outer_mm - z_mm;
    let outline = outline(design, &joint, false)?.mirrored();
    let holes: Vec<Contour> = joint.distal.holes.iter().map(|hole| circle(hole).mirrored()).collect();
    let mut solid = Solid::new();
    let (bottom, top) = solid.extrude_chamfered(&outline, 0.0, plate, chamfer).map_err(&foot)?;
    let (mut bottoms, mut tops) = solid.through_holes(&holes, 0.0, plate, chamfer).map_err(&foot)?;
    let bore = Contour::circle(Point2::origin(), joint.hub.bore_mm).reversed();
    let (bore_bottom, bore_top) =
        solid.extrude_chamfered(&bore, 0.0, above(levels.hub_mm), chamfer).map_err(&foot)?;
    bottoms.push(bore_bottom);
    let (hub_foot, hub_top) = solid.extrude(&joint.hub.outline().mirrored(), plate, above(levels.hub_mm));
    solid.cap(Facing::Up, hub_top, &[bore_top]);
    tops.push(hub_foot);
    let [floor, jaws] = [levels.channel_half_mm, -levels.jaw_mm].map(|by| above(levels.tendon_mm + by));
    let outlines = block_outlines(&joint.distal, |contour| contour.mirrored());
    tops.push(block(&mut solid, outlines, [plate, floor, jaws]));
    solid.cap(Facing::Down, bottom, &bottoms);
    solid.cap(Facing::Up, top, &tops);
    let pose = Pose { flipped: true, z_mm: outer_mm };
    Ok(Part::new(DISTAL, Role::DistalLink, solid, Some(pose)))
}
