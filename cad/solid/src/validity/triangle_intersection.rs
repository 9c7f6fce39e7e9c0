//! Intersection of two triangles, exact by orientation predicates (Shewchuk).

use robust::{Coord, Coord3D, orient2d, orient3d};

use super::plane::Plane;
use crate::mesh::Point3;

/// A triangle with the indices of its corners.
pub(super) type Corners = [(u32, Point3); 3];

/// Whether floating point already proves that the triangles do not [`intersect`]: the corners that
/// are not shared are on one side.
///
/// Triangles of positive area in different planes intersect in the line of both planes. If all
/// unshared corners of one of them are on one side of the other's plane, it has at most a shared
/// corner or a shared edge on that line.
pub(super) fn are_disjoint((s, s_plane): (&Corners, &Plane), (t, t_plane): (&Corners, &Plane)) -> bool {
    let on_one_side = |of: &Corners, other: &Corners, plane: &Plane| {
        let unshared = of.iter().filter(|(i, _)| other.iter().all(|(j, _)| i != j));
        plane.has_on_one_side(other[0].1, unshared.map(|(_, p)| *p))
    };
    s_plane.is_certain() && t_plane.is_certain() && (on_one_side(t, s, s_plane) || on_one_side(s, t, t_plane))
}

/// Whether the triangles have a common point other than those of corners and edges that they share
/// by index.
pub(super) fn intersect(s: &Corners, t: &Corners) -> bool {
    let of_t = sides(t, s);
    if one_sided(of_t) {
        return false;
    }
    // A shared corner is in the plane, so that only triangles without one can be one-sided from
    // `t`.
    let shared = s.iter().filter(|(i, _)| t.iter().any(|(j, _)| i == j)).count();
    let in_plane = of_t == [0.0; 3];
    match shared {
        0 => {
            let of_s = sides(s, t);
            match one_sided(of_s) {
                true => false,
                false if in_plane => overlap_in_plane(s, t),
                false => pierces(s, of_s, t) || pierces(t, of_t, s),
            }
        }
        _ if in_plane => overlap_in_plane(s, t),
        // From a shared corner, an intersection leaves one triangle through its opposite edge.
        1 => opposite_edge_pierces(t, of_t, s) || opposite_edge_pierces(s, sides(s, t), t),
        // Two planes through a shared edge have no other common point.
        _ => false,
    }
}

/// The side of `plane` of each corner of `of`. A shared corner is in the plane, which exact
/// arithmetic would find only with its slowest method.
fn sides(of: &Corners, plane: &Corners) -> [f64; 3] {
    of.map(|(i, p)| if plane.iter().any(|(j, _)| i == *j) { 0.0 } else { side(plane, p) })
}

/// Strictly on one side: no contact.
fn one_sided(sides: [f64; 3]) -> bool {
    sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
}

