//! Shapes of contours: circles, hexagons, slots, ring segments, rectangles and letters.

use std::f64::consts::{FRAC_PI_6, PI};

use pinswitch_solid::profile::{Arc, Contour, Edge, Point2, Vector2};
use pinswitch_solid::solid::Solid;

/// A contour of straight edges with more corners than this is a letter.
const MOST_CORNERS: usize = 12;
/// Lengths in mm and angles in radians that differ by less are equal.
const EQUAL: f64 = 1e-6;

/// Returns whether two lengths or angles are equal, within the rounding of a construction.
#[must_use]
pub fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < EQUAL
}

/// Returns whether two points are equal, within the rounding of a construction.
pub(crate) fn same_point(a: Point2, b: Point2) -> bool {
    (a - b).norm() < EQUAL
}

/// Returns, for every ring of a solid, whether it outlines an engraved letter or an island in one.
#[must_use]
pub fn lettering(solid: &Solid) -> Vec<bool> {
    let rings: Vec<&Contour> = solid.rings().map(|(contour, _)| contour).collect();
    let is_straight = |c: &Contour| c.edges().iter().all(|e| matches!(e, Edge::Line));
    let is_letter = |c: &Contour| c.edges().len() > MOST_CORNERS && is_straight(c);
    let letters: Vec<_> = rings.iter().filter(|c| is_letter(c)).map(|c| c.bounds()).collect();
    rings
        .iter()
        .map(|contour| {
            let (low, high) = contour.bounds();
            let is_inside =
                |(a, b): &(Point2, Point2)| a.x < low.x && a.y < low.y && high.x < b.x && high.y < b.y;
            is_letter(contour) || (is_straight(contour) && letters.iter().any(is_inside))
        })
        .collect()
}

/// Returns centre and radius of a contour that is a full circle.
pub(crate) fn circle(contour: &Contour) -> Option<(Point2, f64)> {
    let mut arcs = contour.edges().iter().map(|e| if let Edge::Arc(a) = e { Some(a) } else { None });
    match (arcs.next()?, arcs.next()?, arcs.next()) {
        (Some(a), Some(b), None) if same_point(a.centre, b.centre) => Some((a.centre, a.radius_mm)),
        _ => None,
    }
}

/// Returns centre and half of the width across flats of a contour that is a regular hexagon.
#[must_use]
pub fn hexagon(contour: &Contour) -> Option<(Point2, f64)> {
    let corners = contour.corners();
    if corners.len() != 6 || contour.edges().iter().any(|e| !matches!(e, Edge::Line)) {
        return None;
    }
    let middle = nalgebra::center(&corners[0], &corners[3]);
    let radius = (corners[0] - middle).norm();
    let is_regular = (0..6).all(|i| {
        let (from, to) = contour.ends(i);
        same((from - middle).norm(), radius) && same((to - from).norm(), radius)
    });
    is_regular.then(|| (middle, radius * libm::cos(FRAC_PI_6)))
}

/// The arcs of a contour.
fn arcs(contour: &Contour) -> Vec<&Arc> {
    contour.edges().iter().filter_map(|e| if let Edge::Arc(a) = e { Some(a) } else { None }).collect()
}

/// Returns the centres of both ends of a straight slot with round ends, the one farther from the axis first, and the radius
/// of the ends.
pub(crate) fn slot(contour: &Contour) -> Option<(Point2, Point2, f64)> {
    let arcs = arcs(contour);
    let [a, b] = arcs[..] else { return None };
    let is_slot = contour.edges().len() == 4
        && same(a.radius_mm, b.radius_mm)
        && [a, b].iter().all(|arc| same(arc.sweep_rad.abs(), PI));
    let far_first = a.centre.coords.norm() >= b.centre.coords.norm();
    let (far, near) = if far_first { (a.centre, b.centre) } else { (b.centre, a.centre) };
    is_slot.then_some((far, near, a.radius_mm))
}

/// The section of a slot along an arc about the axis.
pub(crate) struct ArcSlotSection {
    pub(crate) radius_mm: f64,
    /// Half of the angle between the centres of its ends.
    pub(crate) half_rad: f64,
    pub(crate) width_mm: f64,
    pub(crate) outer_edge: Arc,
}

