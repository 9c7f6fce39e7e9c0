//! Dimensions of the basin of the one-piece mould.

use crate::config::MouldTable;

/// Width of the ledge between cavity and basin, mm. It guides the blade that cuts the layer to its width.
pub(crate) const LEDGE_MM: f64 = 1.0;

/// Returns how far the walls of the basin lean outward at the brim, mm.
///
/// Floor, inner wall, ribs and end walls of the cavity shape the layer, which must touch the shell over its full width.
/// They are vertical, and silicone peels from them. The content of the basin is cut off: only its walls may lean.
pub(crate) fn lean_mm(m: &MouldTable) -> f64 {
    m.overfill_mm * libm::tan(m.draft_deg.to_radians())
}

/// Returns the width of the tray beyond the cavity, mm.
pub(crate) fn around_mm(m: &MouldTable) -> f64 {
    m.wall_mm + LEDGE_MM + lean_mm(m)
}
