//! Dimensions of the keys that register the parts of a split mould: cones on one part in holes of the next.

use crate::config::MouldTable;

/// Positions of the keys as shares of half the span. One is off centre, so that the parts fit one way only.
pub(crate) const PLACES: [f64; 3] = [-0.8, 0.35, 0.8];
/// Reduction of the radius of a key per mm of height.
pub(crate) const TAPER: f64 = 0.2;
/// Play between the head of a key and the end of its hole, mm.
pub(crate) const HEAD_PLAY_MM: f64 = 0.4;
/// Least wall around a key, mm.
const WALL_MM: f64 = 1.0;
/// Least radius of the head of a key, mm.
const LEAST_HEAD_MM: f64 = 0.1;
/// Height of the ring above the height of a key, mm.
pub(crate) const HOLE_END_MM: f64 = HEAD_PLAY_MM + WALL_MM;

/// Returns the radial thickness of the ring for keys of this diameter, mm.
pub(crate) fn ring_wall_mm(m: &MouldTable, key_diameter_mm: f64) -> f64 {
    m.wall_mm.max(key_diameter_mm + 2.0 * (m.clearance_mm + WALL_MM))
}

/// Returns the height at which the head of a key has its least radius, mm.
pub(crate) fn highest_mm(key_diameter_mm: f64) -> f64 {
    (key_diameter_mm / 2.0 - LEAST_HEAD_MM) / TAPER
}
