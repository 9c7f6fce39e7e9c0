//! Arrows of motion: from a body toward the place where it goes, as far as the next body.

use super::illustration::Motion;
use pinswitch_solid::mesh::{Mesh, Point3, Vector3};

/// Least gap between a moved body and its place for an arrow between them, mm.
const LEAST_MM: f64 = 3.0;
/// Length of an arrow beyond a body, mm.
const BEYOND_MM: f64 = 10.0;
/// Places beside the middle where an arrow may be, in halves of the size of the bodies.
const BESIDE: f64 = 0.85;
/// Visible share of an arrow that suffices in the middle, and the number of its points that are examined.
const VISIBLE: f64 = 0.5;
const SAMPLES: u32 = 5;
/// Visible share of an arrow that an end on a body is worth.
const MET: f64 = 0.4;
/// Greatest distance of an arrow from the axis around which it is, mm, and the number of places up to there.
const AROUND_MM: f64 = 15.0;
const STEPS: u32 = 60;
/// Difference of heights of the same face, mm.
const SAME_MM: f64 = 1e-6;
/// Distance of a point of an arrow from the surface before which it is examined, mm.
const AIR_MM: f64 = 0.5;

/// A mesh with its bounds, which exclude most rays.
pub(super) struct Target<'a> {
    mesh: &'a Mesh,
    low: Point3,
    high: Point3,
}

impl<'a> Target<'a> {
    /// Creates a target; `None` for an empty mesh.
    pub(super) fn new(mesh: &'a Mesh) -> Option<Self> {
        let (low, high) = mesh.bounds()?;
        Some(Self { mesh, low, high })
    }

    /// Returns whether a ray may meet the mesh (Kay and Kajiya, 1986).
    fn may_meet(&self, from: Point3, direction: Vector3) -> bool {
        let (mut enter, mut leave) = (0.0, f64::INFINITY);
        for k in 0..3 {
            // Along an axis of which the ray has no part, the quotients are infinite, or NaN on a face.
            let ends = [self.low[k], self.high[k]].map(|end| (end - from[k]) / direction[k]);
            enter = f64::max(enter, ends[0].min(ends[1]));
            leave = f64::min(leave, ends[0].max(ends[1]));
        }
        enter <= leave
    }

    /// Distances along a ray to the triangles that it meets, mm.
    fn hits(&self, from: Point3, direction: Vector3) -> impl Iterator<Item = f64> {
        let triangles = self.may_meet(from, direction).then_some(&self.mesh.triangles);
        triangles
            .into_iter()
            .flatten()
            .filter_map(move |t| distance(t.map(|i| self.mesh.positions[i as usize]), from, direction))
    }
}

