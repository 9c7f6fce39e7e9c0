//! Frames: polygons in which a part of a cap is triangulated on its own.
//!
//! Around each letter of a label, the cap is the same whatever the other letters are, and outside of all frames it is the
//! same for all labels of one length: a [`CapCache`] knows most of it. A frame adds vertices and no edge of the solid.

use std::sync::Arc;

use super::cap::{CapError, Triangles};
use super::cap_cache::CapCache;
use super::definition::{Cap, RingId, Solid};
use crate::mesh::Point3;
use crate::profile::{Contour, Point2};

/// A polygon around holes of a cap.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) polygon: Contour,
    /// The holes inside it.
    pub(super) holes: Vec<RingId>,
}

impl Solid {
    /// Adds a frame, a `polygon` around `holes` of one cap. A cap is triangulated as a whole if a frame is within 0.01 mm of a
    /// contour or of another frame, or around other holes.
    pub fn frame(&mut self, polygon: Contour, holes: &[RingId]) {
        self.frames.push(Frame { polygon, holes: holes.to_vec() });
    }

    /// The frames around holes of a cap.
    pub(super) fn frames_of<'a>(&'a self, cap: &'a Cap) -> impl Iterator<Item = &'a Frame> {
        let is_of = |frame: &&Frame| frame.holes.first().is_some_and(|hole| cap.rings.contains(hole));
        self.frames.iter().filter(is_of)
    }
}

/// A loop of corners, with the index of its first vertex in the mesh.
pub(super) type Loop<'a> = (&'a [Point2], usize);

/// Least distance of a frame from contours and from other frames, mm: facets between closer ones may be too thin.
const CLEARANCE_MM: f64 = 0.01;

/// Returns whether a frame is closer to another loop than it may be. A loop that crosses it far from all corners is not found: the
/// triangulation refuses it.
pub(super) fn is_close(frame: &[Point2], other: &[Point2]) -> bool {
    let whole = |points: &[Point2]| {
        points.iter().map(|p| (*p, *p)).reduce(|(low, high), (p, _)| (low.inf(&p), high.sup(&p)))
    };
    let Some(around) = whole(frame) else { return false };
    let are_apart = |(low, high): (Point2, Point2), (from, to): (Point2, Point2)| {
        (0..2).any(|i| from[i] > high[i] + CLEARANCE_MM || low[i] > to[i] + CLEARANCE_MM)
    };
    let bounds = |[a, b]: [Point2; 2]| (a.inf(&b), a.sup(&b));
    let is_within = |[a, b]: [Point2; 2], [c, d]: [Point2; 2]| {
        !are_apart(bounds([a, b]), bounds([c, d]))
            && [
                distance_mm(a, [c, d]),
                distance_mm(b, [c, d]),
                distance_mm(c, [a, b]),
                distance_mm(d, [a, b]),
            ]
            .iter()
            .any(|distance| *distance < CLEARANCE_MM)
    };
    sides(other)
        .filter(|side| !are_apart(bounds(*side), around))
        .any(|side| sides(frame).any(|own| is_within(own, side)))
}

/// The sides of a closed polygon.
fn sides(points: &[Point2]) -> impl Iterator<Item = [Point2; 2]> {
    points.iter().zip(points.iter().cycle().skip(1)).map(|(from, to)| [*from, *to])
}

/// Distance of a point from a segment, mm.
fn distance_mm(point: Point2, [from, to]: [Point2; 2]) -> f64 {
    let along = to - from;
    let share = (point - from).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
    (from + along * share.clamp(0.0, 1.0) - point).norm()
}

/// Triangles of a part of a cap, of indices into `vertices`.
pub(super) struct Region {
    pub(super) vertices: Vec<usize>,
    pub(super) triangles: Arc<Triangles>,
}

