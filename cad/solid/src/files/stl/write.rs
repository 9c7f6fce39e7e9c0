//! Writes binary STL.

use super::binary::{HEADER, RECORD};
use crate::mesh::Mesh;

/// Returns the mesh as binary STL: single precision, unit normals, an empty header.
///
/// # Errors
/// More triangles than the format can count (2³²).
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
