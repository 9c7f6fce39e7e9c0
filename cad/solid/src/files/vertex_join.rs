//! Corners with identical coordinates made one vertex.

use std::hash::BuildHasher;

use hashbrown::{DefaultHashBuilder, HashTable};

use crate::mesh::Point3;

/// The vertices met so far.
#[derive(Default)]
pub(super) struct VertexJoin {
    /// Coordinates of each vertex, as bits: a NaN is equal to itself.
    vertices: Vec<[u32; 3]>,
    /// Numbers of the vertices by a hash of their coordinates. The table holds no coordinates, so that it fits into the
    /// processor's caches: a file names most vertices again soon after the first time.
    numbers: HashTable<u32>,
    hasher: DefaultHashBuilder,
}

impl VertexJoin {
    /// Makes room for so many vertices more.
    pub(super) fn reserve(&mut self, additional: usize) {
        let Self { vertices, numbers, hasher } = self;
        vertices.reserve(additional);
        numbers.reserve(additional, |i| hasher.hash_one(vertices[*i as usize]));
    }

    /// The number of the vertex at `corner`; vertices are numbered as they come.
    pub(super) fn number(&mut self, corner: [f32; 3]) -> u32 {
        let Self { vertices, numbers, hasher } = self;
        let key = corner.map(f32::to_bits);
        let entry = numbers.entry(
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

    /// All vertices by their numbers.
    pub(super) fn iter(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.vertices.iter().map(|v| v.map(f32::from_bits))
    }

    /// The positions of all vertices.
    pub(super) fn into_positions(self) -> Vec<Point3> {
        self.iter().map(point).collect()
    }
}

/// A point from single precision.
pub(super) fn point([x, y, z]: [f32; 3]) -> Point3 {
    Point3::new(x.into(), y.into(), z.into())
}
