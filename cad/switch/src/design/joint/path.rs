//! The path of the taut tendon over a joint: from the guide on the proximal link over pins and
//! silicone to the anchor on the distal link.
//!
//! The tendon has no stiffness and no friction here, so that it is a taut string around convex
//! bodies: the upper hull of the mouths of guide and anchor and of the discs of pins and silicone.
//! The wrap is the angle between the directions of both free spans.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::{Joint, SETBACK_MM};
use pinswitch_friction::finger::{FlexionWrap, JointPathError, Wrap};
use pinswitch_solid::profile::{Disc, HullArc, Point2, Vector2, hull_arcs};

/// Contacts over a smaller angle are tangent points, radians.
const SAME_RAD: f64 = 1e-9;
/// Number of flexions at which [`Joint::largest_turns_rad`] and [`Joint::moment_arms_mm`] sample.
const SAMPLES: u32 = 64;

/// The taut tendon at one flexion. Angles are from +y towards +x.
#[derive(Clone, Debug, PartialEq)]
pub struct JointContact {
    /// Flexion, degrees.
    pub flexion_deg: f64,
    /// Normal of the free span on the distal link: the lower end of the wrap.
    pub from_rad: f64,
    /// Normal of the free span on the proximal link: the upper end of the wrap.
    pub to_rad: f64,
    /// Contacts with pins and silicone, from the proximal to the distal link. Their directions are
    /// counter-clockwise from +x.
    pub(crate) arcs: Vec<HullArc>,
    /// Mouth of the anchor.
    pub anchor: Point2,
    /// Direction of the distal link; a unit vector.
    pub along: Vector2,
    /// Turn of the tendon at the anchor.
    pub anchor_turn_rad: f64,
    /// Turn of the tendon in the guide.
    pub guide_turn_rad: f64,
    /// Moment arm of the tendon on the distal link, mm.
    pub moment_arm_mm: f64,
}

impl JointContact {
    /// Returns the wrap angle: that between the free spans.
    pub fn wrap_rad(&self) -> f64 {
        self.to_rad - self.from_rad
    }

    /// Returns the angle of the middle of the wrap.
    pub fn middle_rad(&self) -> f64 {
        f64::midpoint(self.from_rad, self.to_rad)
    }
}

impl Joint {
    /// Returns the discs of silicone and pins under the axis of the tendon, the silicone first.
    pub(crate) fn discs(&self) -> &[Disc] {
        &self.discs
    }

    /// Returns the rotation of the distal link from the assembly, counter-clockwise seen from +z.
    pub fn turn_rad(&self, flexion_deg: f64) -> f64 {
        (flexion_deg - self.assembled_deg).to_radians()
    }

    /// Returns the contact of the taut tendon at a flexion.
    pub fn contact(&self, flexion_deg: f64) -> JointContact {
        let turn = self.turn_rad(flexion_deg);
        let anchor = turned(self.distal.mouth().coords, turn);
        let guide = self.proximal.mouth();
        let link_rad = self.distal.angle_rad - turn;
        let point = |centre: Point2| Disc { centre, radius_mm: 0.0 };
        let mut discs = self.discs.clone();
        let switch = discs.len();
        discs.extend([point(guide), point(Point2::from(anchor))]);
        let angle = |p: Vector2| libm::atan2(p.y, p.x);
        let first = angle(guide.coords);
        let last = first + (angle(anchor) - first).rem_euclid(TAU);
        let all = hull_arcs(&discs, first, last);
        let is_switch = |arc: &&HullArc| arc.disc < switch && arc.to_rad - arc.from_rad > SAME_RAD;
        let arcs: Vec<HullArc> = all.iter().filter(is_switch).copied().collect();
        // Without a contact, the normal of the straight tendon.
        let straight = all.first().map_or(first, |arc| arc.to_rad);
        let ends = [
            arcs.first().map_or(straight, |arc| arc.from_rad),
            arcs.last().map_or(straight, |arc| arc.to_rad),
        ];
        let [to_rad, from_rad] = ends.map(|direction| FRAC_PI_2 - direction);
        let normal = Vector2::new(libm::sin(from_rad), libm::cos(from_rad));
        JointContact {
            flexion_deg,
            from_rad,
            to_rad,
            arcs,
            anchor: Point2::from(anchor),
            along: turned(self.distal.along, turn),
            anchor_turn_rad: (from_rad - link_rad).abs(),
            guide_turn_rad: (to_rad - self.proximal.angle_rad).abs(),
            moment_arm_mm: anchor.dot(&normal),
        }
    }

    /// Returns the free end of the tendon on the distal link, at a contact.
    pub(crate) fn distal_end(&self, contact: &JointContact) -> Point2 {
        let rest = self.tendon_ends_mm()[0] - self.distal.block_mm[0] - SETBACK_MM;
        contact.anchor + contact.along * rest
    }

    /// Returns the free end of the tendon on the proximal link.
    pub(crate) fn proximal_end(&self) -> Point2 {
        self.proximal.at(self.tendon_ends_mm()[1], self.proximal.tendon_mm)
    }

    /// Returns the largest turns of the tendon in guide and anchor between the stops.
    pub fn largest_turns_rad(&self) -> [f64; 2] {
        let turns = self.samples().map(|contact| [contact.guide_turn_rad, contact.anchor_turn_rad]);
        turns.fold([0.0, 0.0], |[a, b], [c, d]| [a.max(c), b.max(d)])
    }

    /// Returns the least and the largest moment arm between the stops, mm.
    pub fn moment_arms_mm(&self) -> [f64; 2] {
        let arms = self.samples().map(|contact| contact.moment_arm_mm);
        arms.fold([f64::INFINITY, 0.0], |[low, high], arm| [low.min(arm), high.max(arm)])
    }

    fn samples(&self) -> impl Iterator<Item = JointContact> + '_ {
        let [low, high] = self.flexion_deg;
        (0..=SAMPLES).map(move |i| self.contact(low + (high - low) * f64::from(i) / f64::from(SAMPLES)))
    }
}

/// The wrap between the stops of the built joint.
impl FlexionWrap for Joint {
    fn wrap(&self, joint_deg: f64) -> Result<Wrap, JointPathError> {
        let [low, high] = self.flexion_deg;
        let help = "give flexions between the stops: mount.flexion_min_deg and mount.flexion_max_deg";
        JointPathError::within("joint angle (deg)", joint_deg, (low, high), help)?;
        let contact = self.contact(joint_deg);
        Ok(Wrap { wrap_deg: contact.wrap_rad().to_degrees(), middle_deg: contact.middle_rad().to_degrees() })
    }

    fn measured_joint_deg(&self) -> Option<f64> {
        // There the contact is that of the layout.
        let [low, high] = self.flexion_deg;
        let is_published = self.assembled_deg == pinswitch_friction::published::WRAP_ANGLE_DEG;
        (is_published && (low..=high).contains(&self.assembled_deg)).then_some(self.assembled_deg)
    }
}

/// Rotates a vector counter-clockwise.
fn turned(v: Vector2, by_rad: f64) -> Vector2 {
    let (sin, cos) = (libm::sin(by_rad), libm::cos(by_rad));
    Vector2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
}
