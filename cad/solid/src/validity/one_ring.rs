//! One-rings: the facets around a vertex, with the half-edges from and to it.

use crate::mesh::Mesh;

/// A half-edge at the centre of a one-ring, packed so that sorting groups the half-edges of one
/// edge.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct HalfEdge(u64);

impl HalfEdge {
    fn new(far: u32, slot: u32, is_outgoing: bool) -> Self {
        Self(u64::from(far) << 32 | u64::from(slot) << 1 | u64::from(is_outgoing))
    }

    /// The vertex at the other end.
    pub(super) fn far(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// The position of its facet in [`OneRing::facets`].
    pub(super) fn slot(self) -> usize {
        (self.0 as u32 >> 1) as usize
    }

    /// Whether the half-edge starts at the centre; otherwise it ends there.
    pub(super) fn is_outgoing(self) -> bool {
        self.0 & 1 == 1
    }
}

/// The one-ring of a vertex.
pub(super) struct OneRing<'a> {
    /// The vertex.
    pub(super) centre: u32,
    /// Indices of the facets, ascending. A facet with several corners at the centre occurs as
    /// often.
    pub(super) facets: &'a [u32],
    /// The half-edges from and to the centre, sorted by the vertex at the other end.
    pub(super) half_edges: &'a [HalfEdge],
}

impl<'a> OneRing<'a> {
    /// Edges at the centre: the vertex at the other end, with the half-edges of the edge.
    pub(super) fn edges(&self) -> impl Iterator<Item = (u32, &'a [HalfEdge])> + use<'a> {
        self.half_edges.chunk_by(|a, b| a.far() == b.far()).map(|edge| (edge[0].far(), edge))
    }
}

/// Writes the half-edges of the one-ring of `facets` around `centre` to `half_edges`.
pub(super) fn collect_half_edges(half_edges: &mut Vec<HalfEdge>, mesh: &Mesh, centre: u32, facets: &[u32]) {
    half_edges.clear();
    let mut last = None;
    for (slot, f) in facets.iter().enumerate() {
        let t = mesh.triangles[*f as usize];
        // A facet that occurs again contributes its next corner.
        let from = last.filter(|(g, _)| g == f).map_or(0, |(_, corner)| corner + 1);
        let Some(corner) = (from..3).find(|k| t[*k] == centre) else { continue };
        last = Some((*f, corner));
        half_edges.push(HalfEdge::new(t[(corner + 1) % 3], slot as u32, true));
        half_edges.push(HalfEdge::new(t[(corner + 2) % 3], slot as u32, false));
    }
    half_edges.sort_unstable();
}

/// Facets around each vertex, packed: those of vertex `v` are `facets[starts[v]..starts[v + 1]]`.
pub(super) struct VertexFacets {
    starts: Vec<usize>,
    facets: Vec<u32>,
}

impl VertexFacets {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut starts = vec![0; mesh.positions.len() + 1];
        for v in mesh.triangles.iter().flatten() {
            starts[*v as usize + 1] += 1;
        }
        for v in 1..starts.len() {
            starts[v] += starts[v - 1];
        }
        let mut next = starts.clone();
        let mut facets = vec![0; 3 * mesh.triangles.len()];
        for (f, t) in (0u32..).zip(&mesh.triangles) {
            for v in t {
                facets[next[*v as usize]] = f;
                next[*v as usize] += 1;
            }
        }
        Self { starts, facets }
    }

    /// The facets around vertex `v`.
    pub(super) fn of(&self, v: usize) -> &[u32] {
        &self.facets[self.starts[v]..self.starts[v + 1]]
    }
}