/// Returns the section of a slot along an arc about the axis.
pub(crate) fn arc_slot(contour: &Contour) -> Option<ArcSlotSection> {
    let arcs = arcs(contour);
    let (sides, caps): (Vec<&Arc>, Vec<&Arc>) = arcs.iter().partition(|a| is_about_axis(a));
    let ([a, b], [cap, _], 4) = (&sides[..], &caps[..], contour.edges().len()) else { return None };
    let outer = if a.radius_mm > b.radius_mm { a } else { b };
    Some(ArcSlotSection {
        radius_mm: cap.centre.coords.norm(),
        half_rad: libm::asin((cap.centre.x / cap.centre.coords.norm()).abs()),
        width_mm: (a.radius_mm - b.radius_mm).abs(),
        outer_edge: **outer,
    })
}

/// Returns inner radius, outer radius, first and last angle of a segment of a ring about the axis.
pub(crate) fn ring_segment(contour: &Contour) -> Option<(f64, f64, f64, f64)> {
    let arcs = arcs(contour);
    let [a, b] = arcs[..] else { return None };
    if contour.edges().len() != 4 || [a, b].iter().any(|arc| !is_about_axis(arc)) {
        return None;
    }
    let (inner, outer) = (a.radius_mm.min(b.radius_mm), a.radius_mm.max(b.radius_mm));
    let angles =
        contour.corners().iter().filter(|p| same(p.coords.norm(), inner)).map(|p| libm::atan2(p.x, p.y));
    let (from, to) = angles.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), a| (l.min(a), h.max(a)));
    Some((inner, outer, from, to))
}

/// Returns the lower left and the upper right corner of a rectangle whose sides are parallel to those of the paper.
pub(crate) fn rectangle(contour: &Contour) -> Option<(Point2, Point2)> {
    let is_rectangle = contour.edges().len() == 4
        && (0..4).all(|i| {
            let (from, to) = contour.ends(i);
            matches!(contour.edges()[i], Edge::Line) && (same(from.x, to.x) || same(from.y, to.y))
        });
    is_rectangle.then(|| contour.bounds())
}

/// Returns whether an arc is about the axis.
pub(crate) fn is_about_axis(arc: &Arc) -> bool {
    arc.centre.coords.norm() < EQUAL
}

/// Unit tangents of an edge at its start and at its end.
fn tangents(contour: &Contour, i: usize) -> [Vector2; 2] {
    let (from, to) = contour.ends(i);
    match contour.edges()[i] {
        Edge::Line => [(to - from).normalize(); 2],
        Edge::Arc(arc) => [from, to].map(|p| {
            let out = (p - arc.centre).normalize() * arc.sweep_rad.signum();
            Vector2::new(-out.y, out.x)
        }),
    }
}

/// Returns whether an edge is tangent to both of its neighbours.
pub(crate) fn is_smooth(contour: &Contour, i: usize) -> bool {
    let n = contour.edges().len();
    let [start, end] = tangents(contour, i);
    let (before, after) = (tangents(contour, (i + n - 1) % n)[1], tangents(contour, (i + 1) % n)[0]);
    (start - before).norm() < EQUAL && (end - after).norm() < EQUAL
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_hexagons_are_hexagons() {
        let at = |i: i32| Point2::new(2.0 * libm::cos(f64::from(i)), 2.0 * libm::sin(f64::from(i)));
        let corner = |i: i32| {
            let angle = f64::from(i) * std::f64::consts::FRAC_PI_3 + 0.3;
            Point2::new(1.0 + 2.0 * libm::cos(angle), 2.0 * libm::sin(angle))
        };
        let (middle, half) = hexagon(&Contour::polygon((0..6).map(corner).collect())).unwrap();
        assert!((middle - Point2::new(1.0, 0.0)).norm() < 1e-9 && (half - 3.0_f64.sqrt()).abs() < 1e-9);
        assert!(hexagon(&Contour::polygon((0..6).map(at).collect())).is_none());
    }
}
