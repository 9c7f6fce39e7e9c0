//! A bounding volume hierarchy of facets, with nodes of eight boxes that are compared at once.
//!
//! Facets are sorted along a Morton curve through the centres of their boxes. Eight neighbours on
//! the curve form a leaf, eight leaves a node of the next level, and so on. The tree is implicit:
//! the children of node `n` are the nodes `8 n .. 8 n + 8` of the level below. Boxes are in single
//! precision, rounded outward; the exact box of a facet comes from the mesh ([`corner_box`]).

use super::plane::Plane;
use crate::mesh::{Mesh, Point3, Vector3};
use crate::parallel;

/// Boxes per node.
const WIDTH: usize = 8;
/// Number of facets around a vertex from which it is a hub: their boxes all meet, so that pairs of
/// them are found by angle ([`super::hub`]).
const HUB_FACETS: u32 = 64;
/// The hub of a facet or a node without one.
const NO_HUB: u32 = u32::MAX;

/// An axis-parallel box in single precision, rounded outward.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    low: [f32; 3],
    high: [f32; 3],
}

impl Bounds {
    const EMPTY: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

    /// The smallest such box that contains the box from `low` to `high`.
    pub(super) fn around(low: Point3, high: Point3) -> Self {
        Self { low: low.coords.map(rounded_down).into(), high: high.coords.map(rounded_up).into() }
    }

    pub(super) fn joined(self, other: Self) -> Self {
        let mut both = self;
        for axis in 0..3 {
            both.low[axis] = both.low[axis].min(other.low[axis]);
            both.high[axis] = both.high[axis].max(other.high[axis]);
        }
        both
    }
}

#[allow(clippy::cast_possible_truncation)]
fn rounded_down(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

#[allow(clippy::cast_possible_truncation)]
fn rounded_up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}

/// Eight boxes in structure-of-arrays layout. Unused lanes are NaN, which overlap nothing.
#[derive(Clone, Copy)]
struct Node {
    low: [[f32; WIDTH]; 3],
    high: [[f32; WIDTH]; 3],
}

impl Node {
    fn of(boxes: impl Iterator<Item = Bounds>) -> Self {
        let mut node = Self { low: [[f32::NAN; WIDTH]; 3], high: [[f32::NAN; WIDTH]; 3] };
        for (lane, bounds) in boxes.take(WIDTH).enumerate() {
            for axis in 0..3 {
                node.low[axis][lane] = bounds.low[axis];
                node.high[axis][lane] = bounds.high[axis];
            }
        }
        node
    }

    fn lane(&self, lane: usize) -> Bounds {
        Bounds { low: self.low.map(|column| column[lane]), high: self.high.map(|column| column[lane]) }
    }

    /// The box that contains all lanes; `min` and `max` ignore NaN.
    fn hull(&self) -> Bounds {
        (0..WIDTH).map(|lane| self.lane(lane)).fold(Bounds::EMPTY, Bounds::joined)
    }

    /// Lanes whose boxes touch or overlap `bounds`.
    fn lanes_overlapping(&self, bounds: &Bounds) -> Lanes {
        let mut overlaps = [1_u32; WIDTH];
        for axis in 0..3 {
            let (low, high) = (bounds.low[axis], bounds.high[axis]);
            for (lane, overlaps) in overlaps.iter_mut().enumerate() {
                // `&` instead of `&&`, on integers as wide as a coordinate: without branches, one
                // instruction compares four lanes.
                *overlaps &=
                    u32::from(self.low[axis][lane] <= high) & u32::from(self.high[axis][lane] >= low);
            }
        }
        Lanes((0..WIDTH).fold(0, |lanes, lane| lanes | u8::from(overlaps[lane] != 0) << lane))
    }
}

/// A set of lanes of a node, as bits.
#[derive(Clone, Copy)]
struct Lanes(u8);

impl Lanes {
    fn len(self) -> u32 {
        self.0.count_ones()
    }

    /// The lanes after `lane`.
    fn after(self, lane: usize) -> Self {
        Self((u16::from(self.0) >> (lane + 1) << (lane + 1)) as u8)
    }
}

impl Iterator for Lanes {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0.wrapping_sub(1);
        (lane < WIDTH).then_some(lane)
    }
}

