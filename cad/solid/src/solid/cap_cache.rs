//! A cache of triangulated caps: those of a solid are often equal, and so are those of a family of
//! solids that differ in height or in a label only.

use std::collections::HashMap;
use std::hash::{Hash, Hasher};
use std::sync::{Arc, Mutex, PoisonError};

use super::cap::{CapError, Triangles, triangulate};
use crate::profile::Point2;

/// Numbers of a loop that are hashed: loops with the same beginning are compared in full.
const HASHED_NUMBERS: usize = 8;

/// Triangulations by the exact corners of the rings of a cap, independent of its height.
///
/// ```
/// use pinswitch_solid::profile::{ChordTolerance, Contour, Point2};
/// use pinswitch_solid::solid::{CapCache, Solid};
///
/// let caps = CapCache::new(10_000);
/// let tolerance = ChordTolerance::new(0.01)?;
/// let disc = Contour::circle(Point2::origin(), 5.0);
/// for height_mm in [1.0, 2.0, 3.0] {
///     let solid = Solid::prism(&disc, &[], 0.0, height_mm, 0.0)?;
///     assert_eq!(solid.mesh_with(tolerance, &caps)?, solid.mesh(tolerance)?);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct CapCache {
    /// Most corners of each generation.
    capacity: usize,
    generations: Mutex<Generations>,
}

/// Entries by their last use: the older generation is dropped when the newer one is full.
#[derive(Debug, Default)]
struct Generations {
    newer: HashMap<Loops, Arc<Triangles>>,
    older: HashMap<Loops, Arc<Triangles>>,
    /// Corners in `newer`.
    corners: usize,
}

/// The rings of a cap, with coordinates as bits: equal keys have exactly the same triangulation.
#[derive(Debug, PartialEq, Eq)]
struct Loops {
    /// Number of corners of each ring.
    lengths: Vec<usize>,
    /// x and y of every corner.
    coordinates: Vec<u64>,
}

impl Hash for Loops {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.lengths.hash(state);
        let mut rest = self.coordinates.as_slice();
        for length in &self.lengths {
            let (ring, after) = rest.split_at(2 * length);
            ring.iter().take(HASHED_NUMBERS).for_each(|number| number.hash(state));
            rest = after;
        }
    }
}

impl Loops {
    fn new(loops: &[&[Point2]]) -> Self {
        Self {
            lengths: loops.iter().map(|points| points.len()).collect(),
            coordinates: loops
                .iter()
                .copied()
                .flatten()
                .flat_map(|p| [p.x.to_bits(), p.y.to_bits()])
                .collect(),
        }
    }
}

impl CapCache {
    /// Creates a cache of up to `corners` corners, at about 50 bytes each. The least recently used
    /// caps are dropped.
    pub fn new(corners: usize) -> Self {
        Self { capacity: corners / 2, generations: Mutex::default() }
    }

    /// Returns the triangulation of `loops`, cached or new. Threads that request the same one at
    /// the same time each compute it.
    pub(super) fn triangles(&self, loops: &[&[Point2]], z_mm: f64) -> Result<Arc<Triangles>, CapError> {
        let key = Loops::new(loops);
        if let Some(known) = self.locked(|generations| generations.get(&key)) {
            return Ok(known);
        }
        let made = Arc::new(triangulate(loops, z_mm)?);
        self.locked(|generations| generations.insert(key, made.clone(), self.capacity));
        Ok(made)
    }

    /// Corners in the newer generation.
    #[cfg(test)]
    pub(super) fn corners(&self) -> usize {
        self.locked(|generations| generations.corners)
    }

    fn locked<T>(&self, work: impl FnOnce(&mut Generations) -> T) -> T {
        // No step leaves the maps inconsistent, so that a poisoned lock is safe.
        work(&mut self.generations.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Generations {
    fn get(&mut self, key: &Loops) -> Option<Arc<Triangles>> {
        if let Some(known) = self.newer.get(key) {
            return Some(known.clone());
        }
        let (key, known) = self.older.remove_entry(key)?;
        self.corners += key.coordinates.len() / 2;
        self.newer.insert(key, known.clone());
        Some(known)
    }

    fn insert(&mut self, key: Loops, made: Arc<Triangles>, capacity: usize) {
        let corners = key.coordinates.len() / 2;
        if self.corners + corners > capacity {
            self.older = std::mem::take(&mut self.newer);
            self.corners = 0;
        }
        self.corners += corners;
        self.newer.insert(key, made);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side: f64) -> Vec<Point2> {
        [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| Point2::new(x, y)).to_vec()
    }

    #[test]
    fn the_least_recently_used_cap_is_dropped() {
        let cache = CapCache::new(16);
        let triangles = |side: f64| cache.triangles(&[&square(side)], 0.0).unwrap();
        let (first, second) = (triangles(1.0), triangles(2.0));
        assert!(Arc::ptr_eq(&first, &triangles(1.0)) && Arc::ptr_eq(&second, &triangles(2.0)));
        // Two squares fill a generation: the second pair moves the first to the older one, a third
        // pair drops it.
        for side in 3..=6 {
            triangles(f64::from(side));
        }
        assert!(!Arc::ptr_eq(&first, &triangles(1.0)));
        assert_eq!(first, triangles(1.0));
    }

    #[test]
    fn equal_hashes_do_not_collide() {
        let cache = CapCache::new(1000);
        let octagon = |last: f64| -> Vec<Point2> {
            let around = (0..8).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_4);
            around
                .map(|a| Point2::new(libm::cos(a), libm::sin(a)) * if a > 5.0 { last } else { 1.0 })
                .collect()
        };
        let (round, cut) = (octagon(1.0), octagon(0.1));
        cache.triangles(&[&round], 0.0).unwrap();
        let cached = cache.triangles(&[&cut], 0.0).unwrap();
        assert_eq!(*cached, triangulate(&[&cut], 0.0).unwrap());
    }
}
