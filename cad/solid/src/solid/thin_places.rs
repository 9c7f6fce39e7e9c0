//! Thin places: pairs of walls that face each other with little material between them.
//!
//! Distances are those between the exact lines and arcs of the profile at every common height,
//! without a mesh and without sampling. So one rule finds every thin place of every part.

use std::borrow::Cow;

use super::definition::{Solid, Wall};
use super::wall_section::{Directions, PlainEdge, SAME_MM, Section, nearest, tangent};
use crate::profile::{Arc, Contour, Edge, Point2};

/// A thin wall of a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinPlace {
    /// Distance between the two faces, mm.
    pub thickness_mm: f64,
    /// Middle of the wall, in the plane of the section.
    pub middle: Point2,
    /// Lower end of the wall, mm.
    pub from_mm: f64,
    /// Upper end of the wall, mm.
    pub to_mm: f64,
}

/// An edge of a wall, with its bounding box over all heights.
struct Face {
    wall: usize,
    edge: usize,
    /// The edge at every height, for an upright wall, and its directions.
    upright: Option<(Section, Directions)>,
    low: Point2,
    high: Point2,
    from_mm: f64,
    to_mm: f64,
}

/// Box of a face, which shows that most pairs of faces are not close.
struct Span {
    low: Point2,
    high_y_mm: f64,
    from_mm: f64,
    to_mm: f64,
}

impl Span {
    /// Whether the two are closer than `under_mm` in y, and have heights in common.
    fn meets(&self, other: &Self, under_mm: f64) -> bool {
        other.low.y <= self.high_y_mm + under_mm
            && self.low.y <= other.high_y_mm + under_mm
            && self.to_mm.min(other.to_mm) > self.from_mm.max(other.from_mm) + SAME_MM
    }
}

impl Solid {
    /// Returns every pair of faces closer than `under_mm` through material, the closest first.
    /// Walls that are lower than thick are excluded: they are steps, such as the floor of an
    /// engraved letter.
    pub fn thin_places(&self, under_mm: f64) -> Vec<ThinPlace> {
        let mut faces = self.faces();
        faces.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
        let spans: Vec<Span> = faces.iter().map(Face::span).collect();
        let mut places = Vec::new();
        for (i, a) in faces.iter().enumerate() {
            let near = spans[i + 1..].iter().take_while(|b| b.low.x < a.high.x + under_mm);
            for (b, _) in faces[i + 1..].iter().zip(near).filter(|(_, span)| spans[i].meets(span, under_mm)) {
                let (from_mm, to_mm) = (a.from_mm.max(b.from_mm), a.to_mm.min(b.to_mm));
                // An upright wall is as thick at every height, and no step only if that is less than its height.
                let is_upright = a.upright.is_some() && b.upright.is_some();
                let under_mm = if is_upright { under_mm.min(to_mm - from_mm) } else { under_mm };
                if !a.is_apart(b, under_mm) {
                    places.extend(self.between(a, b, from_mm, to_mm, under_mm));
                }
            }
        }
        places.sort_by(|a, b| {
            let key = |p: &ThinPlace| [p.thickness_mm, p.from_mm, p.middle.x, p.middle.y];
            key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal)
        });
        places
    }

    fn faces(&self) -> Vec<Face> {
        let mut all = Vec::new();
        for (wall, Wall { lower, upper }) in self.walls.iter().enumerate() {
            let (lower, upper) = (&self.rings[lower.0], &self.rings[upper.0]);
            let is_upright = lower.contour == upper.contour;
            for edge in 0..lower.contour.edges().len() {
                let (a, b) = (lower.contour.edge_bounds(edge), upper.contour.edge_bounds(edge));
                let (low, high) = (a.0.inf(&b.0), a.1.sup(&b.1));
                let upright = is_upright.then(|| self.edge_at(wall, edge, 0.0)).map(|section| {
                    let directions = section.directions();
                    (section, directions)
                });
                all.push(Face { wall, edge, upright, low, high, from_mm: lower.z_mm, to_mm: upper.z_mm });
            }
        }
        all
    }

    /// The wall between two faces over their common heights, if it is thin.
    fn between(&self, a: &Face, b: &Face, from_mm: f64, to_mm: f64, under_mm: f64) -> Option<ThinPlace> {
        let are_upright = a.upright.is_some() && b.upright.is_some();
        // The mean of a slanted wall needs both ends, including one that is not thin.
        let within_mm = if are_upright { under_mm } else { f64::INFINITY };
        let at = |z_mm: f64| {
            let (a, b) = (self.face_at(a, z_mm), self.face_at(b, z_mm));
            nearest(&a, &b, within_mm)
        };
        let below = at(from_mm);
        let above = if are_upright { below } else { at(to_mm) };
        let thickness = |place: Option<(f64, Point2)>| place.map_or(f64::INFINITY, |p| p.0);
        let (thickness_mm, middle) = if thickness(above) < thickness(below) { above? } else { below? };
        // The mean thickness decides whether a slanted wall is a step; a wall with one end only is
        // not.
        let mean = f64::midpoint(thickness(below), thickness(above));
        let is_step = to_mm - from_mm <= if mean.is_finite() { mean } else { thickness_mm };
        (thickness_mm < under_mm && !is_step).then_some(ThinPlace { thickness_mm, middle, from_mm, to_mm })
    }

    fn face_at<'a>(&self, face: &'a Face, z_mm: f64) -> Cow<'a, Section> {
        if let Some((section, _)) = &face.upright {
            return Cow::Borrowed(section);
        }
        let Wall { lower, upper } = self.walls[face.wall];
        let (lower, upper) = (&self.rings[lower.0], &self.rings[upper.0]);
        let share = (z_mm - lower.z_mm) / (upper.z_mm - lower.z_mm);
        Cow::Owned(self.edge_at(face.wall, face.edge, share))
    }

    /// An edge of a wall at a share of its height.
    fn edge_at(&self, wall: usize, edge: usize, share: f64) -> Section {
        let Wall { lower, upper } = self.walls[wall];
        let (lower, upper) = (&self.rings[lower.0].contour, &self.rings[upper.0].contour);
        let n = lower.edges().len();
        let at = |i: usize| edge_between(lower, upper, i % n, share);
        let (before, after) = (at(edge + n - 1), at(edge + 1));
        Section::new(at(edge), tangent(&before, 1.0), tangent(&after, 0.0))
    }
}

