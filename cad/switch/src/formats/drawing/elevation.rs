//! A view from a side with hidden lines, whole or behind a cut.
//!
//! Edges are the ends of walls, their corners, and where they turn away from the eye. A piece of an edge is seen if the
//! first material on a line of sight beside it lies no nearer than the edge itself.

use pinswitch_friction::sort_by_number;

use super::body::{Body, Curve};

/// Beside an edge, mm: further than rounding, nearer than anything that is made.
const BESIDE_MM: f64 = 2e-5;
/// By how much material may lie nearer than an edge without hiding it, mm: a slope seen beside its own edge.
const NEARER_MM: f64 = 4e-3;
/// Longest piece of an edge that is judged by one look, as a share of the view.
const PIECE_SHARE: f64 = 1.0 / 60.0;

/// A straight line of a view: both ends as `[u, z]`.
pub(super) type Stroke = [[f64; 2]; 2];

/// The lines of a view.
#[derive(Clone, Debug, Default)]
pub(super) struct Elevation {
    pub(super) visible: Vec<Stroke>,
    pub(super) hidden: Vec<Stroke>,
}

/// Distances that differ by less are the same, mm: what lies alike on both sides is thinned out alike.
const SAME_MM: f64 = 1e-3;

/// An edge: from and to as `[u, z, w]`, with the share of the way between.
struct Edge {
    at: Box<dyn Fn(f64) -> [f64; 3]>,
    length_mm: f64,
}

/// What is seen of `bodies`, if all that lies nearer than `cut_mm` is taken away.
pub(super) fn elevation(bodies: &[Body], cut_mm: Option<f64>) -> Elevation {
    let size = bodies.iter().flat_map(|b| &b.walls).flat_map(|w| &w.lower).fold(0.0f64, |most, c| {
        let p = c.at(0.0);
        most.max(p[0].abs()).max(p[1].abs())
    });
    let mut lines = Lines::default();
    for body in bodies {
        for wall in &body.walls {
            for edge in edges(wall) {
                judge(bodies, cut_mm, &edge, (size * PIECE_SHARE).max(0.02), &mut lines);
            }
        }
    }
    lines.merged()
}

