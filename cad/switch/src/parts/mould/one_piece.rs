//! The mould in one piece: a tray with a basin above the cavity.

use super::super::{Part, Role, offset_error};
use super::Cavity;
use crate::config::{ConfigError, MouldTable};
use crate::design::Design;
use pinswitch_solid::profile::Contour;
use pinswitch_solid::solid::{Facing, Solid};

/// How far the basin reaches beyond the cavity: its ledge guides the blade that cuts the layer to width.
const LEDGE_MM: f64 = 1.0;

/// How far the basin's walls lean outward at the brim, mm.
///
/// Floor, inner wall, ribs and end walls shape the layer, which must lie on the shell over its whole width: they stay
/// upright, and silicone peels from them. What the basin holds is cut off: only its walls may lean.
fn lean_mm(m: &MouldTable) -> f64 {
    m.overfill_mm * m.draft_deg.to_radians().tan()
}

/// How far the tray reaches beyond the cavity, mm.
pub(crate) fn around_mm(m: &MouldTable) -> f64 {
    m.wall_mm + LEDGE_MM + lean_mm(m)
}

/// The hollow of the tray, counter-clockwise: the cavity, and the basin at its ledge and at its brim.
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

/// What the basin holds when it is full to the brim, mm³.
pub(super) fn basin_mm3(design: &Design) -> f64 {
    let TrayCavity { ledge, brim, .. } = tray_cavity(design);
    let mut solid = Solid::new();
    let (ledge, brim) = (solid.ring(ledge, 0.0), solid.ring(brim, design.configuration().mould.overfill_mm));
    solid.wall(ledge, brim);
    solid.volume_mm3()
}

pub(in super::super) fn one_piece(design: &Design) -> Result<Part, ConfigError> {
    let m = &design.configuration().mould;
    let TrayCavity { cavity, layer, ledge, brim } = tray_cavity(design);
    let around = around_mm(m);
    let body = cavity.sector.grown(around, around, around).outline();
    let ledge_mm = m.floor_mm + cavity.depth_mm;
    let top_mm = ledge_mm + m.overfill_mm;
    let chamfer = design.configuration().print.elephant_foot_mm;

    let mut solid = Solid::new();
    let (bottom, top) = solid
        .extrude_chamfered(&body, 0.0, top_mm, chamfer)
        .map_err(offset_error("print.elephant_foot_mm"))?;
    solid.cap(Facing::Down, bottom, &[]);
    let (foot, mouth) = solid.extrude(&layer.reversed(), m.floor_mm, ledge_mm);
    solid.cap(Facing::Up, foot, &[]);
    if m.overfill_mm > 0.0 {
        let (ledge, brim) = (solid.ring(ledge.reversed(), ledge_mm), solid.ring(brim.reversed(), top_mm));
        solid.wall(ledge, brim);
        solid.cap(Facing::Up, ledge, &[mouth]);
        solid.cap(Facing::Up, top, &[brim]);
    } else {
        solid.cap(Facing::Up, top, &[mouth]);
    }
    Ok(Part::new("mould-tray", Role::Mould, solid, None))
}
