//! Side views with hidden lines, of whole bodies or of what is behind a cutting plane.
//!
//! Edges are the ends of walls, their corners, and their silhouettes. A piece of an edge is visible if the first material
//! on a line of sight next to it is not nearer than the edge.

use super::body::{Body, Curve, Wall};
use super::strokes::{Stroke, joined};

/// Offset of a line of sight from an edge, mm: more than rounding, less than any feature.
const BESIDE_MM: f64 = 2e-5;
/// Material may be nearer than an edge by this without hiding it, mm: a slope next to its own edge.
const NEARER_MM: f64 = 4e-3;
/// Longest piece of an edge that one line of sight tests, as a share of the view.
const PIECE_SHARE: f64 = 1.0 / 60.0;

/// Shortest edge that is drawn, mm.
const LEAST_EDGE_MM: f64 = 1e-6;
/// Bisection steps to the end of a visible piece.
const BISECTIONS: usize = 24;

/// The lines of a side view.
#[derive(Clone, Debug, Default)]
pub struct Elevation {
    /// Visible edges.
    pub visible: Vec<Stroke>,
    /// Hidden edges, without those behind a visible one.
    pub hidden: Vec<Stroke>,
}

/// An edge: its point `[u, z, w]` at a share of its length.
struct Edge {
    at: Box<dyn Fn(f64) -> [f64; 3]>,
    length_mm: f64,
}

/// Returns the edges of `bodies`. With `cut_mm`, material with a greater `w` is removed.
#[must_use]
pub fn elevation(bodies: &[Body], cut_mm: Option<f64>) -> Elevation {
    let size = bodies.iter().flat_map(|b| &b.walls).flat_map(|w| &w.lower).fold(0.0f64, |most, c| {
        let p = c.at(0.0);
        most.max(p[0].abs()).max(p[1].abs())
    });
    let mut lines = Lines::default();
    for body in bodies {
        for wall in &body.walls {
            for edge in edges(wall) {
                split(bodies, cut_mm, &edge, (size * PIECE_SHARE).max(0.02), &mut lines);
            }
        }
    }
    lines.joined()
}

/// The edges of a wall.
fn edges(wall: &Wall) -> Vec<Edge> {
    let mut all = Vec::new();
    for (curves, z) in [(&wall.lower, wall.from_mm), (&wall.upper, wall.to_mm)] {
        for curve in curves {
            let mut from = 0.0;
            for to in curve.turns(0).chain([1.0]) {
                let (curve, first) = (*curve, std::mem::replace(&mut from, to));
                let at = move |share: f64| {
                    let [u, w] = curve.at(first + (to - first) * share);
                    [u, z, w]
                };
                let length_mm = (at(1.0)[0] - at(0.0)[0]).abs();
                all.push(Edge { at: Box::new(at), length_mm });
            }
        }
    }
    let number = wall.lower.len();
    for i in 0..number {
        let (lower, upper) = (wall.lower[i], wall.upper[i]);
        let before = &wall.lower[(i + number - 1) % number];
        if is_seen_corner(before, &lower) {
            all.push(upright(&lower, 0.0, &upper, 0.0, wall));
        }
        // Silhouettes: on a cone they are at equal shares of both curves.
        for (a, b) in lower.turns(0).zip(upper.turns(0)) {
            all.push(upright(&lower, a, &upper, b, wall));
        }
    }
    all
}

/// Returns whether the corner between two curves is an edge or part of the silhouette.
fn is_seen_corner(before: &Curve, after: &Curve) -> bool {
    let (a, b) = (before.tangent(1.0), after.tangent(0.0));
    let is_smooth = (a[0] * b[1] - a[1] * b[0]).abs() < 1e-3 && a[0] * b[0] + a[1] * b[1] > 0.0;
    !is_smooth || a[0].abs() < 1e-6
}

