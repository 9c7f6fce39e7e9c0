//! The side supports: plates with radial slots, a lip over the silicone's edge and the shell's holes
//! (cad/doc/dimensions.md, "Side supports").

use super::label::{Zone, engrave};
use super::shell::wall_sector;
use super::{Part, Pose, Role, holes_at, offset_error};
use crate::config::{ConfigError, SlotKind};
use crate::design::Design;
use pinswitch_solid::profile::{Contour, Pen, Point2, Vector2, polar};
use pinswitch_solid::solid::{Facing, Solid};

/// The lip ends this far inside the plate, mm: two coincident walls would not be a solid.
const LIP_END_MM: f64 = 0.5;
/// Ledge between a slot and the lip beside it, mm: likewise.
const LIP_LEDGE_MM: f64 = 0.1;

/// Which side of the switch a support is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
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
    let mut through: Vec<_> = holes_at(
        design.fastener_radius_mm(),
        &design.fastener_angles_rad(),
        c.fasteners.hole_diameter_mm / 2.0,
    )
    .into_iter()
    .map(turned)
    .collect();
    let slots: Vec<_> = design.slot_angles_rad().iter().map(|a| turned(slot(design, *a))).collect();
    let mut blind = Vec::new();
    match c.support.slot_kind {
        SlotKind::Through => through.extend(slots),
        SlotKind::Blind => blind = slots,
    }
    let foot = offset_error("print.elephant_foot_mm");
    let mut solid = Solid::new();
    let rounded = offset_error("support.corner_radius_mm");
    let (bottom, top) = solid.extrude_chamfered(&outline, 0.0, plate, chamfer).map_err(&rounded)?;
    let (bottoms, mut tops) = solid.through_holes(&through, 0.0, plate, chamfer).map_err(&foot)?;
    solid.cap(Facing::Down, bottom, &bottoms);
    let floor = plate - design.slot().depth_mm;
    tops.extend(blind.iter().map(|slot| solid.pocket(slot, &[], floor, plate)));
    let lip_top = plate + c.support.lip_depth_mm;
    let lip = lip(design);
    let lost_lip = lip.is_empty() && c.support.lip_depth_mm > 0.0;
    for piece in lip {
        tops.push(solid.boss(&turned(piece), plate, lip_top));
    }
    let under_slots = design.slot().inner_edge_mm();
    let engraved = engrave(&mut solid, design, &Zone::between_fasteners(design, under_slots), plate);
    tops.extend(engraved.rings);
    solid.cap(Facing::Up, top, &tops);
    let (name, outwards_z, pose) = match side {
        Side::Left => ("support-left", -1.0, Pose::upright(-plate)),
        Side::Right => ("support-right", 1.0, Pose { flipped: true, z_mm: c.shell.width_mm + plate }),
    };
    let mut part = Part::new(name, Role::Support { outwards_z }, solid, Some(pose));
    part.notes.extend(engraved.note);
    if lost_lip {
        part.notes.push(
            "the lip does not fit between the slots and is left out: use support.slots = \"occupied\""
                .to_owned(),
        );
    }
    Ok(part)
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

/// Pieces of the lip, counter-clockwise: they reach over the silicone's edge wherever no pin needs the room.
fn lip(design: &Design) -> Vec<Contour> {
    let c = design.configuration();
    if c.support.lip_depth_mm <= 0.0 {
        return Vec::new();
    }
    let inner = design.contact_radius_mm() + c.support.lip_clearance_mm;
    let outer = inner + c.support.lip_height_mm;
    let edge = design.support_radius_mm() - c.print.elephant_foot_mm - c.print.least_wall_mm;
    let end = design.half_span_rad() + (c.segment.end_margin_mm - LIP_END_MM) / outer;
    if outer > edge {
        return Vec::new();
    }
    // A slot and its clearance, as an angle at the inner radius, where they are widest.
    let beside = (design.slot().width_mm / 2.0 + LIP_LEDGE_MM) / inner;
    let slots = design.slot_angles_rad();
    let mut starts = vec![-end];
    let mut ends = Vec::new();
    for angle in slots {
        ends.push(angle - beside);
        starts.push(angle + beside);
    }
    // Rounded plate corners leave no room under the ends of the lip.
    ends.push(end);
    let rounded = c.support.corner_radius_mm / outer;
    let clamp = |a: f64| a.clamp(-end + rounded, end - rounded);
    let least = 2.0 * c.print.line_mm / inner;
    let pieces = starts.into_iter().zip(ends).map(|(a, b)| (clamp(a), clamp(b)));
    pieces.filter(|(a, b)| b - a >= least).map(|(a, b)| annular_piece(inner, outer, a, b)).collect()
}

/// An annular sector between two angles, counter-clockwise.
fn annular_piece(inner_mm: f64, outer_mm: f64, from_rad: f64, to_rad: f64) -> Contour {
    Pen::at(polar(inner_mm, to_rad))
        .line_to(polar(outer_mm, to_rad))
        .arc_to(Point2::origin(), polar(outer_mm, from_rad), true)
        .line_to(polar(inner_mm, from_rad))
        .arc_to(Point2::origin(), polar(inner_mm, to_rad), false)
        .close()
}
