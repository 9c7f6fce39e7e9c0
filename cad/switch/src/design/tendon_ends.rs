//! The straight ends of the tendon beyond the wrap, and their distances from each other, from the
//! guide pulley and from the sheath stop (cad/doc/dimensions.md, "Tendon"). All of these are at the
//! same height, so distances are computed in the plane.

use std::f64::consts::{FRAC_PI_2, PI};

use super::mounting::{Mounting, PULLEY_RADIUS_MM, SheathStop};
use super::{Dimensions, pulley_outer_mm};
use crate::config::MountKind;
use pinswitch_solid::profile::{Point2, Vector2, polar};

/// Length of an end in pictures if nothing shortens it, mm.
const SHOWN_MM: f64 = 20.0;
/// Least length of an end in pictures, mm.
const LEAST_SHOWN_MM: f64 = 1.0;
/// Gap between the tendon and bodies that it must not touch, mm.
const TENDON_AIR_MM: f64 = 1.0;
/// Length of an end without a pulley, mm: longer than every set.
const FAR_MM: f64 = 1e4;
/// Distance beyond the wrap within which crossing ends are reported, mm.
const NEAR_MM: f64 = 100.0;

/// An end of the tendon, which leaves the wrap along the tangent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TendonEnd {
    pub(super) start: Point2,
    /// Direction away from the wrap; a unit vector.
    pub(super) along: Vector2,
}

impl TendonEnd {
    fn up_to(&self, length_mm: f64) -> [Point2; 2] {
        [self.start, self.start + self.along * length_mm]
    }
}

impl Dimensions {
    /// Returns the end on the load side, and the other end.
    pub(super) fn tendon_ends(&self) -> [TendonEnd; 2] {
        [-1.0, 1.0].map(|side| {
            let outwards = polar(1.0, side * self.half_wrap_rad()).coords;
            let start = Point2::from(outwards * self.tendon_axis_radius_mm());
            TendonEnd { start, along: Vector2::new(outwards.y, -outwards.x) * side }
        })
    }

    /// Returns the tips of the ends in pictures, each with the direction of its pull: on the load side, and the other. On a
    /// joint, they are beyond anchor and proximal link.
    pub(crate) fn tendon_tips(&self) -> [(Point2, Vector2); 2] {
        if let Some(joint) = self.joint() {
            let contact = joint.contact(joint.assembled_deg);
            let ways = [
                [contact.anchor, joint.distal_end(&contact)],
                [joint.proximal.mouth(), joint.proximal_end()],
            ];
            return ways.map(|[from, tip]| (tip, (tip - from).normalize()));
        }
        let (ends, lengths) = (self.tendon_ends(), self.shown_ends_mm());
        [0, 1].map(|i| (ends[i].start + ends[i].along * lengths[i], ends[i].along))
    }

    /// Returns the lengths of the ends in pictures, mm: on the load side, which on the rig extends
    /// to the guide pulley, and on the other side. Ends that would meet are shortened. On a joint
    /// they extend beyond anchor and proximal link.
    pub fn shown_ends_mm(&self) -> [f64; 2] {
        if let Some(joint) = self.joint() {
            return joint.tendon_ends_mm();
        }
        let pulley = (self.configuration().mount.kind == MountKind::Rig)
            .then_some(self.configuration().mount.pulley_distance_mm);
        if self.fits(pulley, SHOWN_MM) {
            return [pulley.unwrap_or(SHOWN_MM), SHOWN_MM];
        }
        // Bisection to a hundredth of a millimetre, from the shortest length.
        let (mut fits, mut meets) = (LEAST_SHOWN_MM, SHOWN_MM);
        while meets - fits > 0.01 {
            let middle = f64::midpoint(fits, meets);
            if self.fits(pulley, middle) { fits = middle } else { meets = middle }
        }
        [pulley.unwrap_or(fits), fits]
    }