/// The bounding volume hierarchy of the facets of a mesh. A slot is the position of a facet on the
/// curve.
pub(super) struct Bvh {
    /// Index of the facet in each slot.
    facets: Vec<u32>,
    /// Plane of the facet in each slot.
    planes: Vec<Plane>,
    /// Nodes by level; those of the first contain the boxes of facets.
    levels: Vec<Vec<Node>>,
    /// The hub of the facet in each slot; empty without hubs.
    hubs: Vec<u32>,
    /// The hub that all facets below a node share, by level; empty without hubs.
    node_hubs: Vec<Vec<u32>>,
    /// The corners of each leaf; empty without hubs.
    clouds: Vec<Cloud>,
}

/// The corners of the facets of a leaf. Facets around a hub are long and thin, so that their boxes
/// contain much that is far from them.
struct Cloud {
    points: Vec<Point3>,
    /// Directions along which other clouds may be apart: the normal of a facet, and the direction
    /// in its plane across its longest edge.
    slabs: [Slab; 2],
}

/// The least and greatest place of the points of a cloud along a direction.
struct Slab {
    along: Vector3,
    low: f64,
    high: f64,
}

impl Slab {
    fn of(along: Vector3, points: &[Point3]) -> Self {
        let (low, high) = places(along, points);
        Self { along, low, high }
    }

    /// Whether other points are certainly apart along the direction.
    fn is_apart(&self, points: &[Point3]) -> bool {
        let (low, high) = places(self.along, points);
        let size = |p: &Point3| p.coords.abs().sum();
        let reach = points.iter().map(size).fold(self.low.abs() + self.high.abs(), f64::max);
        let rounding = CLOUD_ROUNDING * reach;
        low - rounding > self.high || high + rounding < self.low
    }
}

