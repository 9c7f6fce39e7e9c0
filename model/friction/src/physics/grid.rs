//! Nodes along the wrap and a short span beyond it. Every pin has a node, so that kinks of the
//! tendon are at nodes and refinement converges in second order.

use super::banded::BandedMatrix;
use crate::bed::{Bed, OutsidePins};
use crate::published;

/// Nodes of a wrap and of the spans that lead to it. Angles are in radians, zero in the middle;
/// lengths are in mm along the tendon's axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    /// Angles of the nodes, ascending.
    pub(super) angle_rad: Vec<f64>,
    /// Inverse lengths of the elements between the nodes.
    pub(super) per_element_mm: Vec<f64>,
    /// Quadratic form and linear term of bending, for a stiffness of 1 N mm².
    unit_bending: (BandedMatrix, Vec<f64>),
    /// Length that belongs to each node.
    pub(super) share_mm: Vec<f64>,
    /// Length of silicone that belongs to each node.
    pub(super) silicone_mm: Vec<f64>,
    /// Nodes of the pins.
    pub(super) pins: Vec<usize>,
    /// Angle of the span beyond each end of the wrap.
    pub(super) reach_rad: f64,
    /// Number of elements between neighbouring corners.
    pieces: Vec<usize>,
}

/// Length of an element of the straight spans, relative to the others.
const STRAIGHT: f64 = 1.5;
/// Length of the shortest element next to a pin, relative to the others. A shorter one would be so
/// stiff in bending that rounding hides the balance of forces.
const SHORTEST: f64 = 0.05;
/// Largest difference between equal angles, in radians.
const SAME_RAD: f64 = 1e-9;
/// Clearance of the straight span beyond the wrap at which no pin touches it, in heights of a
/// resting pin.
const CLEAR_OF_PINS: f64 = 1.2;

/// Returns the angle in radians beyond an end of the wrap within which a pin can touch the straight
/// span: a tangent at `Rc` rises by `Rc delta^2/2`.
pub(super) fn reach_rad(bed: &Bed) -> f64 {
    (2.0 * CLEAR_OF_PINS * bed.protrusion_mm() / bed.axis_radius_mm()).sqrt()
}

/// Smallest number of elements over a wrap.
const MIN_ELEMENTS: usize = 2;
/// Length of an element, relative to the length over which the tendon descends from a pin,
/// `sqrt(h0 Rc)`.
const ELEMENT_OF_SPAN: f64 = 0.08;
/// Length of an element, relative to the length over which a stiff tendon presses into silicone,
/// `(EI/k)^(1/4)`.
const ELEMENT_OF_PRESS: f64 = 0.35;
/// Largest number of elements, for wraps that are long compared with their pins.
const MAX_ELEMENTS: usize = 1500;

/// Returns the number of elements over `wrap_rad` on `bed` with a discretisation error of friction
/// below 0.2 % (a test checks it), from the lengths over which the tendon's shape changes. It is
/// 101 for the published rig.
pub(super) fn elements(wrap_rad: f64, bed: &Bed) -> usize {
    let span_mm = ELEMENT_OF_SPAN * (bed.protrusion_mm() * bed.axis_radius_mm()).sqrt();
    let press_mm =
        ELEMENT_OF_PRESS * (bed.tendon_bending_n_mm2(f64::INFINITY) / bed.stiffness_n_mm2()).sqrt().sqrt();
    let element_mm = if press_mm > 0.0 { span_mm.min(press_mm) } else { span_mm };
    let needed = (wrap_rad * bed.axis_radius_mm() / element_mm).ceil() as usize;
    needed.clamp(MIN_ELEMENTS, MAX_ELEMENTS)
}

