//! Binary STL out, binary or ASCII STL in.

use std::io::{Read, Seek};

use super::kind::other_kind;
use super::stl_facets::{HEADER, RECORD, announced, read_binary};
use super::stl_text::{is_ascii, read_ascii};
use crate::mesh::Mesh;

/// Why a file is no STL.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StlError {
    /// The file cannot be read as STL, binary or ASCII.
    #[error("not a readable STL: {}; export the part again", beginning(.0))]
    Unreadable(#[from] std::io::Error),
    /// A line of an ASCII STL is not what stands there.
    #[error("line {line}: {problem}; export the part again")]
    Line {
        /// The line, from 1.
        line: usize,
        /// What is wrong there.
        problem: String,
    },
    /// The file holds fewer or more bytes than its triangle count says.
    #[error(
        "the header announces {announced} triangles, which take {expected} bytes; the file has {found}: it was cut short, \
         or is no STL; export the part again"
    )]
    Length {
        /// Triangles that the header announces.
        announced: u32,
        /// Bytes that they take.
        expected: u64,
        /// Bytes in the file.
        found: u64,
    },
    /// The file is of another kind.
    #[error("the file is {0}, not an STL; give an STL, a 3MF or a STEP")]
    OtherKind(&'static str),
    /// There is nothing in the file.
    #[error("the file is empty; export the part again")]
    NoBytes,
    /// No STL is that short.
    #[error("the file has {0} bytes, and no STL has less than {HEADER}; export the part again")]
    TooShort(u64),
    /// The file is an STL without a single triangle.
    #[error("the STL holds no triangle; export the part again, with something in it")]
    Empty,
}

/// The beginning of a message, which may repeat a line of any length.
fn beginning(error: &std::io::Error) -> String {
    const SHOWN: usize = 200;
    let text = error.to_string();
    let short: String = text.chars().take(SHOWN).collect();
    if short.len() < text.len() { short + "..." } else { short }
}

/// What an STL file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StlFile {
    /// The triangles; corners with identical coordinates are one vertex.
    pub mesh: Mesh,
    /// Facets whose stored normal contradicts the order of their corners.
    pub contrary_normals: usize,
    /// Bytes behind the last triangle that a binary file announces. Readers pass over them.
    pub trailing_bytes: u64,
}

/// The mesh as binary STL: single precision, unit normals, an empty header.
///
/// # Errors
/// A mesh of more triangles than the format can count.
#[allow(clippy::cast_possible_truncation)]
pub fn stl_bytes(mesh: &Mesh) -> std::io::Result<Vec<u8>> {
    let count = u32::try_from(mesh.triangles.len()).map_err(std::io::Error::other)?;
    let mut bytes = Vec::with_capacity(HEADER + RECORD * mesh.triangles.len());
    bytes.resize(HEADER - size_of::<u32>(), 0);
    bytes.extend(count.to_le_bytes());
    for [a, b, c] in mesh.facets() {
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        let mut record = [0; RECORD];
        let numbers = [normal, a.coords, b.coords, c.coords];
        for (place, x) in record.chunks_exact_mut(size_of::<f32>()).zip(numbers.iter().flatten()) {
            place.copy_from_slice(&(*x as f32).to_le_bytes());
        }
        bytes.extend(record);
    }
    Ok(bytes)
}

/// Reads a binary or ASCII STL. Corners with identical coordinates become one vertex; nothing is repaired.
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
/// assert!(read_stl(&mut Cursor::new("no STL at all")).is_err());
/// # Ok::<(), pinswitch_solid::files::StlError>(())
/// ```
///
/// # Errors
/// [`StlError`] if the file is no STL, cut short, or empty.
pub fn read_stl(source: &mut (impl Read + Seek)) -> Result<StlFile, StlError> {
    let head = Head::read(source)?;
    if head.length == 0 {
        return Err(StlError::NoBytes);
    }
    if let Some(kind) = other_kind(&head.bytes, head.fits()) {
        return Err(StlError::OtherKind(kind));
    }
    head.check_length()?;
    let facets = if is_ascii(&head.bytes) { read_ascii(source)? } else { read_binary(source, head.length)? };
    let trailing_bytes = if is_ascii(&head.bytes) { 0 } else { head.trailing() };
    facets.finish().map(|file| StlFile { trailing_bytes, ..file }).ok_or(StlError::Empty)
}