    /// Returns whether ends of this length clear each other, and the free end also clears the guide
    /// pulley.
    fn fits(&self, pulley_mm: Option<f64>, length_mm: f64) -> bool {
        if self.half_wrap_rad() <= FRAC_PI_2 {
            // The ends diverge.
            return true;
        }
        let [load, other] = self.tendon_ends();
        let free = other.up_to(length_mm);
        let apart = between_mm(load.up_to(pulley_mm.unwrap_or(length_mm)), free);
        let axle = self.mounting().and_then(|m| m.axle);
        let flanges = pulley_outer_mm(self.tendon_diameter_mm());
        let air = self.tendon_diameter_mm() / 2.0 + TENDON_AIR_MM;
        apart >= self.tendon_diameter_mm() + TENDON_AIR_MM
            && axle.is_none_or(|hole| from_segment_mm(hole.centre, free) >= flanges + air)
    }

    /// Returns whether ends of the least length clear each other.
    pub(super) fn ends_keep_clear(&self) -> bool {
        let rig = self.configuration().mount.kind == MountKind::Rig;
        self.fits(rig.then_some(self.configuration().mount.pulley_distance_mm), LEAST_SHOWN_MM)
    }

    /// Returns the least length of tendon for the set, rounded up to a millimetre: the wrap, on the
    /// rig the distances to the guide pulleys, half a turn around each and the way of the load, the
    /// lengths along the links of a joint, the sheath stop, and two free ends to grip.
    pub(super) fn least_tendon_mm(&self) -> f64 {
        let c = self.configuration();
        let wrap = 2.0 * self.half_wrap_rad() * self.tendon_axis_radius_mm();
        let pulley = match c.mount.kind {
            MountKind::Rig => {
                // Half a turn at most over each pulley, and the way of the load to the table.
                let turn = PI * (PULLEY_RADIUS_MM + self.tendon_diameter_mm() / 2.0);
                let down = c.rig.tendon_height_mm + c.rig.stroke_mm;
                2.0 * (c.mount.pulley_distance_mm + turn) + down
            }
            MountKind::Joint => self.joint().map_or(0.0, |joint| joint.tendon_ends_mm().iter().sum()),
            _ => 0.0,
        };
        let stop = self.mounting().and_then(|m| m.sheath).map_or(0.0, |stop| {
            let [_, other] = self.tendon_ends();
            (stop.start - other.start).norm() + stop.length_mm
        });
        (wrap + pulley + stop + 2.0 * SHOWN_MM).ceil()
    }

    /// Returns the length of tendon to cut, mm: the configured one, and on the rig at least what its ways need.
    pub(crate) fn tendon_length_mm(&self) -> f64 {
        let c = self.configuration();
        let least = if c.mount.kind == MountKind::Rig { self.least_tendon_mm() } else { 0.0 };
        c.tendon.length_mm.max(least)
    }

    /// Returns the distance beyond the wrap at which the two ends cross, mm; `None` if they do not
    /// cross within [`NEAR_MM`]. Ends that cross must be guided past each other.
    pub(super) fn ends_meet_mm(&self) -> Option<f64> {
        let half = self.half_wrap_rad();
        let meet = self.tendon_axis_radius_mm() * libm::tan(PI - half);
        (half > FRAC_PI_2 && meet < NEAR_MM).then_some(meet)
    }

    /// Returns by how much the sheath stop is too close to the guide pulley, or to the tendon on
    /// the load side, mm; negative if it clears both.
    pub(super) fn stop_in_the_way_mm(&self, mounting: &Mounting) -> f64 {
        let Some(stop) = mounting.sheath else { return f64::NEG_INFINITY };
        let [load, _] = self.tendon_ends();
        let length_mm = mounting.axle.map_or(FAR_MM, |_| self.configuration().mount.pulley_distance_mm);
        let tendon = self.tendon_diameter_mm() / 2.0 + TENDON_AIR_MM
            - distance_to_stop_mm(&stop, load.up_to(length_mm));
        let reach = pulley_outer_mm(self.tendon_diameter_mm()) + super::mounting::PULLEY_AIR_MM;
        let pulley = mounting.axle.map(|hole| reach - distance_to_stop_mm(&stop, [hole.centre; 2]));
        tendon.max(pulley.unwrap_or(f64::NEG_INFINITY))
    }
}

