//! The mould in one piece: a tray with a basin above the cavity.

use super::super::{Part, Role, offset_error};
use super::Cavity;
use crate::config::ConfigError;
use crate::design::Design;
use pinswitch_solid::profile::Contour;
use pinswitch_solid::solid::{Facing, Solid};

/// How far the basin reaches beyond the cavity: its ledge guides the blade that cuts the layer to width.
const LEDGE_MM: f64 = 1.0;

/// The hollow of the tray: cavity foot, cavity mouth and basin, counter-clockwise.
struct TrayCavity {
    cavity: Cavity,
    draft_mm: f64,
    foot: Contour,
    mouth: Contour,
    basin: Contour,
}

fn tray_cavity(design: &Design) -> TrayCavity {
    let cavity = Cavity::of(design);
    let draft_mm = cavity.depth_mm * design.configuration().mould.draft_deg.to_radians().tan();
    let ribs = |sector: super::Sector| sector.grooved(&cavity.groove_angles_rad, cavity.groove_radius_mm);
    // Inner and end walls lean; the ribbed wall shapes the contact and stays upright.
    let wide = cavity.sector.grown(draft_mm, 0.0, draft_mm);
    let (foot, mouth) = (ribs(cavity.sector), ribs(wide));
    TrayCavity { draft_mm, foot, mouth, basin: wide.grown(LEDGE_MM, LEDGE_MM, LEDGE_MM).outline(), cavity }
}

/// What the tray holds when it is full to the brim, mm³.
pub(super) fn filled_mm3(design: &Design) -> f64 {
    let TrayCavity { cavity, foot, mouth, basin, .. } = tray_cavity(design);
    let mut solid = Solid::new();
    let (foot, mouth) = (solid.ring(foot, 0.0), solid.ring(mouth, cavity.depth_mm));
    solid.wall(foot, mouth);
    solid.volume_mm3() + basin.area_mm2() * design.configuration().mould.overfill_mm
}

pub(in super::super) fn one_piece(design: &Design) -> Result<Part, ConfigError> {
    let m = &design.configuration().mould;
    let TrayCavity { cavity, draft_mm, foot, mouth, basin } = tray_cavity(design);
    let wall = m.wall_mm + LEDGE_MM + draft_mm;
    let body = cavity.sector.grown(wall, m.wall_mm + LEDGE_MM, wall).outline();
    let (floor, ledge) = (m.floor_mm, m.floor_mm + cavity.depth_mm);
    let has_basin = m.overfill_mm > 0.0;
    let top = ledge + m.overfill_mm;
    let chamfer = design.configuration().print.elephant_foot_mm;

    let mut solid = Solid::new();
    let (bottom, brim) =
        solid.extrude_chamfered(&body, 0.0, top, chamfer).map_err(offset_error("print.elephant_foot_mm"))?;
    solid.cap(Facing::Down, bottom, &[]);
    let cavity_foot = solid.ring(foot.reversed(), floor);
    let cavity_mouth = solid.ring(mouth.reversed(), ledge);
    solid.wall(cavity_foot, cavity_mouth);
    solid.cap(Facing::Up, cavity_foot, &[]);
    if has_basin {
        let (basin_foot, basin_brim) = solid.extrude(&basin.reversed(), ledge, top);
        solid.cap(Facing::Up, basin_foot, &[cavity_mouth]);
        solid.cap(Facing::Up, brim, &[basin_brim]);
    } else {
        solid.cap(Facing::Up, brim, &[cavity_mouth]);
    }
    Ok(Part::new("mould-tray", Role::Mould, solid, None))
}
