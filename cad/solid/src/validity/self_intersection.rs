//! Facets that intersect.

use super::budget::{Budget, Pool, bound};
use super::bvh::{Bvh, boxes_overlap, corner_box};
use super::fault::{Fault, Level};
use super::hub::arc_boxes;
use super::slivers::Slivers;
use super::triangle_intersection::{Corners, are_disjoint, intersect};
use crate::mesh::Mesh;
use crate::parallel;

/// Most intersections that a part of the search counts: a mesh with more is no more invalid.
const MAX_COUNTED: usize = 2000;
/// Units of work of an exact comparison of two facets.
const EXACT_UNITS: usize = 15;

/// The outcome of the search.
pub(super) struct Search {
    pub(super) fault: Option<Fault>,
    /// The bound that was exceeded before all pairs were compared.
    pub(super) bound: Option<String>,
    /// The work that is left.
    pub(super) left: Pool,
}

/// Intersections among a part of the pairs.
struct Intersections<'a> {
    mesh: &'a Mesh,
    bvh: &'a Bvh,
    slivers: &'a Slivers,
    budget: Budget,
    count: usize,
    /// The least index of a facet among the pairs.
    first: usize,
}

impl Intersections<'_> {
    /// Whether the search of the part ends.
    fn is_over(&self) -> bool {
        self.budget.is_spent() || self.count >= MAX_COUNTED
    }

    /// Compares the facets in two slots.
    fn compare(&mut self, a: usize, b: usize) {
        if !self.is_over() && self.is_intersection(a, b) {
            self.count += 1;
            self.first = self.first.min(self.bvh.facet(a)).min(self.bvh.facet(b));
        }
    }

    fn is_intersection(&mut self, a: usize, b: usize) -> bool {
        let (mesh, bvh) = (self.mesh, self.bvh);
        let corners = |slot: usize| -> Corners {
            let [x, y, z] = mesh.triangles[bvh.facet(slot)];
            let at = |v: u32| (v, mesh.positions[v as usize]);
            [at(x), at(y), at(z)]
        };
        let (s, t) = (corners(a), corners(b));
        self.budget.spend(1);
        if are_disjoint((&s, bvh.plane(a)), (&t, bvh.plane(b))) {
            return false;
        }
        let (i, j, s, t) = match (bvh.facet(a), bvh.facet(b)) {
            (i, j) if i < j => (i, j, s, t),
            (i, j) => (j, i, t, s),
        };
        // Facets with the same corners count as repeated, not as an intersection.
        if s.iter().all(|(v, _)| t.iter().any(|(w, _)| v == w)) {
            return false;
        }
        self.budget.spend(EXACT_UNITS);
        // The boxes of the tree are rounded outward. So few facets intersect that the exact boxes
        // are compared last.
        intersect(&s, &t)
            && boxes_overlap(corner_box(mesh, i), corner_box(mesh, j))
            && self.slivers.accept(&s, &t)
    }
}

/// Searches for pairs of facets that intersect anywhere but in shared corners and edges. Contact of
/// facets thinner than `min_height_mm` with their neighbours does not count. The search does
/// work up to that of `pool`.
pub(super) fn search(mesh: &Mesh, bvh: &Bvh, min_height_mm: f64, pool: Pool) -> Search {
    let slivers = Slivers::of(mesh, min_height_mm);
    let part = |budget| Intersections { mesh, bvh, slivers: &slivers, budget, count: 0, first: usize::MAX };
    let outcome = |part: Intersections<'_>| (part.count, part.first, part.budget);
    let leaves = bvh.leaves();
    let chunks = parallel::chunks(leaves);
    let mut outcomes = parallel::in_chunks(leaves, |leaves| {
        let facets = bvh.slots(leaves.start).start..bvh.slots(leaves.end - 1).end;
        let mut part = part(Budget::of_part(pool, chunks, facets.len(), mesh.triangles.len()));
        let mut near = Vec::new();
        for leaf in leaves {
            if part.is_over() {
                break;
            }
            bvh.pairs_from(leaf, &mut near, |a, b| part.compare(a, b));
            part.budget.spend(near.len());
        }
        outcome(part)
    });
    for (hub, slots) in bvh.hub_slots() {
        let mut part = part(Budget::of_hub(pool, slots.len(), mesh.triangles.len()));
        let arcs = Bvh::new(&arc_boxes(mesh, hub, slots.clone().map(|slot| bvh.facet(slot))));
        let mut near = Vec::new();
        let slot = |arc: usize| slots.start + arcs.facet(arc);
        for leaf in 0..arcs.leaves() {
            if part.is_over() {
                break;
            }
            arcs.pairs_from(leaf, &mut near, |a, b| part.compare(slot(a), slot(b)));
            part.budget.spend(near.len());
        }
        outcomes.push(outcome(part));
    }
    let count: usize = outcomes.iter().map(|(count, ..)| count).sum();
    let is_partial = outcomes.iter().any(|(count, _, budget)| budget.is_spent() || *count >= MAX_COUNTED);
    let first = outcomes.iter().map(|(_, first, _)| *first).min().filter(|_| count > 0);
    let at_least = if is_partial { "at least " } else { "" };
    let detail = format!("{at_least}{count} pairs of facets intersect");
    let mut left = pool;
    left.subtract(outcomes.iter().map(|(.., budget)| *budget));
    let corner = |f: usize| mesh.positions[mesh.triangles[f][0] as usize];
    Search {
        fault: first.map(|f| Fault::new("self-intersection", Level::Error, count, detail).at(corner(f))),
        bound: outcomes
            .iter()
            .any(|(.., budget)| budget.is_spent())
            .then(|| bound(pool, mesh.triangles.len(), "pairs of facets are close to each other")),
        left,
    }
}
