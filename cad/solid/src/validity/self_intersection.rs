//! Facets that intersect.

use super::bvh::{Bvh, boxes_overlap, corner_box};
use super::fault::{Fault, place};
use super::triangle_intersection::{Corners, are_disjoint, intersect};
use crate::mesh::Mesh;
use crate::parallel;

/// Pairs of facets that intersect, and the least index of a facet among them.
struct Intersections {
    count: usize,
    first: usize,
}

/// Searches for pairs of facets that intersect anywhere but in shared corners and edges.
pub(super) fn fault(mesh: &Mesh, bvh: &Bvh) -> Option<Fault> {
    let parts = parallel::in_chunks(bvh.leaves(), |leaves| {
        let mut part = Intersections { count: 0, first: usize::MAX };
        let mut near = Vec::new();
        for leaf in leaves {
            bvh.pairs_from(leaf, &mut near, |a, b| {
                if is_intersection(mesh, bvh, a, b) {
                    part.count += 1;
                    part.first = part.first.min(bvh.facet(a)).min(bvh.facet(b));
                }
            });
        }
        part
    });
    let count: usize = parts.iter().map(|part| part.count).sum();
    let first = parts.iter().map(|part| part.first).min()?;
    (count > 0).then(|| Fault {
        check: "self-intersection",
        count,
        at_mm: place(mesh.positions[mesh.triangles[first][0] as usize]),
        detail: format!("{count} pairs of facets intersect"),
    })
}

/// Whether the facets in two slots intersect.
fn is_intersection(mesh: &Mesh, bvh: &Bvh, a: usize, b: usize) -> bool {
    let corners = |slot: usize| -> Corners {
        let [x, y, z] = mesh.triangles[bvh.facet(slot)];
        let at = |v: u32| (v, mesh.positions[v as usize]);
        [at(x), at(y), at(z)]
    };
    let (s, t) = (corners(a), corners(b));
    if are_disjoint((&s, bvh.plane(a)), (&t, bvh.plane(b))) {
        return false;
    }
    let (i, j, s, t) = match (bvh.facet(a), bvh.facet(b)) {
        (i, j) if i < j => (i, j, s, t),
        (i, j) => (j, i, t, s),
    };
    // Facets with the same corners count as repeated, not as an intersection.
    let same = s.iter().all(|(v, _)| t.iter().any(|(w, _)| v == w));
    // The boxes of the tree are rounded outward. So few facets intersect that the exact boxes are
    // compared last.
    !same && intersect(&s, &t) && boxes_overlap(corner_box(mesh, i), corner_box(mesh, j))
}
