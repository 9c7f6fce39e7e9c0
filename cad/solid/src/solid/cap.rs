//! Caps: constrained Delaunay triangulation of an outline with holes.

use std::collections::VecDeque;

use pinswitch_diagnostic::{Diagnostic, codes};
use spade::{ConstrainedDelaunayTriangulation, Point2 as SpadePoint, Triangulation};

use crate::profile::Point2;

/// Contours of a cap that cannot be triangulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CapError {
    /// Two contours of one cap cross.
    #[error("contours cross near ({x:.3}, {y:.3}) mm at height {z_mm:.3} mm")]
    Crossing {
        /// Place, mm.
        x: f64,
        /// Place, mm.
        y: f64,
        /// Height of the cap, mm.
        z_mm: f64,
    },
    /// Two contours share a point, or a coordinate is not finite.
    #[error("contours touch or are not finite at height {z_mm:.3} mm")]
    Touching {
        /// Height of the cap, mm.
        z_mm: f64,
    },
}

impl From<CapError> for Diagnostic {
    fn from(error: CapError) -> Self {
        Self::new(codes::SHAPE_CANNOT_BE_BUILT, error.to_string())
            .with_help("move the contours apart, or change one of them")
    }
}

/// Counter-clockwise triangles of indices into the concatenated corners of a cap's rings.
pub(super) type Triangles = Vec<[u32; 3]>;

/// Triangulates the region between `loops`: the outline and its holes, in any orientation.
pub(super) fn triangulate(loops: &[&[Point2]], z_mm: f64) -> Result<Triangles, CapError> {
    let points: Vec<_> = loops.concat().iter().map(|p| SpadePoint::new(p.x, p.y)).collect();
    let mut edges = Vec::with_capacity(points.len());
    let mut first = 0;
    for points in loops {
        let n = points.len();
        edges.extend((0..n).map(|i| [first + i, first + (i + 1) % n]));
        first += n;
    }
    let count = points.len();
    let mut crossing = None;
    let positions = points.clone();
    let cdt = ConstrainedDelaunayTriangulation::<SpadePoint<f64>>::try_bulk_load_cdt(points, edges, |edge| {
        crossing.get_or_insert(edge);
    })
    .map_err(|_| CapError::Touching { z_mm })?;
    if let Some([a, _]) = crossing {
        return Err(CapError::Crossing { x: positions[a].x, y: positions[a].y, z_mm });
    }
    if cdt.num_vertices() != count {
        return Err(CapError::Touching { z_mm });
    }
    Ok(inside(&cdt))
}

/// The faces that an odd number of constraint edges separates from the outside.
#[allow(clippy::cast_possible_truncation)]
fn inside(cdt: &ConstrainedDelaunayTriangulation<SpadePoint<f64>>) -> Triangles {
    let mut parity: Vec<Option<bool>> = vec![None; cdt.num_all_faces()];
    let outer = cdt.outer_face();
    parity[outer.fix().index()] = Some(false);
    let mut queue = VecDeque::new();
    for edge in cdt.convex_hull() {
        let face = edge.rev().face().fix().index();
        if parity[face].is_none() {
            parity[face] = Some(edge.is_constraint_edge());
            queue.push_back(edge.rev().face().fix());
        }
    }
    let mut triangles = Vec::new();
    while let Some(face) = queue.pop_front() {
        let face = cdt.face(face);
        let Some(face) = face.as_inner() else { continue };
        let here = parity[face.fix().index()] == Some(true);
        if here {
            triangles.push(face.vertices().map(|v| v.fix().index() as u32));
        }
        for edge in face.adjacent_edges() {
            let beyond = edge.rev().face().fix();
            if parity[beyond.index()].is_none() {
                parity[beyond.index()] = Some(here ^ edge.is_constraint_edge());
                queue.push_back(beyond);
            }
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: f64, high: f64) -> Vec<Point2> {
        [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| Point2::new(x, y)).to_vec()
    }

    fn area(points: &[Point2], triangles: &[[u32; 3]]) -> f64 {
        triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| points[i as usize]);
                (b - a).perp(&(c - a)) / 2.0
            })
            .sum()
    }

    #[test]
    fn islands_in_holes_are_filled() {
        let loops = [square(0.0, 10.0), square(2.0, 8.0), square(4.0, 6.0)];
        let all: Vec<_> = loops.concat();
        let loops: Vec<&[Point2]> = loops.iter().map(Vec::as_slice).collect();
        let triangles = triangulate(&loops, 0.0).unwrap();
        assert!((area(&all, &triangles) - (100.0 - 36.0 + 4.0)).abs() < 1e-12);
    }

    #[test]
    fn crossing_contours_are_refused() {
        let (a, b) = (square(0.0, 4.0), square(2.0, 6.0));
        assert!(matches!(triangulate(&[&a, &b], 0.0), Err(CapError::Crossing { .. })));
        let c = square(4.0, 6.0);
        assert!(matches!(triangulate(&[&a, &c], 0.0), Err(CapError::Touching { .. })));
        let mut d = square(1.0, 2.0);
        d[0].x = f64::NAN;
        assert!(matches!(triangulate(&[&a, &d], 0.0), Err(CapError::Touching { .. })));
    }
}
