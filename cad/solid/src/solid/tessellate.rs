//! From a solid to its triangle mesh, within a chord tolerance.

use super::cap::CapError;
use super::{Cap, CapCache, Facing, Solid};
use crate::mesh::{Mesh, Point3};
use crate::profile::{ChordTolerance, Point2};

/// The flattened ring and where its vertices start in the mesh.
struct FlatRing {
    points: Vec<Point2>,
    first: usize,
}

impl Solid {
    /// The mesh of the solid: every curve within `tolerance`, vertices shared by index between all faces of a ring.
    ///
    /// # Errors
    /// [`CapError`] if contours of one cap cross or touch.
    pub fn mesh(&self, tolerance: ChordTolerance) -> Result<Mesh, CapError> {
        // A prism's lower and upper cap are one triangulation: even a single solid asks for most caps twice.
        self.mesh_with(tolerance, &CapCache::new(usize::MAX))
    }

    /// The same mesh, with the triangulations that other solids have left in `caps`.
    ///
    /// # Errors
    /// [`CapError`] if contours of one cap cross or touch.
    pub fn mesh_with(&self, tolerance: ChordTolerance, caps: &CapCache) -> Result<Mesh, CapError> {
        let chords = self.matched_counts(|contour| contour.chords(tolerance));
        let mut positions = Vec::new();
        let rings: Vec<_> = self
            .rings
            .iter()
            .zip(&chords)
            .map(|(ring, chords)| {
                let points = ring.contour.flattened(chords);
                let first = positions.len();
                positions.extend(points.iter().map(|p| Point3::new(p.x, p.y, ring.z_mm)));
                FlatRing { points, first }
            })
            .collect();
        let mut triangles = Vec::new();
        for wall in &self.walls {
            strip(&rings[wall.lower.0], &rings[wall.upper.0], &positions, &mut triangles);
        }
        for cap in &self.caps {
            let loops: Vec<&[Point2]> = cap.rings.iter().map(|r| rings[r.0].points.as_slice()).collect();
            let cut = caps.triangles(&loops, self.rings[cap.rings[0].0].z_mm)?;
            close(cap, &cut, &rings, &mut triangles);
        }
        Ok(Mesh::new(positions, triangles))
    }
}

/// Adds the triangles of a cap, `cut` into corners of its rings one after the other.
fn close(cap: &Cap, cut: &[[u32; 3]], rings: &[FlatRing], triangles: &mut Vec<[u32; 3]>) {
    let vertices: Vec<u32> = cap
        .rings
        .iter()
        .flat_map(|r| {
            let ring = &rings[r.0];
            (ring.first..ring.first + ring.points.len()).map(index)
        })
        .collect();
    triangles.extend(cut.iter().map(|corners| {
        let [a, b, c] = corners.map(|i| vertices[i as usize]);
        match cap.facing {
            Facing::Up => [a, b, c],
            Facing::Down => [a, c, b],
        }
    }));
}

/// The wall between two rings of equal vertex count, each quad cut along its shorter diagonal.
fn strip(lower: &FlatRing, upper: &FlatRing, positions: &[Point3], triangles: &mut Vec<[u32; 3]>) {
    let n = lower.points.len();
    for i in 0..n {
        let j = (i + 1) % n;
        let (a, b) = (lower.first + i, lower.first + j);
        let (c, d) = (upper.first + j, upper.first + i);
        let rising = (positions[c] - positions[a]).norm_squared();
        let falling = (positions[d] - positions[b]).norm_squared();
        let quad = [a, b, c, d].map(index);
        let [a, b, c, d] = quad;
        // A tie (every vertical wall) goes to the rising diagonal, whatever the rounding.
        if rising <= falling * (1.0 + 1e-9) {
            triangles.extend([[a, b, c], [a, c, d]]);
        } else {
            triangles.extend([[a, b, d], [b, c, d]]);
        }
    }
}

/// A vertex number as STL and the mesh hold it; a mesh of four thousand million vertices does not fit in memory.
#[allow(clippy::cast_possible_truncation)]
fn index(i: usize) -> u32 {
    i as u32
}