impl Grid {
    /// Creates nodes over `wrap_rad` and [`reach_rad`] beyond both ends, about
    /// `wrap_rad / elements` apart, with one at each of `pins_rad` (ascending) within that reach.
    pub(super) fn new(wrap_rad: f64, pins_rad: &[f64], bed: &Bed, elements: usize) -> Self {
        let corners = Corners::new(wrap_rad, pins_rad, bed, elements);
        let step = wrap_rad / elements.max(1) as f64;
        let pieces = corners.angles_rad.windows(2).map(|pair| {
            // Beyond the wrap the tendon is almost straight.
            let beyond = pair[0] + pair[1] > wrap_rad || pair[0] + pair[1] < -wrap_rad;
            let step = if beyond { STRAIGHT * step } else { step };
            ((pair[1] - pair[0]) / step).ceil().max(1.0) as usize
        });
        Self::of_corners(pieces.collect(), corners, bed)
    }

    /// Creates the nodes of a switch with slightly other dimensions, as many between neighbouring
    /// corners as here, so that friction is smooth in the dimensions. `None` if the pins within
    /// reach, or other corners, are not the same.
    pub(super) fn moved(&self, wrap_rad: f64, pins_rad: &[f64], bed: &Bed, elements: usize) -> Option<Self> {
        let corners = Corners::new(wrap_rad, pins_rad, bed, elements);
        let is_same =
            corners.angles_rad.len() == self.pieces.len() + 1 && corners.inside.len() == self.pins.len();
        let moved = is_same.then(|| Self::of_corners(self.pieces.clone(), corners, bed))?;
        (moved.pins == self.pins).then_some(moved)
    }

    /// Creates the nodes between corners, from the number of elements between neighbouring ones.
    fn of_corners(pieces: Vec<usize>, corners: Corners, bed: &Bed) -> Self {
        let Corners { angles_rad: corners, inside, span, reach } = corners;
        let mut angle_rad: Vec<f64> = corners.first().copied().into_iter().collect();
        for (pair, count) in corners.windows(2).zip(&pieces) {
            let piece = (pair[1] - pair[0]) / *count as f64;
            angle_rad.extend((1..*count).map(|k| pair[0] + piece * k as f64));
            angle_rad.push(pair[1]);
        }
        let nodes = angle_rad.len();
        let (mut share_mm, mut silicone_mm) = (vec![0.0; nodes], vec![0.0; nodes]);
        let mut element_mm = Vec::with_capacity(nodes.saturating_sub(1));
        for (i, pair) in angle_rad.windows(2).enumerate() {
            let length = (pair[1] - pair[0]) * bed.axis_radius_mm();
            let silicone = (pair[1].min(span.1) - pair[0].max(span.0)).max(0.0) * bed.axis_radius_mm();
            for node in [i, i + 1] {
                share_mm[node] += length / 2.0;
                silicone_mm[node] += silicone / 2.0;
            }
            element_mm.push(length);
        }
        let pins = inside.iter().map(|p| angle_rad.partition_point(|a| *a < p - SAME_RAD)).collect();
        let unit_bending = unit_bending(&element_mm, bed.axis_radius_mm());
        let per_element_mm = element_mm.iter().map(|length| 1.0 / length).collect();
        Self {
            angle_rad,
            per_element_mm,
            unit_bending,
            share_mm,
            silicone_mm,
            pins,
            reach_rad: reach,
            pieces,
        }
    }

    /// Returns the quadratic form and the linear term of bending, `EI/2 (u'' + u/Rc^2 - 1/Rc)^2`,
    /// for a stiffness in N mm².
    pub(super) fn bending(&self, stiffness_n_mm2: f64) -> (BandedMatrix, Vec<f64>) {
        let (unit, load) = &self.unit_bending;
        let scaled = |entries: &[f64]| entries.iter().map(|entry| stiffness_n_mm2 * entry).collect();
        let form = BandedMatrix {
            diagonal: scaled(&unit.diagonal),
            first: scaled(&unit.first),
            second: scaled(&unit.second),
        };
        (form, scaled(load))
    }

    /// Returns the quadratic form and the linear term of bending for a stiffness of 1 N mm².
    pub(super) fn unit_bending(&self) -> (&BandedMatrix, &[f64]) {
        (&self.unit_bending.0, &self.unit_bending.1)
    }

    /// Returns the number of nodes.
    pub(super) fn len(&self) -> usize {
        self.angle_rad.len()
    }
}

