//! Facets that pass through each other.

use super::facet_tree::{FacetTree, boxes_meet, corner_box};
use super::triangle_pair::{Corners, meet, surely_apart};
use super::{Fault, place};
use crate::mesh::Mesh;
use crate::parallel;

/// Pairs that cross, and the least number of a facet among them.
struct Crossings {
    count: usize,
    first: usize,
}

pub(super) fn self_intersections(mesh: &Mesh, tree: &FacetTree) -> Option<Fault> {
    let parts = parallel::in_chunks(tree.leaves(), |leaves| {
        let mut found = Crossings { count: 0, first: usize::MAX };
        let mut near = Vec::new();
        for leaf in leaves {
            tree.pairs_from(leaf, &mut near, |a, b| {
                if cross(mesh, tree, a, b) {
                    found.count += 1;
                    found.first = found.first.min(tree.facet(a)).min(tree.facet(b));
                }
            });
        }
        found
    });
    let count: usize = parts.iter().map(|part| part.count).sum();
    let first = parts.iter().map(|part| part.first).min()?;
    (count > 0).then(|| Fault {
        check: "self-intersection",
        count,
        at_mm: place(mesh.positions[mesh.triangles[first][0] as usize]),
        detail: format!("{count} pairs of facets pass through each other"),
    })
}

/// Whether the facets in two slots pass through each other.
fn cross(mesh: &Mesh, tree: &FacetTree, a: usize, b: usize) -> bool {
    let corners = |slot: usize| -> Corners {
        let [x, y, z] = mesh.triangles[tree.facet(slot)];
        let at = |v: u32| (v, mesh.positions[v as usize]);
        [at(x), at(y), at(z)]
    };
    let (s, t) = (corners(a), corners(b));
    if surely_apart((&s, tree.plane(a)), (&t, tree.plane(b))) {
        return false;
    }
    let (i, j, s, t) = match (tree.facet(a), tree.facet(b)) {
        (i, j) if i < j => (i, j, s, t),
        (i, j) => (j, i, t, s),
    };
    // Facets on the same corners are counted as repeated, not as crossing.
    let same = s.iter().all(|(v, _)| t.iter().any(|(w, _)| v == w));
    // The tree's boxes are rounded outward. So few facets meet that their exact boxes are worth a look only now.
    !same && meet(&s, &t) && boxes_meet(corner_box(mesh, i), corner_box(mesh, j))
}
