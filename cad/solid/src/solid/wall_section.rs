//! An edge of a wall at one height, and the shortest segment through material between two of them.

use std::f64::consts::PI;

use crate::profile::{Arc, Point2, Vector2};

/// Two faces bound a wall if the segment between them is within this angle of both normals (cosine
/// of 35 degrees). The two sides of a rounded corner, at 45 degrees, do not.
const FACING: f64 = 0.82;
/// Distance up to which points are equal, mm.
pub(super) const SAME_MM: f64 = 1e-9;
/// Angle up to which directions are equal, rad.
const SAME_RAD: f64 = 1e-6;

/// An edge at one height, with the tangents of its neighbours.
#[derive(Clone)]
pub(super) struct Section {
    from: Point2,
    to: Point2,
    arc: Option<Arc>,
    /// Tangent at the end of the edge before, and at the start of the edge after.
    before: Vector2,
    after: Vector2,
}

/// Ends and arc of an edge.
pub(super) type PlainEdge = (Point2, Point2, Option<Arc>);

/// Returns the tangent of an edge at a share of its length.
pub(super) fn tangent((from, to, arc): &PlainEdge, share: f64) -> Vector2 {
    match arc {
        Some(arc) => arc.tangent_at(share),
        None => (to - from).try_normalize(0.0).unwrap_or_else(Vector2::zeros),
    }
}

/// The shortest segment through material between two edges, if shorter than `within_mm`: its length
/// and its middle.
pub(super) fn nearest(a: &Section, b: &Section, within_mm: f64) -> Option<(f64, Point2)> {
    let mut best: Option<(f64, Point2)> = None;
    // The slowest conditions come last.
    let mut consider = |p: Candidate, q: Candidate| {
        let length = (q.point - p.point).norm();
        if length > SAME_MM
            && length < best.map_or(within_mm, |(least, _)| least)
            && a.contains(p)
            && b.contains(q)
            && a.faces(p.point, (q.point - p.point) / length)
            && b.faces(q.point, (p.point - q.point) / length)
        {
            best = Some((length, nalgebra::center(&p.point, &q.point)));
        }
    };
    for p in a.stations(b).into_iter().flatten() {
        b.feet(p.point).into_iter().flatten().for_each(|q| consider(p, q));
    }
    for q in b.stations(a).into_iter().flatten() {
        a.feet(q.point).into_iter().flatten().for_each(|p| consider(p, q));
    }
    best
}

/// A candidate point of an edge. One on the circle of an arc is on the edge only if the arc covers
/// its direction.
#[derive(Clone, Copy)]
struct Candidate {
    point: Point2,
    radial: Option<Vector2>,
}

impl Candidate {
    fn end(point: Point2) -> Self {
        Self { point, radial: None }
    }

    fn on(arc: &Arc, radial: Vector2) -> Self {
        Self { point: arc.centre + radial * arc.radius_mm, radial: Some(radial) }
    }
}

/// Directions in which a wall may be behind an edge: all within an angle of `middle`, a unit vector.
#[derive(Clone, Copy)]
pub(super) struct Directions {
    middle: Vector2,
    /// Cosine and sine of the angle, up to half a turn: there are many edges, and more pairs of them.
    cos: f64,
    sin: f64,
}

impl Directions {
    /// Whether none of these is opposite to one of the others.
    pub(super) fn are_averted(&self, other: &Self) -> bool {
        // The sum of both angles is less than half a turn, and the turn to the opposite direction more than that.
        self.sin * other.cos + self.cos * other.sin > 0.0
            && -self.middle.dot(&other.middle) < self.cos * other.cos - self.sin * other.sin
    }
}

/// Returns the left of a direction.
fn inwards(tangent: Vector2) -> Vector2 {
    Vector2::new(-tangent.y, tangent.x)
}

impl Section {
    pub(super) fn new((from, to, arc): PlainEdge, before: Vector2, after: Vector2) -> Self {
        Self { from, to, arc, before, after }
    }