/// Angles between which the elements are even, and what determines them.
struct Corners {
    /// Pins, ends of the wrap, of the silicone and of the spans beyond, ascending.
    angles_rad: Vec<f64>,
    /// Angles of the pins within reach.
    inside: Vec<f64>,
    /// First and last angle at which silicone can touch the tendon.
    span: (f64, f64),
    /// Angle of the span beyond each end of the wrap.
    reach: f64,
}

impl Corners {
    fn new(wrap_rad: f64, pins_rad: &[f64], bed: &Bed, elements: usize) -> Self {
        let half = wrap_rad / 2.0;
        let reach = reach_rad(bed);
        let end = half + reach;
        let inside: Vec<f64> = pins_rad.iter().copied().filter(|p| p.abs() < end).collect();
        let margin = match bed.outside {
            // Up to the edge of the outermost pins' grooves.
            OutsidePins::Free => bed.groove_radius_mm / bed.contact_radius_mm,
            OutsidePins::NextGroove => published::GROOVE_PITCH_DEG.to_radians(),
            OutsidePins::OnSilicone => f64::INFINITY,
        };
        let span = match (inside.first(), inside.last()) {
            (Some(first), Some(last)) => ((first - margin).max(-end), (last + margin).min(end)),
            _ => (-end, end),
        };
        let step = wrap_rad / elements.max(1) as f64;
        let mut corners = inside.clone();
        corners.dedup_by(|a, b| (*a - *b).abs() < SAME_RAD);
        for corner in [-end, end, -half, half, span.0, span.1] {
            if corners.iter().all(|c| (c - corner).abs() > SHORTEST * step) {
                corners.push(corner);
            }
        }
        corners.sort_by(f64::total_cmp);
        Self { angles_rad: corners, inside, span, reach }
    }
}

/// Returns the terms of bending for a stiffness of 1 N mm², by the three-point second difference,
/// with free ends.
fn unit_bending(element_mm: &[f64], rc: f64) -> (BandedMatrix, Vec<f64>) {
    let n = element_mm.len() + 1;
    let mut form = BandedMatrix::zeros(n);
    let mut load = vec![0.0; n];
    for i in 1..n.saturating_sub(1) {
        let (left, right) = (element_mm[i - 1], element_mm[i]);
        let share = (left + right) / 2.0;
        // Curvature at the node: the second difference, and u/Rc^2.
        let c = [
            2.0 / (left * (left + right)),
            1.0 / (rc * rc) - 2.0 / (left * right),
            2.0 / (right * (left + right)),
        ];
        for (j, cj) in c.iter().enumerate() {
            form.diagonal[i - 1 + j] += share * cj * cj;
            load[i - 1 + j] += share * cj / rc;
        }
        form.first[i - 1] += share * c[0] * c[1];
        form.first[i] += share * c[1] * c[2];
        form.second[i - 1] += share * c[0] * c[2];
    }
    (form, load)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pin_has_a_node() {
        let bed = Bed { outside: OutsidePins::OnSilicone, ..Bed::published() };
        let pins = [-0.4, -0.1, 0.55];
        let grid = Grid::new(1.1, &pins, &bed, 100);
        for (pin, node) in pins.iter().zip(&grid.pins) {
            assert!((grid.angle_rad[*node] - pin).abs() < 1e-12);
        }
        let wrap_mm = (1.1 + 2.0 * reach_rad(&bed)) * bed.axis_radius_mm();
        let element_mm: Vec<f64> = grid.per_element_mm.iter().map(|per| 1.0 / per).collect();
        for lengths in [&grid.share_mm, &element_mm, &grid.silicone_mm] {
            assert!((lengths.iter().sum::<f64>() - wrap_mm).abs() < 1e-9);
        }
    }

    #[test]
    fn free_spans_have_no_silicone() {
        let bed = Bed { outside: OutsidePins::Free, ..Bed::published() };
        let grid = Grid::new(1.1, &[-0.2, 0.2], &bed, 100);
        let silicone: f64 = grid.silicone_mm.iter().sum();
        let margin = bed.groove_radius_mm / bed.contact_radius_mm;
        assert!((silicone - (0.4 + 2.0 * margin) * bed.axis_radius_mm()).abs() < 1e-9);
    }
}
