//! The mould in one piece: a tray with a basin above the cavity.

use super::super::{Part, swallowed};
use super::Cavity;
use crate::config::ConfigError;
use crate::design::Design;
use crate::solid::{Facing, Solid};

/// How far the basin reaches beyond the cavity: its ledge guides the blade that cuts the layer to width.
const LEDGE_MM: f64 = 1.0;

pub(in super::super) fn one_piece(design: &Design) -> Result<Part, ConfigError> {
    let m = &design.configuration().mould;
    let cavity = Cavity::of(design);
    let ribs = |sector: super::Sector| sector.grooved(&cavity.groove_angles_rad, cavity.groove_radius_mm);
    let draft = cavity.depth_mm * m.draft_deg.to_radians().tan();
    let wall = m.wall_mm + LEDGE_MM + draft;
    let body = cavity.sector.grown(wall, m.wall_mm + LEDGE_MM, wall).outline();
    // Inner and end walls lean; the ribbed wall shapes the contact and stays upright.
    let (foot, mouth) = (cavity.sector, cavity.sector.grown(draft, 0.0, draft));
    let basin = mouth.grown(LEDGE_MM, LEDGE_MM, LEDGE_MM).outline().reversed();
    let (floor, ledge) = (m.floor_mm, m.floor_mm + cavity.depth_mm);
    let has_basin = m.overfill_mm > 0.0;
    let top = ledge + m.overfill_mm;
    let chamfer = design.configuration().print.elephant_foot_mm;

    let mut solid = Solid::new();
    let (bottom, brim) =
        solid.extrude_chamfered(&body, 0.0, top, chamfer).map_err(swallowed("print.elephant_foot_mm"))?;
    solid.cap(Facing::Down, bottom, &[]);
    let cavity_foot = solid.ring(ribs(foot).reversed(), floor);
    let cavity_mouth = solid.ring(ribs(mouth).reversed(), ledge);
    solid.wall(cavity_foot, cavity_mouth);
    solid.cap(Facing::Up, cavity_foot, &[]);
    if has_basin {
        let (basin_foot, basin_brim) = solid.extrude(&basin, ledge, top);
        solid.cap(Facing::Up, basin_foot, &[cavity_mouth]);
        solid.cap(Facing::Up, brim, &[basin_brim]);
    } else {
        solid.cap(Facing::Up, brim, &[cavity_mouth]);
    }
    Ok(Part::new("mould-tray", solid, None))
}
