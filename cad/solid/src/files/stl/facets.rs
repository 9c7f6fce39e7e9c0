//! Facets of an STL in the order of the file, with their corners merged.

use super::vertex_map::{VertexMap, point};
use crate::mesh::{Mesh, Vector3};

/// The content of an STL file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StlFile {
    /// The triangles; corners with identical coordinates are one vertex.
    pub mesh: Mesh,
    /// Number of facets whose stored normal contradicts the order of their corners.
    pub contrary_normals: usize,
    /// Bytes after the last triangle that a binary header announces; readers ignore them.
    pub trailing_bytes: u64,
}

/// Facets whose corners are merged to vertices.
#[derive(Default)]
pub(super) struct Facets {
    vertices: VertexMap,
    triangles: Vec<[u32; 3]>,
    contrary_normals: usize,
}

impl Facets {
    pub(super) fn with_capacity(facets: usize) -> Self {
        let mut empty = Self::default();
        empty.reserve(facets);
        empty
    }

    pub(super) fn len(&self) -> usize {
        self.triangles.len()
    }

    pub(super) fn reserve(&mut self, facets: usize) {
        self.triangles.reserve(facets);
        // A closed surface has half as many vertices as facets.
        self.vertices.reserve(facets / 2 + 2);
    }

    pub(super) fn add(&mut self, normal: [f32; 3], corners: [[f32; 3]; 3]) {
        // Adding zero turns -0 into +0, so that both are one vertex.
        let [a, b, c] = corners.map(|[x, y, z]| [x + 0.0, y + 0.0, z + 0.0]);
        let vertices = &mut self.vertices;
        self.triangles.push([vertices.index_of(a), vertices.index_of(b), vertices.index_of(c)]);
        let (a, b, c) = (point(a), point(b), point(c));
        let stored = Vector3::from(normal.map(f64::from));
        self.contrary_normals += usize::from((b - a).cross(&(c - a)).dot(&stored) < 0.0);
    }

    /// Appends facets that come later in the file. Vertices get the numbers that adding facet by
    /// facet gives them.
    pub(super) fn append(&mut self, later: Self) {
        if self.triangles.is_empty() {
            *self = later;
            return;
        }
        let indices: Vec<u32> = later.vertices.iter().map(|v| self.vertices.index_of(v)).collect();
        let renumbered =
            |[a, b, c]: [u32; 3]| [indices[a as usize], indices[b as usize], indices[c as usize]];
        self.triangles.extend(later.triangles.into_iter().map(renumbered));
        self.contrary_normals += later.contrary_normals;
    }

    /// Returns the mesh of all facets; `None` if there is none.
    pub(super) fn finish(self) -> Option<StlFile> {
        let mesh = Mesh::new(self.vertices.into_positions(), self.triangles);
        (!mesh.triangles.is_empty()).then_some(StlFile {
            mesh,
            contrary_normals: self.contrary_normals,
            trailing_bytes: 0,
        })
    }
}
