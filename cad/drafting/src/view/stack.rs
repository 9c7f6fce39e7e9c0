//! Front views of several bodies on one axis, with visible and hidden edges.

use super::body::{Body, Side};
use super::plan::{Trace, plan, traces};
use crate::Layer;
use crate::contour::lettering;
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::{Arc, Contour, Point2, Vector2};
use pinswitch_solid::solid::{Facing, Solid};
use std::f64::consts::TAU;

/// Offset of a line of sight from an edge, mm: more than rounding, less than any feature.
const BESIDE_MM: f64 = 2e-5;
/// Longest piece of an edge that one line of sight tests, mm.
const PIECE_MM: f64 = 0.5;
/// Space around engraved letters without hidden lines, mm: a dash in a space would read as a minus.
const AROUND_MARK_MM: f64 = 2.0;
/// Bisection steps to the end of a visible piece.
const BISECTIONS: usize = 24;

/// A body of an assembly.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// The solid.
    pub solid: &'a Solid,
    /// Its pose in the assembly.
    pub pose: Pose,
    /// Whether its own lines are drawn. It hides others either way.
    pub is_drawn: bool,
}

impl Placed<'_> {
    /// Height of its upper end, mm.
    fn top_mm(&self) -> f64 {
        let (low, high) = self.solid.bounds().map_or((0.0, 0.0), |(low, high)| (low.z, high.z));
        if self.pose.flipped { self.pose.z_mm - low } else { self.pose.z_mm + high }
    }

    /// The same body, `by_mm` higher.
    fn lifted(&self, by_mm: f64) -> Self {
        Self { pose: Pose { z_mm: self.pose.z_mm + by_mm, ..self.pose }, ..*self }
    }
}

