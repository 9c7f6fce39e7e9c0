//! Stars: the facets around each vertex with the edges that run from it, in one pass for all checks that need them.
//!
//! Every edge belongs to the star of its lesser vertex and every facet to that of its least, so that edges and facets
//! are counted where they lie: without a table of all edges, and for all vertices at the same time.

use super::Fault;
use super::edges::Edges;
use super::facets::Repeats;
use super::fans::Fans;
use crate::mesh::Mesh;
use crate::parallel;

/// A half-edge at the middle of a star, packed so that sorting puts those to the same vertex side by side.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Spoke(u64);

impl Spoke {
    fn new(far: u32, place: u32, outgoing: bool) -> Self {
        Self(u64::from(far) << 32 | u64::from(place) << 1 | u64::from(outgoing))
    }

    /// The vertex at the other end.
    pub(super) fn far(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// The place of its facet among those of the star.
    pub(super) fn place(self) -> usize {
        (self.0 as u32 >> 1) as usize
    }

    /// Whether the half-edge starts at the middle; otherwise it ends there.
    pub(super) fn outgoing(self) -> bool {
        self.0 & 1 == 1
    }
}

/// The surroundings of one vertex.
pub(super) struct Star<'a> {
    pub(super) middle: u32,
    /// Numbers of the facets, ascending. One with several corners here is named as often.
    pub(super) facets: &'a [u32],
    /// The half-edges from and to the middle, by the vertex at the other end.
    pub(super) spokes: &'a [Spoke],
}

impl<'a> Star<'a> {
    /// The spokes edge by edge.
    pub(super) fn edges(&self) -> impl Iterator<Item = (u32, &'a [Spoke])> + use<'a> {
        self.spokes.chunk_by(|a, b| a.far() == b.far()).map(|edge| (edge[0].far(), edge))
    }
}

/// What the stars of a range of vertices show.
#[derive(Default)]
struct Found {
    edges: Edges,
    fans: Fans,
    repeats: Repeats,
}

/// What is wrong with facets, edges and vertices that should belong together.
pub(super) struct Faults {
    pub(super) repeated: Option<Fault>,
    pub(super) edges: Vec<Fault>,
    pub(super) vertices: Option<Fault>,
}

pub(super) fn examine(mesh: &Mesh) -> Faults {
    let around = Around::new(mesh);
    let parts = parallel::in_chunks(mesh.positions.len(), |vertices| {
        let mut found = Found::default();
        let mut spokes = Vec::new();
        for v in vertices {
            let facets = around.facets(v);
            let middle = v as u32;
            fill(&mut spokes, mesh, middle, facets);
            let star = Star { middle, facets, spokes: &spokes };
            found.edges.see(&star);
            found.fans.see(&star);
            found.repeats.see(mesh, &star);
        }
        found
    });
    let mut all = Found::default();
    for part in parts {
        all.edges.append(part.edges);
        all.fans.append(part.fans);
        all.repeats.append(part.repeats);
    }
    Faults {
        repeated: all.repeats.fault(mesh),
        edges: all.edges.faults(mesh),
        vertices: all.fans.fault(mesh),
    }
}

/// The spokes of the star of `facets` around `middle`.
fn fill(spokes: &mut Vec<Spoke>, mesh: &Mesh, middle: u32, facets: &[u32]) {
    spokes.clear();
    let mut last = None;
    for (place, f) in facets.iter().enumerate() {
        let t = mesh.triangles[*f as usize];
        // A facet that is named again is here with its next corner.
        let from = last.filter(|(g, _)| g == f).map_or(0, |(_, corner)| corner + 1);
        let Some(corner) = (from..3).find(|k| t[*k] == middle) else { continue };
        last = Some((*f, corner));
        spokes.push(Spoke::new(t[(corner + 1) % 3], place as u32, true));
        spokes.push(Spoke::new(t[(corner + 2) % 3], place as u32, false));
    }
    spokes.sort_unstable();
}

/// Facet numbers around each vertex, packed: those of vertex `v` are `facets[starts[v]..starts[v + 1]]`.
struct Around {
    starts: Vec<usize>,
    facets: Vec<u32>,
}

impl Around {
    fn new(mesh: &Mesh) -> Self {
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

    fn facets(&self, v: usize) -> &[u32] {
        &self.facets[self.starts[v]..self.starts[v + 1]]
    }
}