/// Edge `i` at a share of the height from `lower` to `upper`.
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

impl Face {
    fn span(&self) -> Span {
        Span { low: self.low, high_y_mm: self.high.y, from_mm: self.from_mm, to_mm: self.to_mm }
    }

    /// Whether no wall is between this face and another one: it is further away than `under_mm` at every height, by its box or
    /// the disc around that, or the two do not face each other.
    fn is_apart(&self, other: &Self, under_mm: f64) -> bool {
        other.low.y > self.high.y + under_mm
            || self.low.y > other.high.y + under_mm
            || self.is_averted(other)
            || self.is_beyond(other, under_mm)
            || other.is_beyond(self, under_mm)
    }

    /// Whether no direction through material from this face is one to the other.
    fn is_averted(&self, other: &Self) -> bool {
        match (&self.upright, &other.upright) {
            (Some((_, a)), Some((_, b))) => a.are_averted(b),
            _ => false,
        }
    }

    /// Whether the disc around the box of another face is further away than `under_mm` from the
    /// line or circle of this one.
    fn is_beyond(&self, other: &Self, under_mm: f64) -> bool {
        self.upright.as_ref().is_some_and(|(section, _)| {
            let middle = nalgebra::center(&other.low, &other.high);
            section.offset_mm(middle) > under_mm + 0.5 * (other.high - other.low).norm()
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::definition::Facing;
    use super::*;
    use crate::profile::Pen;
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
    fn a_thick_plate_has_no_thin_place() {
        let hole = Contour::circle(Point2::new(5.0, 5.0), 2.0).reversed();
        assert_eq!(plate(&[hole]).thin_places(2.9), []);
        assert_eq!(plate(&[]).thin_places(9.9), []);
    }

    #[test]
    fn walls_around_holes_are_measured() {
        let near_edge = Contour::circle(Point2::new(5.0, 2.6), 2.0).reversed();
        let places = plate(&[near_edge]).thin_places(0.9);
        assert!((places[0].thickness_mm - 0.6).abs() < 1e-12, "{places:?}");
        assert!((places[0].middle - Point2::new(5.0, 0.3)).norm() < 1e-9 && places[0].to_mm == 4.0);
        let two = [4.0, 8.5].map(|x| Contour::circle(Point2::new(x, 5.0), 2.0).reversed());
        assert!((plate(&two).thin_places(0.9)[0].thickness_mm - 0.5).abs() < 1e-12);
        // Corner against corner, across a diagonal.
        let square = rectangle(4.0, 3.0, 2.0, 2.0).reversed();
        let beyond = rectangle(6.3, 5.4, 2.0, 2.0).reversed();
        assert!((plate(&[square, beyond]).thin_places(0.9)[0].thickness_mm - 0.5).abs() < 1e-12);
    }

    #[test]
    fn cones_are_measured_at_their_widest() {
        let mut solid = Solid::new();
        let (bottom, top) = solid.extrude(&rectangle(0.0, 0.0, 20.0, 10.0), 0.0, 4.0);
        let circle = |r: f64| Contour::circle(Point2::new(5.0, 5.0), r).reversed();
        let (low, high) = (solid.ring(circle(1.0), 0.0), solid.ring(circle(4.5), 4.0));
        solid.wall(low, high);
        solid.cap(Facing::Down, bottom, &[low]);
        let letter = solid.pocket(&rectangle(19.4, 4.0, 0.3, 2.0).reversed(), &[], 3.8, 4.0);
        solid.cap(Facing::Up, top, &[high, letter]);
        let places = solid.thin_places(0.9);
        assert!((places[0].thickness_mm - 0.5).abs() < 1e-9, "{places:?}");
        assert!(places.iter().all(|p| p.middle.x < 12.0), "{places:?}");
    }

    #[test]
    fn a_rounded_corner_is_not_a_wall() {
        let rounded = Pen::at(Point2::new(0.0, 0.2))
            .arc_to(Point2::new(0.2, 0.2), Point2::new(0.2, 0.0), true)
            .line_to(Point2::new(8.0, 0.0))
            .line_to(Point2::new(8.0, 8.0))
            .line_to(Point2::new(0.0, 8.0))
            .close();
        assert_eq!(Solid::prism(&rounded, &[], 0.0, 5.0, 0.0).unwrap().thin_places(2.0), []);
        let pin = Contour::circle(Point2::origin(), 0.4);
        let places = Solid::prism(&pin, &[], 0.0, 5.0, 0.0).unwrap().thin_places(2.0);
        assert!((places[0].thickness_mm - 0.8).abs() < 1e-12, "{places:?}");
    }

    /// Of a regular polygon of 12 sides, each faces the opposite one and the four beside that.
    #[test]
    fn sides_that_do_not_face_each_other_are_averted() {
        let corners = (0..12).map(|i| crate::profile::polar(5.0, -TAU * f64::from(i) / 12.0)).collect();
        let solid = Solid::prism(&Contour::polygon(corners), &[], 0.0, 5.0, 0.0).unwrap();
        let faces = solid.faces();
        let averted = |a: &Face| faces.iter().filter(|b| a.is_averted(b)).count();
        assert!(faces.iter().all(|a| averted(a) == 7));
    }

    proptest! {
        /// Between averted edges there is no wall of any thickness.
        #[test]
        fn averted_edges_have_no_wall(radii in proptest::collection::vec(6.0..9.0f64, 6..16), hole in 0.2..1.5f64) {
            let count = radii.len() as f64;
            let corner = |(i, r): (usize, &f64)| crate::profile::polar(*r, -TAU * i as f64 / count);
            let outline = Contour::polygon(radii.iter().enumerate().map(corner).collect());
            let ring = Contour::circle(Point2::new(0.1, 0.05), hole.min(0.5)).reversed();
            let solid = Solid::prism(&outline, &[ring], 0.0, 500.0, 0.0).unwrap();
            let faces = solid.faces();
            let mut walls = 0;
            for (i, a) in faces.iter().enumerate() {
                for b in &faces[i + 1..] {
                    let is_wall = solid.between(a, b, 0.0, 500.0, 1e3).is_some();
                    walls += usize::from(is_wall);
                    prop_assert!(!(is_wall && a.is_averted(b)), "{} and {}", a.edge, b.edge);
                }
            }
            prop_assert!(walls > 0);
        }

        /// The thickness between two holes is the exact distance of their circles.
        #[test]
        fn the_thinnest_place_is_the_least_distance(x in 6.0..9.0f64, y in 3.0..7.0f64, r in 0.5..2.0f64) {
            let (one, two) = (Contour::circle(Point2::new(4.0, 5.0), 1.0), Contour::circle(Point2::new(x, y), r));
            let exact = (Point2::new(x, y) - Point2::new(4.0, 5.0)).norm() - 1.0 - r;
            prop_assume!(exact > 0.01);
            let places = plate(&[one.reversed(), two.reversed()]).thin_places(exact + 0.1);
            prop_assert!(places.iter().any(|p| (p.thickness_mm - exact).abs() < 1e-9), "{places:?}, {exact}");
        }
    }
}
