//! Tessellation of a solid within a chord tolerance.

use super::cap::CapError;
use super::cap_cache::CapCache;
use super::definition::{Cap, Facing, RingId, Solid, Wall, larger};
use super::frame::{Frame, Loop, Region, area_between_mm2, is_close};
use crate::mesh::{Mesh, Point3};
use crate::profile::{ChordTolerance, Point2};

/// Relative difference up to which areas of a cap are equal.
const SAME_AREA: f64 = 1e-9;

/// A flattened ring, and the index of its first vertex in the mesh.
struct FlatRing {
    points: Vec<Point2>,
    first: usize,
}

impl FlatRing {
    fn as_loop(&self) -> Loop<'_> {
        (&self.points, self.first)
    }
}

impl Solid {
    /// Returns the mesh of the solid, with every curve within `tolerance`. All faces of a ring
    /// share its vertices by index.
    ///
    /// # Errors
    /// [`CapError`] if contours of one cap cross or touch.
    pub fn mesh(&self, tolerance: ChordTolerance) -> Result<Mesh, CapError> {
        // The caps of a prism have the same triangulation: even a single solid uses most of them
        // twice.
        self.mesh_with(tolerance, &CapCache::new(usize::MAX))
    }

    /// As [`Self::mesh`], with triangulations of other solids in `caps`.
    ///
    /// # Errors
    /// [`CapError`] if contours of one cap cross or touch.
    pub fn mesh_with(&self, tolerance: ChordTolerance, caps: &CapCache) -> Result<Mesh, CapError> {
        let chords = self.matched_counts(self.least_pieces(tolerance));
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
            let regions = match self.framed(cap, &rings, &mut positions, caps) {
                Some(regions) => regions,
                None => vec![self.whole(cap, &rings, caps)?],
            };
            regions.iter().for_each(|region| close(cap.facing, region, &mut triangles));
        }
        Ok(Mesh::new(positions, triangles))
    }

    /// Triangulates a cap between all its rings.
    fn whole(&self, cap: &Cap, rings: &[FlatRing], caps: &CapCache) -> Result<Region, CapError> {
        let loops: Vec<Loop<'_>> = cap.rings.iter().map(|ring| rings[ring.0].as_loop()).collect();
        Region::between(&loops, self.rings[cap.rings[0].0].z_mm, caps)
    }

    /// Triangulates a cap in its frames and outside of them, and adds the corners of the frames to `positions`. `None` without
    /// frames, or if one is close to a contour or another frame, or around others than its holes.
    fn framed(
        &self,
        cap: &Cap,
        rings: &[FlatRing],
        positions: &mut Vec<Point3>,
        caps: &CapCache,
    ) -> Option<Vec<Region>> {
        let frames: Vec<&Frame> = self.frames_of(cap).collect();
        if frames.is_empty() {
            return None;
        }
        let z_mm = self.rings[cap.rings[0].0].z_mm;
        let mut next = positions.len();
        let is_framed = |ring: &RingId| frames.iter().any(|frame| frame.holes.contains(ring));
        let outer = cap.rings.iter().filter(|ring| !is_framed(ring));
        let mut outside: Vec<Loop<'_>> = outer.map(|ring| rings[ring.0].as_loop()).collect();
        let polygons: Vec<&[Point2]> = frames.iter().map(|frame| frame.polygon.corners()).collect();
        let contours: Vec<&[Point2]> = cap.rings.iter().map(|ring| rings[ring.0].points.as_slice()).collect();
        let is_crowded = |(i, polygon): (usize, &&[Point2])| {
            polygons[i + 1..].iter().chain(&contours).any(|other| is_close(polygon, other))
        };
        if polygons.iter().enumerate().any(is_crowded) {
            return None;
        }
        let mut regions = Vec::with_capacity(frames.len() + 1);
        for frame in frames.iter().copied() {
            let corners = frame.polygon.corners();
            let holes = frame.holes.iter().map(|hole| rings[hole.0].as_loop());
            let loops: Vec<Loop<'_>> = std::iter::once((corners, next)).chain(holes).collect();
            regions.push(Region::between(&loops, z_mm, caps).ok()?);
            outside.push((corners, next));
            next += corners.len();
        }
        regions.push(Region::between(&outside, z_mm, caps).ok()?);
        let count = positions.len();
        let corners = frames.iter().flat_map(|frame| frame.polygon.corners());
        positions.extend(corners.map(|p| Point3::new(p.x, p.y, z_mm)));
        let area_mm2: f64 = regions.iter().map(|region| region.area_mm2(positions)).sum();
        let exact_mm2 = area_between_mm2(cap.rings.iter().map(|ring| rings[ring.0].as_loop()));
        if (area_mm2 - exact_mm2).abs() > SAME_AREA * exact_mm2 {
            positions.truncate(count);
            return None;
        }
        Some(regions)
    }
}

