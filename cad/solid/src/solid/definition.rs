//! Rings, walls and caps: the definition of a solid, and the operations that build one.

use super::frame::Frame;
use crate::mesh::Point3;
use crate::profile::{Contour, OffsetError};

/// A ring: a contour at a height. Walls and caps of one ring share its vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RingId(pub(super) usize);

/// The direction that a cap faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facing {
    /// Material is below it.
    Up,
    /// Material is above it.
    Down,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ring {
    pub(super) contour: Contour,
    pub(super) z_mm: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wall {
    pub(super) lower: RingId,
    pub(super) upper: RingId,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cap {
    pub(super) facing: Facing,
    /// The outline first, then its holes.
    pub(super) rings: Vec<RingId>,
}

/// A solid between contours at heights. Every ring must belong to two faces: a wall and a cap, or
/// two walls.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    pub(super) rings: Vec<Ring>,
    pub(super) walls: Vec<Wall>,
    pub(super) caps: Vec<Cap>,
    pub(super) frames: Vec<Frame>,
}

impl Solid {
    /// Creates a solid without faces.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds `contour` at height `z_mm`.
    pub fn ring(&mut self, contour: Contour, z_mm: f64) -> RingId {
        self.rings.push(Ring { contour, z_mm });
        RingId(self.rings.len() - 1)
    }

    /// Adds a wall from `lower` up to `upper`. Both contours have the same edges in the same order;
    /// that of a hole runs clockwise, with material to its left.
    pub fn wall(&mut self, lower: RingId, upper: RingId) {
        self.walls.push(Wall { lower, upper });
    }

    /// Adds a flat cap inside `outline` without `holes`, all at one height.
    pub fn cap(&mut self, facing: Facing, outline: RingId, holes: &[RingId]) {
        let rings = std::iter::once(outline).chain(holes.iter().copied()).collect();
        self.caps.push(Cap { facing, rings });
    }

    /// Adds a vertical wall over `contour` from `from_mm` to `to_mm`; returns its lower and upper
    /// ring.
    pub fn extrude(&mut self, contour: &Contour, from_mm: f64, to_mm: f64) -> (RingId, RingId) {
        let (lower, upper) = (self.ring(contour.clone(), from_mm), self.ring(contour.clone(), to_mm));
        self.wall(lower, upper);
        (lower, upper)
    }

    /// As [`Self::extrude`], with a 45 degree chamfer of `chamfer_mm` into the material at the
    /// lower edge.
    ///
    /// # Errors
    /// [`OffsetError`] if the chamfer removes an edge of the contour.
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

    /// Creates a prism over `outline` with `holes` (clockwise), from `from_mm` to `to_mm`, with a
    /// chamfer at the bottom.
    ///
    /// # Errors
    /// [`OffsetError`] if the chamfer removes an edge.
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

    /// Adds the walls of through holes; returns their lower and upper rings.
    ///
    /// # Errors
    /// [`OffsetError`] if the chamfer removes an edge.
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

    /// Adds a pocket with a flat floor from `top_mm` down to `floor_mm`. `outline` runs clockwise,
    /// islands inside it run counter-clockwise and end at the top. Returns the ring at its top,
    /// which is a hole in the cap there.
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

    /// Adds a recess with a flat ceiling from `bottom_mm` up to `ceiling_mm`. `outline` runs
    /// clockwise, islands inside it run counter-clockwise and end at the bottom. Returns the ring
    /// at its mouth, which is a hole in the cap there.
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

    /// Adds a boss with a flat top from `foot_mm` to `top_mm` over `outline` (counter-clockwise).
    /// Returns the ring at its foot, which is a hole in the cap below.
    pub fn boss(&mut self, outline: &Contour, foot_mm: f64, top_mm: f64) -> RingId {
        let (foot, top) = self.extrude(outline, foot_mm, top_mm);
        self.cap(Facing::Up, top, &[]);
        foot
    }

    /// Returns the solid rotated about the z axis by `angle_rad`, counter-clockwise.
    #[must_use]
    pub fn rotated(&self, angle_rad: f64) -> Self {
        let turned = |ring: &Ring| Ring { contour: ring.contour.rotated(angle_rad), ..*ring };
        let turned_frame =
            |frame: &Frame| Frame { polygon: frame.polygon.rotated(angle_rad), holes: frame.holes.clone() };
        Self {
            rings: self.rings.iter().map(turned).collect(),
            frames: self.frames.iter().map(turned_frame).collect(),
            ..self.clone()
        }
    }

    /// Returns the lower and upper corner of the exact bounding box in mm; `None` without rings.
    pub fn bounds(&self) -> Option<(Point3, Point3)> {
        self.rings
            .iter()
            .map(|ring| {
                let (low, high) = ring.contour.bounds();
                (Point3::new(low.x, low.y, ring.z_mm), Point3::new(high.x, high.y, ring.z_mm))
            })
            .reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)))
    }

    /// Returns the contours that bound the material at height `z_mm`, outlines counter-clockwise
    /// and holes clockwise. For a slanted wall it is the contour midway between its rings
    /// ([`Contour::midway`]).
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

    /// Raises the numbers of pieces per edge of each ring, so that both rings of a wall have equal
    /// ones and the wall is a strip.
    pub(crate) fn matched_counts(&self, mut numbers: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
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

    /// Contour and height in mm of every ring, by index.
    pub fn rings(&self) -> impl Iterator<Item = (&Contour, f64)> {
        self.rings.iter().map(|ring| (&ring.contour, ring.z_mm))
    }

    /// Indices of the lower and upper ring of every wall.
    pub fn walls(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.walls.iter().map(|wall| (wall.lower.0, wall.upper.0))
    }

    /// Direction of every cap and indices of its rings, the outline first.
    pub fn caps(&self) -> impl Iterator<Item = (Facing, Vec<usize>)> + '_ {
        self.caps.iter().map(|cap| (cap.facing, cap.rings.iter().map(|ring| ring.0).collect()))
    }

    /// Heights of the rings in mm, ascending, without repeats.
    pub fn heights_mm(&self) -> Vec<f64> {
        let mut heights: Vec<f64> = self.rings.iter().map(|r| r.z_mm).collect();
        heights.sort_by(f64::total_cmp);
        heights.dedup();
        heights
    }
}

/// The larger of each two numbers.
pub(super) fn larger(a: &[usize], b: &[usize]) -> Vec<usize> {
    a.iter().zip(b).map(|(x, y)| *x.max(y)).collect()
}
