//! The tendon, taut over resting pins and silicone (cad/doc/dimensions.md, "Tendon").
//!
//! Its axis is a string around discs: one of the silicone and one for each pin, with half of the tendon added to their radii.
//! It consists of lines and arcs; each arc is a contact with a pin or with the silicone.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{Part, Pose, Role};
use crate::design::{Design, Joint, JointContact, PULLEY_RADIUS_MM, RigLayout};
use pinswitch_solid::profile::{Contour, Disc, HullArc, Pen, Point2, Vector2, hull_arcs};
use pinswitch_solid::solid::{Facing, Solid};

/// Number of sides of the section: a polygon inside the circle, so that it does not overlap bodies that the circle touches.
const SIDES: u32 = 12;
/// Length of the ends beyond the guide pulleys of a rig, mm. The rest is drawn with the bought bodies.
pub(crate) const RIG_END_MM: f64 = 20.0;
/// Shorter arcs of the axis are points, mm: their facets would have no height.
const SHORTEST_ARC_MM: f64 = 2e-4;

/// A contact of the tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Number of the pin, from 0 by increasing angle; `None` for silicone or proxy.
    pub pin: Option<usize>,
    /// First angle about the pulley's axis.
    pub from_rad: f64,
    /// Last angle.
    pub to_rad: f64,
}

/// Returns the contacts of the unloaded tendon with pins and silicone, by increasing angle. Contacts with silicone are mostly
/// outside of the outermost pins.
pub fn touches(design: &Design) -> Vec<Touch> {
    let (_, arcs) = string(design);
    let mut all: Vec<Touch> = arcs
        .iter()
        .filter(|arc| arc.to_rad - arc.from_rad > 1e-6)
        .map(|arc| Touch {
            pin: arc.disc.checked_sub(1),
            from_rad: FRAC_PI_2 - arc.to_rad,
            to_rad: FRAC_PI_2 - arc.from_rad,
        })
        .collect();
    all.reverse();
    all
}

/// Discs and arcs of the string around them. A disc after the first is a pin, numbered from 0.
fn string(design: &Design) -> (Vec<Disc>, Vec<HullArc>) {
    let discs = design.tendon_discs();
    let half = design.half_wrap_rad();
    let arcs = hull_arcs(&discs, FRAC_PI_2 - half, FRAC_PI_2 + half);
    (discs, arcs)
}

pub(super) fn tendon(design: &Design) -> Part {
    let (discs, arcs) = string(design);
    let [load_side, other_side] = design.shown_ends_mm();
    let ends = Ends {
        // The side of the load is at the largest angle.
        leads_mm: [other_side, load_side],
        rig: design.rig_layout(),
        has_drive_pulley: design.has_drive_pulley(),
        groove_mm: PULLEY_RADIUS_MM + design.tendon_diameter_mm() / 2.0,
    };
    body(design, |half_mm| strip(&discs, &arcs, &ends, half_mm))
}

/// Returns the tendon of a joint at a flexion in degrees; `None` without a joint.
pub fn tendon_at_flexion(design: &Design, flexion_deg: f64) -> Option<Part> {
    let joint = design.joint()?;
    let contact = joint.contact(flexion_deg);
    Some(body(design, |half_mm| joint_strip(&joint, &contact, half_mm)))
}

/// A body whose sections are strips of a given half width.
fn body(design: &Design, strip: impl Fn(f64) -> Contour) -> Part {
    let radius = design.tendon_diameter_mm() / 2.0;
    let mut solid = Solid::new();
    let mut below = None;
    for k in 0..SIDES / 2 {
        let angle = (f64::from(k) + 0.5) / f64::from(SIDES) * TAU;
        let outline = strip(radius * libm::sin(angle));
        let ring = solid.ring(outline, -radius * libm::cos(angle));
        match below {
            None => solid.cap(Facing::Down, ring, &[]),
            Some(below) => solid.wall(below, ring),
        }
        below = Some(ring);
    }
    if let Some(top) = below {
        solid.cap(Facing::Up, top, &[]);
    }
    let middle = design.configuration().shell.width_mm / 2.0;
    Part::new("tendon", Role::Tendon, solid, Some(Pose::upright(middle)))
}

/// The ends of the tendon beyond the wrap: straight, or over the guide pulleys of a rig.
struct Ends {
    leads_mm: [f64; 2],
    rig: Option<RigLayout>,
    has_drive_pulley: bool,
    /// Radius of the axis of the tendon on a guide pulley.
    groove_mm: f64,
}

impl Ends {
    /// Adds the way from the wrap, which it leaves outward of `from_rad`, over the guide pulley of the load and down, on one
    /// side of the axis; then the way back on the other side, to the wrap.
    fn load_side(&self, pen: Pen, from_rad: f64, half_mm: f64) -> Option<Pen> {
        let axle = self.rig.as_ref()?.load_axle;
        let on = |angle: f64, by: f64| {
            axle + Vector2::new(libm::cos(angle), libm::sin(angle)) * (self.groove_mm + by)
        };
        let down = |by: f64| on(PI, by) - Vector2::y() * RIG_END_MM;
        let out =
            pen.line_to(on(from_rad, half_mm)).arc_to(axle, on(PI, half_mm), true).line_to(down(half_mm));
        Some(out.line_to(down(-half_mm)).line_to(on(PI, -half_mm)).arc_to(
            axle,
            on(from_rad, -half_mm),
            false,
        ))
    }

