//! Merging of corners with identical coordinates to one vertex.

use std::hash::BuildHasher;

use hashbrown::{DefaultHashBuilder, HashTable};

use crate::mesh::Point3;

/// Vertices by their coordinates, in the order of their first corners.
#[derive(Default)]
pub(super) struct VertexMap {
    /// Coordinates of each vertex, as bits: a NaN equals itself.
    vertices: Vec<[u32; 3]>,
    /// Indices of the vertices by a hash of their coordinates. The table does not repeat the
    /// coordinates, so that it fits into the processor's caches: most vertices of a file occur
    /// again soon after their first corner.
    indices: HashTable<u32>,
    hasher: DefaultHashBuilder,
}

impl VertexMap {
    /// Reserves capacity for `additional` vertices.
    pub(super) fn reserve(&mut self, additional: usize) {
        let Self { vertices, indices, hasher } = self;
        vertices.reserve(additional);
        indices.reserve(additional, |i| hasher.hash_one(vertices[*i as usize]));
    }

    /// Returns the index of the vertex at `corner`, a new one for new coordinates.
    pub(super) fn index_of(&mut self, corner: [f32; 3]) -> u32 {
        let Self { vertices, indices, hasher } = self;
        let key = corner.map(f32::to_bits);
        let entry = indices.entry(
            hasher.hash_one(key),
            |i| vertices[*i as usize] == key,
            |i| hasher.hash_one(vertices[*i as usize]),
        );
        *entry
            .or_insert_with(|| {
                let next = u32::try_from(vertices.len()).unwrap_or(u32::MAX);
                vertices.push(key);
                next
            })
            .get()
    }

    /// Coordinates of all vertices, by index.
    pub(super) fn iter(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.vertices.iter().map(|v| v.map(f32::from_bits))
    }

    /// Positions of all vertices, by index.
    pub(super) fn into_positions(self) -> Vec<Point3> {
        self.iter().map(point).collect()
    }
}

/// A point from single precision.
pub(super) fn point([x, y, z]: [f32; 3]) -> Point3 {
    Point3::new(x.into(), y.into(), z.into())
}
