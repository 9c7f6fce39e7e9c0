//! The lid of the split mould. It sets the width of the layer, and has a pouring funnel and vents at both ends.

use super::super::{Part, Pose, Role, offset_error};
use super::split::plate_sector;
use super::{Cavity, keys};
use crate::config::ConfigError;
use crate::design::Design;
use pinswitch_solid::profile::{Contour, Pen, Point2, polar};
use pinswitch_solid::solid::{Facing, Solid};

/// Width of pouring slot and vents as a share of the free cavity under the ribs.
const OPENING: f64 = 0.8;
/// Half of the length of the pouring slot as a share of half the span.
const SLOT_SHARE: f64 = 0.15;
/// Position of the vents as a share of half the span.
const VENT_SHARE: f64 = 0.9;
/// Least chamfer that can be printed, mm (cad/doc/print-limits.md, "First layer").
const LEAST_CHAMFER_MM: f64 = 0.02;

/// The openings of the lid, clockwise.
struct Openings {
    keys: Vec<Contour>,
    vents: Vec<Contour>,
    /// Lower and upper end of the pouring funnel.
    spout: Contour,
    mouth: Contour,
}

fn openings(design: &Design, plate: &Contour) -> Result<Openings, ConfigError> {
    let c = design.configuration();
    let cavity = Cavity::of(design);
    let free = cavity.sector.outer_mm - cavity.sector.inner_mm - cavity.groove_radius_mm;
    let middle = cavity.sector.inner_mm + free / 2.0;
    let vent = (c.mould.vent_diameter_mm.min(OPENING * free)) / 2.0;
    let keys = keys::through_holes(design);
    let vents = [-1.0, 1.0]
        .map(|side| {
            let angle = side * (VENT_SHARE * design.half_span_rad() - vent / middle).max(0.0);
            Contour::circle(polar(middle, angle), vent).reversed()
        })
        .to_vec();
    let width = OPENING * free;
    let spout = arc_slot(middle, width / 2.0, SLOT_SHARE * design.half_span_rad());
    // The funnel widens upward, up to a wall to its neighbours.
    let neighbours = keys.iter().chain(&vents).chain([plate]);
    let room = neighbours.map(|other| gap_mm(&spout, other)).fold(f64::INFINITY, f64::min);
    let wanted = (c.mould.pour_width_mm - width) / 2.0;
    // At least two printed lines.
    let wall = c.print.least_wall_mm.max(2.0 * c.print.line_mm);
    let widening = wanted.min(room - wall).clamp(0.0, c.mould.floor_mm);
    let mouth = spout.offset(widening).map_err(offset_error("mould.pour_width_mm"))?;
    Ok(Openings { keys, vents, spout, mouth })
}

/// Returns the counter-clockwise outlines of the silicone in the lid: at the lower and the upper end of the funnel, and in the
/// vents. `None` if they cannot be built, which [`lid`] reports.
pub(super) fn silicone_outlines(design: &Design) -> Option<(Contour, Contour, Vec<Contour>)> {
    let plate = plate_sector(design, &Cavity::of(design)).outline();
    let o = openings(design, &plate).ok()?;
    Some((o.spout.reversed(), o.mouth.reversed(), o.vents.iter().map(Contour::reversed).collect()))
}

/// Volume of funnel and vents, mm³; 0 if they cannot be built, which [`lid`] reports.
pub(super) fn openings_mm3(design: &Design) -> f64 {
    let plate = plate_sector(design, &Cavity::of(design)).outline();
    openings(design, &plate).map_or(0.0, |o| {
        let thickness = design.configuration().mould.floor_mm;
        let mut solid = Solid::new();
        let (spout, mouth) = (solid.ring(o.spout.reversed(), 0.0), solid.ring(o.mouth.reversed(), thickness));
        solid.wall(spout, mouth);
        solid.volume_mm3() - o.vents.iter().map(Contour::area_mm2).sum::<f64>() * thickness
    })
}

pub(in crate::parts) fn lid(design: &Design) -> Result<Part, ConfigError> {
    let c = design.configuration();
    let thickness = c.mould.floor_mm;
    let chamfer = c.print.elephant_foot_mm;
    let foot = offset_error("print.elephant_foot_mm");
    let plate = plate_sector(design, &Cavity::of(design)).outline();
    let o = openings(design, &plate)?;
    let holes = [o.keys, o.vents].concat();

    let mut solid = Solid::new();
    let (bottom, top) = solid.extrude_chamfered(&plate, 0.0, thickness, chamfer).map_err(&foot)?;
    let of_holes = hole_chamfer_mm(design, &plate, &o.spout, &holes);
    let (mut bottoms, mut tops) = solid.through_holes(&holes, 0.0, thickness, of_holes).map_err(&foot)?;
    let (spout, mouth) = (solid.ring(o.spout, 0.0), solid.ring(o.mouth, thickness));
    solid.wall(spout, mouth);
    bottoms.push(spout);
    tops.push(mouth);
    solid.cap(Facing::Down, bottom, &bottoms);
    solid.cap(Facing::Up, top, &tops);
    let mut part = Part::new("mould-lid", Role::Mould, solid, None);
    part.tool_pose = Some(Pose::upright(c.mould.floor_mm + Cavity::of(design).depth_mm));
    Ok(part)
}

/// The chamfer of the holes of the lid, mm: that of all parts, or less to keep walls on the bed between the holes, the funnel
/// and the chamfered edge.
fn hole_chamfer_mm(design: &Design, plate: &Contour, spout: &Contour, holes: &[Contour]) -> f64 {
    let print = &design.configuration().print;
    let wall = print.least_wall_mm;
    let room = |i: usize, hole: &Contour| {
        let apart = holes.iter().skip(i + 1).map(|other| (gap_mm(hole, other) - wall) / 2.0);
        let neighbours = [gap_mm(hole, spout) - wall, gap_mm(hole, plate) - wall - print.elephant_foot_mm];
        apart.chain(neighbours).fold(f64::INFINITY, f64::min)
    };
    let room = holes.iter().enumerate().map(|(i, hole)| room(i, hole)).fold(f64::INFINITY, f64::min);
    let chamfer = print.elephant_foot_mm.min(room);
    if chamfer < LEAST_CHAMFER_MM { 0.0 } else { chamfer }
}

/// Least distance of eight points on each edge of `slot` from the curve of `other`, mm.
fn gap_mm(slot: &Contour, other: &Contour) -> f64 {
    let points = slot.flattened(&vec![8; slot.edges().len()]);
    points.iter().map(|p| other.distance_mm(*p)).fold(f64::INFINITY, f64::min)
}

/// A slot along the arc with round ends, clockwise.
fn arc_slot(radius_mm: f64, half_width_mm: f64, half_rad: f64) -> Contour {
    let (inner, outer) = (radius_mm - half_width_mm, radius_mm + half_width_mm);
    let end = |side: f64| polar(radius_mm, side * half_rad);
    Pen::at(polar(inner, half_rad))
        .arc_to(end(1.0), polar(outer, half_rad), true)
        .arc_to(Point2::origin(), polar(outer, -half_rad), true)
        .arc_to(end(-1.0), polar(inner, -half_rad), true)
        .arc_to(Point2::origin(), polar(inner, half_rad), false)
        .close()
        .reversed()
}
