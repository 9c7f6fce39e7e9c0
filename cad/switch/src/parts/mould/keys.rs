//! The keys of a split mould, and their holes.

use crate::design::Design;
use crate::design::mould_keys::{HEAD_PLAY_MM, PLACES, TAPER, ring_wall_mm};
use pinswitch_solid::profile::{Contour, OffsetError, Point2, polar};
use pinswitch_solid::solid::{Facing, RingId, Solid};

use super::Cavity;

/// Radial thickness of the ring, mm.
pub(super) fn wall_of_ring_mm(design: &Design) -> f64 {
    let m = &design.configuration().mould;
    ring_wall_mm(m, m.key_diameter_mm)
}

/// Centres of the keys.
pub(crate) fn middles(design: &Design) -> [Point2; 3] {
    let cavity = Cavity::of(design).sector;
    let radius = cavity.outer_mm + wall_of_ring_mm(design) / 2.0;
    PLACES.map(|place| polar(radius, place * cavity.half_span_rad))
}

/// Circles of the feet of the keys, counter-clockwise, enlarged by `play_mm`.
fn feet(design: &Design, play_mm: f64) -> Vec<Contour> {
    let radius = design.configuration().mould.key_diameter_mm / 2.0 + play_mm;
    middles(design).map(|middle| Contour::circle(middle, radius)).to_vec()
}

fn head(foot: &Contour, height_mm: f64) -> Result<Contour, OffsetError> {
    foot.offset(height_mm * TAPER)
}

/// Adds keys on the face at `z_mm`; returns their feet, which are holes in the cap of that face.
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

/// Adds blind holes for the keys in the lower face at `z_mm`; returns their mouths.
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

/// Through holes for the keys, clockwise.
pub(super) fn through_holes(design: &Design) -> Vec<Contour> {
    let clearance = design.configuration().mould.clearance_mm;
    feet(design, clearance).iter().map(Contour::reversed).collect()
}
