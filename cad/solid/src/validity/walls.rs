//! Walls that are thinner than a printer can lay down.

use rstar::AABB;

use super::intersections::facet_tree;
use super::{Fault, place};
use crate::mesh::{Mesh, Point3, Vector3};

/// Two facets bound a wall if their normals are this nearly opposite (cosine).
const OPPOSITE: f64 = -0.7;

/// Looks inward from the middle of every facet for a facing one closer than `min_wall_mm`.
pub(super) fn thin(mesh: &Mesh, min_wall_mm: f64) -> Option<Fault> {
    let tree = facet_tree(mesh);
    let mut worst: Option<(f64, Point3)> = None;
    let mut count = 0;
    for [a, b, c] in mesh.facets() {
        let Some(inward) = (c - a).cross(&(b - a)).try_normalize(0.0) else { continue };
        let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let end = middle + inward * min_wall_mm;
        let reach = AABB::from_corners(middle.inf(&end).coords.into(), middle.sup(&end).coords.into());
        let nearest = tree
            .locate_in_envelope_intersecting(&reach)
            .filter_map(|other| distance_mm(mesh, other.data, middle, inward))
            .fold(f64::INFINITY, f64::min);
        if nearest < min_wall_mm * (1.0 - 1e-6) {
            count += 1;
            if worst.is_none_or(|(least, _)| nearest < least) {
                worst = Some((nearest, middle));
            }
        }
    }
    worst.map(|(thickness, at)| Fault {
        check: "thin wall",
        count,
        at_mm: place(at),
        detail: format!(
            "walls under {count} facets are thinner than {min_wall_mm} mm, the thinnest {thickness:.3} mm"
        ),
    })
}

/// Distance along a ray to facet `i`, if the ray leaves the body there through a facing facet (Möller & Trumbore).
fn distance_mm(mesh: &Mesh, i: usize, from: Point3, along: Vector3) -> Option<f64> {
    let [a, b, c] = mesh.corners(mesh.triangles[i]);
    let (u, v) = (b - a, c - a);
    let normal = u.cross(&v).try_normalize(0.0)?;
    // The starting facet looks back along the ray (-1): one that bounds the other side looks ahead.
    if -along.dot(&normal) > OPPOSITE {
        return None;
    }
    let p = along.cross(&v);
    let determinant = u.dot(&p);
    let s = from - a;
    let q = s.cross(&u);
    let (x, y) = (s.dot(&p) / determinant, along.dot(&q) / determinant);
    let distance = v.dot(&q) / determinant;
    (x >= 0.0 && y >= 0.0 && x + y <= 1.0 && distance > 1e-9).then_some(distance)
}