/// How a file begins, and how long it is.
struct Head {
    bytes: Vec<u8>,
    length: u64,
}

impl Head {
    /// Reads the head and returns to the start.
    fn read(source: &mut (impl Read + Seek)) -> std::io::Result<Self> {
        let length = source.seek(std::io::SeekFrom::End(0))?;
        source.rewind()?;
        let mut bytes = Vec::with_capacity(HEADER);
        source.by_ref().take(HEADER as u64).read_to_end(&mut bytes)?;
        source.rewind()?;
        Ok(Self { bytes, length })
    }

    /// Facets that a binary STL announces, and the bytes that it has with them.
    fn announced(&self) -> Option<(u32, u64)> {
        let announced = announced(&self.bytes)?;
        Some((announced, HEADER as u64 + RECORD as u64 * u64::from(announced)))
    }

    /// Whether it is as long as a binary STL with its count of facets. Some programs append bytes; a reader ignores them,
    /// and so do we.
    fn fits(&self) -> bool {
        self.announced().is_some_and(|(_, expected)| expected <= self.length)
    }

    fn trailing(&self) -> u64 {
        self.announced().map_or(0, |(_, expected)| self.length.saturating_sub(expected))
    }

    /// A binary STL says how long it is; a file cut short must not pass for a smaller part.
    fn check_length(&self) -> Result<(), StlError> {
        match self.announced() {
            _ if is_ascii(&self.bytes) || self.fits() => Ok(()),
            Some((announced, expected)) => Err(StlError::Length { announced, expected, found: self.length }),
            None => Err(StlError::TooShort(self.length)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Point3;
    use std::io::Cursor;

    fn tetrahedron() -> Mesh {
        let positions = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)];
        Mesh::new(
            positions.map(|(x, y, z)| Point3::new(x, y, z)).to_vec(),
            vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        )
    }

    #[test]
    fn a_mesh_survives_the_round_trip() {
        let bytes = stl_bytes(&tetrahedron()).unwrap();
        assert_eq!(bytes.len(), 84 + 4 * 50);
        let back = read_stl(&mut Cursor::new(bytes)).unwrap().mesh;
        assert_eq!((back.positions.len(), back.triangles.len()), (4, 4));
        for volume in back.axis_volumes_mm3() {
            assert!((volume - 1.0 / 6.0).abs() < 1e-12);
        }
    }

    #[test]
    fn bytes_behind_the_last_triangle_are_counted() {
        let mut bytes = stl_bytes(&tetrahedron()).unwrap();
        let trailing = |bytes: &[u8]| read_stl(&mut Cursor::new(bytes.to_vec())).unwrap().trailing_bytes;
        assert_eq!(trailing(&bytes), 0);
        bytes.extend([7; 13]);
        assert_eq!(trailing(&bytes), 13);
    }

    #[test]
    fn broken_files_are_refused() {
        let bytes = stl_bytes(&tetrahedron()).unwrap();
        let read = |bytes: &[u8]| read_stl(&mut Cursor::new(bytes.to_vec()));
        assert!(matches!(read(&bytes[..150]), Err(StlError::Length { announced: 4, .. })));
        assert!(matches!(read(b""), Err(StlError::NoBytes)));
        assert!(matches!(read(&[1, 0, 2]), Err(StlError::TooShort(3))));
        assert!(matches!(read(b"solid x\nfacet normal 0 0 z\n"), Err(StlError::Line { line: 2, .. })));
        assert!(matches!(read(b"solid x\nendsolid x\n"), Err(StlError::Empty)));
        let long = read(format!("solid x\n{}\n", "facet ".repeat(10_000)).as_bytes()).unwrap_err();
        assert!(long.to_string().len() < 300, "{long}");
        assert!(matches!(read(&stl_bytes(&Mesh::default()).unwrap()), Err(StlError::Empty)));
    }
}
