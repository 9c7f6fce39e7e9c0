//! Manifold vertices: the facets around each vertex form a single fan, so that its link is
//! connected.

use super::fault::{Fault, Level};
use super::occurrences::Occurrences;
use super::one_ring::OneRing;
use crate::mesh::Mesh;

/// Vertices in which parts of the surface touch without a common edge.
#[derive(Default)]
pub(super) struct VertexFaults {
    split: Occurrences<u32>,
    /// Union-find forest over the facets of a one-ring, reused for every vertex.
    parents: Vec<usize>,
}

impl VertexFaults {
    /// Checks the centre of a one-ring.
    pub(super) fn check(&mut self, ring: &OneRing) {
        if self.fans(ring) > 1 {
            self.split.add(ring.centre);
        }
    }

    /// Number of fans: groups of facets that are connected through edges at the centre.
    fn fans(&mut self, ring: &OneRing) -> usize {
        self.parents.clear();
        self.parents.extend(0..ring.facets.len());
        let mut fans = ring.facets.len();
        for (_, half_edges) in ring.edges().filter(|(far, _)| *far != ring.centre) {
            for pair in half_edges.windows(2) {
                let (a, b) = (self.root(pair[0].slot()), self.root(pair[1].slot()));
                fans -= usize::from(a != b);
                self.parents[b] = a;
            }
        }
        fans
    }

    fn root(&mut self, mut slot: usize) -> usize {
        while self.parents[slot] != slot {
            self.parents[slot] = self.parents[self.parents[slot]];
            slot = self.parents[slot];
        }
        slot
    }

    /// Adds the faults of later vertices.
    pub(super) fn append(&mut self, later: Self) {
        self.split.append(later.split);
    }

    pub(super) fn fault(self, mesh: &Mesh) -> Option<Fault> {
        let Occurrences { count, first } = self.split;
        let detail = format!("{count} vertices join parts of the surface without a common edge");
        let fault = Fault::new("non-manifold vertex", Level::Error, count, detail);
        first.map(|v| fault.at(mesh.positions[v as usize]))
    }
}
