//! The facets of an STL file as they come in, and those of a binary one read many at once.

use std::io::Read;

use super::StlFile;
use super::vertex_join::{VertexJoin, point};
use crate::mesh::{Mesh, Vector3};
use crate::parallel;

/// Bytes before the first facet of a binary STL: a text of 80, then how many facets there are.
pub(super) const HEADER: usize = 84;
/// Bytes of a facet: its normal, three corners, and two bytes that mean nothing.
pub(super) const RECORD: usize = 50;
/// Facets that are read at once, 3 MB: enough for some threads to share.
const RECORDS_AT_ONCE: usize = 1 << 16;

/// Facets with their corners joined.
#[derive(Default)]
pub(super) struct Facets {
    vertices: VertexJoin,
    triangles: Vec<[u32; 3]>,
    contrary_normals: usize,
}

impl Facets {
    fn with_room(facets: usize) -> Self {
        let mut empty = Self::default();
        empty.reserve(facets);
        empty
    }

    fn reserve(&mut self, facets: usize) {
        self.triangles.reserve(facets);
        // A closed surface has half as many vertices as facets.
        self.vertices.reserve(facets / 2 + 2);
    }

    pub(super) fn add(&mut self, normal: [f32; 3], corners: [[f32; 3]; 3]) {
        // Adding zero turns -0 into +0, so that both are one vertex.
        let [a, b, c] = corners.map(|[x, y, z]| [x + 0.0, y + 0.0, z + 0.0]);
        let vertices = &mut self.vertices;
        self.triangles.push([vertices.number(a), vertices.number(b), vertices.number(c)]);
        let (a, b, c) = (point(a), point(b), point(c));
        let stored = Vector3::from(normal.map(f64::from));
        self.contrary_normals += usize::from((b - a).cross(&(c - a)).dot(&stored) < 0.0);
    }

    /// Adds facets that come later in the file. Vertices are numbered as if facets had been added one by one.
    fn append(&mut self, later: Self) {
        if self.triangles.is_empty() {
            *self = later;
            return;
        }
        let numbers: Vec<u32> = later.vertices.iter().map(|v| self.vertices.number(v)).collect();
        let renumbered =
            |[a, b, c]: [u32; 3]| [numbers[a as usize], numbers[b as usize], numbers[c as usize]];
        self.triangles.extend(later.triangles.into_iter().map(renumbered));
        self.contrary_normals += later.contrary_normals;
    }

    /// The mesh of all facets; `None` without any.
    pub(super) fn finish(self) -> Option<StlFile> {
        let mesh = Mesh::new(self.vertices.into_positions(), self.triangles);
        (!mesh.triangles.is_empty()).then_some(StlFile {
            mesh,
            contrary_normals: self.contrary_normals,
            trailing_bytes: 0,
        })
    }
}

/// Reads a binary STL of `length` bytes.
///
/// Corners are joined in two steps: first among some thousand facets, with a table that fits into the nearest caches
/// and on several threads, then what is left of them, a sixth, among all.
pub(super) fn read_binary(source: &mut impl Read, length: u64) -> std::io::Result<Facets> {
    let mut header = [0; HEADER];
    source.read_exact(&mut header)?;
    let mut left = announced(&header).unwrap_or_default() as usize;
    // No more room than the file can fill, whatever its header says.
    let most = left.min(usize::try_from(length / RECORD as u64).unwrap_or(usize::MAX));
    let mut facets = Facets::default();
    let mut buffer = vec![0; RECORD * RECORDS_AT_ONCE.min(most)];
    while left > 0 {
        let count = left.min(RECORDS_AT_ONCE);
        buffer.resize(RECORD * count, 0);
        source.read_exact(&mut buffer)?;
        for part in
            parallel::in_chunks(count, |range| joined(&buffer[RECORD * range.start..RECORD * range.end]))
        {
            facets.append(part);
        }
        left -= count;
        if left > 0 {
            facets.reserve(most - facets.triangles.len());
        }
    }
    Ok(facets)
}

/// The facets of some records of a binary STL.
fn joined(records: &[u8]) -> Facets {
    let mut facets = Facets::with_room(records.len() / RECORD);
    for record in records.chunks_exact(RECORD) {
        let (numbers, _) = record.as_chunks();
        let at = |i: usize| {
            let [x, y, z] = [numbers[i], numbers[i + 1], numbers[i + 2]];
            [f32::from_le_bytes(x), f32::from_le_bytes(y), f32::from_le_bytes(z)]
        };
        facets.add(at(0), [at(3), at(6), at(9)]);
    }
    facets
}

/// The number of facets that the header of a binary STL announces.
pub(super) fn announced(header: &[u8]) -> Option<u32> {
    let count = header.get(HEADER - 4..HEADER)?.try_into().ok()?;
    Some(u32::from_le_bytes(count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::read_stl;
    use std::io::Cursor;

    /// A binary STL whose facets name some corners again at once, some much later and some never.
    fn file(facets: usize) -> Vec<u8> {
        let mut bytes = vec![b' '; HEADER - 4];
        bytes.extend(u32::try_from(facets).unwrap().to_le_bytes());
        for f in 0..facets {
            let corner = |i: usize| {
                [(f + i) as f32, ((f * 7919 + i) % 1000) as f32, if f % 3 == 0 { -0.0 } else { 0.0 }]
            };
            let numbers = [[0.0, 0.0, (f % 2) as f32 - 0.5], corner(0), corner(1), corner(f % 5)];
            bytes.extend(numbers.as_flattened().iter().flat_map(|x| x.to_le_bytes()).chain([0, 0]));
        }
        bytes
    }

    #[test]
    fn facets_read_at_once_are_those_read_one_by_one() {
        // Less than a part, some parts, and more than is read at once.
        for facets in [3, 4097, 20_000, RECORDS_AT_ONCE + 5000] {
            let bytes = file(facets);
            let mut one_by_one = Facets::default();
            for facet in stl_io::create_stl_reader(&mut Cursor::new(&bytes)).unwrap() {
                let facet = facet.unwrap();
                one_by_one.add(facet.normal.0, facet.vertices.map(|v| v.0));
            }
            assert!(
                read_stl(&mut Cursor::new(bytes)).unwrap() == one_by_one.finish().unwrap(),
                "{facets} facets"
            );
        }
    }

    #[test]
    fn a_header_that_announces_too_much_takes_no_memory() {
        let mut bytes = file(10);
        bytes[..6].copy_from_slice(b"solidX");
        bytes[HEADER - 4..HEADER].copy_from_slice(&[0x20; 4]);
        assert!(read_stl(&mut Cursor::new(bytes)).is_err());
    }
}
