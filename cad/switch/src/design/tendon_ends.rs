//! The tendon's two straight ends beyond the wrap, and how near they come to each other, to the guide pulley and to the
//! sheath stop (cad/doc/dimensions.md, "Tendon"). All of these stand at the same height.

use std::f64::consts::{FRAC_PI_2, PI};

use super::mounting::{Mounting, PULLEY_RADIUS_MM, SheathStop};
use super::{Dimensions, pulley_outer_mm};
use crate::config::MountKind;
use pinswitch_solid::profile::{Point2, Vector2, polar};

/// What is shown of an end that nothing shortens, mm.
const SHOWN_MM: f64 = 20.0;
/// Least of an end that is shown, mm.
const LEAST_SHOWN_MM: f64 = 1.0;
/// Air around the tendon beside what it must not touch, mm.
const TENDON_AIR_MM: f64 = 1.0;
/// A length beyond which nothing of ours stands, mm: an end that runs on.
const FAR_MM: f64 = 1e4;
/// Ends that meet within this length must be led past each other, mm.
const NEAR_MM: f64 = 100.0;

/// An end of the tendon, from where it leaves the wrap along its tangent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TendonEnd {
    pub(super) start: Point2,
    /// Away from the wrap; a unit vector.
    pub(super) along: Vector2,
}

impl TendonEnd {
    fn up_to(&self, length_mm: f64) -> [Point2; 2] {
        [self.start, self.start + self.along * length_mm]
    }
}

impl Dimensions {
    /// The ends on the load's side and on the other.
    pub(super) fn tendon_ends(&self) -> [TendonEnd; 2] {
        [-1.0, 1.0].map(|side| {
            let outwards = polar(1.0, side * self.half_wrap_rad()).coords;
            let start = Point2::from(outwards * self.tendon_axis_radius_mm());
            TendonEnd { start, along: Vector2::new(outwards.y, -outwards.x) * side }
        })
    }

    /// What is shown of the ends, mm: on the load's side, up to the guide pulley on the rig, and on the other. Ends that
    /// would meet are shown shorter.
    pub fn shown_ends_mm(&self) -> [f64; 2] {
        let pulley = (self.configuration().mount.kind == MountKind::Rig)
            .then_some(self.configuration().mount.pulley_distance_mm);
        if self.fits(pulley, SHOWN_MM) {
            return [pulley.unwrap_or(SHOWN_MM), SHOWN_MM];
        }
        // What fits is found to a hundredth of a millimetre, from the shortest on.
        let (mut fits, mut meets) = (LEAST_SHOWN_MM, SHOWN_MM);
        while meets - fits > 0.01 {
            let middle = f64::midpoint(fits, meets);
            if self.fits(pulley, middle) { fits = middle } else { meets = middle }
        }
        [pulley.unwrap_or(fits), fits]
    }

    /// Whether ends of this length keep clear of each other, and the free one of the guide pulley.
    fn fits(&self, pulley_mm: Option<f64>, length_mm: f64) -> bool {
        if self.half_wrap_rad() <= FRAC_PI_2 {
            // They run apart.
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

    /// Whether the shortest ends that are shown keep clear.
    pub(super) fn ends_keep_clear(&self) -> bool {
        let rig = self.configuration().mount.kind == MountKind::Rig;
        self.fits(rig.then_some(self.configuration().mount.pulley_distance_mm), LEAST_SHOWN_MM)
    }

    /// Least length of tendon that does what the set is for, mm: the wrap, on the rig the way to the guide pulley and half a
    /// turn over it, the sheath stop, and two ends to take hold of. Whole millimetres.
    pub(super) fn least_tendon_mm(&self) -> f64 {
        let c = self.configuration();
        let wrap = 2.0 * self.half_wrap_rad() * self.tendon_axis_radius_mm();
        let pulley = match c.mount.kind {
            MountKind::Rig => {
                c.mount.pulley_distance_mm + PI * (PULLEY_RADIUS_MM + self.tendon_diameter_mm() / 2.0)
            }
            _ => 0.0,
        };
        let stop = self.mounting().and_then(|m| m.sheath).map_or(0.0, |stop| {
            let [_, other] = self.tendon_ends();
            (stop.start - other.start).norm() + stop.length_mm
        });
        (wrap + pulley + stop + 2.0 * SHOWN_MM).ceil()
    }

    /// How far beyond the wrap the two ends meet, mm, if they do so soon: they must be led past each other there.
    pub(super) fn ends_meet_mm(&self) -> Option<f64> {
        let half = self.half_wrap_rad();
        let meet = self.tendon_axis_radius_mm() * libm::tan(PI - half);
        (half > FRAC_PI_2 && meet < NEAR_MM).then_some(meet)
    }

    /// How much nearer the sheath stop stands to the guide pulley, or to the tendon on the load's side, than it may, mm;
    /// negative where it keeps clear of both.
    pub(super) fn stop_in_the_way_mm(&self, mounting: &Mounting) -> f64 {
        let Some(stop) = mounting.sheath else { return f64::NEG_INFINITY };
        let [load, _] = self.tendon_ends();
        let length_mm = mounting.axle.map_or(FAR_MM, |_| self.configuration().mount.pulley_distance_mm);
        let tendon =
            self.tendon_diameter_mm() / 2.0 + TENDON_AIR_MM - beside_mm(&stop, load.up_to(length_mm));
        let reach = pulley_outer_mm(self.tendon_diameter_mm()) + super::mounting::PULLEY_AIR_MM;
        let pulley = mounting.axle.map(|hole| reach - beside_mm(&stop, [hole.centre; 2]));
        tendon.max(pulley.unwrap_or(f64::NEG_INFINITY))
    }
}

/// Distance of a segment from the sheath stop's block, mm; 0 within.
fn beside_mm(stop: &SheathStop, segment: [Point2; 2]) -> f64 {
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

/// Distance between two segments, mm; 0 where they cross.
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

/// Distance of a point from a segment, mm.
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
    fn segments_are_as_far_apart_as_they_are() {
        let segment = |a: [f64; 2], b: [f64; 2]| [Point2::from(a), Point2::from(b)];
        let base = segment([0.0, 0.0], [4.0, 0.0]);
        assert_eq!(between_mm(base, segment([1.0, -1.0], [2.0, 3.0])), 0.0);
        assert_eq!(between_mm(base, segment([1.0, 2.0], [2.0, 3.0])), 2.0);
        assert_eq!(between_mm(base, segment([7.0, 4.0], [9.0, 9.0])), 5.0);
        assert_eq!(between_mm(base, segment([5.0, 0.0], [6.0, 0.0])), 1.0);
    }

    #[test]
    fn ends_are_shown_whole_until_they_would_meet() {
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
