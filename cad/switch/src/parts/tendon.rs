//! The tendon, taut over resting pins and silicone (cad/doc/dimensions.md, "Tendon").
//!
//! Its axis is a string around discs: that of the silicone and one for each pin, all larger by half of the tendon. So it is
//! lines and arcs, and it is known where it lies on a pin and where on the silicone.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::{Part, Pose, Role};
use crate::design::Design;
use pinswitch_solid::profile::{Contour, Disc, HullArc, Pen, Point2, Vector2, hull_arcs, polar};
use pinswitch_solid::solid::{Facing, Solid};

/// Sides of the tendon's section: a polygon inside the circle, so that it overlaps nothing that the circle touches.
const SIDES: u32 = 12;
/// Arcs shorter than this, in radians, are none.
const SAME_RAD: f64 = 1e-9;

/// Where the tendon lies on something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The pin's number, from 0 along increasing angle; `None` on the silicone, or the proxy.
    pub pin: Option<usize>,
    /// First angle, in the frame of the pulley.
    pub from_rad: f64,
    /// Last angle.
    pub to_rad: f64,
}

/// The discs that the tendon's axis goes around, the silicone's first, with the numbers of their pins.
fn discs(design: &Design) -> (Vec<Disc>, Vec<usize>) {
    let half = design.tendon_diameter_mm() / 2.0;
    let mut discs = vec![Disc { centre: Point2::origin(), radius_mm: design.tendon_axis_radius_mm() }];
    let mut pins = Vec::new();
    let radius_mm = design.configuration().pins.diameter_mm / 2.0 + half;
    for (i, angle) in design.pin_angles_rad().into_iter().enumerate() {
        // Also pins beyond the wrap: one that stands in the tendon's way lifts it.
        discs.push(Disc { centre: polar(design.contact_radius_mm(), angle), radius_mm });
        pins.push(i);
    }
    (discs, pins)
}

/// What the unloaded tendon lies on, along increasing angle: pins, and silicone where no pin carries it, foremost outside
/// the outermost pins.
pub fn touches(design: &Design) -> Vec<Touch> {
    let (_, arcs, pins) = string(design);
    let mut all: Vec<Touch> = arcs
        .iter()
        .filter(|arc| arc.to_rad - arc.from_rad > 1e-6)
        .map(|arc| Touch {
            pin: arc.disc.checked_sub(1).and_then(|i| pins.get(i).copied()),
            from_rad: FRAC_PI_2 - arc.to_rad,
            to_rad: FRAC_PI_2 - arc.from_rad,
        })
        .collect();
    all.reverse();
    all
}

fn string(design: &Design) -> (Vec<Disc>, Vec<HullArc>, Vec<usize>) {
    let (discs, pins) = discs(design);
    let half = design.half_wrap_rad();
    let arcs = hull_arcs(&discs, FRAC_PI_2 - half, FRAC_PI_2 + half);
    (discs, arcs, pins)
}

pub(super) fn tendon(design: &Design) -> Part {
    let radius = design.tendon_diameter_mm() / 2.0;
    let (discs, arcs, _) = string(design);
    let [load_side, other_side] = design.shown_ends_mm();
    // The load's side is at the largest direction.
    let leads = [other_side, load_side];
    let mut solid = Solid::new();
    let mut below = None;
    for k in 0..SIDES / 2 {
        let angle = (f64::from(k) + 0.5) / f64::from(SIDES) * TAU;
        let outline = strip(&discs, &arcs, leads, radius * libm::sin(angle));
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

/// What the string covers if it is twice `half_mm` wide, counter-clockwise.
fn strip(discs: &[Disc], arcs: &[HullArc], leads_mm: [f64; 2], half_mm: f64) -> Contour {
    let direction = |angle: f64| Vector2::new(libm::cos(angle), libm::sin(angle));
    let onward = |angle: f64| Vector2::new(-libm::sin(angle), libm::cos(angle));
    let at = |arc: &HullArc, angle: f64, by: f64| {
        discs[arc.disc].centre + direction(angle) * (discs[arc.disc].radius_mm + by)
    };
    let (Some(first), Some(last)) = (arcs.first(), arcs.last()) else { return Contour::polygon(Vec::new()) };
    let start = |by: f64| at(first, first.from_rad, by) - onward(first.from_rad) * leads_mm[0];
    let end = |by: f64| at(last, last.to_rad, by) + onward(last.to_rad) * leads_mm[1];
    let turns = |arc: &&HullArc| arc.to_rad - arc.from_rad > SAME_RAD;
    let mut pen = Pen::at(start(half_mm));
    for arc in arcs.iter().filter(turns) {
        pen = pen.line_to(at(arc, arc.from_rad, half_mm)).arc_to(
            discs[arc.disc].centre,
            at(arc, arc.to_rad, half_mm),
            true,
        );
    }
    pen = pen.line_to(end(half_mm)).line_to(end(-half_mm));
    for arc in arcs.iter().rev().filter(turns) {
        pen = pen.line_to(at(arc, arc.to_rad, -half_mm)).arc_to(
            discs[arc.disc].centre,
            at(arc, arc.from_rad, -half_mm),
            false,
        );
    }
    pen.line_to(start(-half_mm)).close()
}
