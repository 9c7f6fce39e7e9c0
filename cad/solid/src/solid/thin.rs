//! Thin places: where two walls of a solid face each other through little material.
//!
//! Distances are those between the exact lines and arcs of the profile, at every height at which both walls stand; no
//! mesh and no sampling takes part. So one rule finds every thin place of every part, whatever its form.

use std::borrow::Cow;

use super::{Solid, Wall};
use crate::profile::{Arc, Contour, Edge, Point2, Vector2};

/// Two faces bound a wall if the way between them leaves either within this angle of its normal (cosine of 35 degrees):
/// the two sides of a rounded corner, which lie at 45 degrees, do not.
const FACING: f64 = 0.82;
/// Points closer than this are one, mm.
const SAME_MM: f64 = 1e-9;

/// A place where a solid is thin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinPlace {
    /// Material between the two faces, mm.
    pub thickness_mm: f64,
    /// Middle of the wall, in the plane of the sections.
    pub middle: Point2,
    /// Height at which the wall begins, mm.
    pub from_mm: f64,
    /// Height at which it ends, mm.
    pub to_mm: f64,
}

/// One edge of one wall, as a box around all its heights.
struct Face {
    wall: usize,
    edge: usize,
    /// Of a wall that stands upright, the edge as it is at every height.
    upright: Option<Section>,
    low: Point2,
    high: Point2,
    from_mm: f64,
    to_mm: f64,
}

/// An edge at one height, with the directions of its neighbours where they meet.
#[derive(Clone)]
struct Section {
    from: Point2,
    to: Point2,
    arc: Option<Arc>,
    /// Tangent at the end of the edge before, and at the start of the edge after.
    before: Vector2,
    after: Vector2,
}

impl Solid {
    /// Every pair of faces with less than `under_mm` of material between them, the thinnest first. A wall that is lower
    /// than it is thick is none: it is a step, such as the floor of an engraved letter.
    pub fn thin_places(&self, under_mm: f64) -> Vec<ThinPlace> {
        let mut faces = self.faces();
        faces.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
        let mut found = Vec::new();
        for (i, a) in faces.iter().enumerate() {
            let near = faces[i + 1..].iter().take_while(|b| b.low.x < a.high.x + under_mm);
            for b in near.filter(|b| !a.is_apart(b, under_mm)) {
                let (from_mm, to_mm) = (a.from_mm.max(b.from_mm), a.to_mm.min(b.to_mm));
                if to_mm > from_mm + SAME_MM {
                    found.extend(self.between(a, b, from_mm, to_mm, under_mm));
                }
            }
        }
        found.sort_by(|a, b| {
            let key = |p: &ThinPlace| [p.thickness_mm, p.from_mm, p.middle.x, p.middle.y];
            key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal)
        });
        found
    }

    fn faces(&self) -> Vec<Face> {
        let mut all = Vec::new();
        for (wall, Wall { lower, upper }) in self.walls.iter().enumerate() {
            let (lower, upper) = (&self.rings[lower.0], &self.rings[upper.0]);
            let is_upright = lower.contour == upper.contour;
            for edge in 0..lower.contour.edges().len() {
                let (a, b) = (lower.contour.edge_bounds(edge), upper.contour.edge_bounds(edge));
                let (low, high) = (a.0.inf(&b.0), a.1.sup(&b.1));
                let upright = is_upright.then(|| self.edge_at(wall, edge, 0.0));
                all.push(Face { wall, edge, upright, low, high, from_mm: lower.z_mm, to_mm: upper.z_mm });
            }
        }
        all
    }

    /// What is between two faces over the heights at which both stand, if it is thin.
    fn between(&self, a: &Face, b: &Face, from_mm: f64, to_mm: f64, under_mm: f64) -> Option<ThinPlace> {
        let are_upright = a.upright.is_some() && b.upright.is_some();
        // Of a wall that leans, the end that is not thin is measured, too: the mean of both is asked for below.
        let within_mm = if are_upright { under_mm } else { f64::INFINITY };
        let at = |z_mm: f64| {
            let (a, b) = (self.face_at(a, z_mm), self.face_at(b, z_mm));
            nearest(&a, &b, within_mm)
        };
        let below = at(from_mm);
        let above = if are_upright { below } else { at(to_mm) };
        let thickness = |place: Option<(f64, Point2)>| place.map_or(f64::INFINITY, |p| p.0);
        let (thickness_mm, middle) = if thickness(above) < thickness(below) { above? } else { below? };
        // Of a wall that leans, the mean tells whether it is higher than thick; where one end faces nothing, it is.
        let mean = f64::midpoint(thickness(below), thickness(above));
        let is_step = to_mm - from_mm <= if mean.is_finite() { mean } else { thickness_mm };
        (thickness_mm < under_mm && !is_step).then_some(ThinPlace { thickness_mm, middle, from_mm, to_mm })
    }

    fn face_at<'a>(&self, face: &'a Face, z_mm: f64) -> Cow<'a, Section> {
        if let Some(section) = &face.upright {
            return Cow::Borrowed(section);
        }
        let Wall { lower, upper } = self.walls[face.wall];
        let (lower, upper) = (&self.rings[lower.0], &self.rings[upper.0]);
        let share = (z_mm - lower.z_mm) / (upper.z_mm - lower.z_mm);
        Cow::Owned(self.edge_at(face.wall, face.edge, share))
    }

    /// An edge of a wall at a share of the way up.
    fn edge_at(&self, wall: usize, edge: usize, share: f64) -> Section {
        let Wall { lower, upper } = self.walls[wall];
        let (lower, upper) = (&self.rings[lower.0].contour, &self.rings[upper.0].contour);
        let n = lower.edges().len();
        let at = |i: usize| edge_between(lower, upper, i % n, share);
        let (from, to, arc) = at(edge);
        let (before, after) = (at(edge + n - 1), at(edge + 1));
        Section { from, to, arc, before: tangent(&before, 1.0), after: tangent(&after, 0.0) }
    }
}

