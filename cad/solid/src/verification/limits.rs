//! How far two meshes of one solid may differ, from the chord tolerance alone.
//!
//! Let `e` be the chord tolerance. Our mesh is within `e` of every curve. The kernel inscribes its
//! chords, and measures their sag in the middle fifth of a chord, where it is at least 96 % of the
//! largest: its mesh is within `s = e/0.96`. The limits follow wall by wall, with `θ` the angle of
//! an arc, `L` the length of an edge and `h` the slant height.
//!
//! - *Volume.* Ours deviates by at most [`Solid::volume_bound_mm3`]. A curved wall of the kernel is
//!   off by at most `s` over its area `L h`. Where a wall is twisted, its triangles are off the
//!   ruled surface by `e` in the mean, too.
//! - *Area of upright walls.* A chord of half angle `t` has a sag of `r (1 - cos t)`, and is
//!   shorter than its arc by `2 r (t - sin t) <= 2 t r (1 - cos t)`. So the length of an inscribed
//!   arc is short by at most `s θ`. Our vertices are outside of the arc by at most `e`, and a curve
//!   outside of a convex one at that distance is longer by at most `e θ`.
//! - *Area of cones.* The slant height of a piece is short, too, by at most the same share of the
//!   area.
//! - *Area next to the edges.* Where rows of the kernel's triangles do not match the chords of an
//!   edge, a triangle on a chord is higher by at most twice the sag: `s L` over an edge.
//! - *Area of twisted walls.* On a piece between edge vectors `u` and `v`, `p` and `q` long, with a
//!   ruling `c`, the normal of the ruled surface is linear: `N = (1 - t) u×c + t v×c + w u×v`. Two
//!   triangles have half the sum of its lengths in two corners, the surface the mean of its length.
//!   Both are at least `|M|`, the length in the middle, and at most `|M| + m²/(2 |M|)`, where `m`
//!   is the largest deviation across `M`: at most `(p q sin d + min(p, q) d h)/2` for edges that
//!   are turned by `d`. `|M|` is at least the mean length times the height.
//! - *Area of caps.* Ours keep it, but for arcs that are drawn as chords. The kernel's are off by
//!   at most `s` over their arcs.
//! - *Bounding box, and vertices of ours from the kernel's surface.* Both are on edges: `e + s`.
//! - *Vertices of the kernel from our surface.* They are on the exact surface: `e`, and on a
//!   twisted wall `3 e` more: the triangles are off by three times their mean in the middle of a
//!   piece.

use crate::mesh::Mesh;
use crate::profile::{ChordTolerance, Contour, Edge, FLAT_MM};
use crate::solid::Solid;

/// Share of the largest sag of a chord that the kernel measures at least: `4 x (1 - x)` at `x` =
/// 0.4.
const MEASURED_SAG: f64 = 0.96;
/// Rounding of a coordinate in single precision, and of the kernel's own computations, mm.
const ROUNDING_MM: f64 = 1e-5;

/// Largest differences between two meshes of one solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub(super) volume_mm3: f64,
    pub(super) area_mm2: f64,
    /// Of each coordinate of the bounding boxes.
    pub(super) box_mm: f64,
    /// Of a vertex of ours from the kernel's surface.
    pub(super) ours_mm: f64,
    /// Of a vertex of the kernel from our surface.
    pub(super) kernels_mm: f64,
}

impl Limits {
    /// The limits for `mesh`, which is our mesh of `solid` within `tolerance`.
    pub(super) fn new(solid: &Solid, mesh: &Mesh, tolerance: ChordTolerance) -> Self {
        let e = tolerance.mm();
        let s = e / MEASURED_SAG;
        let rings: Vec<(&Contour, f64)> = solid.rings().collect();
        let mut limits = Self {
            volume_mm3: solid.volume_bound_mm3(tolerance),
            area_mm2: ROUNDING_MM * mesh.facets().map(half_perimeter).sum::<f64>(),
            box_mm: e + s + ROUNDING_MM,
            ours_mm: e + s + ROUNDING_MM,
            kernels_mm: e + ROUNDING_MM,
        };
        for (lower, upper) in solid.walls() {
            let height_mm = rings[upper].1 - rings[lower].1;
            for wall in edges([rings[lower].0, rings[upper].0], height_mm, tolerance) {
                limits.volume_mm3 += wall.volume_mm3(e, s);
                limits.area_mm2 += wall.area_mm2(e, s);
                if wall.is_twisted() {
                    limits.kernels_mm = 4.0 * e + ROUNDING_MM;
                }
            }
        }
        for (_, members) in solid.caps() {
            let arcs: f64 = members.iter().map(|ring| arcs_mm(rings[*ring].0)).sum();
            limits.area_mm2 += (FLAT_MM.min(e) + s) * arcs;
        }
        limits
    }
}