/// The edge between points of the lower and of the upper curve of a wall.
fn upright(lower: &Curve, a: f64, upper: &Curve, b: f64, wall: &Wall) -> Edge {
    let (foot, head, from, to) = (lower.at(a), upper.at(b), wall.from_mm, wall.to_mm);
    let at = move |share: f64| {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        [mix(foot[0], head[0]), mix(from, to), mix(foot[1], head[1])]
    };
    Edge { at: Box::new(at), length_mm: libm::hypot(to - from, head[0] - foot[0]) }
}

/// Splits an edge where its visibility changes.
fn split(bodies: &[Body], cut_mm: Option<f64>, edge: &Edge, piece_mm: f64, lines: &mut Lines) {
    if edge.length_mm < LEAST_EDGE_MM {
        return;
    }
    let pieces = (edge.length_mm / piece_mm).ceil().clamp(4.0, 400.0);
    let state = |share: f64| sight(bodies, cut_mm, (edge.at)(share));
    let middle = |i: f64| (i + 0.5) / pieces;
    let (mut begin, mut is) = (0.0, state(middle(0.0)));
    let mut i = 1.0;
    while i < pieces {
        let next = state(middle(i));
        if next != is {
            let (mut low, mut high) = (middle(i - 1.0), middle(i));
            for _ in 0..BISECTIONS {
                let half = f64::midpoint(low, high);
                if state(half) == is { low = half } else { high = half }
            }
            lines.add(is, (edge.at)(begin), (edge.at)(high));
            (begin, is) = (high, next);
        }
        i += 1.0;
    }
    lines.add(is, (edge.at)(begin), (edge.at)(1.0));
}

/// The visibility of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sight {
    Visible,
    Hidden,
    /// Removed by the cut.
    Removed,
}

fn sight(bodies: &[Body], cut_mm: Option<f64>, [u, z, w]: [f64; 3]) -> Sight {
    if cut_mm.is_some_and(|cut| w > cut + 1e-7) {
        return Sight::Removed;
    }
    let is_clear =
        |du: f64, dz: f64| !hides(bodies, cut_mm, [u + du * BESIDE_MM, z + dz * BESIDE_MM, w + NEARER_MM]);
    let seen =
        [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].into_iter().any(|(du, dz)| is_clear(du, dz));
    if seen { Sight::Visible } else { Sight::Hidden }
}

/// Returns whether material hides a point.
fn hides(bodies: &[Body], cut_mm: Option<f64>, [u, z, w]: [f64; 3]) -> bool {
    let mut depths = Vec::new();
    bodies.iter().filter(|body| body.may_hide([u, z, w])).any(|body| {
        depths.clear();
        body.crossings(0, u, z, &mut depths);
        let nearest = match cut_mm {
            // Cut material shows its face.
            Some(cut) if depths.iter().filter(|w| **w > cut).count() % 2 == 1 => Some(cut),
            Some(cut) => depths.iter().copied().filter(|w| *w <= cut).reduce(f64::max),
            None => depths.iter().copied().reduce(f64::max),
        };
        nearest.is_some_and(|nearest| nearest > w)
    })
}

/// Lines of a view, not yet joined.
#[derive(Default)]
struct Lines {
    visible: Vec<Stroke>,
    hidden: Vec<Stroke>,
}

impl Lines {
    fn add(&mut self, sight: Sight, from: [f64; 3], to: [f64; 3]) {
        let stroke = [[from[0], from[1]], [to[0], to[1]]];
        match sight {
            Sight::Visible => self.visible.push(stroke),
            Sight::Hidden => self.hidden.push(stroke),
            Sight::Removed => {}
        }
    }

    fn joined(self) -> Elevation {
        let visible = joined(&self.visible, &[]);
        let hidden = joined(&self.hidden, &visible);
        Elevation { visible, hidden }
    }
}

#[cfg(test)]
mod tests {
    use super::super::body::Side;
    use super::*;
    use pinswitch_solid::pose::Pose;
    use pinswitch_solid::profile::{Contour, Point2};
    use pinswitch_solid::solid::Solid;