impl Solid {
    /// Least number of pieces per edge of each ring that keeps its curves, and the walls above it,
    /// within `tolerance`.
    fn least_pieces(&self, tolerance: ChordTolerance) -> Vec<Vec<usize>> {
        let mut pieces: Vec<_> = self.rings.iter().map(|ring| ring.contour.chords(tolerance)).collect();
        for Wall { lower: RingId(a), upper: RingId(b) } in &self.walls {
            let of_wall = self.rings[*a].contour.wall_pieces(&self.rings[*b].contour, tolerance);
            pieces[*a] = larger(&pieces[*a], &of_wall);
        }
        pieces
    }
}

/// Appends the triangles of a region of a cap.
fn close(facing: Facing, region: &Region, triangles: &mut Vec<[u32; 3]>) {
    triangles.extend(region.triangles.iter().map(|corners| {
        let [a, b, c] = corners.map(|i| index(region.vertices[i as usize]));
        match facing {
            Facing::Up => [a, b, c],
            Facing::Down => [a, c, b],
        }
    }));
}

/// Appends the wall between two rings of equal vertex count, each quadrilateral cut along its
/// shorter diagonal.
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
        // Equal diagonals (every vertical wall) give the rising one, regardless of rounding.
        if rising <= falling * (1.0 + 1e-9) {
            triangles.extend([[a, b, c], [a, c, d]]);
        } else {
            triangles.extend([[a, b, d], [b, c, d]]);
        }
    }
}

/// The index of a vertex. A mesh of 2³² vertices does not fit in memory.
#[allow(clippy::cast_possible_truncation)]
fn index(i: usize) -> u32 {
    i as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{Contour, Pen, polar};

    /// A ring sector of any angle.
    fn sector(half_rad: f64) -> Contour {
        let corner = |radius: f64, side: f64| polar(radius, side * half_rad);
        Pen::at(corner(20.0, 1.0))
            .line_to(corner(22.0, 1.0))
            .arc_to(Point2::origin(), corner(22.0, -1.0), true)
            .line_to(corner(20.0, -1.0))
            .arc_to(Point2::origin(), corner(20.0, 1.0), false)
            .close()
    }

    /// Least distance between the diagonals of a quadrilateral; the mean distance of its triangles
    /// from the ruled surface is a sixth of it.
    fn diagonals_apart_mm([a, b, c, d]: [Point3; 4]) -> f64 {
        let across = (c - a).cross(&(d - b));
        (b - a).dot(&across).abs() / across.norm()
    }

    #[test]
    fn twisted_walls_are_within_tolerance() {
        let mut solid = Solid::new();
        let (lower, upper) = (solid.ring(sector(0.78), 0.0), solid.ring(sector(0.84), 10.0));
        solid.wall(lower, upper);
        for tolerance_mm in [0.1, 0.01, 0.001, 1e-4] {
            let pieces = solid.matched_counts(solid.least_pieces(ChordTolerance::new(tolerance_mm).unwrap()));
            let [below, above]: [Vec<Point3>; 2] = [(0, 0.0), (1, 10.0)].map(|(i, z_mm)| {
                let points = solid.rings[i].contour.flattened(&pieces[i]);
                points.iter().map(|p| Point3::new(p.x, p.y, z_mm)).collect()
            });
            let n = below.len();
            let quad = |i: usize| [below[i], below[(i + 1) % n], above[(i + 1) % n], above[i]];
            let worst = (0..n).map(|i| diagonals_apart_mm(quad(i))).fold(0.0, f64::max);
            assert!(worst / 6.0 <= tolerance_mm * 1.0001, "{worst} at {tolerance_mm}");
            // There are not many more pieces than necessary.
            assert!(tolerance_mm > 0.001 || worst / 6.0 > tolerance_mm / 2.0, "{worst} at {tolerance_mm}");
        }
    }
}