    /// The points of the way from the drive to the wrap, on one side of the axis: the end, the foot and the head of the arc
    /// on the guide pulley, and its centre. The tendon leaves the wrap outward of `to_rad`.
    fn drive_side(&self, to_rad: f64, by_mm: f64) -> Option<[Point2; 4]> {
        let axle = self.rig.as_ref().filter(|_| self.has_drive_pulley)?.drive_axle;
        let on =
            |angle: f64| axle - Vector2::new(libm::cos(angle), libm::sin(angle)) * (self.groove_mm - by_mm);
        let foot = on(FRAC_PI_2);
        Some([foot + Vector2::x() * RIG_END_MM, foot, on(to_rad), axle])
    }
}

/// The point at an angle of a disc, outward of its edge by `by_mm`.
fn on(disc: Disc, angle: f64, by_mm: f64) -> Point2 {
    disc.centre + Vector2::new(libm::cos(angle), libm::sin(angle)) * (disc.radius_mm + by_mm)
}

/// Adds a contact with a disc, from one angle to another, to an outline at `by_mm` from the axis of the tendon. A contact that is
/// too short for an arc is a point.
fn along(pen: Pen, disc: Disc, [from_rad, to_rad]: [f64; 2], by_mm: f64) -> Pen {
    if (to_rad - from_rad).abs() * disc.radius_mm < SHORTEST_ARC_MM {
        return pen.line_to(on(disc, f64::midpoint(from_rad, to_rad), by_mm));
    }
    let pen = pen.line_to(on(disc, from_rad, by_mm));
    pen.arc_to(disc.centre, on(disc, to_rad, by_mm), to_rad > from_rad)
}

/// The outline of a string of width `2 * half_mm`, counter-clockwise.
fn strip(discs: &[Disc], arcs: &[HullArc], ends: &Ends, half_mm: f64) -> Contour {
    let onward = |angle: f64| Vector2::new(-libm::sin(angle), libm::cos(angle));
    let at = |arc: &HullArc, angle: f64, by: f64| on(discs[arc.disc], angle, by);
    let (Some(first), Some(last)) = (arcs.first(), arcs.last()) else { return Contour::polygon(Vec::new()) };
    let start = |by: f64| at(first, first.from_rad, by) - onward(first.from_rad) * ends.leads_mm[0];
    let end = |by: f64| at(last, last.to_rad, by) + onward(last.to_rad) * ends.leads_mm[1];
    let mut pen = match ends.drive_side(first.from_rad, half_mm) {
        Some([end, foot, head, axle]) => Pen::at(end).line_to(foot).arc_to(axle, head, false),
        None => Pen::at(start(half_mm)),
    };
    for arc in arcs {
        pen = along(pen, discs[arc.disc], [arc.from_rad, arc.to_rad], half_mm);
    }
    pen = match ends.load_side(pen.clone(), last.to_rad, half_mm) {
        Some(pen) => pen,
        None => pen.line_to(end(half_mm)).line_to(end(-half_mm)),
    };
    for arc in arcs.iter().rev() {
        pen = along(pen, discs[arc.disc], [arc.to_rad, arc.from_rad], -half_mm);
    }
    match ends.drive_side(first.from_rad, -half_mm) {
        Some([end, foot, head, axle]) => pen.line_to(head).arc_to(axle, foot, true).line_to(end).close(),
        None => pen.line_to(start(-half_mm)).close(),
    }
}

/// The outline of the tendon of a joint, counter-clockwise: from the proximal end through the guide, over the contacts and
/// through the anchor to the distal end. The tendon turns sharply at the mouths of guide and anchor.
fn joint_strip(joint: &Joint, contact: &JointContact, half_mm: f64) -> Contour {
    let (guide, anchor) = (joint.proximal.mouth(), contact.anchor);
    let (start, end) = (joint.proximal_end(), joint.distal_end(contact));
    let at = |arc: &HullArc, angle: f64, by: f64| on(joint.discs()[arc.disc], angle, by);
    let arcs = &contact.arcs;
    let first = arcs.first().map_or(anchor, |arc| at(arc, arc.from_rad, 0.0));
    let last = arcs.last().map_or(guide, |arc| at(arc, arc.to_rad, 0.0));
    let ends = |by: f64| {
        [
            offset(start, None, Some(guide), by),
            offset(guide, Some(start), Some(first), by),
            offset(anchor, Some(last), Some(end), by),
            offset(end, Some(anchor), None, by),
        ]
    };
    let [first, second, third, fourth] = ends(half_mm);
    let mut pen = Pen::at(first).line_to(second);
    for arc in arcs {
        pen = along(pen, joint.discs()[arc.disc], [arc.from_rad, arc.to_rad], half_mm);
    }
    pen = pen.line_to(third).line_to(fourth);
    let [first, second, third, fourth] = ends(-half_mm);
    pen = pen.line_to(fourth).line_to(third);
    for arc in arcs.iter().rev() {
        pen = along(pen, joint.discs()[arc.disc], [arc.to_rad, arc.from_rad], -half_mm);
    }
    pen.line_to(second).line_to(first).close()
}

/// A point of a line, moved to its outer side by `by`: at a corner, both of its sides move by the same distance.
fn offset(at: Point2, before: Option<Point2>, after: Option<Point2>, by: f64) -> Point2 {
    // The outer side of the tendon is on the right of its direction.
    let normal = |from: Point2, to: Point2| {
        let along = (to - from).normalize();
        Vector2::new(along.y, -along.x)
    };
    let normals = [before.map(|p| normal(p, at)), after.map(|p| normal(at, p))];
    match normals {
        [Some(a), Some(b)] => at + (a + b) * (by / (1.0 + a.dot(&b))),
        [Some(only), None] | [None, Some(only)] => at + only * by,
        [None, None] => at,
    }
}
