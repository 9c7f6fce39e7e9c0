//! Solids made of contours at heights: walls between two rings, and flat caps with holes.
//!
//! The same [`Solid`] yields the closed-form volume, the mesh (watertight by construction: walls and caps share
//! their ring's vertices by index) and, with the feature `brep`, the exact boundary representation.

#[cfg(feature = "truck")]
mod brep;
mod cap;
mod cap_cache;
mod content;
mod tessellate;
mod thin;
mod volume;

use crate::profile::{Contour, OffsetError};

#[cfg(feature = "truck")]
pub use brep::{BrepError, BrepMesh};
pub use cap::CapError;
pub use cap_cache::CapCache;
pub use thin::ThinPlace;

/// A ring: one contour at one height. Walls and caps that name it share its vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RingId(usize);

/// Which way a cap faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facing {
    /// Material lies below it.
    Up,
    /// Material lies above it.
    Down,
}

#[derive(Clone, Debug, PartialEq)]
struct Ring {
    contour: Contour,
    z_mm: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Wall {
    lower: RingId,
    upper: RingId,
}

#[derive(Clone, Debug, PartialEq)]
struct Cap {
    facing: Facing,
    /// The outline first, then its holes.
    rings: Vec<RingId>,
}

/// A solid between contours at heights. Every ring must end up in two faces: a wall and a cap, or two walls.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    rings: Vec<Ring>,
    walls: Vec<Wall>,
    caps: Vec<Cap>,
}

impl Solid {
    /// A solid without faces.
    pub fn new() -> Self {
        Self::default()
    }

    /// Puts `contour` at height `z_mm`.
    pub fn ring(&mut self, contour: Contour, z_mm: f64) -> RingId {
        self.rings.push(Ring { contour, z_mm });
        RingId(self.rings.len() - 1)
    }

    /// A wall from `lower` up to `upper`. Both contours have the same edges in the same order; a hole's contour
    /// runs clockwise, so that material stays to its left.
    pub fn wall(&mut self, lower: RingId, upper: RingId) {
        self.walls.push(Wall { lower, upper });
    }

    /// A flat cap inside `outline` without `holes`, all at one height.
    pub fn cap(&mut self, facing: Facing, outline: RingId, holes: &[RingId]) {
        let rings = std::iter::once(outline).chain(holes.iter().copied()).collect();
        self.caps.push(Cap { facing, rings });
    }

    /// A vertical wall over `contour` from `from_mm` to `to_mm`; returns its lower and upper ring.
    pub fn extrude(&mut self, contour: &Contour, from_mm: f64, to_mm: f64) -> (RingId, RingId) {
        let (lower, upper) = (self.ring(contour.clone(), from_mm), self.ring(contour.clone(), to_mm));
        self.wall(lower, upper);
        (lower, upper)
    }

    /// Like [`Self::extrude`], with a 45 degree chamfer of `chamfer_mm` into the material at the lower edge.
    ///
    /// # Errors
    /// [`OffsetError`] if the chamfer swallows an edge of the contour.
    pub fn extrude_chamfered(
        &mut self,
        contour: &Contour,
        from_mm: f64,
        to_mm: f64,
        chamfer_mm: f64,
    ) -> Result<(RingId, RingId), OffsetError> {
        if chamfer_mm <= 0.0 {
            return Ok(self.extrude(contour, from_mm, to_mm));
        }
        let foot = self.ring(contour.offset(chamfer_mm)?, from_mm);
        let (knee, upper) = self.extrude(contour, from_mm + chamfer_mm, to_mm);
        self.wall(foot, knee);
        Ok((foot, upper))
    }

    /// A plain prism over `outline` with `holes` (clockwise), from `from_mm` to `to_mm`, chamfered at the bottom;
    /// both caps included.
    ///
    /// # Errors
    /// [`OffsetError`] if the chamfer swallows an edge.
    pub fn prism(
        outline: &Contour,
        holes: &[Contour],
        from_mm: f64,
        to_mm: f64,
        chamfer_mm: f64,
    ) -> Result<Self, OffsetError> {
        let mut solid = Self::new();
        let (bottom, top) = solid.extrude_chamfered(outline, from_mm, to_mm, chamfer_mm)?;
        let (bottoms, tops) = solid.through_holes(holes, from_mm, to_mm, chamfer_mm)?;
        solid.cap(Facing::Down, bottom, &bottoms);
        solid.cap(Facing::Up, top, &tops);
        Ok(solid)
    }

    /// Walls of holes that go right through; returns their lower and upper rings.
    ///
    /// # Errors
    /// [`OffsetError`] if the chamfer swallows an edge.
    pub fn through_holes(
        &mut self,
        holes: &[Contour],
        from_mm: f64,
        to_mm: f64,
        chamfer_mm: f64,
    ) -> Result<(Vec<RingId>, Vec<RingId>), OffsetError> {
        let walls: Result<Vec<_>, _> =
            holes.iter().map(|hole| self.extrude_chamfered(hole, from_mm, to_mm, chamfer_mm)).collect();
        Ok(walls?.into_iter().unzip())
    }