    /// All directions that [`Section::faces`] accepts at any point: those close to a normal, and up to the normals of the
    /// neighbours at corners that point into the material.
    pub(super) fn directions(&self) -> Directions {
        let (first, last) = self.tangents();
        let (middle, mut cos, mut sin) = match &self.arc {
            Some(arc) => {
                let half_rad = 0.5 * arc.sweep_rad;
                let (middle_rad, reach_rad) = (arc.start_rad + half_rad, half_rad.abs() + libm::acos(FACING));
                let outwards = Vector2::new(libm::cos(middle_rad), libm::sin(middle_rad));
                let reach_rad = reach_rad.min(PI);
                (-outwards * arc.sweep_rad.signum(), libm::cos(reach_rad), libm::sin(reach_rad))
            }
            None => (inwards(first), FACING, (1.0 - FACING * FACING).sqrt()),
        };
        for (before, after, neighbour) in [(self.before, first, self.before), (last, self.after, self.after)]
        {
            let normal = inwards(neighbour);
            if before.perp(&after) < 0.0 && middle.dot(&normal) < cos {
                (cos, sin) = (middle.dot(&normal), middle.perp(&normal).abs());
            }
        }
        (cos, sin) = (cos - SAME_RAD * sin, sin + SAME_RAD * cos);
        // All directions, also for an edge without a direction.
        if sin < 0.0 || middle == Vector2::zeros() {
            (cos, sin) = (-1.0, 0.0);
        }
        Directions { middle, cos, sin }
    }

    /// Returns the tangents at both ends.
    fn tangents(&self) -> (Vector2, Vector2) {
        let here: PlainEdge = (self.from, self.to, self.arc);
        let first = tangent(&here, 0.0);
        (first, if self.arc.is_some() { tangent(&here, 1.0) } else { first })
    }

    /// Distance of a point from the line or circle of this edge, mm.
    pub(super) fn offset_mm(&self, point: Point2) -> f64 {
        match &self.arc {
            Some(arc) => ((point - arc.centre).norm() - arc.radius_mm).abs(),
            None => {
                let along = self.to - self.from;
                along.perp(&(point - self.from)).abs() / along.norm()
            }
        }
    }

    /// Points where the shortest segment to `other` can start: the ends, and points of an arc that
    /// are parallel to it.
    fn stations(&self, other: &Self) -> [Option<Candidate>; 4] {
        let mut all = [Some(Candidate::end(self.from)), Some(Candidate::end(self.to)), None, None];
        if let Some(arc) = &self.arc {
            let towards = match &other.arc {
                Some(o) => (o.centre - arc.centre).try_normalize(SAME_MM),
                None => (other.to - other.from).try_normalize(SAME_MM).map(inwards),
            };
            // Concentric arcs are parallel everywhere.
            let towards = towards.unwrap_or_else(|| (arc.point_at(0.5, 1.0) - arc.centre).normalize());
            all[2] = Some(Candidate::on(arc, towards));
            all[3] = Some(Candidate::on(arc, -towards));
        }
        all
    }

    /// Points closest to `point`; on an arc also the furthest, across its inside.
    fn feet(&self, point: Point2) -> [Option<Candidate>; 4] {
        let mut feet = [Some(Candidate::end(self.from)), Some(Candidate::end(self.to)), None, None];
        match &self.arc {
            Some(arc) => {
                if let Some(radial) = (point - arc.centre).try_normalize(SAME_MM) {
                    feet[2] = Some(Candidate::on(arc, radial));
                    feet[3] = Some(Candidate::on(arc, -radial));
                }
            }
            None => {
                let along = self.to - self.from;
                let share = (point - self.from).dot(&along) / along.norm_squared();
                feet[2] = (0.0..=1.0).contains(&share).then(|| Candidate::end(self.from + along * share));
            }
        }
        feet
    }

    /// Whether a candidate point is on this edge.
    fn contains(&self, candidate: Candidate) -> bool {
        match (&self.arc, candidate.radial) {
            (Some(arc), Some(radial)) => arc.covers(libm::atan2(radial.y, radial.x)),
            _ => true,
        }
    }

    /// Whether `direction` at `point` of this edge is into the material and close to the normal,
    /// or, at a corner that points into the material, between the normals of its two sides.
    fn faces(&self, point: Point2, direction: Vector2) -> bool {
        let own = match &self.arc {
            // The left of its direction: towards the centre for a counter-clockwise arc.
            Some(arc) => (arc.centre - point) * (arc.sweep_rad.signum() / arc.radius_mm),
            None => inwards((self.to - self.from).normalize()),
        };
        if own.dot(&direction) >= FACING {
            return true;
        }
        let between = |first: Vector2, second: Vector2| {
            let (first_in, second_in) = (inwards(first), inwards(second));
            // A corner that points into the material is closest for every direction between the two
            // normals.
            first.perp(&second) < 0.0 && first_in.perp(&direction) <= 0.0 && direction.perp(&second_in) <= 0.0
        };
        let here: PlainEdge = (self.from, self.to, self.arc);
        (point == self.from && between(self.before, tangent(&here, 0.0)))
            || (point == self.to && between(tangent(&here, 1.0), self.after))
    }
}
