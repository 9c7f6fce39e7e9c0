//! The front view of the assembly: what is seen of each body from above the right support, and what others hide of it.

use super::body::{Body, Side};
use super::features::lettering;
use super::plan::{Trace, plan, traces};
use crate::parts::{Part, Role};
use pinswitch_drafting::Layer;
use pinswitch_solid::pose::Pose;
use pinswitch_solid::profile::{Arc, Contour, Point2, Vector2};
use pinswitch_solid::solid::Facing;
use std::f64::consts::TAU;

/// Beside an edge, mm: further than rounding, nearer than anything that is made.
const BESIDE_MM: f64 = 2e-5;
/// Longest piece of an edge that is judged by one look, mm.
const PIECE_MM: f64 = 0.5;
/// Around an engraved letter, free of hidden lines, mm: a dash in the room of a space would read as a minus.
const AROUND_MARK_MM: f64 = 2.0;
/// Halvings until the end of a visible piece is found.
const HALVINGS: usize = 24;

/// The lines of the view: the uppermost body whole, of the others what is seen as visible lines and what is covered as
/// hidden ones. The support on the far side is left out, it lies under its like.
pub(super) fn front_lines(bodies: &[(&Part, Pose)], lowest_mm: f64, chamfer_mm: f64) -> Vec<(Layer, Trace)> {
    let top = |(part, pose): &(&Part, Pose)| {
        let (low, high) = part.solid.bounds().map_or((0.0, 0.0), |(low, high)| (low.z, high.z));
        if pose.flipped { pose.z_mm - low } else { pose.z_mm + high }
    };
    let Some(nearest) = bodies.iter().max_by(|a, b| top(a).total_cmp(&top(b))) else { return Vec::new() };
    let mut lines: Vec<(Layer, Trace)> = plan(&nearest.0.solid, nearest.1.flipped, chamfer_mm)
        .into_iter()
        .filter(|(layer, _)| *layer != Layer::Hidden)
        .collect();
    let place = |pose: &Pose| Pose { z_mm: pose.z_mm - lowest_mm, ..*pose };
    let all: Vec<Body> =
        bodies.iter().map(|(part, pose)| Body::seen(&part.solid, place(pose), Side::Above)).collect();
    for (part, pose) in bodies {
        if part.name == nearest.0.name || matches!(part.role, Role::Support { .. }) {
            continue;
        }
        for (trace, z) in upper_edges(part, place(pose)) {
            if lines.iter().any(|(_, other)| is_same(other, &trace)) {
                continue;
            }
            lines.extend(pieces(&trace, |point, beside| is_seen(&all, point, beside, z)));
        }
    }
    let marks = marks(nearest);
    lines.into_iter().flat_map(|(layer, trace)| legible(layer, trace, &marks)).collect()
}

/// The boxes of the letters in the upper face of a part, with some room around them.
fn marks((part, pose): &(&Part, Pose)) -> Vec<(Point2, Point2)> {
    let letters = lettering(&part.solid);
    let of_letters = part.solid.rings().zip(letters).filter(|(_, is_letter)| *is_letter);
    of_letters
        .map(|((contour, _), _)| {
            let contour = if pose.flipped { contour.mirrored() } else { contour.clone() };
            let (low, high) = contour.bounds();
            let around = Vector2::new(AROUND_MARK_MM, AROUND_MARK_MM);
            (low - around, high + around)
        })
        .collect()
}

/// What is drawn of a line: hidden ones end where marks are read.
fn legible(layer: Layer, trace: Trace, marks: &[(Point2, Point2)]) -> Vec<(Layer, Trace)> {
    if layer != Layer::Hidden || marks.is_empty() {
        return vec![(layer, trace)];
    }
    let is_clear = |p: Point2, _: Vector2| {
        !marks.iter().any(|(low, high)| low.x < p.x && p.x < high.x && low.y < p.y && p.y < high.y)
    };
    let kept = pieces(&trace, is_clear).into_iter().filter(|(is, _)| *is == Layer::Visible);
    kept.map(|(_, piece)| (layer, piece)).collect()
}

