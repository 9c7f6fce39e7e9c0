//! Keys: cones that register the parts of a split mould. One sits off centre, so that they fit one way only.

use crate::config::MouldTable;
use crate::design::Design;
use pinswitch_solid::profile::{Contour, OffsetError, Point2, polar};
use pinswitch_solid::solid::{Facing, RingId, Solid};

use super::Cavity;

/// Where the keys lie, as shares of half the span.
pub(crate) const PLACES: [f64; 3] = [-0.8, 0.35, 0.8];
/// How much narrower a key is at its head, per side and mm of height.
const TAPER: f64 = 0.2;
/// Play between a key's head and the end of its hole, mm.
const HEAD_PLAY_MM: f64 = 0.4;
/// Least wall around a key, mm.
const WALL_MM: f64 = 1.0;
/// Least radius of a key's head, mm.
const LEAST_HEAD_MM: f64 = 0.1;
/// What the ring must be higher than a key.
pub(crate) const HOLE_END_MM: f64 = HEAD_PLAY_MM + WALL_MM;

/// Radial thickness of the ring that keys of this diameter need.
pub(crate) fn ring_wall_mm(m: &MouldTable, key_diameter_mm: f64) -> f64 {
    m.wall_mm.max(key_diameter_mm + 2.0 * (m.clearance_mm + WALL_MM))
}

/// Height at which a key's head would be too narrow.
pub(crate) fn highest_mm(key_diameter_mm: f64) -> f64 {
    (key_diameter_mm / 2.0 - LEAST_HEAD_MM) / TAPER
}

/// Radial thickness of the ring of a design.
pub(super) fn wall_of_ring_mm(design: &Design) -> f64 {
    let m = &design.configuration().mould;
    ring_wall_mm(m, m.key_diameter_mm)
}

/// Middles of the keys, about the pulley's axis.
pub(crate) fn middles(design: &Design) -> [Point2; 3] {
    let cavity = Cavity::of(design).sector;
    let radius = cavity.outer_mm + wall_of_ring_mm(design) / 2.0;
    PLACES.map(|place| polar(radius, place * cavity.half_span_rad))
}

/// Circles of the keys' feet, counter-clockwise, widened by `play_mm`.
fn feet(design: &Design, play_mm: f64) -> Vec<Contour> {
    let radius = design.configuration().mould.key_diameter_mm / 2.0 + play_mm;
    middles(design).map(|middle| Contour::circle(middle, radius)).to_vec()
}

fn head(foot: &Contour, height_mm: f64) -> Result<Contour, OffsetError> {
    foot.offset(height_mm * TAPER)
}

/// Keys that stand on the face at `z_mm`; returns their feet, which are holes in that face's cap.
pub(super) fn pegs(solid: &mut Solid, design: &Design, z_mm: f64) -> Result<Vec<RingId>, OffsetError> {
    let height = design.configuration().mould.key_height_mm;
    feet(design, 0.0)
        .into_iter()
        .map(|foot| {
            let head = head(&foot, height)?;
            let (foot, head) = (solid.ring(foot, z_mm), solid.ring(head, z_mm + height));
            solid.wall(foot, head);
            solid.cap(Facing::Up, head, &[]);
            Ok(foot)
        })
        .collect()
}

/// Blind holes for the keys in the face at `z_mm` below; returns their mouths.
pub(super) fn blind_holes(solid: &mut Solid, design: &Design, z_mm: f64) -> Result<Vec<RingId>, OffsetError> {
    let m = &design.configuration().mould;
    let depth = m.key_height_mm + HEAD_PLAY_MM;
    feet(design, m.clearance_mm)
        .into_iter()
        .map(|mouth| {
            let end = head(&mouth, m.key_height_mm)?.reversed();
            let (mouth, end) = (solid.ring(mouth.reversed(), z_mm), solid.ring(end, z_mm + depth));
            solid.wall(mouth, end);
            solid.cap(Facing::Down, end, &[]);
            Ok(mouth)
        })
        .collect()
}

/// Straight through holes for the keys, clockwise.
pub(super) fn through_holes(design: &Design) -> Vec<Contour> {
    let clearance = design.configuration().mould.clearance_mm;
    feet(design, clearance).iter().map(Contour::reversed).collect()
}
