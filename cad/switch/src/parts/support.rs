//! The side supports: plates with radial slots, a lip over the silicone's edge and the shell's holes
//! (cad/doc/dimensions.md, "Side supports").

use super::left_out::LeftOut;
use super::marks::{self, engrave_marks};
use super::shell::wall_sector;
use super::{Part, Pose, Role, fastening, offset_error};
use crate::config::{ConfigError, FastenerKind, MountKind, SlotKind};
use crate::design::{Design, Recess};
use pinswitch_solid::profile::{Contour, Pen, Point2, Vector2, polar};
use pinswitch_solid::solid::{Facing, Solid};

/// The lip ends this far inside the plate, mm: two coincident walls would not be a solid.
const LIP_END_MM: f64 = 0.5;
/// Ledge between a slot and the lip beside it, mm: likewise.
const LIP_LEDGE_MM: f64 = 0.1;
/// Least height of a tooth of the lip, mm.
const LEAST_TOOTH_MM: f64 = 0.05;
/// Points closer than this are one, mm.
const LIP_SAME_MM: f64 = 1e-6;

/// Which side of the switch a support is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// At z = 0; printed as it stands.
    Left,
    /// At the other end: printed turned half round, so its plan is mirrored.
    Right,
}

/// The support at z = 0.
pub(super) fn left(design: &Design) -> Result<Part, ConfigError> {
    support(design, Side::Left)
}

/// The support at the other end.
pub(super) fn right(design: &Design) -> Result<Part, ConfigError> {
    support(design, Side::Right)
}

/// A plate, printed on its outer face: slots and lip look up.
fn support(design: &Design, side: Side) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let (plate, chamfer) = (c.support.plate_mm, c.print.elephant_foot_mm);
    let turned = |contour: Contour| if side == Side::Right { contour.mirrored() } else { contour };
    let mut sector = wall_sector(design);
    sector.outer_mm = design.support_radius_mm();
    let outline = turned(sector.rounded(c.support.corner_radius_mm));
    let slots: Vec<_> = design.slot_angles_rad().iter().map(|a| turned(slot(design, *a))).collect();
    let (through, blind) = match c.support.slot_kind {
        SlotKind::Through => (slots, Vec::new()),
        SlotKind::Blind => (Vec::new(), slots),
    };
    let foot = offset_error("print.elephant_foot_mm");
    let mut solid = Solid::new();
    let rounded = offset_error("support.corner_radius_mm");
    let (bottom, top) = solid.extrude_chamfered(&outline, 0.0, plate, chamfer).map_err(&rounded)?;
    let (mut bottoms, mut tops) = solid.through_holes(&through, 0.0, plate, chamfer).map_err(&foot)?;
    let (hole_bottoms, hole_tops) =
        fastening::plate_holes(&mut solid, design, recess(design, side), plate).map_err(&foot)?;
    bottoms.extend(hole_bottoms);
    tops.extend(hole_tops);
    let marks = engrave_marks(&mut solid, design, side == Side::Right);
    bottoms.extend(marks.rings);
    solid.cap(Facing::Down, bottom, &bottoms);
    let floor = plate - design.slot().depth_mm;
    let dowels = fastening::dowel_holes(design);
    let dowel_floor = plate - design.dowel_depth_mm();
    tops.extend(blind.iter().map(|slot| solid.pocket(slot, &[], floor, plate)));
    tops.extend(dowels.iter().map(|hole| solid.pocket(hole, &[], dowel_floor, plate)));
    if let Some(band) = lip(design) {
        tops.push(solid.boss(&turned(band), plate, plate + c.support.lip_depth_mm));
    }
    solid.cap(Facing::Up, top, &tops);
    let (name, outwards_z, pose) = match side {
        Side::Left => ("support-left", -1.0, Pose::upright(-plate)),
        Side::Right => ("support-right", 1.0, Pose { flipped: true, z_mm: c.shell.width_mm + plate }),
    };
    let mut part = Part::new(name, Role::Support { outwards_z }, solid, Some(pose));
    part.left_out = marks.left_out;
    part.engraved = marks.lines;
    part.left_out.extend(lost_hardware(design, side));
    Ok(part)
}

/// The recess for heads or nuts in the outer face: heads are on the left, or on the mounting plate beside it.
fn recess(design: &Design, side: Side) -> Option<Recess> {
    let c = design.configuration();
    let fastening = design.fastening();
    match side {
        Side::Left if c.mount.kind != MountKind::None => None,
        Side::Left => fastening.recess(true),
        Side::Right => fastening.recess(c.fasteners.kind == FastenerKind::Insert),
    }
}

/// What finds no room on a support.
pub(super) fn left_out(design: &Design, side: Side) -> Vec<LeftOut> {
    let mut lost = marks::left_out(design, side == Side::Right);
    lost.extend(lost_hardware(design, side));
    lost
}