/// The edges of a wall.
fn edges(wall: &super::body::Wall) -> Vec<Edge> {
    let mut all = Vec::new();
    for (curves, z) in [(&wall.lower, wall.from_mm), (&wall.upper, wall.to_mm)] {
        for curve in curves {
            let mut shares = curve.turns(0);
            shares.insert(0, 0.0);
            shares.push(1.0);
            for pair in shares.windows(2) {
                let (curve, from, to) = (*curve, pair[0], pair[1]);
                let at = move |share: f64| {
                    let [u, w] = curve.at(from + (to - from) * share);
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
        // Where both turn away from the eye: on a cone the shares are the same.
        for (a, b) in lower.turns(0).into_iter().zip(upper.turns(0)) {
            all.push(upright(&lower, a, &upper, b, wall));
        }
    }
    all
}

/// Whether the corner between two curves is an edge, or the end of what can be seen of them.
fn is_seen_corner(before: &Curve, after: &Curve) -> bool {
    let (a, b) = (before.tangent(1.0), after.tangent(0.0));
    let is_smooth = (a[0] * b[1] - a[1] * b[0]).abs() < 1e-3 && a[0] * b[0] + a[1] * b[1] > 0.0;
    !is_smooth || a[0].abs() < 1e-6
}

fn upright(lower: &Curve, a: f64, upper: &Curve, b: f64, wall: &super::body::Wall) -> Edge {
    let (foot, head, from, to) = (lower.at(a), upper.at(b), wall.from_mm, wall.to_mm);
    let at = move |share: f64| {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        [mix(foot[0], head[0]), mix(from, to), mix(foot[1], head[1])]
    };
    Edge { at: Box::new(at), length_mm: libm::hypot(to - from, head[0] - foot[0]) }
}

/// Cuts an edge where it begins or ends to be seen.
fn judge(bodies: &[Body], cut_mm: Option<f64>, edge: &Edge, piece_mm: f64, lines: &mut Lines) {
    if edge.length_mm < 1e-6 {
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
            for _ in 0..24 {
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

/// What can be seen of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sight {
    Visible,
    Hidden,
    /// It was cut away.
    Gone,
}

fn sight(bodies: &[Body], cut_mm: Option<f64>, [u, z, w]: [f64; 3]) -> Sight {
    if cut_mm.is_some_and(|cut| w > cut + 1e-7) {
        return Sight::Gone;
    }
    let is_clear = |du: f64, dz: f64| {
        nearest(bodies, cut_mm, u + du * BESIDE_MM, z + dz * BESIDE_MM)
            .is_none_or(|near| near <= w + NEARER_MM)
    };
    let seen =
        [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].into_iter().any(|(du, dz)| is_clear(du, dz));
    if seen { Sight::Visible } else { Sight::Hidden }
}

/// The nearest material on a line of sight.
fn nearest(bodies: &[Body], cut_mm: Option<f64>, u: f64, z: f64) -> Option<f64> {
    let mut nearest: Option<f64> = None;
    let mut found = Vec::new();
    for body in bodies {
        found.clear();
        body.crossings(0, u, z, &mut found);
        let far = match cut_mm {
            // A cut through material shows its face.
            Some(cut) if found.iter().filter(|w| **w > cut).count() % 2 == 1 => Some(cut),
            Some(cut) => found.iter().copied().filter(|w| *w <= cut).reduce(f64::max),
            None => found.iter().copied().reduce(f64::max),
        };
        nearest = match (nearest, far) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        };
    }
    nearest
}

/// Lines before those that lie on each other are joined.
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
            Sight::Gone => {}
        }
    }

    fn merged(self) -> Elevation {
        let visible = joined(&self.visible, &[]);
        let hidden = joined(&self.hidden, &visible);
        Elevation { visible, hidden }
    }
}

/// A line through strokes: its direction, its distance from the origin, and what they cover of it.
struct Carrier {
    direction: [f64; 2],
    offset: f64,
    spans: Vec<[f64; 2]>,
}

/// `strokes` with those joined that lie on each other or end to end, without what `over` covers.
pub(super) fn joined(strokes: &[Stroke], over: &[Stroke]) -> Vec<Stroke> {
    let mut all: Vec<Carrier> = Vec::new();
    for stroke in strokes {
        let (carrier, span) = place(stroke, &mut all);
        if let Some(span) = span {
            all[carrier].spans.push(span);
        }
    }
    let mut result = Vec::new();
    for carrier in &mut all {
        sort_by_number(&mut carrier.spans, |span| span[0]);
        let mut kept: Vec<[f64; 2]> = Vec::new();
        for span in &carrier.spans {
            match kept.last_mut() {
                Some(last) if span[0] <= last[1] + 1e-4 => last[1] = last[1].max(span[1]),
                _ => kept.push(*span),
            }
        }
        let covers = over.iter().filter_map(|o| along(carrier, o));
        for cover in covers.collect::<Vec<_>>() {
            kept = kept
                .into_iter()
                .flat_map(|s| [[s[0], s[1].min(cover[0])], [s[0].max(cover[1]), s[1]]])
                .filter(|s| s[1] - s[0] > 1e-4)
                .collect();
        }
        let [c, s] = carrier.direction;
        let at = |t: f64| [c * t - s * carrier.offset, s * t + c * carrier.offset];
        result.extend(kept.into_iter().filter(|k| k[1] - k[0] > 1e-4).map(|k| [at(k[0]), at(k[1])]));
    }
    result
}

/// `strokes` without those that lie nearer than `apart_mm` beside a longer one, or one of `kept`, over most of their length:
/// a black patch tells nobody anything.
pub(super) fn legible(strokes: &[Stroke], kept: &[Stroke], apart_mm: f64) -> Vec<Stroke> {
    let length = |s: &Stroke| libm::hypot(s[1][0] - s[0][0], s[1][1] - s[0][1]);
    let reach = |axis: usize| {
        let ends = strokes.iter().flatten().map(|p| p[axis]);
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
    };
    let reaches = [reach(0), reach(1)];
    // What bounds the view stays in any case.
    let is_bound = |s: &Stroke| {
        (0..2).any(|axis| {
            let at = |x: f64| s.iter().all(|p| (p[axis] - x).abs() < 1e-4);
            at(reaches[axis].0) || at(reaches[axis].1)
        })
    };
    let mut longest: Vec<&Stroke> = strokes.iter().collect();
    sort_by_number(&mut longest, |s| -length(s));
    let (bounds, inner): (Vec<&Stroke>, Vec<&Stroke>) = longest.into_iter().partition(|s| is_bound(s));
    let mut all: Vec<Stroke> = Vec::new();
    for stroke in bounds.into_iter().chain(inner) {
        let Some([c, s]) = direction_of(stroke) else { continue };
        let split = |p: [f64; 2]| (p[0] * c + p[1] * s, p[1] * c - p[0] * s);
        let ((a, off), (b, _)) = (split(stroke[0]), split(stroke[1]));
        let (low, high) = (a.min(b), a.max(b));
        let is_crowded = all.iter().chain(kept).any(|other| {
            let ((p, near), (q, far)) = (split(other[0]), split(other[1]));
            let is_parallel = (near - far).abs() < 1e-4;
            let shared = high.min(p.max(q)) - low.max(p.min(q));
            is_parallel && (near - off).abs() < apart_mm - SAME_MM && shared > 0.8 * (high - low)
        });
        if !is_crowded {
            all.push(*stroke);
        }
    }
    all
}

fn direction_of(stroke: &Stroke) -> Option<[f64; 2]> {
    let d = [stroke[1][0] - stroke[0][0], stroke[1][1] - stroke[0][1]];
    let length = libm::hypot(d[0], d[1]);
    if length < 1e-6 {
        return None;
    }
    // One of the two directions, and the axes exactly.
    let sign = if d[0] < -1e-9 * length || (d[0].abs() <= 1e-9 * length && d[1] < 0.0) { -1.0 } else { 1.0 };
    let unit = [sign * d[0] / length, sign * d[1] / length];
    Some(if unit[1].abs() < 1e-9 {
        [1.0, 0.0]
    } else if unit[0].abs() < 1e-9 {
        [0.0, 1.0]
    } else {
        unit
    })
}

/// What `stroke` covers of a carrier that it lies on.
fn along(carrier: &Carrier, stroke: &Stroke) -> Option<[f64; 2]> {
    let [c, s] = carrier.direction;
    let split = |p: [f64; 2]| (p[0] * c + p[1] * s, p[1] * c - p[0] * s);
    let ((a, off), (b, far)) = (split(stroke[0]), split(stroke[1]));
    let is_on = (off - carrier.offset).abs() < 1e-4 && (far - carrier.offset).abs() < 1e-4;
    is_on.then_some([a.min(b), a.max(b)])
}

fn place(stroke: &Stroke, all: &mut Vec<Carrier>) -> (usize, Option<[f64; 2]>) {
    let Some(direction) = direction_of(stroke) else { return (0, None) };
    for (i, carrier) in all.iter().enumerate() {
        let turn = carrier.direction[0] * direction[1] - carrier.direction[1] * direction[0];
        if turn.abs() < 1e-6
            && let Some(span) = along(carrier, stroke)
        {
            return (i, Some(span));
        }
    }
    let [c, s] = direction;
    let offset = stroke[0][1] * c - stroke[0][0] * s;
    let carrier = Carrier { direction, offset, spans: Vec::new() };
    let span = along(&carrier, stroke);
    all.push(carrier);
    (all.len() - 1, span)
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
        Body::seen(solid, Pose::upright(0.0), side)
    }

    fn length(strokes: &[Stroke]) -> f64 {
        strokes.iter().map(|[a, b]| libm::hypot(a[0] - b[0], a[1] - b[1])).sum()
    }

    #[test]
    fn a_block_is_a_rectangle_and_hides_what_is_behind_it() {
        let near = block([(0.0, 5.0), (10.0, 5.0), (10.0, 6.0), (0.0, 6.0)], 0.0, 4.0);
        let far = block([(4.0, 0.0), (20.0, 0.0), (20.0, 1.0), (4.0, 1.0)], 1.0, 3.0);
        let both = [seen(&near, Side::Above), seen(&far, Side::Above)];
        let view = elevation(&both, None);
        // Of the far one a corner and two edges of 6 mm are hidden.
        assert!((length(&view.visible) - (28.0 + 2.0 * 10.0 + 2.0)).abs() < 1e-3, "{:?}", view.visible);
        assert!((length(&view.hidden) - (2.0 * 6.0 + 2.0)).abs() < 1e-3, "{:?}", view.hidden);
        // Cut between the two, only the far one is there.
        let behind = elevation(&both, Some(3.0));
        assert!((length(&behind.visible) - 36.0).abs() < 1e-3 && behind.hidden.is_empty());
    }

    #[test]
    fn lines_that_crowd_are_thinned() {
        let upright = |u: f64, high: f64| [[u, 0.0], [u, high]];
        let strokes =
            [upright(0.0, 5.0), upright(0.3, 5.0), upright(0.8, 20.0), upright(0.9, 5.0), upright(1.6, 5.0)];
        assert_eq!(legible(&strokes, &[], 0.5), [upright(0.0, 5.0), upright(1.6, 5.0), upright(0.8, 20.0)]);
        assert_eq!(legible(&strokes[..1], &[upright(0.2, 9.0)], 0.5), Vec::<Stroke>::new());
        // What crosses does not crowd.
        assert_eq!(legible(&[upright(0.0, 5.0), [[-1.0, 2.0], [1.0, 2.0]]], &[], 0.5).len(), 2);
    }

    #[test]
    fn a_hole_is_hidden_until_it_is_cut() {
        let outline = Contour::polygon(
            [(0.0, 0.0), (10.0, 0.0), (10.0, 8.0), (0.0, 8.0)].map(|(x, y)| Point2::new(x, y)).to_vec(),
        );
        let hole = Contour::circle(Point2::new(5.0, 4.0), 2.0).reversed();
        let body = [seen(&Solid::prism(&outline, &[hole], 0.0, 3.0, 0.0).unwrap(), Side::Above)];
        let whole = elevation(&body, None);
        assert!((length(&whole.visible) - 26.0).abs() < 1e-3);
        // Its two sides, and no more than that: what its ends would draw lies on the outline.
        assert!((length(&whole.hidden) - 6.0).abs() < 1e-3, "{:?}", whole.hidden);
        let cut = elevation(&body, Some(4.0));
        assert!(cut.hidden.is_empty(), "{:?}", cut.hidden);
    }
}