fn first_hit(targets: &[&Target<'_>], from: Point3, direction: Vector3) -> Option<f64> {
    targets.iter().flat_map(|target| target.hits(from, direction)).min_by(f64::total_cmp)
}

/// Returns the distance along a ray to a mesh, mm; `None` if the ray misses it. `direction` is a unit vector.
pub(crate) fn distance_to_mesh(mesh: &Mesh, from: Point3, direction: Vector3) -> Option<f64> {
    first_hit(&[&Target::new(mesh)?], from, direction)
}

fn is_hit(targets: &[&Target<'_>], from: Point3, direction: Vector3) -> bool {
    targets.iter().any(|target| target.hits(from, direction).next().is_some())
}

/// The motion of bodies.
pub(super) struct Way {
    /// Displacement from their place to where they are shown, mm.
    pub(super) by: Vector3,
    pub(super) motion: Motion,
    /// A point of the line on which the arrow is; `None` for where the bodies have material.
    pub(super) axis: Option<Point3>,
}

/// Where the arrow of bodies meets them: a point of their surface, and the half of their thickness there, mm.
#[derive(Clone, Copy)]
struct Contact {
    point: Point3,
    half_mm: f64,
}

/// Returns the first and the last point of the arrow of bodies. `others` are the bodies on which it ends; `toward_camera` is a
/// unit vector. `None` for bodies without a displacement.
///
/// The arrow is where the bodies have material, in their middle if it is visible there and ends on a body.
pub(super) fn motion_arrow(
    moved: &[&Target<'_>],
    others: &[&Target<'_>],
    way: &Way,
    toward_camera: Vector3,
) -> Option<[Point3; 2]> {
    let group = Group::new(moved, others, way, toward_camera)?;
    if let Some(axis) = way.axis {
        return group.around(axis).map(|contact| group.arrow(contact));
    }
    let middle = group.contact(group.front).or_else(|| group.hole());
    let visible = |contact: &Contact| group.visible(group.arrow(*contact));
    if let Some(middle) = middle.filter(|middle| group.is_met(middle) && visible(middle) >= VISIBLE) {
        return Some(group.arrow(middle));
    }
    let beside = group.beside();
    if let Some(middle) =
        middle.filter(|middle| !beside.iter().any(|c| group.is_met(c)) && visible(middle) >= VISIBLE)
    {
        return Some(group.arrow(middle));
    }
    // The first of the most visible ones, with a preference for those that end on a body.
    let merit = |contact: &Contact| visible(contact) + f64::from(u8::from(group.is_met(contact))) * MET;
    let best = middle.into_iter().chain(beside).map(|contact| (merit(&contact), contact));
    let best =
        best.reduce(|best, other| if other.0 > best.0 { other } else { best }).map(|(_, contact)| contact);
    let best = best.unwrap_or(group.in_air());
    if !way.motion.stays() && visible(&best) < VISIBLE {
        // The bodies hide the way behind them: the arrow goes on in front.
        return Some(beyond(&middle.unwrap_or(best), group.out));
    }
    Some(group.arrow(best))
}

/// Bodies that move together, and what is around them.
struct Group<'a> {
    moved: &'a [&'a Target<'a>],
    others: &'a [&'a Target<'a>],
    way: &'a Way,
    toward_camera: Vector3,
    /// Direction of the displacement.
    out: Vector3,
    /// Directions across it: toward the camera, and to the side.
    across: [Vector3; 2],
    /// Middle of the box of the bodies, and that of its face toward their place.
    centre: Point3,
    front: Point3,
    size: Vector3,
}

impl<'a> Group<'a> {
    fn new(
        moved: &'a [&'a Target<'a>],
        others: &'a [&'a Target<'a>],
        way: &'a Way,
        toward_camera: Vector3,
    ) -> Option<Self> {
        let out = way.by.try_normalize(1e-9)?;
        let bounds = moved.iter().map(|target| (target.low, target.high));
        let (low, high) = bounds.reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)))?;
        let sideways = (toward_camera - out * toward_camera.dot(&out)).try_normalize(1e-9);
        let sideways = sideways.unwrap_or_else(|| out.yzx().cross(&out).normalize());
        let (centre, size) = (nalgebra::center(&low, &high), high - low);
        let front = centre - out * (size.dot(&out.abs()) / 2.0);
        let across = [sideways, out.cross(&sideways)];
        Some(Self { moved, others, way, toward_camera, out, across, centre, front, size })
    }

    /// Half of the size of the box in a direction, mm.
    fn extent(&self, direction: Vector3) -> f64 {
        self.size.dot(&direction.abs()) / 2.0
    }

    /// The contact on the line through `place` along the displacement; `None` where it misses the bodies.
    fn contact(&self, place: Point3) -> Option<Contact> {
        let from = place - self.out;
        let distances = || self.moved.iter().flat_map(|target| target.hits(from, self.out));
        let (first, last) = (distances().min_by(f64::total_cmp)?, distances().max_by(f64::total_cmp)?);
        Some(Contact { point: from + self.out * first, half_mm: (last - first) / 2.0 })
    }

    /// The middle, as if it were material.
    fn in_air(&self) -> Contact {
        Contact { point: self.front, half_mm: self.extent(self.out) }
    }

    /// The middle of a hole, as in a nut; `None` if the middle is open to a side.
    fn hole(&self) -> Option<Contact> {
        let [sideways, across] = self.across;
        let sides = [sideways, -sideways, across, -across];
        sides.iter().all(|side| is_hit(self.moved, self.centre, *side)).then(|| self.in_air())
    }

    /// Contacts beside the middle, those toward the camera first.
    fn beside(&self) -> Vec<Contact> {
        let [sideways, across] = self.across;
        let places = [sideways, across, -across, -sideways].into_iter().flat_map(|direction| {
            [0.5, 1.0].map(|share| self.front + direction * (share * BESIDE * self.extent(direction)))
        });
        places.filter_map(|place| self.contact(place)).collect()
    }

    /// The contact in front of what is on an axis: at the foremost face around it, as near to the camera as it reaches.
    fn around(&self, axis: Point3) -> Option<Contact> {
        let level = self.out * (self.front - axis).dot(&self.out);
        let place =
            |step: u32| axis + level + self.across[0] * (f64::from(step) * AROUND_MM / f64::from(STEPS));
        let contacts = (1..=STEPS).filter_map(|step| self.contact(place(step)));
        let height = |c: &Contact| c.point.coords.dot(&self.out);
        contacts.reduce(|best, other| if height(&other) <= height(&best) + SAME_MM { other } else { best })
    }

    /// Returns whether the way from a contact meets a body.
    fn is_met(&self, contact: &Contact) -> bool {
        first_hit(self.others, contact.point, -self.out).is_some_and(|free| free <= self.way.by.norm())
    }

    /// The visible share of an arrow.
    fn visible(&self, [from, to]: [Point3; 2]) -> f64 {
        let at = |i: u32| from + (to - from) * ((f64::from(i) + 0.5) / f64::from(SAMPLES));
        let is_hidden = |place: Point3| {
            let place = place + self.toward_camera * AIR_MM;
            [self.moved, self.others].iter().any(|targets| is_hit(targets, place, self.toward_camera))
        };
        (0..SAMPLES).filter(|i| !is_hidden(at(*i))).count() as f64 / f64::from(SAMPLES)
    }

    fn arrow(&self, contact: Contact) -> [Point3; 2] {
        let Contact { point, half_mm } = contact;
        // To the body that they meet; otherwise to the middle of the place: the tips of long bodies, such as screws, end far
        // behind what receives them.
        let by_mm = self.way.by.norm();
        let length_mm = if by_mm - half_mm > LEAST_MM { by_mm - half_mm } else { by_mm };
        let free_mm = first_hit(self.others, point, -self.out);
        let free_mm = free_mm.filter(|free| (LEAST_MM..=by_mm + SAME_MM).contains(free));
        let end = point - self.out * free_mm.unwrap_or(length_mm);
        match self.way.motion.stays() {
            true => [point, end],
            false if (point - end).norm() > LEAST_MM => [end, point],
            false => beyond(&contact, self.out),
        }
    }
}

