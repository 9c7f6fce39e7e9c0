//! Nodes along the wrap: one at every pin, so that the tendon's kinks lie on nodes and refinement converges in second
//! order.

use super::{Bed, OutsidePins};
use crate::published;

/// Nodes of a wrap. Angles in radians, zero in the middle; lengths in mm along the tendon's axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    /// Angles of the nodes, ascending.
    pub(super) angle_rad: Vec<f64>,
    /// Lengths of the elements between the nodes.
    pub(super) element_mm: Vec<f64>,
    /// Length that belongs to each node.
    pub(super) share_mm: Vec<f64>,
    /// Length of silicone that belongs to each node.
    pub(super) silicone_mm: Vec<f64>,
    /// Nodes of the pins.
    pub(super) pins: Vec<usize>,
}

/// Two angles closer than this are one, in radians.
const SAME_RAD: f64 = 1e-9;

impl Grid {
    /// Nodes over `wrap_rad`, about `wrap_rad / elements` apart, with one at each of `pins_rad` (ascending, within the
    /// wrap).
    pub(super) fn new(wrap_rad: f64, pins_rad: &[f64], bed: &Bed, elements: usize) -> Self {
        let half = wrap_rad / 2.0;
        let inside: Vec<f64> = pins_rad.iter().map(|p| p.clamp(-half, half)).collect();
        let margin = match bed.outside {
            // Up to the edge of the outermost pins' grooves: the silicone that holds them.
            OutsidePins::Free => bed.groove_radius_mm / bed.contact_radius_mm,
            OutsidePins::NextGroove => published::GROOVE_PITCH_DEG.to_radians(),
            OutsidePins::OnSilicone => wrap_rad,
        };
        let span = match (inside.first(), inside.last()) {
            (Some(first), Some(last)) => ((first - margin).max(-half), (last + margin).min(half)),
            _ => (-half, half),
        };
        let mut corners: Vec<f64> = inside.iter().copied().chain([-half, half, span.0, span.1]).collect();
        corners.sort_by(f64::total_cmp);
        corners.dedup_by(|a, b| (*a - *b).abs() < SAME_RAD);
        let step = wrap_rad / elements.max(1) as f64;
        let mut angle_rad: Vec<f64> = corners.first().copied().into_iter().collect();
        for pair in corners.windows(2) {
            let pieces = ((pair[1] - pair[0]) / step).ceil().max(1.0);
            let piece = (pair[1] - pair[0]) / pieces;
            angle_rad.extend((1..pieces as usize).map(|k| pair[0] + piece * k as f64));
            angle_rad.push(pair[1]);
        }
        let nodes = angle_rad.len();
        let (mut share_mm, mut silicone_mm) = (vec![0.0; nodes], vec![0.0; nodes]);
        let mut element_mm = Vec::with_capacity(nodes.saturating_sub(1));
        for (i, pair) in angle_rad.windows(2).enumerate() {
            let length = (pair[1] - pair[0]) * bed.axis_radius_mm();
            let middle = (pair[0] + pair[1]) / 2.0;
            for node in [i, i + 1] {
                share_mm[node] += length / 2.0;
                if middle > span.0 && middle < span.1 {
                    silicone_mm[node] += length / 2.0;
                }
            }
            element_mm.push(length);
        }
        let pins = inside.iter().map(|p| angle_rad.partition_point(|a| *a < p - SAME_RAD)).collect();
        Self { angle_rad, element_mm, share_mm, silicone_mm, pins }
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.angle_rad.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pin_has_a_node_and_lengths_add_up() {
        let bed = Bed { outside: OutsidePins::OnSilicone, ..Bed::published() };
        let pins = [-0.4, -0.1, 0.55];
        let grid = Grid::new(1.1, &pins, &bed, 100);
        for (pin, node) in pins.iter().zip(&grid.pins) {
            assert!((grid.angle_rad[*node] - pin).abs() < 1e-12);
        }
        let wrap_mm = 1.1 * bed.axis_radius_mm();
        for lengths in [&grid.share_mm, &grid.element_mm, &grid.silicone_mm] {
            assert!((lengths.iter().sum::<f64>() - wrap_mm).abs() < 1e-9);
        }
    }

    #[test]
    fn free_ends_have_silicone_between_the_pins_only() {
        let bed = Bed::published();
        let grid = Grid::new(1.1, &[-0.2, 0.2], &bed, 100);
        let silicone: f64 = grid.silicone_mm.iter().sum();
        let margin = bed.groove_radius_mm / bed.contact_radius_mm;
        assert!((silicone - (0.4 + 2.0 * margin) * bed.axis_radius_mm()).abs() < 1e-9);
    }
}