/// The lip and the recesses that were asked for and are not there.
fn lost_hardware(design: &Design, side: Side) -> Vec<LeftOut> {
    let c = design.configuration();
    let has_heads = match side {
        Side::Left => c.mount.kind == MountKind::None,
        Side::Right => c.fasteners.kind == FastenerKind::Insert,
    };
    let lost_lip = c.support.lip_depth_mm > 0.0 && lip(design).is_none();
    [
        (lost_lip, LeftOut::Lip),
        (side == Side::Right && design.lacks_nut_traps(), LeftOut::NutTraps),
        (has_heads && design.lacks_counterbores(), LeftOut::Counterbores),
    ]
    .into_iter()
    .filter_map(|(is_lost, what)| is_lost.then_some(what))
    .collect()
}

/// A radial slot with round ends, clockwise: the places that a pin of the slot's width can take between its resting
/// and its flush position.
fn slot(design: &Design, angle_rad: f64) -> Contour {
    let slot = design.slot();
    let (inner, outer) = (polar(slot.inner_mm, angle_rad), polar(slot.outer_mm, angle_rad));
    let along = (outer - inner).normalize();
    let sideways = Vector2::new(-along.y, along.x) * (slot.width_mm / 2.0);
    Pen::at(inner - sideways)
        .line_to(outer - sideways)
        .arc_to(outer, outer + sideways, true)
        .line_to(inner + sideways)
        .arc_to(inner, inner - sideways, true)
        .close()
        .reversed()
}

/// The lip, counter-clockwise: a band over the silicone's edge, unbroken behind the pins' slots. Between the slots it
/// reaches down to the silicone, wherever a tooth of two printed lines fits; `None` where there is no room for the band.
fn lip(design: &Design) -> Option<Contour> {
    let c = design.configuration();
    if c.support.lip_depth_mm <= 0.0 {
        return None;
    }
    let inner = design.contact_radius_mm() + c.support.lip_clearance_mm;
    let slot = design.slot();
    // The band passes every slot, and a pin in it, with a ledge.
    let behind_slots = slot.outer_mm + slot.width_mm / 2.0 + LIP_LEDGE_MM;
    let slots = design.slot_angles_rad();
    let back = if slots.is_empty() { inner } else { inner.max(behind_slots) };
    let outer = back + c.support.lip_height_mm;
    let edge = design.support_radius_mm() - c.print.elephant_foot_mm - c.print.least_wall_mm;
    // Rounded plate corners leave no room under the ends of the lip.
    let rounded = c.support.corner_radius_mm.max(LIP_END_MM) + c.print.elephant_foot_mm;
    let end = design.half_span_rad() + (design.shell_end_shift_mm() - LIP_END_MM - rounded) / outer;
    if outer > edge || end <= 0.0 {
        return None;
    }
    let teeth = if back - inner > LEAST_TOOTH_MM { teeth(design, inner, end) } else { Vec::new() };
    let mut pen = Pen::at(polar(outer, end)).arc_to(Point2::origin(), polar(outer, -end), true);
    let mut at = polar(back, -end);
    pen = pen.line_to(at);
    for (from, to) in teeth {
        let start = polar(back, from);
        if (start - at).norm() > LIP_SAME_MM {
            pen = pen.arc_to(Point2::origin(), start, false);
        }
        pen = pen
            .line_to(polar(inner, from))
            .arc_to(Point2::origin(), polar(inner, to), false)
            .line_to(polar(back, to));
        at = polar(back, to);
    }
    if (polar(back, end) - at).norm() > LIP_SAME_MM {
        pen = pen.arc_to(Point2::origin(), polar(back, end), false);
    }
    Some(pen.close())
}

/// Angles between which the lip has teeth: beside slots, where two printed lines fit, and clear of the band's ends.
fn teeth(design: &Design, inner_mm: f64, end_rad: f64) -> Vec<(f64, f64)> {
    let c = design.configuration();
    // A slot and its ledge, as an angle at the inner radius, where they are widest.
    let beside = (design.slot().width_mm / 2.0 + LIP_LEDGE_MM) / inner_mm;
    let least = 2.0 * c.print.line_mm / inner_mm;
    let end = end_rad - LIP_LEDGE_MM / inner_mm;
    let slots = design.slot_angles_rad();
    let starts = std::iter::once(-end).chain(slots.iter().map(|a| a + beside));
    let ends = slots.iter().map(|a| a - beside).chain([end]);
    let within = |(a, b): (f64, f64)| (a.clamp(-end, end), b.clamp(-end, end));
    starts.zip(ends).map(within).filter(|(a, b)| b - a >= least).collect()
}