    /// A pocket with a flat floor, sunk from `top_mm` to `floor_mm`: `outline` runs clockwise, islands inside it
    /// counter-clockwise and as high as the top. Returns the ring at its top, a hole in the cap there.
    pub fn pocket(&mut self, outline: &Contour, islands: &[Contour], floor_mm: f64, top_mm: f64) -> RingId {
        let (floor, top) = self.extrude(outline, floor_mm, top_mm);
        let mut feet = Vec::new();
        for island in islands {
            let (foot, head) = self.extrude(island, floor_mm, top_mm);
            feet.push(foot);
            self.cap(Facing::Up, head, &[]);
        }
        self.cap(Facing::Up, floor, &feet);
        top
    }

    /// A recess with a flat ceiling, sunk upward from `bottom_mm` to `ceiling_mm`: `outline` runs clockwise, islands inside
    /// it counter-clockwise and as deep as the bottom. Returns the ring at its mouth, a hole in the cap there.
    pub fn recess(
        &mut self,
        outline: &Contour,
        islands: &[Contour],
        bottom_mm: f64,
        ceiling_mm: f64,
    ) -> RingId {
        let (mouth, ceiling) = self.extrude(outline, bottom_mm, ceiling_mm);
        let mut roots = Vec::new();
        for island in islands {
            let (foot, root) = self.extrude(island, bottom_mm, ceiling_mm);
            roots.push(root);
            self.cap(Facing::Down, foot, &[]);
        }
        self.cap(Facing::Down, ceiling, &roots);
        mouth
    }

    /// A boss with a flat top, raised from `foot_mm` to `top_mm` over `outline` (counter-clockwise). Returns the ring
    /// at its foot, a hole in the cap that it stands on.
    pub fn boss(&mut self, outline: &Contour, foot_mm: f64, top_mm: f64) -> RingId {
        let (foot, top) = self.extrude(outline, foot_mm, top_mm);
        self.cap(Facing::Up, top, &[]);
        foot
    }

    /// Lower and upper corner of the exact bounding box in mm; `None` without rings.
    pub fn bounds(&self) -> Option<(nalgebra::Point3<f64>, nalgebra::Point3<f64>)> {
        self.rings
            .iter()
            .map(|ring| {
                let (low, high) = ring.contour.bounds();
                (
                    nalgebra::Point3::new(low.x, low.y, ring.z_mm),
                    nalgebra::Point3::new(high.x, high.y, ring.z_mm),
                )
            })
            .reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)))
    }

    /// The contours that bound the material at height `z_mm`, outlines counter-clockwise and holes clockwise;
    /// slanted walls give the contour midway between their rings ([`Contour::midway`]).
    pub fn section(&self, z_mm: f64) -> Vec<Contour> {
        self.walls
            .iter()
            .map(|w| (&self.rings[w.lower.0], &self.rings[w.upper.0]))
            .filter(|(lower, upper)| lower.z_mm < z_mm && z_mm < upper.z_mm)
            .map(|(lower, upper)| {
                let upright = lower.contour == upper.contour;
                if upright { lower.contour.clone() } else { lower.contour.midway(&upper.contour) }
            })
            .collect()
    }

    /// Pieces per edge of each ring, `numbers` or more; rings that walls join get the same ones, the larger ones, so
    /// that the wall between them is a strip.
    fn matched_counts(&self, mut numbers: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
        loop {
            let mut settled = true;
            for Wall { lower: RingId(a), upper: RingId(b) } in &self.walls {
                if numbers[*a] != numbers[*b] {
                    let most = larger(&numbers[*a], &numbers[*b]);
                    numbers[*a].clone_from(&most);
                    numbers[*b] = most;
                    settled = false;
                }
            }
            if settled {
                return numbers;
            }
        }
    }

    /// Contour and height in mm of every ring, in the order of their numbers.
    pub fn rings(&self) -> impl Iterator<Item = (&Contour, f64)> {
        self.rings.iter().map(|ring| (&ring.contour, ring.z_mm))
    }

    /// Numbers of the lower and upper ring of every wall.
    pub fn walls(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.walls.iter().map(|wall| (wall.lower.0, wall.upper.0))
    }

    /// Which way every cap faces, and the numbers of its rings, the outline first.
    pub fn caps(&self) -> impl Iterator<Item = (Facing, Vec<usize>)> + '_ {
        self.caps.iter().map(|cap| (cap.facing, cap.rings.iter().map(|ring| ring.0).collect()))
    }

    /// Every height at which a ring lies, ascending, without repeats.
    pub fn heights_mm(&self) -> Vec<f64> {
        let mut heights: Vec<f64> = self.rings.iter().map(|r| r.z_mm).collect();
        heights.sort_by(f64::total_cmp);
        heights.dedup();
        heights
    }
}

/// The larger of each two numbers.
fn larger(a: &[usize], b: &[usize]) -> Vec<usize> {
    a.iter().zip(b).map(|(x, y)| *x.max(y)).collect()
}
