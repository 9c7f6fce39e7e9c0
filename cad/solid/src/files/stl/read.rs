//! Reads binary and ASCII STL.

use std::io::{Read, Seek};

use super::ascii::{is_ascii, read_ascii};
use super::binary::{HEADER, RECORD, announced, read_binary};
use super::error::StlError;
use super::facets::StlFile;
use super::file_type::other_format;

/// Reads a binary or ASCII STL. Corners with identical coordinates become one vertex; nothing is
/// repaired.
///
/// ```
/// use std::io::Cursor;
///
/// use pinswitch_solid::files::read_stl;
///
/// let text = "solid one
/// facet normal 0 0 1
/// outer loop
/// vertex 0 0 0
/// vertex 5 0 0
/// vertex 0 5 0
/// endloop
/// endfacet
/// endsolid one
/// ";
/// let stl = read_stl(&mut Cursor::new(text))?;
/// assert_eq!((stl.mesh.triangles.len(), stl.mesh.positions.len(), stl.contrary_normals), (1, 3, 0));
/// assert!(read_stl(&mut Cursor::new("not an STL")).is_err());
/// # Ok::<(), pinswitch_solid::files::StlError>(())
/// ```
///
/// # Errors
/// [`StlError`] if the file is not an STL, is cut short or contains no triangle.
pub fn read_stl(source: &mut (impl Read + Seek)) -> Result<StlFile, StlError> {
    let head = Head::read(source)?;
    if head.length == 0 {
        return Err(StlError::NoBytes);
    }
    if !head.is_exact()
        && let Some(format) = other_format(&head.bytes, head.fits())
    {
        return Err(StlError::OtherFormat(format));
    }
    head.check_length()?;
    let (facets, deviations) = if head.is_ascii() {
        read_ascii(source)?
    } else {
        (read_binary(source, head.facets(), head.length)?, head.deviations())
    };
    let trailing_bytes = if head.is_ascii() { 0 } else { head.trailing_bytes() };
    facets.finish().map(|file| StlFile { trailing_bytes, deviations, ..file }).ok_or(StlError::NoTriangle)
}

/// Bytes of a normal: fewer at the end of a file are no facet that is cut short.
const NORMAL: u64 = 12;

/// The first bytes of a file, and its length.
struct Head {
    bytes: Vec<u8>,
    length: u64,
    /// Whether the bytes after the last whole facet are no part of a facet.
    has_foreign_tail: bool,
}

impl Head {
    /// Reads the head and returns to the start.
    fn read(source: &mut (impl Read + Seek)) -> std::io::Result<Self> {
        let length = source.seek(std::io::SeekFrom::End(0))?;
        source.rewind()?;
        let mut bytes = Vec::with_capacity(HEADER);
        source.by_ref().take(HEADER as u64).read_to_end(&mut bytes)?;
        let tail = length.saturating_sub(HEADER as u64) % RECORD as u64;
        source.seek(std::io::SeekFrom::Start(length - tail))?;
        let mut end = Vec::with_capacity(RECORD);
        source.by_ref().take(tail).read_to_end(&mut end)?;
        source.rewind()?;
        let has_foreign_tail = tail < NORMAL || end.iter().all(|byte| *byte == 0);
        Ok(Self { bytes, length, has_foreign_tail })
    }

    /// Whether the file is a binary STL with as many bytes as its count of facets announces: no other file is, whatever its
    /// header has.
    fn is_exact(&self) -> bool {
        self.announced().is_some_and(|(facets, expected)| facets > 0 && expected == self.length)
    }

    /// Whether the file is an ASCII STL. A binary header may begin with `solid`, too; then the file is exactly as long as the
    /// header announces, or its count is the greatest number, whose bytes are not text.
    fn is_ascii(&self) -> bool {
        let is_streamed =
            self.announced().is_some_and(|(facets, _)| facets == u32::MAX) && self.uncounted().is_some();
        is_ascii(&self.bytes) && !self.is_exact() && !is_streamed
    }

    /// The facet count of a binary STL, and the size in bytes of a file with that many.
    fn announced(&self) -> Option<(u32, u64)> {
        let announced = announced(&self.bytes)?;
        Some((announced, HEADER as u64 + RECORD as u64 * u64::from(announced)))
    }

