//! Distances from the vertices of one mesh to the surface of another.

use super::bvh::{Bounds, Bvh};
use crate::mesh::{Mesh, Point3, Vector3};
use crate::parallel;

/// Returns the largest distance in mm from a vertex of `from` to the surface of `to`, and that
/// vertex; `None` if one of the meshes is empty or has a coordinate that is not finite.
///
/// Vertices within `near_mm` of the surface are found fastest; the distance of any other is exact,
/// too.
pub(crate) fn largest_distance(from: &Mesh, to: &Mesh, near_mm: f64) -> Option<(f64, Point3)> {
    let is_finite = |p: &Point3| p.coords.iter().all(|c| c.is_finite());
    if to.triangles.is_empty() || !from.positions.iter().chain(&to.positions).all(is_finite) {
        return None;
    }
    let bvh = Bvh::new(to);
    let chunks = parallel::in_chunks(from.positions.len(), |range| {
        let mut leaves = Vec::new();
        let distances =
            from.positions[range].iter().map(|p| (distance(*p, to, &bvh, near_mm, &mut leaves), *p));
        distances.reduce(larger)
    });
    chunks.into_iter().flatten().reduce(larger)
}

fn larger(a: (f64, Point3), b: (f64, Point3)) -> (f64, Point3) {
    if b.0 > a.0 { b } else { a }
}

/// Distance of a point from a mesh: the nearest facet is in a box around the point as soon as that
/// contains one.
fn distance(p: Point3, mesh: &Mesh, bvh: &Bvh, near_mm: f64, leaves: &mut Vec<usize>) -> f64 {
    let mut reach_mm = near_mm;
    loop {
        let reach = Vector3::repeat(reach_mm);
        let bounds = Bounds::around(p - reach, p + reach);
        bvh.leaves_overlapping(&bounds, 0, leaves);
        let mut nearest = f64::INFINITY;
        bvh.slots_overlapping(&bounds, leaves, |slot| {
            nearest = nearest.min(to_triangle(p, mesh.corners(mesh.triangles[bvh.facet(slot)])));
        });
        if nearest <= reach_mm {
            return nearest;
        }
        reach_mm *= 4.0;
    }
}

/// Distance of a point from a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
fn to_triangle(p: Point3, [a, b, c]: [Point3; 3]) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(&ac);
    let area = normal.norm_squared();
    if area > 0.0 {
        // Barycentric coordinates of the projection onto the plane.
        let v = normal.dot(&ap.cross(&ac)) / area;
        let w = normal.dot(&ab.cross(&ap)) / area;
        if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
            return (normal.dot(&ap) / area.sqrt()).abs();
        }
    }
    [(a, b), (b, c), (c, a)].map(|(q, r)| to_segment(p, q, r)).into_iter().fold(f64::INFINITY, f64::min)
}

fn to_segment(p: Point3, a: Point3, b: Point3) -> f64 {
    let ab = b - a;
    let length = ab.norm_squared();
    let share = if length > 0.0 { ((p - a).dot(&ab) / length).clamp(0.0, 1.0) } else { 0.0 };
    (p - (a + ab * share)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn mesh(points: &[[f64; 3]]) -> Mesh {
        let positions: Vec<Point3> = points.iter().map(|p| Point3::from(*p)).collect();
        let index = |i: usize| u32::try_from(i).unwrap();
        let triangles = (0..points.len() / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2].map(index)).collect();
        Mesh::new(positions, triangles)
    }

    #[test]
    fn distances_to_face_edge_and_corner_are_exact() {
        let triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(Point3::from);
        for (point, distance) in [
            ([1.0, 1.0, -2.0], 2.0),
            ([1.0, -3.0, 4.0], 5.0),
            ([4.0, 4.0, 0.0], 8f64.sqrt()),
            ([-3.0, -4.0, 12.0], 13.0),
        ] {
            assert!((to_triangle(Point3::from(point), triangle) - distance).abs() < 1e-12, "{point:?}");
        }
        let degenerate = [[0.0; 3], [0.0; 3], [2.0, 0.0, 0.0]].map(Point3::from);
        assert_eq!(to_triangle(Point3::new(1.0, 3.0, 0.0), degenerate), 3.0);
    }

    #[test]
    fn meshes_without_a_surface_have_no_distance() {
        let one = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let nan = mesh(&[[f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(largest_distance(&one, &Mesh::default(), 1.0), None);
        assert_eq!(largest_distance(&Mesh::default(), &one, 1.0), None);
        assert_eq!(largest_distance(&one, &nan, 1.0), None);
    }

    proptest! {
        /// The hierarchy gives the distance of a loop over all facets.
        #[test]
        fn the_nearest_facet_is_found(
            points in prop::collection::vec(prop::array::uniform3(-9.0..9.0f64), 3..90),
            others in prop::collection::vec(prop::array::uniform3(-20.0..20.0f64), 1..9),
            near_mm in 1e-3..1.0f64,
        ) {
            let to = mesh(&points);
            let from = Mesh::new(others.into_iter().map(Point3::from).collect(), Vec::new());
            let all = |p: &Point3| to.facets().map(|t| to_triangle(*p, t)).fold(f64::INFINITY, f64::min);
            let expected = from.positions.iter().map(all).fold(0.0, f64::max);
            let (distance, at) = largest_distance(&from, &to, near_mm).unwrap();
            prop_assert_eq!((distance, all(&at)), (expected, expected));
        }
    }
}