/// The arrow from the far side of the bodies away from them.
fn beyond(contact: &Contact, out: Vector3) -> [Point3; 2] {
    let back = contact.point + out * (2.0 * contact.half_mm);
    [back, back + out * BEYOND_MM]
}

/// The distance along a ray to a triangle (Möller and Trumbore, 1997); `None` if the ray misses it.
fn distance([a, b, c]: [Point3; 3], from: Point3, direction: Vector3) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(&ac);
    let determinant = ab.dot(&across);
    if determinant == 0.0 {
        return None;
    }
    let offset = from - a;
    let u = offset.dot(&across) / determinant;
    let along = offset.cross(&ab);
    let v = direction.dot(&along) / determinant;
    let t = ac.dot(&along) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_solid::profile::{ChordTolerance, Contour, Point2};
    use pinswitch_solid::solid::Solid;

    const UP: Vector3 = Vector3::new(0.0, 0.0, 10.0);

    fn prism(outer: &Contour, holes: &[Contour], low: f64, high: f64) -> Mesh {
        let solid = Solid::prism(outer, holes, low, high, 0.0).unwrap();
        solid.mesh(ChordTolerance::new(0.01).unwrap()).unwrap()
    }

    fn plate(low: f64, high: f64) -> Mesh {
        prism(&Contour::circle(Point2::origin(), 20.0), &[], low, high)
    }

    /// The arrow of a mesh seen from above at the front.
    fn arrow_of(moved: &Mesh, others: &[&Mesh], by: Vector3, motion: Motion) -> Option<[Point3; 2]> {
        let way = Way { by, motion, axis: None };
        let others: Vec<Target<'_>> = others.iter().filter_map(|mesh| Target::new(mesh)).collect();
        let camera = Vector3::new(0.0, 1.0, 0.3).normalize();
        motion_arrow(&[&Target::new(moved).unwrap()], &others.iter().collect::<Vec<_>>(), &way, camera)
    }

    fn is_near(arrow: Option<[Point3; 2]>, expected: [[f64; 3]; 2]) -> bool {
        let expected = expected.map(Point3::from);
        arrow.is_some_and(|a| a.iter().zip(expected).all(|(p, q)| (p - q).norm() < 0.05))
    }

    /// The arrow begins at the lower face and ends on the next body.
    #[test]
    fn arrows_end_on_the_next_body() {
        let lid = plate(15.0, 17.0);
        let heights = |base_top: f64, motion| {
            arrow_of(&lid, &[&plate(0.0, base_top)], UP, motion).map(|ends| ends.map(|p| p.z))
        };
        assert_eq!(heights(5.0, Motion::Into), Some([15.0, 5.0]));
        // Nothing is below: to the middle of the place.
        assert_eq!(heights(4.0, Motion::Into), Some([15.0, 6.0]));
        assert_eq!(heights(8.0, Motion::Into), Some([15.0, 8.0]));
        assert_eq!(heights(8.0, Motion::Away), Some([8.0, 15.0]));
    }

    /// A nut is put over the middle of its hole.
    #[test]
    fn holes_have_their_arrow_in_the_middle() {
        let hole = Contour::circle(Point2::origin(), 2.0);
        let nut = prism(&Contour::circle(Point2::origin(), 4.0), &[hole], 10.0, 12.0);
        let arrow = arrow_of(&nut, &[], UP, Motion::Into);
        assert!(is_near(arrow, [[0.0, 0.0, 10.0], [0.0, 0.0, 1.0]]), "{arrow:?}");
    }

    fn arch() -> Mesh {
        let corners = [(-20.0, 0.0), (-16.0, 0.0), (0.0, 18.0), (16.0, 0.0), (20.0, 0.0), (0.0, 22.0)];
        let corners = corners.map(|(x, y)| Point2::new(x, y)).to_vec();
        prism(&Contour::polygon(corners), &[], 0.0, 2.0)
    }

    /// The arrow of a rope over a wheel begins on the rope, not in the empty middle of its box.
    #[test]
    fn curved_bodies_have_their_arrow_on_their_material() {
        let arrow = arrow_of(&arch(), &[], Vector3::new(0.0, 10.0, 0.0), Motion::Flexible);
        assert!(is_near(arrow, [[0.0, 18.0, 1.0], [0.0, 10.0, 1.0]]), "{arrow:?}");
        // Put down flat, it has its empty middle below the camera's side.
        let [start, end] = arrow_of(&arch(), &[], UP, Motion::Into).unwrap();
        assert!((18.0..22.0).contains(&start.y) && start.z.abs() < 1e-9 && start.x == end.x, "{start}");
    }

    /// A lid has its arrow at the edge toward the camera if a wall hides its middle.
    #[test]
    fn arrows_are_where_they_are_visible() {
        let lid = plate(15.0, 17.0);
        let corners = [(-30.0, 5.0), (30.0, 5.0), (30.0, 7.0), (-30.0, 7.0)];
        let wall =
            prism(&Contour::polygon(corners.map(|(x, y)| Point2::new(x, y)).to_vec()), &[], -20.0, 60.0);
        let [start, _] = arrow_of(&lid, &[&wall], UP, Motion::Into).unwrap();
        assert!(start.y > 7.0, "{start}");
    }

    #[test]
    fn bodies_in_their_place_have_no_arrow() {
        assert_eq!(arrow_of(&plate(0.0, 1.0), &[], Vector3::zeros(), Motion::Still), None);
    }
}
