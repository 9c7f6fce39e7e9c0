//! Manifold edges: every edge has exactly two facets, with opposite half-edges.

use super::fault::{Fault, Level};
use super::occurrences::Occurrences;
use super::one_ring::OneRing;
use crate::mesh::Mesh;

/// An edge by its lesser and its greater vertex.
type Edge = (u32, u32);

/// Edges that are not manifold, by kind.
#[derive(Default)]
pub(super) struct EdgeFaults {
    open: Occurrences<Edge>,
    non_manifold: Occurrences<Edge>,
    flipped: Occurrences<Edge>,
}

impl EdgeFaults {
    /// Checks the edges from the centre of a one-ring to greater vertices.
    pub(super) fn check(&mut self, ring: &OneRing) {
        for (far, half_edges) in ring.edges().filter(|(far, _)| *far >= ring.centre) {
            let outgoing = half_edges.iter().filter(|h| h.is_outgoing()).count();
            let edge = (ring.centre, far);
            // Each half-edge of an edge from a vertex to itself occurs twice, outgoing and
            // incoming.
            let (outgoing, facets) =
                if far == ring.centre { (0, outgoing) } else { (outgoing, half_edges.len()) };
            match facets {
                1 => self.open.add(edge),
                2 if outgoing == 1 => {}
                2 => self.flipped.add(edge),
                _ => self.non_manifold.add(edge),
            }
        }
    }

    /// Adds the faults of later vertices.
    pub(super) fn append(&mut self, later: Self) {
        self.open.append(later.open);
        self.non_manifold.append(later.non_manifold);
        self.flipped.append(later.flipped);
    }

    pub(super) fn faults(self, mesh: &Mesh) -> Vec<Fault> {
        let fault = |edges: Occurrences<Edge>, check, problem: &str| {
            let edge = edges.first?;
            let [a, b] = [edge.0, edge.1].map(|i| mesh.positions[i as usize]);
            let count = edges.count;
            let detail = format!("{count} edges {problem}; the first is {:.4} mm long", (b - a).norm());
            Some(Fault::new(check, Level::Error, count, detail).at(nalgebra::center(&a, &b)))
        };
        [
            fault(self.open, "open edge", "have only one facet, so that the surface has a hole"),
            fault(self.non_manifold, "non-manifold edge", "have more than two facets"),
            fault(self.flipped, "flipped facet", "have two facets that face opposite ways"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