/// The least and greatest place of points along a direction.
fn places(along: Vector3, points: &[Point3]) -> (f64, f64) {
    let places = points.iter().map(|p| along.dot(&p.coords));
    places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

impl Cloud {
    fn of(mesh: &Mesh, facets: &[u32]) -> Self {
        let mut vertices: Vec<u32> = facets.iter().flat_map(|f| mesh.triangles[*f as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let points: Vec<Point3> = vertices.iter().map(|v| mesh.positions[*v as usize]).collect();
        let [a, b, c] = mesh.corners(mesh.triangles[facets[facets.len() / 2] as usize]);
        let edges = [b - a, c - b, a - c];
        let longest = edges.into_iter().fold(edges[0], |x, y| if y.norm() > x.norm() { y } else { x });
        let normal = (b - a).cross(&(c - a));
        let unit = |v: Vector3| v.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        let slabs = [unit(normal), unit(normal.cross(&longest))].map(|along| Slab::of(along, &points));
        Self { points, slabs }
    }

    /// Whether points are certainly apart from the corners.
    fn is_apart_from(&self, points: &[Point3]) -> bool {
        self.slabs.iter().any(|slab| slab.is_apart(points))
    }
}

/// Relative rounding error of a place along a direction, with a margin.
const CLOUD_ROUNDING: f64 = 1e-12;
/// Number of facets of a leaf near a segment from which their corners are compared first.
const CROWD: u32 = 3;

/// The hub of each facet: of its vertices with at least [`HUB_FACETS`] facets, that with the most.
/// Empty if no vertex is a hub.
fn hubs(mesh: &Mesh) -> Vec<u32> {
    let mut facets = vec![0_u32; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|v| facets[*v as usize] += 1);
    if facets.iter().all(|count| *count < HUB_FACETS) {
        return Vec::new();
    }
    let hub = |t: &[u32; 3]| {
        let most = t.iter().copied().max_by_key(|v| (facets[*v as usize], std::cmp::Reverse(*v)));
        most.filter(|v| facets[*v as usize] >= HUB_FACETS).unwrap_or(NO_HUB)
    };
    mesh.triangles.iter().map(hub).collect()
}

/// The hub that all of `hubs` are.
fn common_hub(hubs: &[u32]) -> u32 {
    if hubs.iter().all(|hub| *hub == hubs[0]) { hubs[0] } else { NO_HUB }
}

impl Bvh {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let hub_of_facet = hubs(mesh);
        let mut facets = morton_order(mesh);
        // Facets of one hub become neighbours, so that whole nodes share it.
        if !hub_of_facet.is_empty() {
            facets.sort_by_key(|f| hub_of_facet[*f as usize]);
        }
        let hubs: Vec<u32> = match hub_of_facet.is_empty() {
            true => Vec::new(),
            false => facets.iter().map(|f| hub_of_facet[*f as usize]).collect(),
        };
        let mut node_hubs: Vec<Vec<u32>> = vec![hubs.chunks(WIDTH).map(common_hub).collect()];
        let leaves = parallel::in_chunks(facets.len().div_ceil(WIDTH), |range| {
            let facets = &facets[WIDTH * range.start..facets.len().min(WIDTH * range.end)];
            let bounds = |f: &u32| {
                let (low, high) = corner_box(mesh, *f as usize);
                Bounds::around(low, high)
            };
            facets.chunks(WIDTH).map(|eight| Node::of(eight.iter().map(bounds))).collect::<Vec<_>>()
        });
        let mut levels = vec![leaves.concat()];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let above = below.chunks(WIDTH).map(|eight| Node::of(eight.iter().map(Node::hull))).collect();
            levels.push(above);
            node_hubs.extend(node_hubs.last().map(|below| below.chunks(WIDTH).map(common_hub).collect()));
        }
        let planes = parallel::in_chunks(facets.len(), |slots| {
            let plane = |f: &u32| Plane::of(mesh.corners(mesh.triangles[*f as usize]));
            facets[slots].iter().map(plane).collect::<Vec<_>>()
        });
        let clouds = match hubs.is_empty() {
            true => Vec::new(),
            false => facets.chunks(WIDTH).map(|eight| Cloud::of(mesh, eight)).collect(),
        };
        Self { facets, planes: planes.concat(), levels, hubs, node_hubs, clouds }
    }

    pub(super) fn leaves(&self) -> usize {
        self.levels[0].len()
    }

    /// Index of the facet in `slot`.
    pub(super) fn facet(&self, slot: usize) -> usize {
        self.facets[slot] as usize
    }

    /// Plane of the facet in `slot`.
    pub(super) fn plane(&self, slot: usize) -> &Plane {
        &self.planes[slot]
    }

    /// The slots of a leaf.
    pub(super) fn slots(&self, leaf: usize) -> std::ops::Range<usize> {
        WIDTH * leaf..self.facets.len().min(WIDTH * (leaf + 1))
    }

    /// Ranges of slots whose facets share a hub, with the hub.
    pub(super) fn hub_slots(&self) -> Vec<(u32, std::ops::Range<usize>)> {
        let mut start = 0;
        let groups = self.hubs.chunk_by(|a, b| a == b).map(|group| {
            let slots = start..start + group.len();
            start = slots.end;
            (group[0], slots)
        });
        groups.filter(|(hub, _)| *hub != NO_HUB).collect()
    }

    /// The hub that all facets of a node share.
    fn node_hub(&self, level: usize, node: usize) -> u32 {
        self.node_hubs[level].get(node).copied().unwrap_or(NO_HUB)
    }

    /// Calls `visit` once for every pair of slots whose boxes touch or overlap, the first of them
    /// in `leaf`, the second after it, except facets with the same hub, and
    /// facets of leaves that are apart. `near` is a buffer.
    pub(super) fn pairs_from(&self, leaf: usize, near: &mut Vec<usize>, mut visit: impl FnMut(usize, usize)) {
        let own = &self.levels[0][leaf];
        self.leaves_of_other_hubs(&own.hull(), leaf + 1, self.node_hub(0, leaf), near);
        if let Some(cloud) = self.clouds.get(leaf) {
            let is_apart =
                |other: &Cloud| cloud.is_apart_from(&other.points) || other.is_apart_from(&cloud.points);
            near.retain(|other| !is_apart(&self.clouds[*other]));
        }
        let mut visit = |a: usize, b: usize| {
            if self.hubs.get(a).is_none_or(|hub| *hub == NO_HUB || *hub != self.hubs[b]) {
                visit(a, b);
            }
        };
        for slot in self.slots(leaf) {
            let lane = slot % WIDTH;
            let bounds = own.lane(lane);
            own.lanes_overlapping(&bounds).after(lane).for_each(|other| visit(slot, WIDTH * leaf + other));
            self.slots_overlapping(&bounds, near, |other| visit(slot, other));
        }
    }

    /// Calls `visit` with every slot in the leaves `near` whose box touches or overlaps that of the
    /// segment, which is `bounds`.
    pub(super) fn slots_along(
        &self,
        (from, to): (Point3, Point3),
        bounds: &Bounds,
        near: &[usize],
        mut visit: impl FnMut(usize),
    ) {
        for leaf in near {
            let lanes = self.levels[0][*leaf].lanes_overlapping(bounds);
            let is_crowd = lanes.len() >= CROWD;
            let is_apart = |cloud: &Cloud| cloud.is_apart_from(&[from, to]);
            if is_crowd && self.clouds.get(*leaf).is_some_and(is_apart) {
                continue;
            }
            lanes.for_each(|lane| visit(WIDTH * leaf + lane));
        }
    }

    /// Calls `visit` with every slot in the leaves `near` whose box touches or overlaps `bounds`.
    pub(super) fn slots_overlapping(&self, bounds: &Bounds, near: &[usize], mut visit: impl FnMut(usize)) {
        for leaf in near {
            let lanes = self.levels[0][*leaf].lanes_overlapping(bounds);
            lanes.for_each(|lane| visit(WIDTH * leaf + lane));
        }
    }

    /// Writes the leaves from `first` on whose boxes touch or overlap `bounds` to `leaves`.
    pub(super) fn leaves_overlapping(&self, bounds: &Bounds, first: usize, leaves: &mut Vec<usize>) {
        self.leaves_of_other_hubs(bounds, first, NO_HUB, leaves);
    }

    /// As [`Self::leaves_overlapping`], without leaves whose facets all share `hub`.
    fn leaves_of_other_hubs(&self, bounds: &Bounds, first: usize, hub: u32, leaves: &mut Vec<usize>) {
        leaves.clear();
        let query = Query { bounds, first, hub };
        match self.levels.len() - 1 {
            // A single leaf has no parent.
            0 => leaves.extend((first == 0).then_some(0)),
            top => self.descend(top, 0, &query, leaves),
        }
    }

    fn descend(&self, level: usize, node: usize, query: &Query<'_>, leaves: &mut Vec<usize>) {
        for lane in self.levels[level][node].lanes_overlapping(query.bounds) {
            let child = WIDTH * node + lane;
            let leaves_to_its_end = (child + 1) * WIDTH.pow(level as u32 - 1);
            match level {
                _ if leaves_to_its_end <= query.first => {}
                _ if query.hub != NO_HUB && self.node_hub(level - 1, child) == query.hub => {}
                1 => leaves.push(child),
                _ => self.descend(level - 1, child, query, leaves),
            }
        }
    }
}

/// What a search of leaves looks for.
struct Query<'a> {
    bounds: &'a Bounds,
    /// The first leaf.
    first: usize,
    /// The hub whose leaves are skipped.
    hub: u32,
}