/// Returns the distance of a segment from the block of the sheath stop, mm; 0 inside.
fn distance_to_stop_mm(stop: &SheathStop, segment: [Point2; 2]) -> f64 {
    let outwards = Vector2::new(-stop.along.y, stop.along.x) * stop.half_width_mm;
    let corners = [(0.0, -1.0), (stop.length_mm, -1.0), (stop.length_mm, 1.0), (0.0, 1.0)]
        .map(|(along, across)| stop.start + stop.along * along + outwards * across);
    let from = segment[0] - stop.start;
    let along = from.dot(&stop.along);
    let is_within =
        (0.0..=stop.length_mm).contains(&along) && from.perp(&stop.along).abs() <= stop.half_width_mm;
    let edges = (0..4).map(|i| between_mm([corners[i], corners[(i + 1) % 4]], segment));
    if is_within { 0.0 } else { edges.fold(f64::INFINITY, f64::min) }
}

/// Returns the distance between two segments, mm; 0 if they cross.
fn between_mm(a: [Point2; 2], b: [Point2; 2]) -> f64 {
    let side = |s: [Point2; 2], p: Point2| (s[1] - s[0]).perp(&(p - s[0]));
    let parts = |s: [Point2; 2], t: [Point2; 2]| side(s, t[0]) * side(s, t[1]) < 0.0;
    if parts(a, b) && parts(b, a) {
        return 0.0;
    }
    let ends = [
        from_segment_mm(a[0], b),
        from_segment_mm(a[1], b),
        from_segment_mm(b[0], a),
        from_segment_mm(b[1], a),
    ];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

/// Returns the distance of a point from a segment, mm.
fn from_segment_mm(p: Point2, [from, to]: [Point2; 2]) -> f64 {
    let (line, to_point) = (to - from, p - from);
    let length2 = line.norm_squared();
    let share = if length2 > 0.0 { (to_point.dot(&line) / length2).clamp(0.0, 1.0) } else { 0.0 };
    (to_point - line * share).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Configuration, assign};

    fn dimensions(assignments: &[&str]) -> Dimensions {
        let mut c = Configuration::default();
        assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
        Dimensions::new(c)
    }

    #[test]
    fn distances_between_segments_are_exact() {
        let segment = |a: [f64; 2], b: [f64; 2]| [Point2::from(a), Point2::from(b)];
        let base = segment([0.0, 0.0], [4.0, 0.0]);
        assert_eq!(between_mm(base, segment([1.0, -1.0], [2.0, 3.0])), 0.0);
        assert_eq!(between_mm(base, segment([1.0, 2.0], [2.0, 3.0])), 2.0);
        assert_eq!(between_mm(base, segment([7.0, 4.0], [9.0, 9.0])), 5.0);
        assert_eq!(between_mm(base, segment([5.0, 0.0], [6.0, 0.0])), 1.0);
    }

    #[test]
    fn ends_that_would_meet_are_shortened() {
        assert_eq!(dimensions(&[]).shown_ends_mm(), [SHOWN_MM; 2]);
        assert_eq!(dimensions(&["layout.wrap_angle_deg=200"]).shown_ends_mm(), [SHOWN_MM; 2]);
        let [load, other] = dimensions(&["layout.wrap_angle_deg=280"]).shown_ends_mm();
        assert!(load == other && (LEAST_SHOWN_MM..SHOWN_MM).contains(&load), "{load}");
        let [pulley, other] = dimensions(&["layout.wrap_angle_deg=290", "mount.kind=rig"]).shown_ends_mm();
        assert!(pulley > SHOWN_MM && other < SHOWN_MM, "{pulley} {other}");
        assert_eq!(
            dimensions(&[]).least_tendon_mm(),
            (63.89f64.to_radians() * dimensions(&[]).tendon_axis_radius_mm() + 40.0).ceil()
        );
        assert!(
            dimensions(&["mount.kind=rig"]).least_tendon_mm() > dimensions(&[]).least_tendon_mm() + 130.0
        );
        assert_eq!(dimensions(&[]).ends_meet_mm(), None);
        assert!(dimensions(&["layout.wrap_angle_deg=280"]).ends_meet_mm().is_some());
    }
}