/// One edge of a wall.
struct WallEdge {
    /// Lengths of the lower and upper edge, mm.
    lengths_mm: [f64; 2],
    /// Larger angle of its arcs, radians; zero for lines.
    sweep_rad: f64,
    /// Angle by which the edge turns from the lower to the upper ring, radians.
    turn_rad: f64,
    /// Height and slant height, mm.
    height_mm: f64,
    slant_mm: f64,
    /// Pieces of a twisted wall.
    pieces: f64,
}

/// The edges of a wall between two contours.
fn edges<'a>(
    [lower, upper]: [&'a Contour; 2],
    height_mm: f64,
    tolerance: ChordTolerance,
) -> impl Iterator<Item = WallEdge> + 'a {
    let pieces = lower.wall_pieces(upper, tolerance);
    pieces.into_iter().enumerate().map(move |(i, pieces)| {
        let sweep = |edge: &Edge| if let Edge::Arc(arc) = edge { arc.sweep_rad.abs() } else { 0.0 };
        let (a, b) = (lower.ends(i), upper.ends(i));
        let shift_mm = (a.0 - b.0).norm().max((a.1 - b.1).norm());
        WallEdge {
            lengths_mm: [lower.edge_mm(i), upper.edge_mm(i)],
            sweep_rad: sweep(&lower.edges()[i]).max(sweep(&upper.edges()[i])),
            turn_rad: lower.turn_to_rad(upper, i),
            height_mm,
            slant_mm: libm::hypot(height_mm, shift_mm),
            pieces: pieces as f64,
        }
    })
}

impl WallEdge {
    /// Whether the edge turns: angles below are rounding.
    fn is_twisted(&self) -> bool {
        self.turn_rad > 1e-9
    }

    fn area(&self) -> f64 {
        self.lengths_mm.iter().sum::<f64>() / 2.0 * self.slant_mm
    }

    fn volume_mm3(&self, e: f64, s: f64) -> f64 {
        let curved = if self.sweep_rad > 0.0 { s } else { 0.0 };
        let twisted = if self.is_twisted() { e } else { 0.0 };
        (curved + twisted) * self.area()
    }

    fn area_mm2(&self, e: f64, s: f64) -> f64 {
        let chords = if self.slant_mm > self.height_mm { 2.0 } else { 1.0 };
        let next_to_edges = if self.sweep_rad > 0.0 { s * self.lengths_mm.iter().sum::<f64>() } else { 0.0 };
        chords * (e + s) * self.sweep_rad * self.slant_mm + next_to_edges + 2.0 * self.twist_mm2()
    }

    /// Largest difference between the area of a twisted wall and that of its triangles.
    fn twist_mm2(&self) -> f64 {
        if !self.is_twisted() {
            return 0.0;
        }
        let [p, q] = self.lengths_mm.map(|length| length / self.pieces);
        let turn = self.turn_rad.min(std::f64::consts::FRAC_PI_2);
        let across = (p * q * libm::sin(turn) + p.min(q) * turn * self.slant_mm) / 2.0;
        let middle = f64::midpoint(p, q) * libm::cos(turn / 2.0) * self.height_mm;
        self.pieces * across.min(across * across / (2.0 * middle))
    }
}

/// Length of the arcs of a contour, mm.
fn arcs_mm(contour: &Contour) -> f64 {
    let is_arc = |i: &usize| matches!(contour.edges()[*i], Edge::Arc(_));
    (0..contour.edges().len()).filter(is_arc).map(|i| contour.edge_mm(i)).sum()
}

/// Half of the perimeter: the area of a triangle changes by at most this times the distance that
/// its corners move.
fn half_perimeter([a, b, c]: [crate::mesh::Point3; 3]) -> f64 {
    ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 2.0
}