/// The edges of the faces of a part that look up in the assembly, each with its height. Letters are no shape of the part.
fn upper_edges(part: &Part, pose: Pose) -> Vec<(Trace, f64)> {
    let eye = if pose.flipped { Facing::Down } else { Facing::Up };
    let rings: Vec<(&Contour, f64)> = part.solid.rings().collect();
    let letters = lettering(&part.solid);
    let caps = part.solid.caps().filter(|(facing, _)| *facing == eye);
    let mut drawn: Vec<&Contour> = Vec::new();
    let mut all = Vec::new();
    for i in caps.flat_map(|(_, members)| members).filter(|i| !letters[*i]) {
        let (contour, z) = rings[i];
        if drawn.contains(&contour) {
            continue;
        }
        drawn.push(contour);
        let seen = if pose.flipped { contour.mirrored() } else { contour.clone() };
        let height = if pose.flipped { pose.z_mm - z } else { pose.z_mm + z };
        all.extend(traces(&seen).into_iter().map(|trace| (trace, height)));
    }
    all
}

/// Whether an edge at height `z` is seen: on one side of it nothing lies higher.
fn is_seen(bodies: &[Body], point: Point2, beside: Vector2, z: f64) -> bool {
    [1.0, -1.0].iter().any(|side| !is_covered(bodies, point + beside * (side * BESIDE_MM), z))
}

/// Whether any body has material over a point at height `z`.
fn is_covered(bodies: &[Body], point: Point2, z: f64) -> bool {
    let mut found = Vec::new();
    bodies.iter().any(|body| {
        body.levels_mm.windows(2).filter(|level| level[1] > z + 1e-6).any(|level| {
            found.clear();
            body.crossings(0, point.x, f64::midpoint(level[0].max(z), level[1]), &mut found);
            found.iter().filter(|y| **y > point.y).count() % 2 == 1
        })
    })
}

/// A trace, cut where it begins or ends to be seen. `is_seen` takes a point and the direction across the trace there.
fn pieces(trace: &Trace, is_seen: impl Fn(Point2, Vector2) -> bool) -> Vec<(Layer, Trace)> {
    let number = (length_mm(trace) / PIECE_MM).ceil().clamp(4.0, 400.0);
    let state = |share: f64| {
        let (point, along) = at(trace, share);
        is_seen(point, Vector2::new(-along.y, along.x))
    };
    let middle = |i: f64| (i + 0.5) / number;
    let layer = |is_visible: bool| if is_visible { Layer::Visible } else { Layer::Hidden };
    let (mut begin, mut is, mut all) = (0.0, state(middle(0.0)), Vec::new());
    let mut i = 1.0;
    while i < number {
        let next = state(middle(i));
        if next != is {
            let (mut low, mut high) = (middle(i - 1.0), middle(i));
            for _ in 0..HALVINGS {
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

/// What of a trace lies between two shares of its way.
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

/// Whether two lines of a view are one.
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
    use crate::built::Built;
    use crate::config::{Configuration, assign};
    use crate::design::Design;

    /// Length of a layer of the front view of an assembly, mm.
    fn drawn(assignments: &[&str], layer: Layer) -> f64 {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        let built = Built::new(Design::new(c).unwrap()).unwrap();
        let bodies: Vec<(&Part, Pose)> =
            built.assembly().filter_map(|b| Some((&b.part, b.part.pose?))).collect();
        let lines = front_lines(&bodies, -50.0, 0.0);
        lines.iter().filter(|(l, _)| *l == layer).map(|(_, trace)| length_mm(trace)).sum()
    }

    #[test]
    fn a_plate_is_seen_beside_the_switch_and_hidden_under_it() {
        let bare = drawn(&["layout.pins=[5, 8, 11]"], Layer::Visible);
        let flange = &["layout.pins=[5, 8, 11]", "mount.kind=flange"][..];
        // The outline of the flange and its four holes.
        let seen = drawn(flange, Layer::Visible) - bare;
        assert!(seen > 4.0 * 4.5 * 3.0 + 100.0, "{seen} mm");
        let hidden = drawn(flange, Layer::Hidden) - drawn(&["layout.pins=[5, 8, 11]"], Layer::Hidden);
        assert!(hidden > 0.0 && hidden < seen, "{hidden} mm");
    }

    #[test]
    fn a_covered_half_of_a_circle_is_hidden() {
        let circle = Trace::Circle(Point2::origin(), 2.0);
        let halves = pieces(&circle, |p, _| p.y > 0.0);
        let of = |wanted: Layer| -> f64 {
            halves.iter().filter(|(layer, _)| *layer == wanted).map(|(_, t)| length_mm(t)).sum()
        };
        assert!((of(Layer::Visible) - TAU).abs() < 1e-5 && (of(Layer::Hidden) - TAU).abs() < 1e-5);
        assert_eq!(pieces(&circle, |_, _| true), [(Layer::Visible, circle)]);
    }
}