type PlainEdge = (Point2, Point2, Option<Arc>);

/// Edge `i` at a share of the way from `lower` to `upper`.
fn edge_between(lower: &Contour, upper: &Contour, i: usize, share: f64) -> PlainEdge {
    let mix = |a: Point2, b: Point2| a + (b - a) * share;
    let ((from, to), (from_up, to_up)) = (lower.ends(i), upper.ends(i));
    let (from, to) = (mix(from, from_up), mix(to, to_up));
    let arc = match (&lower.edges()[i], &upper.edges()[i]) {
        (Edge::Arc(a), Edge::Arc(_)) if share <= 0.0 => Some(*a),
        (Edge::Arc(a), Edge::Arc(b)) => {
            Some(Arc::between(mix(a.centre, b.centre), from, to, a.sweep_rad > 0.0))
        }
        _ => None,
    };
    (from, to, arc)
}

fn tangent((from, to, arc): &PlainEdge, share: f64) -> Vector2 {
    match arc {
        Some(arc) => arc.tangent_at(share),
        None => (to - from).try_normalize(0.0).unwrap_or_else(Vector2::zeros),
    }
}

/// The shortest way through material between two edges, if it is shorter than `within_mm`: its length, and its middle.
fn nearest(a: &Section, b: &Section, within_mm: f64) -> Option<(f64, Point2)> {
    let mut best: Option<(f64, Point2)> = None;
    // Whether an arc reaches its point is asked last: it takes longest to tell.
    let mut consider = |p: Spot, q: Spot| {
        let length = (q.point - p.point).norm();
        if length > SAME_MM
            && length < best.map_or(within_mm, |(least, _)| least)
            && a.holds(p)
            && b.holds(q)
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

/// A point of an edge; one in a direction from an arc's centre lies on the arc only if that reaches there.
#[derive(Clone, Copy)]
struct Spot {
    point: Point2,
    radial: Option<Vector2>,
}

impl Spot {
    fn end(point: Point2) -> Self {
        Self { point, radial: None }
    }

    fn on(arc: &Arc, radial: Vector2) -> Self {
        Self { point: arc.centre + radial * arc.radius_mm, radial: Some(radial) }
    }
}

impl Face {
    /// Whether another face is further away than `under_mm` at every height: its box, or the disc around that.
    fn is_apart(&self, other: &Self, under_mm: f64) -> bool {
        other.low.y > self.high.y + under_mm
            || self.low.y > other.high.y + under_mm
            || self.is_beyond(other, under_mm)
            || other.is_beyond(self, under_mm)
    }

    /// Whether the disc around another face's box is further away than `under_mm` from the line or circle of this one.
    fn is_beyond(&self, other: &Self, under_mm: f64) -> bool {
        self.upright.as_ref().is_some_and(|section| {
            let middle = nalgebra::center(&other.low, &other.high);
            section.offset_mm(middle) > under_mm + 0.5 * (other.high - other.low).norm()
        })
    }
}

impl Section {
    /// Distance of a point from the line or circle that this edge is a part of, mm.
    fn offset_mm(&self, point: Point2) -> f64 {
        match &self.arc {
            Some(arc) => ((point - arc.centre).norm() - arc.radius_mm).abs(),
            None => {
                let along = self.to - self.from;
                along.perp(&(point - self.from)).abs() / along.norm()
            }
        }
    }

    /// Points from which the shortest way to `other` can start: the ends, and where an arc is parallel to it.
    fn stations(&self, other: &Self) -> [Option<Spot>; 4] {
        let mut all = [Some(Spot::end(self.from)), Some(Spot::end(self.to)), None, None];
        if let Some(arc) = &self.arc {
            let towards = match &other.arc {
                Some(o) => (o.centre - arc.centre).try_normalize(SAME_MM),
                None => (other.to - other.from).try_normalize(SAME_MM).map(|t| Vector2::new(-t.y, t.x)),
            };
            // Arcs about one centre are parallel all along.
            let towards = towards.unwrap_or_else(|| (arc.point_at(0.5, 1.0) - arc.centre).normalize());
            all[2] = Some(Spot::on(arc, towards));
            all[3] = Some(Spot::on(arc, -towards));
        }
        all
    }

    /// Points that are nearest to `point`: on an arc also the furthest, which lies across its inside.
    fn feet(&self, point: Point2) -> [Option<Spot>; 4] {
        let mut feet = [Some(Spot::end(self.from)), Some(Spot::end(self.to)), None, None];
        match &self.arc {
            Some(arc) => {
                if let Some(radial) = (point - arc.centre).try_normalize(SAME_MM) {
                    feet[2] = Some(Spot::on(arc, radial));
                    feet[3] = Some(Spot::on(arc, -radial));
                }
            }
            None => {
                let along = self.to - self.from;
                let share = (point - self.from).dot(&along) / along.norm_squared();
                feet[2] = (0.0..=1.0).contains(&share).then(|| Spot::end(self.from + along * share));
            }
        }
        feet
    }

    /// Whether a spot lies on this edge.
    fn holds(&self, spot: Spot) -> bool {
        match (&self.arc, spot.radial) {
            (Some(arc), Some(radial)) => arc.covers(libm::atan2(radial.y, radial.x)),
            _ => true,
        }
    }

    /// Whether a way that leaves `point` of this edge in `direction` starts into the material, about at a right angle, or
    /// at a corner that stands into the material, between its two sides.
    fn faces(&self, point: Point2, direction: Vector2) -> bool {
        let inwards = |t: Vector2| Vector2::new(-t.y, t.x);
        let own = match &self.arc {
            // To the left of its direction: towards the centre where it runs counter-clockwise.
            Some(arc) => (arc.centre - point) * (arc.sweep_rad.signum() / arc.radius_mm),
            None => inwards((self.to - self.from).normalize()),
        };
        if own.dot(&direction) >= FACING {
            return true;
        }
        let between = |first: Vector2, second: Vector2| {
            let (first_in, second_in) = (inwards(first), inwards(second));
            // The outline turns away from the material: every direction between the two normals is nearest to the corner.
            first.perp(&second) < 0.0 && first_in.perp(&direction) <= 0.0 && direction.perp(&second_in) <= 0.0
        };
        let here: PlainEdge = (self.from, self.to, self.arc);
        (point == self.from && between(self.before, tangent(&here, 0.0)))
            || (point == self.to && between(tangent(&here, 1.0), self.after))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::Pen;
    use crate::solid::Facing;
    use proptest::prelude::*;

    fn rectangle(x: f64, y: f64, wide: f64, high: f64) -> Contour {
        Contour::polygon(
            [(0.0, 0.0), (wide, 0.0), (wide, high), (0.0, high)]
                .map(|(dx, dy)| Point2::new(x + dx, y + dy))
                .to_vec(),
        )
    }

    fn plate(holes: &[Contour]) -> Solid {
        Solid::prism(&rectangle(0.0, 0.0, 20.0, 10.0), holes, 0.0, 4.0, 0.0).unwrap()
    }

    #[test]
    fn a_plate_with_room_around_its_holes_has_no_thin_place() {
        let hole = Contour::circle(Point2::new(5.0, 5.0), 2.0).reversed();
        assert_eq!(plate(&[hole]).thin_places(2.9), []);
        assert_eq!(plate(&[]).thin_places(9.9), []);
    }

    #[test]
    fn walls_between_holes_and_to_edges_are_measured() {
        let near_edge = Contour::circle(Point2::new(5.0, 2.6), 2.0).reversed();
        let found = plate(&[near_edge]).thin_places(0.9);
        assert!((found[0].thickness_mm - 0.6).abs() < 1e-12, "{found:?}");
        assert!((found[0].middle - Point2::new(5.0, 0.3)).norm() < 1e-9 && found[0].to_mm == 4.0);
        let two = [4.0, 8.5].map(|x| Contour::circle(Point2::new(x, 5.0), 2.0).reversed());
        assert!((plate(&two).thin_places(0.9)[0].thickness_mm - 0.5).abs() < 1e-12);
        // Corner against corner, across a diagonal.
        let square = rectangle(4.0, 3.0, 2.0, 2.0).reversed();
        let beyond = rectangle(6.3, 5.4, 2.0, 2.0).reversed();
        assert!((plate(&[square, beyond]).thin_places(0.9)[0].thickness_mm - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_cone_is_measured_where_it_is_widest_and_a_shallow_pocket_is_no_wall() {
        let mut solid = Solid::new();
        let (bottom, top) = solid.extrude(&rectangle(0.0, 0.0, 20.0, 10.0), 0.0, 4.0);
        let circle = |r: f64| Contour::circle(Point2::new(5.0, 5.0), r).reversed();
        let (low, high) = (solid.ring(circle(1.0), 0.0), solid.ring(circle(4.5), 4.0));
        solid.wall(low, high);
        solid.cap(Facing::Down, bottom, &[low]);
        let letter = solid.pocket(&rectangle(19.4, 4.0, 0.3, 2.0).reversed(), &[], 3.8, 4.0);
        solid.cap(Facing::Up, top, &[high, letter]);
        let found = solid.thin_places(0.9);
        assert!((found[0].thickness_mm - 0.5).abs() < 1e-9, "{found:?}");
        assert!(found.iter().all(|p| p.middle.x < 12.0), "{found:?}");
    }

    #[test]
    fn a_rounded_corner_is_no_wall_and_a_pin_is() {
        let rounded = Pen::at(Point2::new(0.0, 0.2))
            .arc_to(Point2::new(0.2, 0.2), Point2::new(0.2, 0.0), true)
            .line_to(Point2::new(8.0, 0.0))
            .line_to(Point2::new(8.0, 8.0))
            .line_to(Point2::new(0.0, 8.0))
            .close();
        assert_eq!(Solid::prism(&rounded, &[], 0.0, 5.0, 0.0).unwrap().thin_places(2.0), []);
        let pin = Contour::circle(Point2::origin(), 0.4);
        let found = Solid::prism(&pin, &[], 0.0, 5.0, 0.0).unwrap().thin_places(2.0);
        assert!((found[0].thickness_mm - 0.8).abs() < 1e-12, "{found:?}");
    }

    proptest! {
        /// What is found is what sampled points of the two circles say.
        #[test]
        fn the_thinnest_place_is_the_least_distance(x in 6.0..9.0f64, y in 3.0..7.0f64, r in 0.5..2.0f64) {
            let (one, two) = (Contour::circle(Point2::new(4.0, 5.0), 1.0), Contour::circle(Point2::new(x, y), r));
            let exact = (Point2::new(x, y) - Point2::new(4.0, 5.0)).norm() - 1.0 - r;
            prop_assume!(exact > 0.01);
            let found = plate(&[one.reversed(), two.reversed()]).thin_places(exact + 0.1);
            prop_assert!(found.iter().any(|p| (p.thickness_mm - exact).abs() < 1e-9), "{found:?}, {exact}");
        }
    }
}
