//! Facets of an STL in the order of the file, with their corners merged.

use super::vertex_map::{VertexMap, point};
use crate::mesh::{Mesh, Point3, Vector3};

/// The content of an STL file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StlFile {
    /// The triangles; corners with identical coordinates are one vertex.
    pub mesh: Mesh,
    /// Number of facets whose stored normal contradicts the order of their corners: the angle to
    /// the normal of the facet is at least 100 degrees.
    pub contrary_normals: usize,
    /// Number of facets whose stored normal is not perpendicular to them, by 10 to 100 degrees.
    pub oblique_normals: usize,
    /// Number of facets whose stored normal is not finite.
    pub invalid_normals: usize,
    /// Bytes after the last triangle that a binary header announces; readers ignore them.
    pub trailing_bytes: u64,
    /// Deviations from the format that readers accept.
    pub deviations: Vec<&'static str>,
}

/// Normals of facets, by their angle to the facet.
#[derive(Clone, Copy, Debug, Default)]
struct Normals {
    contrary: usize,
    oblique: usize,
    invalid: usize,
}

/// Cosine of 100 degrees: a normal at a right angle to that of the facet is not contrary.
const CONTRARY: f64 = -0.173_648_177_666_930_35;
/// Cosine of 10 degrees.
const OBLIQUE: f64 = 0.984_807_753_012_208;
/// Height of a facet in mm below which its own normal is uncertain.
const UNCERTAIN_HEIGHT_MM: f64 = 1e-4;

impl Normals {
    fn add(&mut self, stored: [f32; 3], [a, b, c]: [Point3; 3]) {
        let stored = Vector3::from(stored.map(f64::from));
        if !stored.iter().all(|x| x.is_finite()) {
            self.invalid += 1;
            return;
        }
        let (u, v) = (b - a, c - a);
        let normal = u.cross(&v);
        let (area, length) = (normal.norm(), stored.norm());
        let longest = u.norm().max(v.norm()).max((c - b).norm());
        // Many programs write zeros, for readers to compute.
        if length == 0.0 || area <= UNCERTAIN_HEIGHT_MM * longest {
            return;
        }
        let cosine = normal.dot(&stored) / (area * length);
        self.contrary += usize::from(cosine <= CONTRARY);
        self.oblique += usize::from(cosine > CONTRARY && cosine < OBLIQUE);
    }
}

/// Facets whose corners are merged to vertices.
#[derive(Default)]
pub(super) struct Facets {
    vertices: VertexMap,
    triangles: Vec<[u32; 3]>,
    normals: Normals,
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
        self.normals.add(normal, [point(a), point(b), point(c)]);
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
        self.normals.contrary += later.normals.contrary;
        self.normals.oblique += later.normals.oblique;
        self.normals.invalid += later.normals.invalid;
    }

    /// Returns the mesh of all facets; `None` if there is none.
    pub(super) fn finish(self) -> Option<StlFile> {
        let mesh = Mesh::new(self.vertices.into_positions(), self.triangles);
        (!mesh.triangles.is_empty()).then_some(StlFile {
            mesh,
            contrary_normals: self.normals.contrary,
            oblique_normals: self.normals.oblique,
            invalid_normals: self.normals.invalid,
            trailing_bytes: 0,
            deviations: Vec::new(),
        })
    }
}
