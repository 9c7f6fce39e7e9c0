//! The one-piece mould: a tray with a basin above the cavity.

use super::super::{Part, Role, offset_error};
use super::Cavity;
use super::lid::gap_mm;
use crate::config::ConfigError;
use crate::design::Design;
use crate::design::mould_tray::{LEDGE_MM, around_mm, lean_mm};
use pinswitch_solid::profile::{Contour, Point2, Vector2};
use pinswitch_solid::solid::{Facing, Solid};

/// Bisection steps to the least distance of the cavities of a gang mould.
const BISECTIONS: usize = 40;

/// The hollow of the tray: the cavity, and the outlines of layer, ledge and brim, counter-clockwise.
struct TrayCavity {
    cavity: Cavity,
    layer: Contour,
    ledge: Contour,
    brim: Contour,
}

fn tray_cavity(design: &Design) -> TrayCavity {
    let cavity = Cavity::of(design);
    let grown = |mm: f64| cavity.sector.grown(mm, mm, mm).outline();
    TrayCavity {
        layer: cavity.section(),
        ledge: grown(LEDGE_MM),
        brim: grown(LEDGE_MM + lean_mm(&design.configuration().mould)),
        cavity,
    }
}

/// Volume of the basin, mm³.
pub(super) fn basin_mm3(design: &Design) -> f64 {
    let TrayCavity { ledge, brim, .. } = tray_cavity(design);
    let mut solid = Solid::new();
    let (ledge, brim) = (solid.ring(ledge, 0.0), solid.ring(brim, design.configuration().mould.overfill_mm));
    solid.wall(ledge, brim);
    solid.volume_mm3()
}

/// The step from one cavity of a gang mould to the next, with a wall between their basins. Layers of less than 180 degrees
/// nest in each other; others are side by side.
fn step(design: &Design, brim: &Contour) -> Vector2 {
    let wall = design.configuration().mould.wall_mm;
    let (low, high) = brim.bounds();
    if !design.gang_nests() {
        return Vector2::new(high.x - low.x + wall, 0.0);
    }
    let fits = |mm: f64| gap_mm(brim, &brim.translated(Vector2::new(0.0, mm))) >= wall;
    let (mut far, mut near) = (high.y - low.y + wall, 0.0);
    for _ in 0..BISECTIONS {
        let middle = f64::midpoint(far, near);
        if fits(middle) { far = middle } else { near = middle }
    }
    Vector2::new(0.0, far)
}

/// Sides of the block of a gang mould, mm: along the tangent in the middle of the wrap, and across it.
pub fn gang_mm(design: &Design) -> [f64; 2] {
    let (low, high) = gang(design).bounds();
    [high.x - low.x, high.y - low.y]
}

/// The block of a gang mould: a rectangle around all basins.
fn gang(design: &Design) -> Contour {
    let m = &design.configuration().mould;
    let TrayCavity { brim, .. } = tray_cavity(design);
    let last = step(design, &brim) * (m.layers as f64 - 1.0);
    let (low, high) = brim.bounds();
    let around = Vector2::new(m.wall_mm, m.wall_mm);
    let (low, high) = (low - around, high + last + around);
    Contour::polygon(vec![low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)])
}

pub(in super::super) fn one_piece(design: &Design) -> Result<Part, ConfigError> {
    let m = &design.configuration().mould;
    let TrayCavity { cavity, layer, ledge, brim } = tray_cavity(design);
    let around = around_mm(m);
    let body =
        if m.layers > 1 { gang(design) } else { cavity.sector.grown(around, around, around).outline() };
    let step = if m.layers > 1 { step(design, &brim) } else { Vector2::zeros() };
    let ledge_mm = m.floor_mm + cavity.depth_mm;
    let top_mm = ledge_mm + m.overfill_mm;
    let chamfer = design.configuration().print.elephant_foot_mm;

    let mut solid = Solid::new();
    let (bottom, top) = solid
        .extrude_chamfered(&body, 0.0, top_mm, chamfer)
        .map_err(offset_error("print.elephant_foot_mm"))?;
    solid.cap(Facing::Down, bottom, &[]);
    let mut mouths = Vec::new();
    for i in 0..m.layers {
        let placed = |contour: &Contour| contour.translated(step * i as f64).reversed();
        let (foot, mouth) = solid.extrude(&placed(&layer), m.floor_mm, ledge_mm);
        solid.cap(Facing::Up, foot, &[]);
        if m.overfill_mm > 0.0 {
            let (ledge, brim) = (solid.ring(placed(&ledge), ledge_mm), solid.ring(placed(&brim), top_mm));
            solid.wall(ledge, brim);
            solid.cap(Facing::Up, ledge, &[mouth]);
            mouths.push(brim);
        } else {
            mouths.push(mouth);
        }
    }
    solid.cap(Facing::Up, top, &mouths);
    Ok(Part::new("mould-tray", Role::Mould, solid, None))
}