/// Returns the lines of `bodies`, viewed from above: all of the uppermost body, and the visible and hidden edges of the
/// others. `lowest_mm` is the height of the lowest body, and `chamfer_mm` that of bottom chamfers.
#[must_use]
pub fn stacked_plan(bodies: &[Placed<'_>], lowest_mm: f64, chamfer_mm: f64) -> Vec<(Layer, Trace)> {
    // The last of several that are equally high.
    let uppermost = (0..bodies.len()).max_by(|a, b| bodies[*a].top_mm().total_cmp(&bodies[*b].top_mm()));
    let Some(uppermost) = uppermost else { return Vec::new() };
    let Placed { solid, pose, .. } = bodies[uppermost];
    let mut lines: Vec<(Layer, Trace)> = plan(solid, pose.flipped, chamfer_mm)
        .into_iter()
        .filter(|(layer, _)| *layer != Layer::Hidden)
        .collect();
    let bodies: Vec<Placed<'_>> = bodies.iter().map(|b| b.lifted(-lowest_mm)).collect();
    let all: Vec<Body> = bodies.iter().map(|b| Body::new(b.solid, b.pose, Side::Above)).collect();
    for (i, body) in bodies.iter().enumerate().filter(|(_, body)| body.is_drawn) {
        if i == uppermost {
            continue;
        }
        for (trace, z) in upper_edges(body) {
            if lines.iter().any(|(_, other)| is_same(other, &trace)) {
                continue;
            }
            lines.extend(pieces(&trace, |point, across| is_visible(&all, point, across, z)));
        }
    }
    let letters = letter_boxes(solid, pose);
    lines.into_iter().flat_map(|(layer, trace)| clear_of_letters(layer, trace, &letters)).collect()
}

/// Bounding boxes of the letters of a body, with some space around them.
fn letter_boxes(solid: &Solid, pose: Pose) -> Vec<(Point2, Point2)> {
    let of_letters = solid.rings().zip(lettering(solid)).filter(|(_, is_letter)| *is_letter);
    of_letters
        .map(|((contour, _), _)| {
            let contour = if pose.flipped { contour.mirrored() } else { contour.clone() };
            let (low, high) = contour.bounds();
            let around = Vector2::new(AROUND_MARK_MM, AROUND_MARK_MM);
            (low - around, high + around)
        })
        .collect()
}

/// The pieces of a line outside of the boxes of letters, if it is hidden.
fn clear_of_letters(layer: Layer, trace: Trace, letters: &[(Point2, Point2)]) -> Vec<(Layer, Trace)> {
    if layer != Layer::Hidden || letters.is_empty() {
        return vec![(layer, trace)];
    }
    let is_clear = |p: Point2, _: Vector2| {
        !letters.iter().any(|(low, high)| low.x < p.x && p.x < high.x && low.y < p.y && p.y < high.y)
    };
    let clear = pieces(&trace, is_clear).into_iter().filter(|(is, _)| *is == Layer::Visible);
    clear.map(|(_, piece)| (layer, piece)).collect()
}

/// The edges of the upward faces of a body, each with its height, without engraved letters.
fn upper_edges(&Placed { solid, pose, .. }: &Placed<'_>) -> Vec<(Trace, f64)> {
    let eye = if pose.flipped { Facing::Down } else { Facing::Up };
    let rings: Vec<(&Contour, f64)> = solid.rings().collect();
    let letters = lettering(solid);
    let caps = solid.caps().filter(|(facing, _)| *facing == eye);
    let mut known: Vec<&Contour> = Vec::new();
    let mut all = Vec::new();
    for i in caps.flat_map(|(_, members)| members).filter(|i| !letters[*i]) {
        let (contour, z) = rings[i];
        if known.contains(&contour) {
            continue;
        }
        known.push(contour);
        let seen = if pose.flipped { contour.mirrored() } else { contour.clone() };
        let height = if pose.flipped { pose.z_mm - z } else { pose.z_mm + z };
        all.extend(traces(&seen).into_iter().map(|trace| (trace, height)));
    }
    all
}

/// Returns whether an edge at height `z` is visible: no body is above it on at least one side.
fn is_visible(bodies: &[Body], point: Point2, across: Vector2, z: f64) -> bool {
    [1.0, -1.0].iter().any(|side| !is_covered(bodies, point + across * (side * BESIDE_MM), z))
}

/// Returns whether a body has material above a point at height `z`.
fn is_covered(bodies: &[Body], point: Point2, z: f64) -> bool {
    let mut ends = Vec::new();
    bodies.iter().any(|body| {
        body.levels_mm.windows(2).filter(|level| level[1] > z + 1e-6).any(|level| {
            ends.clear();
            body.crossings(0, point.x, f64::midpoint(level[0].max(z), level[1]), &mut ends);
            ends.iter().filter(|y| **y > point.y).count() % 2 == 1
        })
    })
}

/// Splits a trace where its visibility changes. `is_visible` gets a point and the direction across the trace there.
fn pieces(trace: &Trace, is_visible: impl Fn(Point2, Vector2) -> bool) -> Vec<(Layer, Trace)> {
    let number = (length_mm(trace) / PIECE_MM).ceil().clamp(4.0, 400.0);
    let state = |share: f64| {
        let (point, along) = at(trace, share);
        is_visible(point, Vector2::new(-along.y, along.x))
    };
    let middle = |i: f64| (i + 0.5) / number;
    let layer = |is: bool| if is { Layer::Visible } else { Layer::Hidden };
    let (mut begin, mut is, mut all) = (0.0, state(middle(0.0)), Vec::new());
    let mut i = 1.0;
    while i < number {
        let next = state(middle(i));
        if next != is {
            let (mut low, mut high) = (middle(i - 1.0), middle(i));
            for _ in 0..BISECTIONS {
                let half = f64::midpoint(low, high);
                if state(half) == is { low = half } else { high = half }
            }
            all.push((layer(is), piece(trace, begin, high)));
            (begin, is) = (high, next);
        }
        i += 1.0;
    }
    all.push((layer(is), piece(trace, begin, 1.0)));
    all
}

/// A point of a trace and the direction along it.
fn at(trace: &Trace, share: f64) -> (Point2, Vector2) {
    match trace {
        Trace::Line(a, b) => (a + (b - a) * share, (b - a).normalize()),
        Trace::Arc(arc) => (arc.point_at(share, arc.radius_mm), arc.tangent_at(share)),
        Trace::Circle(centre, radius_mm) => at(&Trace::Arc(whole(*centre, *radius_mm)), share),
    }
}

/// The piece of a trace between two shares of its length.
fn piece(trace: &Trace, from: f64, to: f64) -> Trace {
    match trace {
        _ if from <= 0.0 && to >= 1.0 => *trace,
        Trace::Line(a, b) => Trace::Line(a + (b - a) * from, a + (b - a) * to),
        Trace::Arc(arc) => Trace::Arc(Arc {
            start_rad: arc.start_rad + arc.sweep_rad * from,
            sweep_rad: arc.sweep_rad * (to - from),
            ..*arc
        }),
        Trace::Circle(centre, radius_mm) => piece(&Trace::Arc(whole(*centre, *radius_mm)), from, to),
    }
}

fn length_mm(trace: &Trace) -> f64 {
    match trace {
        Trace::Line(a, b) => (b - a).norm(),
        Trace::Arc(arc) => arc.length_mm(),
        Trace::Circle(_, radius_mm) => TAU * radius_mm,
    }
}

const fn whole(centre: Point2, radius_mm: f64) -> Arc {
    Arc { centre, radius_mm, start_rad: 0.0, sweep_rad: TAU }
}

/// Returns whether two lines of a view are equal.
fn is_same(a: &Trace, b: &Trace) -> bool {
    let near = |p: Point2, q: Point2| (p - q).norm() < 1e-6;
    match (a, b) {
        (Trace::Line(a, b), Trace::Line(c, d)) => {
            (near(*a, *c) && near(*b, *d)) || (near(*a, *d) && near(*b, *c))
        }
        (Trace::Circle(a, r), Trace::Circle(b, s)) => near(*a, *b) && (r - s).abs() < 1e-6,
        (Trace::Arc(a), Trace::Arc(b)) => {
            near(a.point_at(0.5, a.radius_mm), b.point_at(0.5, b.radius_mm))
                && (a.radius_mm - b.radius_mm).abs() < 1e-6
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block([low_x, low_y, high_x, high_y]: [f64; 4], height: f64) -> Solid {
        let corners = [(low_x, low_y), (high_x, low_y), (high_x, high_y), (low_x, high_y)];
        let outline = Contour::polygon(corners.map(|(x, y)| Point2::new(x, y)).to_vec());
        Solid::prism(&outline, &[], 0.0, height, 0.0).unwrap()
    }

    fn drawn_mm(lines: &[(Layer, Trace)], layer: Layer) -> f64 {
        lines.iter().filter(|(l, _)| *l == layer).map(|(_, trace)| length_mm(trace)).sum()
    }

    #[test]
    fn a_lower_body_is_hidden_where_covered() {
        let (plate, block) = (block([0.0, 0.0, 30.0, 10.0], 2.0), block([10.0, -5.0, 20.0, 5.0], 4.0));
        let placed = |solid, z_mm, is_drawn| Placed { solid, pose: Pose::upright(z_mm), is_drawn };
        let lines = stacked_plan(&[placed(&plate, 0.0, true), placed(&block, 2.0, true)], 0.0, 0.0);
        // Ten of the plate's 80 mm are below the block.
        assert!((drawn_mm(&lines, Layer::Visible) - (40.0 + 70.0)).abs() < 1e-4, "{lines:?}");
        assert!((drawn_mm(&lines, Layer::Hidden) - 10.0).abs() < 1e-4, "{lines:?}");
        let alone = stacked_plan(&[placed(&plate, 0.0, false), placed(&block, 2.0, true)], 0.0, 0.0);
        assert!((drawn_mm(&alone, Layer::Visible) - 40.0).abs() < 1e-9, "{alone:?}");
    }

    #[test]
    fn a_covered_half_circle_is_hidden() {
        let circle = Trace::Circle(Point2::origin(), 2.0);
        let halves = pieces(&circle, |p, _| p.y > 0.0);
        let half = |layer| drawn_mm(&halves, layer);
        assert!((half(Layer::Visible) - TAU).abs() < 1e-5 && (half(Layer::Hidden) - TAU).abs() < 1e-5);
        assert_eq!(pieces(&circle, |_, _| true), [(Layer::Visible, circle)]);
    }
}