    /// Number of facets in the file if its count is that of a program which writes facets before it
    /// knows their number, and leaves 0 or the greatest number there.
    fn uncounted(&self) -> Option<u64> {
        let (announced, _) = self.announced()?;
        let body = self.length.checked_sub(HEADER as u64).filter(|body| *body > 0)?;
        let facets = body / RECORD as u64;
        (matches!(announced, 0 | u32::MAX) && facets > 0 && self.has_foreign_tail).then_some(facets)
    }

    /// Number of facets of a binary file.
    fn facets(&self) -> u64 {
        let announced = || self.announced().map_or(0, |(announced, _)| u64::from(announced));
        self.uncounted().unwrap_or_else(announced)
    }

    fn deviations(&self) -> Vec<&'static str> {
        let deviation = "the header does not count the facets; the length of the file gives their number";
        self.uncounted().map(|_| deviation).into_iter().collect()
    }

    /// Whether the file has room for all facets that a binary header announces. Some programs
    /// append bytes, which readers ignore.
    fn fits(&self) -> bool {
        self.uncounted().is_some() || self.announced().is_some_and(|(_, expected)| expected <= self.length)
    }

    fn trailing_bytes(&self) -> u64 {
        let expected = HEADER as u64 + RECORD as u64 * self.facets();
        self.length.saturating_sub(expected)
    }

    /// Refuses a binary file that is shorter than its header announces: it would pass for a smaller
    /// part.
    fn check_length(&self) -> Result<(), StlError> {
        match self.announced() {
            _ if self.is_ascii() || self.fits() => Ok(()),
            Some((announced, expected)) => Err(StlError::Length { announced, expected, actual: self.length }),
            None => Err(StlError::TooShort(self.length)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::binary::RECORDS_PER_READ;
    use super::super::facets::Facets;
    use super::super::write::stl_bytes;
    use super::*;
    use crate::mesh::{Mesh, Point3};
    use std::io::Cursor;

    fn tetrahedron() -> Mesh {
        let positions = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)];
        Mesh::new(
            positions.map(|(x, y, z)| Point3::new(x, y, z)).to_vec(),
            vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        )
    }

    #[test]
    fn a_written_mesh_is_read_back() {
        let bytes = stl_bytes(&tetrahedron()).unwrap();
        assert_eq!(bytes.len(), 84 + 4 * 50);
        let back = read_stl(&mut Cursor::new(bytes)).unwrap().mesh;
        assert_eq!((back.positions.len(), back.triangles.len()), (4, 4));
        for volume in back.axis_volumes_mm3() {
            assert!((volume - 1.0 / 6.0).abs() < 1e-12);
        }
    }

    #[test]
    fn trailing_bytes_are_counted() {
        let mut bytes = stl_bytes(&tetrahedron()).unwrap();
        let trailing = |bytes: &[u8]| read_stl(&mut Cursor::new(bytes.to_vec())).unwrap().trailing_bytes;
        assert_eq!(trailing(&bytes), 0);
        bytes.extend([7; 13]);
        assert_eq!(trailing(&bytes), 13);
    }

    /// Programs that write facets as they come leave 0 or the greatest number as their count.
    #[test]
    fn uncounted_facets_are_read() {
        let mut bytes = stl_bytes(&tetrahedron()).unwrap();
        for count in [0, u32::MAX] {
            bytes[HEADER - 4..HEADER].copy_from_slice(&count.to_le_bytes());
            let stl = read_stl(&mut Cursor::new(bytes.clone())).unwrap();
            assert_eq!((stl.mesh.triangles.len(), stl.trailing_bytes, stl.deviations.len()), (4, 0, 1));
            assert!(read_stl(&mut Cursor::new(&bytes[..bytes.len() - 1])).is_err());
            for tail in [&b"abc"[..], &[0; 40]] {
                let stl = read_stl(&mut Cursor::new([&bytes, tail].concat())).unwrap();
                assert_eq!((stl.mesh.triangles.len(), stl.trailing_bytes), (4, tail.len() as u64));
            }
        }
    }

    /// A header may begin with `solid`, even without a zero byte in the count of facets.
    #[test]
    fn binary_files_may_begin_with_solid() {
        let mut bytes = stl_bytes(&tetrahedron()).unwrap();
        bytes[..HEADER - 4].fill(b' ');
        bytes[..5].copy_from_slice(b"solid");
        assert_eq!(read_stl(&mut Cursor::new(bytes)).unwrap().mesh.triangles.len(), 4);
    }

    /// Normals at a right angle to the facet are only oblique, whatever the sign of their rounding.
    #[test]
    fn normals_are_contrary_from_100_degrees() {
        let stl = |normal: &str| {
            let text = format!(
                "solid\nfacet normal {normal}\nouter loop\nvertex 0 0 0\nvertex 5 0 0\nvertex 0 5 0\nendloop\nendfacet\n"
            );
            let stl = read_stl(&mut Cursor::new(text)).unwrap();
            (stl.contrary_normals, stl.oblique_normals, stl.invalid_normals)
        };
        assert_eq!(stl("0 0 1"), (0, 0, 0));
        assert_eq!(stl("0 0 0"), (0, 0, 0));
        assert_eq!(stl("1 0 -1e-12"), (0, 1, 0));
        assert_eq!(stl("1 0 -0.17"), (0, 1, 0));
        assert_eq!(stl("1 0 -0.19"), (1, 0, 0));
        assert_eq!(stl("nan nan nan"), (0, 0, 1));
    }

    #[test]
    fn broken_files_are_refused() {
        let bytes = stl_bytes(&tetrahedron()).unwrap();
        let read = |bytes: &[u8]| read_stl(&mut Cursor::new(bytes.to_vec()));
        assert!(matches!(read(&bytes[..150]), Err(StlError::Length { announced: 4, .. })));
        assert!(matches!(read(b""), Err(StlError::NoBytes)));
        assert!(matches!(read(&[1, 0, 2]), Err(StlError::TooShort(3))));
        assert!(matches!(read(b"solid x\nfacet normal 0 0 z\n"), Err(StlError::Line { line: 2, .. })));
        assert!(matches!(read(b"solid x\nendsolid x\n"), Err(StlError::NoTriangle)));
        let long = read(format!("solid x\n{}\n", "facet ".repeat(10_000)).as_bytes()).unwrap_err();
        assert!(long.to_string().len() < 300, "{long}");
        assert!(matches!(read(&stl_bytes(&Mesh::default()).unwrap()), Err(StlError::NoTriangle)));
    }

    /// A binary STL whose facets repeat some corners soon, some much later and some never.
    fn repetitive(facets: usize) -> Vec<u8> {
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
    fn chunks_merge_to_the_same_mesh() {
        // Less than a chunk, several chunks, and more than one read.
        for facets in [3, 4097, 20_000, RECORDS_PER_READ + 5000] {
            let bytes = repetitive(facets);
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
    fn an_excessive_count_reserves_no_memory() {
        let mut bytes = repetitive(10);
        bytes[..6].copy_from_slice(b"solidX");
        bytes[HEADER - 4..HEADER].copy_from_slice(&[0x20; 4]);
        assert!(read_stl(&mut Cursor::new(bytes)).is_err());
    }

    /// A binary file of exactly the announced length is one, whatever its header has; so is a streamed one.
    #[test]
    fn headers_of_binary_files_may_be_any() {
        let facet = [0_u8; 12]
            .into_iter()
            .chain([0.0_f32, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 5.0, 0.0].into_iter().flat_map(f32::to_le_bytes))
            .chain([0, 0])
            .collect::<Vec<u8>>();
        let file = |header: &str, count: u32| {
            let mut bytes = format!("{header:<80}").into_bytes();
            bytes.extend(count.to_le_bytes());
            bytes.extend(&facet);
            read_stl(&mut std::io::Cursor::new(bytes))
        };
        for header in ["ISO-10303-21 converted part", "ply\n", "%PDF part", "Rar!", "solid part"] {
            assert_eq!(file(header, 1).unwrap().mesh.triangles.len(), 1, "{header}");
        }
        assert_eq!(file("solid part", u32::MAX).unwrap().mesh.triangles.len(), 1);
        assert!(file("%PDF part", 7).is_err());
    }
}