fn coord(p: Point3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

fn side(plane: &Corners, p: Point3) -> f64 {
    // Most coplanar facets are those of a cap, at exactly the same height.
    if (0..3).any(|axis| plane.iter().all(|(_, q)| q[axis] == p[axis])) {
        return 0.0;
    }
    orient3d(coord(plane[0].1), coord(plane[1].1), coord(plane[2].1), coord(p))
}

fn edges(t: &Corners) -> [(Point3, Point3); 3] {
    [(t[0].1, t[1].1), (t[1].1, t[2].1), (t[2].1, t[0].1)]
}

/// Whether an edge of `from` intersects `into`; `sides` are the sides of its corners.
fn pierces(from: &Corners, sides: [f64; 3], into: &Corners) -> bool {
    (0..3).any(|i| segment_intersects([i, (i + 1) % 3], from, sides, into))
}

/// As [`pierces`], for the edge between the two corners that are not shared.
fn opposite_edge_pierces(from: &Corners, sides: [f64; 3], into: &Corners) -> bool {
    let unshared = |k: &usize| into.iter().all(|(j, _)| from[*k].0 != *j);
    let mut far = (0..3).filter(unshared);
    match (far.next(), far.next(), far.next()) {
        (Some(p), Some(q), None) => segment_intersects([p, q], from, sides, into),
        _ => false,
    }
}

/// Whether the segment between two corners of `from` and the triangle have a common point.
fn segment_intersects([i, j]: [usize; 2], from: &Corners, sides: [f64; 3], t: &Corners) -> bool {
    if sides[i] * sides[j] > 0.0 {
        return false;
    }
    let (p, q) = (from[i].1, from[j].1);
    if sides[i] == 0.0 && sides[j] == 0.0 {
        return segment_intersects_in_plane(p, q, t);
    }
    let turns = edges(t).map(|(a, b)| orient3d(coord(p), coord(q), coord(a), coord(b)));
    turns.iter().all(|o| *o >= 0.0) || turns.iter().all(|o| *o <= 0.0)
}

/// Projection along the axis that is closest to the normal of the triangle.
fn projection(t: &Corners) -> impl Fn(Point3) -> Coord<f64> + use<> {
    let normal = (t[1].1 - t[0].1).cross(&(t[2].1 - t[0].1)).abs();
    let drop = normal.imax();
    move |p: Point3| match drop {
        0 => Coord { x: p.y, y: p.z },
        1 => Coord { x: p.z, y: p.x },
        _ => Coord { x: p.x, y: p.y },
    }
}

/// The projected triangle, counter-clockwise.
fn counter_clockwise(t: &Corners, flat: &impl Fn(Point3) -> Coord<f64>) -> [Coord<f64>; 3] {
    let [a, b, c] = t.map(|(_, p)| flat(p));
    if orient2d(a, b, c) < 0.0 { [a, c, b] } else { [a, b, c] }
}

/// Whether coplanar triangles overlap: convex shapes are disjoint if and only if an edge of one of
/// them separates them.
fn overlap_in_plane(s: &Corners, t: &Corners) -> bool {
    let flat = projection(s);
    let (a, b) = (counter_clockwise(s, &flat), counter_clockwise(t, &flat));
    let separates = |x: &[Coord<f64>; 3], y: &[Coord<f64>; 3]| {
        (0..3).any(|i| y.iter().all(|p| orient2d(x[i], x[(i + 1) % 3], *p) <= 0.0))
    };
    !separates(&a, &b) && !separates(&b, &a)
}

fn segment_intersects_in_plane(p: Point3, q: Point3, t: &Corners) -> bool {
    let flat = projection(t);
    let (p, q, t) = (flat(p), flat(q), counter_clockwise(t, &flat));
    let outside_an_edge = (0..3).any(|i| [p, q].iter().all(|x| orient2d(t[i], t[(i + 1) % 3], *x) < 0.0));
    let turns = t.map(|x| orient2d(p, q, x));
    let is_one_sided = turns.iter().all(|o| *o > 0.0) || turns.iter().all(|o| *o < 0.0);
    !outside_an_edge && !is_one_sided
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(numbers: [u32; 3], points: [[f64; 3]; 3]) -> Corners {
        let at = |i: usize| (numbers[i], Point3::from(points[i]));
        [at(0), at(1), at(2)]
    }

    const FLAT: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn crossing_and_touching_triangles_intersect() {
        let flat = triangle([0, 1, 2], FLAT);
        let through = triangle([3, 4, 5], [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [5.0, 5.0, 1.0]]);
        let above = triangle([3, 4, 5], [[1.0, 1.0, 0.5], [1.0, 1.0, 1.0], [5.0, 5.0, 1.0]]);
        let touching = triangle([3, 4, 5], [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [5.0, 5.0, 1.0]]);
        assert!(intersect(&flat, &through) && intersect(&through, &flat));
        assert!(intersect(&flat, &touching));
        assert!(!intersect(&flat, &above));
    }

    #[test]
    fn neighbours_intersect_only_when_folded() {
        let flat = triangle([0, 1, 2], FLAT);
        let adjacent = triangle([1, 0, 3], [FLAT[1], FLAT[0], [1.0, -3.0, 0.0]]);
        let folded = triangle([1, 0, 3], [FLAT[1], FLAT[0], [1.0, 1.0, 0.0]]);
        let upright = triangle([1, 0, 3], [FLAT[1], FLAT[0], [1.0, 1.0, 2.0]]);
        assert!(!intersect(&flat, &adjacent) && !intersect(&flat, &upright));
        assert!(intersect(&flat, &folded));
        let fan = triangle([0, 3, 4], [FLAT[0], [-1.0, 0.0, 1.0], [-1.0, 1.0, -1.0]]);
        let stab = triangle([0, 3, 4], [FLAT[0], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]]);
        assert!(!intersect(&flat, &fan));
        assert!(intersect(&flat, &stab));
    }
}
