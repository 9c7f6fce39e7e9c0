//! Facets around a vertex with very many of them.
//!
//! The boxes of such facets all meet at the vertex. As triangles are convex, two of them have a
//! point in addition to the vertex exactly if they have a common direction as seen from the vertex.
//! So they are compared by the boxes of their arcs on a sphere around it, which overlap only for
//! neighbours if the fan is valid.

use crate::mesh::{Mesh, Point3, Vector3};

/// Bound on the rounding errors of a unit vector.
const ROUNDING: f64 = 1e-12;
/// Cosine of an angle up to which the tangents at the ends of an arc meet close to it.
const WIDE: f64 = -0.5;

/// Returns a mesh with one facet for each of `facets`, whose box contains the directions from `hub`
/// to the opposite edge of the facet.
pub(super) fn arc_boxes(mesh: &Mesh, hub: u32, facets: impl Iterator<Item = usize>) -> Mesh {
    let mut boxes = Mesh::default();
    for facet in facets {
        let (low, high) = arc_box(mesh, hub, facet);
        let first = boxes.positions.len() as u32;
        boxes.positions.extend([low, high]);
        boxes.triangles.push([first, first + 1, first]);
    }
    boxes
}

fn arc_box(mesh: &Mesh, hub: u32, facet: usize) -> (Point3, Point3) {
    let whole = (Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0));
    let centre = mesh.positions[hub as usize];
    let mut ends = mesh.triangles[facet].iter().filter(|v| **v != hub);
    let mut direction =
        || ends.next().and_then(|v| (mesh.positions[*v as usize] - centre).try_normalize(f64::MIN_POSITIVE));
    let (Some(a), Some(b)) = (direction(), direction()) else { return whole };
    let cosine = a.dot(&b);
    if cosine.is_nan() || cosine < WIDE {
        return whole;
    }
    // The arc is inside the triangle of its ends and the point where the tangents there meet.
    let tangents = (a + b) / (1.0 + cosine);
    let rounding = Vector3::repeat(ROUNDING);
    (Point3::from(a.inf(&b).inf(&tangents) - rounding), Point3::from(a.sup(&b).sup(&tangents) + rounding))
}