    fn block(corners: [(f64, f64); 4], from: f64, to: f64) -> Solid {
        let outline = Contour::polygon(corners.map(|(x, y)| Point2::new(x, y)).to_vec());
        Solid::prism(&outline, &[], from, to, 0.0).unwrap()
    }

    fn seen(solid: &Solid, side: Side) -> Body {
        Body::new(solid, Pose::upright(0.0), side)
    }

    fn length(strokes: &[Stroke]) -> f64 {
        strokes.iter().map(|[a, b]| libm::hypot(a[0] - b[0], a[1] - b[1])).sum()
    }

    #[test]
    fn a_block_hides_the_block_behind() {
        let near = block([(0.0, 5.0), (10.0, 5.0), (10.0, 6.0), (0.0, 6.0)], 0.0, 4.0);
        let far = block([(4.0, 0.0), (20.0, 0.0), (20.0, 1.0), (4.0, 1.0)], 1.0, 3.0);
        let both = [seen(&near, Side::Above), seen(&far, Side::Above)];
        let view = elevation(&both, None);
        // One corner and two edges of 6 mm of the far block are hidden.
        assert!((length(&view.visible) - (28.0 + 2.0 * 10.0 + 2.0)).abs() < 1e-3, "{:?}", view.visible);
        assert!((length(&view.hidden) - (2.0 * 6.0 + 2.0)).abs() < 1e-3, "{:?}", view.hidden);
        // A cut between the two removes the near one.
        let behind = elevation(&both, Some(3.0));
        assert!((length(&behind.visible) - 36.0).abs() < 1e-3 && behind.hidden.is_empty());
    }

    #[test]
    fn cut_holes_become_visible() {
        let outline = Contour::polygon(
            [(0.0, 0.0), (10.0, 0.0), (10.0, 8.0), (0.0, 8.0)].map(|(x, y)| Point2::new(x, y)).to_vec(),
        );
        let hole = Contour::circle(Point2::new(5.0, 4.0), 2.0).reversed();
        let body = [seen(&Solid::prism(&outline, &[hole], 0.0, 3.0, 0.0).unwrap(), Side::Above)];
        let whole = elevation(&body, None);
        assert!((length(&whole.visible) - 26.0).abs() < 1e-3);
        // Its two sides only: its ends are on the outline.
        assert!((length(&whole.hidden) - 6.0).abs() < 1e-3, "{:?}", whole.hidden);
        let cut = elevation(&body, Some(4.0));
        assert!(cut.hidden.is_empty(), "{:?}", cut.hidden);
    }

    /// A body that is skipped has no material on the line of sight that is nearer than the point.
    #[test]
    fn bodies_that_are_skipped_hide_nothing() {
        let cone = Solid::prism(&Contour::circle(Point2::new(2.0, 1.0), 3.0), &[], 0.0, 4.0, 0.2).unwrap();
        let slab = block([(4.0, 0.0), (20.0, 0.0), (20.0, 1.0), (4.0, 1.0)], 1.0, 3.0);
        let (mut skipped, mut asked) = (0, 0);
        for body in [seen(&cone, Side::Above), seen(&cone, Side::Left), seen(&slab, Side::Right)] {
            for i in 0..20 * 12 * 20 {
                let [u, z, w] = [i % 20, i / 20 % 12, i / 240].map(f64::from);
                let point = [u - 8.03, 0.51 * z - 0.7, w - 9.97];
                if body.may_hide(point) {
                    asked += 1;
                    continue;
                }
                let mut depths = Vec::new();
                body.crossings(0, point[0], point[1], &mut depths);
                assert!(depths.iter().all(|depth| *depth <= point[2]), "{point:?} {depths:?}");
                skipped += 1;
            }
        }
        assert!(skipped > 1000 && asked > 100, "{skipped} {asked}");
    }
}
