//! Half-edges: every edge has exactly two facets, which run along it in opposite senses.

use std::collections::BTreeMap;

use super::{Fault, place};
use crate::mesh::Mesh;

/// Times an edge is used from its smaller to its larger vertex, and back.
#[derive(Clone, Copy, Default)]
struct Uses {
    along: usize,
    against: usize,
}

pub(super) fn unpaired(mesh: &Mesh) -> Vec<Fault> {
    let mut uses: BTreeMap<(u32, u32), Uses> = BTreeMap::new();
    for t in &mesh.triangles {
        for (a, b) in half_edges(*t) {
            let entry = uses.entry((a.min(b), a.max(b))).or_default();
            if a < b { entry.along += 1 } else { entry.against += 1 }
        }
    }
    let all = |wrong: fn(&Uses) -> bool, check, what: &str| {
        let mut bad = uses.iter().filter(|(_, u)| wrong(u));
        let (edge, _) = bad.next()?;
        let count = 1 + bad.count();
        let [a, b] = [edge.0, edge.1].map(|i| mesh.positions[i as usize]);
        Some(Fault {
            check,
            count,
            at_mm: place(nalgebra::center(&a, &b)),
            detail: format!("{count} edges {what}, the first {:.4} mm long", (b - a).norm()),
        })
    };
    [
        all(|u| u.along + u.against == 1, "open edge", "have one facet only: there is a hole"),
        all(|u| u.along + u.against > 2, "non-manifold edge", "have more than two facets"),
        all(
            |u| u.along + u.against == 2 && u.along != 1,
            "flipped facet",
            "have two facets that face opposite ways",
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The three half-edges of a triangle.
pub(super) fn half_edges([a, b, c]: [u32; 3]) -> [(u32, u32); 3] {
    [(a, b), (b, c), (c, a)]
}
