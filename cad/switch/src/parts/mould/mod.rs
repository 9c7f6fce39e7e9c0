//! The casting mould, axis upright, open on top (cad/doc/dimensions.md, "Mould").

pub(crate) mod keys;
mod lid;
mod one_piece;
mod split;

use super::Sector;
use super::layer::layer_sector;
use crate::config::MouldKind;
use crate::design::Design;

pub(super) use lid::lid;
pub(super) use one_piece::one_piece;
pub(super) use split::{core, ring};

/// Volume in mm³ of the mould's cavity up to the layer's width, and of what lies above it: the basin of the one-piece
/// mould, or the split mould's funnel and vents. Draft counts as overfill: it is cut or pressed away.
pub fn cavity_mm3(design: &Design) -> (f64, f64) {
    let cavity = Cavity::of(design);
    let section = cavity.sector.grooved(&cavity.groove_angles_rad, cavity.groove_radius_mm).area_mm2();
    let layer = section * cavity.depth_mm;
    let above = match design.configuration().mould.kind {
        MouldKind::None => 0.0,
        MouldKind::OnePiece => one_piece::filled_mm3(design) - layer,
        MouldKind::Split => lid::openings_mm3(design),
    };
    (layer, above)
}

/// The cavity before its ribs: the layer, enlarged by what the silicone shrinks.
struct Cavity {
    sector: Sector,
    groove_radius_mm: f64,
    groove_angles_rad: Vec<f64>,
    depth_mm: f64,
}

impl Cavity {
    fn of(design: &Design) -> Self {
        let c = design.configuration();
        let scale = 1.0 / (1.0 - c.mould.shrinkage_pct / 100.0);
        Self {
            sector: layer_sector(design).scaled(scale),
            groove_radius_mm: c.segment.groove_radius_mm * scale,
            groove_angles_rad: design.groove_angles_rad(),
            depth_mm: design.layer_width_mm() * scale,
        }
    }
}
