//! The one-piece mould: a tray with a basin above the cavity.

use super::super::{Part, Role, offset_error};
use super::Cavity;
use crate::config::ConfigError;
use crate::design::Design;
use crate::design::mould_tray::{LEDGE_MM, around_mm, lean_mm};
use pinswitch_solid::profile::Contour;
use pinswitch_solid::solid::{Facing, Solid};

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

/// Returns the outlines of the basin at its ledge and at its brim, counter-clockwise.
pub(super) fn basin(design: &Design) -> [Contour; 2] {
    let TrayCavity { ledge, brim, .. } = tray_cavity(design);
    [ledge, brim]
}

/// Volume of the basin, mm³.
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
    let mouth = if m.overfill_mm > 0.0 {
        let (ledge, brim) = (solid.ring(ledge.reversed(), ledge_mm), solid.ring(brim.reversed(), top_mm));
        solid.wall(ledge, brim);
        solid.cap(Facing::Up, ledge, &[mouth]);
        brim
    } else {
        mouth
    };
    solid.cap(Facing::Up, top, &[mouth]);
    Ok(Part::new("mould-tray", Role::Mould, solid, None))
}
