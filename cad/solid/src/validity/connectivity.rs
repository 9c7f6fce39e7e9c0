//! Connectivity of facets, edges and vertices, checked in one pass over the one-rings.
//!
//! Every edge belongs to the one-ring of its lesser vertex, and every facet to that of its least.
//! So edges and facets are counted without a table of all edges, and vertices are independent of
//! each other.

use super::closed_fan::is_closed_fan;
use super::edge_manifold::EdgeFaults;
use super::facets::RepeatedFacets;
use super::fault::Fault;
use super::one_ring::{OneRing, VertexFacets, collect_half_edges};
use super::vertex_manifold::VertexFaults;
use crate::mesh::Mesh;
use crate::parallel;

/// Faults within a range of vertices.
#[derive(Default)]
struct RangeFaults {
    edges: EdgeFaults,
    vertices: VertexFaults,
    repeated: RepeatedFacets,
}

/// Faults of the connectivity of a mesh.
pub(super) struct Connectivity {
    pub(super) repeated: Option<Fault>,
    pub(super) edges: Vec<Fault>,
    pub(super) vertices: Option<Fault>,
}

impl Connectivity {
    /// Number of edges with only one facet.
    pub(super) fn open_edges(&self) -> usize {
        self.edges.iter().filter(|fault| fault.check == "open edge").map(|fault| fault.count).sum()
    }

    pub(super) fn has_open_edges(&self) -> bool {
        self.open_edges() > 0
    }
}

/// Whether every edge has two facets with opposite half-edges: the mesh is closed and oriented.
pub(crate) fn is_closed(mesh: &Mesh) -> bool {
    check(mesh).edges.is_empty()
}

/// Checks that edges and vertices are manifold and that no facet occurs twice.
pub(super) fn check(mesh: &Mesh) -> Connectivity {
    let around = VertexFacets::new(mesh);
    let parts = parallel::in_chunks(mesh.positions.len(), |vertices| {
        let mut part = RangeFaults::default();
        let mut half_edges = Vec::new();
        for v in vertices {
            let (centre, facets) = (v as u32, around.of(v));
            if is_closed_fan(mesh, centre, facets) {
                continue;
            }
            collect_half_edges(&mut half_edges, mesh, centre, facets);
            let ring = OneRing { centre, facets, half_edges: &half_edges };
            part.edges.check(&ring);
            part.vertices.check(&ring);
            part.repeated.check(mesh, &ring);
        }
        part
    });
    let mut all = RangeFaults::default();
    for part in parts {
        all.edges.append(part.edges);
        all.vertices.append(part.vertices);
        all.repeated.append(part.repeated);
    }
    Connectivity {
        repeated: all.repeated.fault(mesh),
        edges: all.edges.faults(mesh),
        vertices: all.vertices.fault(mesh),
    }
}
