//! The casting mould, with its axis vertical and open at the top (cad/doc/dimensions.md, "Mould").

mod cast;
pub(crate) mod keys;
mod lid;
mod one_piece;
mod split;

use super::Sector;
use super::layer::layer_sector;
use crate::config::MouldKind;
use crate::design::Design;
use pinswitch_solid::profile::Contour;

pub(crate) use cast::{CAST_LAYER, CAST_OVERFILL, CAST_SPRUE, CAST_VENT, cast};
pub(super) use lid::lid;
pub(super) use one_piece::one_piece;
pub(super) use split::{core, core_has_lost_label, ring};

/// Returns the volume in mm³ of the cavity, and of the space above it: the basin of the one-piece mould, or
/// funnel and vents of the split mould.
pub fn cavity_mm3(design: &Design) -> (f64, f64) {
    let cavity = Cavity::of(design);
    let layer = cavity.section().area_mm2() * cavity.depth_mm;
    let above = match design.configuration().mould.kind {
        MouldKind::None => 0.0,
        MouldKind::OnePiece => one_piece::basin_mm3(design),
        MouldKind::Split => lid::openings_mm3(design),
    };
    (layer, above)
}

/// The cavity without its ribs: the layer, enlarged by the shrinkage of silicone.
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

    /// The section of the layer, counter-clockwise: the sector with the grooves that the ribs form.
    fn section(&self) -> Contour {
        self.sector.grooved(&self.groove_angles_rad, self.groove_radius_mm)
    }
}

#[cfg(test)]
mod tests;