/// The exact bounding box of facet `f`.
pub(super) fn corner_box(mesh: &Mesh, f: usize) -> (Point3, Point3) {
    let [a, b, c] = mesh.corners(mesh.triangles[f]);
    (a.inf(&b).inf(&c), a.sup(&b).sup(&c))
}

/// Whether two exact boxes touch or overlap.
pub(super) fn boxes_overlap(
    (low, high): (Point3, Point3),
    (other_low, other_high): (Point3, Point3),
) -> bool {
    (0..3).all(|axis| low[axis] <= other_high[axis] && other_low[axis] <= high[axis])
}

/// Facet indices along a Morton curve with 2²¹ cells per side.
fn morton_order(mesh: &Mesh) -> Vec<u32> {
    let (low, high) = mesh.bounds().unwrap_or((Point3::origin(), Point3::origin()));
    let side = (high - low).max();
    let cells_per_mm = if side > 0.0 { f64::from(1 << 21) * 0.999_999 / side } else { 0.0 };
    let chunks = parallel::in_chunks(mesh.triangles.len(), |range| {
        let place = |f: usize| {
            let (facet_low, facet_high) = corner_box(mesh, f);
            let cell = (nalgebra::center(&facet_low, &facet_high) - low) * cells_per_mm;
            (interleaved(cell.x) | interleaved(cell.y) << 1 | interleaved(cell.z) << 2, f as u32)
        };
        range.map(place).collect::<Vec<_>>()
    });
    let mut places = chunks.concat();
    parallel::sort(&mut places);
    places.into_iter().map(|(_, f)| f).collect()
}

/// The lower 21 bits of a cell index, with two zero bits between neighbours.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn interleaved(cell: f64) -> u64 {
    let mut bits = (cell as u64) & 0x1f_ffff;
    bits = (bits | bits << 32) & 0x001f_0000_0000_ffff;
    bits = (bits | bits << 16) & 0x001f_0000_ff00_00ff;
    bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
    bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
    (bits | bits << 2) & 0x1249_2492_4924_9249
}