impl Region {
    /// Triangulates the region between loops.
    pub(super) fn between(loops: &[Loop<'_>], z_mm: f64, caps: &CapCache) -> Result<Self, CapError> {
        let points: Vec<&[Point2]> = loops.iter().map(|(points, _)| *points).collect();
        let triangles = caps.triangles(&points, z_mm)?;
        let vertices = loops.iter().flat_map(|(points, first)| *first..first + points.len()).collect();
        Ok(Self { vertices, triangles })
    }

    /// Its area, mm², of vertices at `positions`.
    pub(super) fn area_mm2(&self, positions: &[Point3]) -> f64 {
        let at = |i: u32| positions[self.vertices[i as usize]].xy();
        let doubled = |[a, b, c]: [u32; 3]| (at(b) - at(a)).perp(&(at(c) - at(a)));
        self.triangles.iter().copied().map(doubled).sum::<f64>() / 2.0
    }
}

/// Area between loops, mm²: of the first one without the others.
pub(super) fn area_between_mm2<'a>(mut loops: impl Iterator<Item = Loop<'a>>) -> f64 {
    let area = |(points, _): Loop<'_>| {
        let from = points.iter().skip(1);
        let doubled: f64 =
            from.clone().zip(from.skip(1)).map(|(a, b)| (a - points[0]).perp(&(b - points[0]))).sum();
        doubled.abs() / 2.0
    };
    let outer = loops.next().map_or(0.0, area);
    outer - loops.map(area).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::super::definition::Facing;
    use super::*;
    use crate::profile::ChordTolerance;
    use crate::validity::{Expectation, examine};
    use proptest::prelude::*;

    fn square(x: f64, y: f64, side: f64) -> Contour {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        Contour::polygon(corners.map(|(u, v)| Point2::new(x + side * u, y + side * v)).to_vec())
    }

    /// A plate with two pockets, each in a frame with this margin.
    fn plate(apart_mm: f64, margin_mm: f64) -> Solid {
        let mut solid = Solid::new();
        let (bottom, top) = solid.extrude(&square(0.0, 0.0, 20.0), 0.0, 4.0);
        let holes = [5.0, 7.0 + apart_mm].map(|x| {
            let hole = solid.pocket(&square(x, 8.0, 2.0).reversed(), &[], 3.0, 4.0);
            solid.frame(square(x - margin_mm, 8.0 - margin_mm, 2.0 + 2.0 * margin_mm), &[hole]);
            hole
        });
        solid.cap(Facing::Down, bottom, &[]);
        solid.cap(Facing::Up, top, &holes);
        solid
    }

    fn volume_mm3(solid: &Solid) -> f64 {
        let mesh = solid.mesh(ChordTolerance::new(0.01).unwrap()).unwrap();
        let report = examine(&mesh, &Expectation::default());
        assert!(report.is_flawless(), "{:?}", report.faults);
        report.facts.volume_mm3
    }

    #[test]
    fn frames_that_touch_are_ignored() {
        let corners = |apart_mm, margin_mm| {
            let mesh = plate(apart_mm, margin_mm).mesh(ChordTolerance::new(0.01).unwrap()).unwrap();
            mesh.positions.len()
        };
        let without = 4 * (2 + 4);
        assert_eq!(corners(2.0, 0.5), without + 8);
        assert_eq!(corners(1.0, 0.5), without);
        assert_eq!(corners(1.0, 0.7), without);
        assert_eq!(corners(2.0, 9.0), without);
    }

    #[test]
    fn what_is_outside_of_frames_is_known() {
        let caps = CapCache::new(10_000);
        let mesh = |side: f64| {
            let mut solid = plate(2.0, 0.5);
            solid.rings[2].contour = square(5.2, 8.2, side).reversed();
            solid.rings[3].contour = square(5.2, 8.2, side).reversed();
            solid.mesh_with(ChordTolerance::new(0.01).unwrap(), &caps).unwrap()
        };
        mesh(1.0);
        let known = caps.corners();
        mesh(1.5);
        // The other pocket has another floor, and another ring around it: 4 and 8 corners.
        assert_eq!(caps.corners(), known + 12);
    }

    /// Frames that share a part of a side, or are a rounding error or less than a facet's height apart.
    #[test]
    fn frames_that_nearly_touch_are_ignored() {
        let exact = 20.0 * 20.0 * 4.0 - 2.0 * 4.0;
        for gap_mm in [0.0, f64::EPSILON, -f64::EPSILON, 1e-15, 1e-9, 1e-6, 1e-5, 1e-3, 0.02] {
            for aside_mm in [0.0, 0.3, 2.5] {
                let mut solid = plate(2.0, 0.5);
                let holes: Vec<_> = solid.frames.iter().map(|frame| frame.holes.clone()).collect();
                solid.frames.clear();
                solid.frame(square(4.0, 7.0, 4.0), &holes[0]);
                solid.frame(square(8.0 + gap_mm, 7.0 - aside_mm, 4.0), &holes[1]);
                for turn_rad in [0.0, 0.7] {
                    let volume_mm3 = volume_mm3(&solid.rotated(turn_rad));
                    assert!((volume_mm3 - exact).abs() < 1e-9, "{gap_mm} {aside_mm}");
                }
            }
        }
    }

    #[test]
    fn frames_around_other_holes_are_ignored() {
        let exact = 20.0 * 20.0 * 4.0 - 2.0 * 4.0;
        for (x, y, side) in [(4.0, 7.0, 9.0), (5.5, 8.5, 0.5), (1.0, 1.0, 2.0)] {
            let mut solid = plate(2.0, 0.5);
            let holes = std::mem::take(&mut solid.frames)[0].holes.clone();
            solid.frame(square(x, y, side), &holes);
            assert!((volume_mm3(&solid) - exact).abs() < 1e-9, "{x} {y} {side}");
        }
    }

    proptest! {
        /// A frame never changes the solid, wherever it is.
        #[test]
        fn frames_do_not_change_the_solid(apart_mm in 0.1..5.0f64, margin_mm in 0.01..6.0f64, turn_rad in -3.0..3.0f64) {
            let exact = 20.0 * 20.0 * 4.0 - 2.0 * 4.0;
            prop_assert!((volume_mm3(&plate(apart_mm, margin_mm).rotated(turn_rad)) - exact).abs() < 1e-9);
        }
    }
}
