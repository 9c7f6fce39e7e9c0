//! The joint: two links on an axle on the pulley's axis (cad/doc/dimensions.md, "Joint").
//!
//! The proximal link carries the switch. The tendon runs along it through a guide, wraps the
//! switch, and ends at an anchor on the distal link. The distal link has a hub in the hollow of the
//! shell, which turns on the axle, and a lug on the hub that meets a stop at both ends of flexion.
//!
//! The wrap starts at the proximal end, at half of the wrap angle of the layout, and grows towards
//! groove 1. At a flexion of the wrap angle of the layout it is therefore the wrap of the layout.
//! The parts are constructed at that flexion. A larger flexion turns the distal link
//! counter-clockwise, seen from +z.

mod axle;
mod path;

use std::f64::consts::PI;

use super::Dimensions;
use super::fastening::{RECESS_PLAY_MM, Recess, recess_below};
use super::mounting::Hole;
use crate::config::MountKind;
use pinswitch_solid::profile::{Contour, Disc, Pen, Point2, Vector2, polar};

pub(crate) use axle::AXLES_MM;
pub use axle::AxleBolt;
pub use path::JointContact;

/// Clearance of the axle in its bores, mm.
const BORE_PLAY_MM: f64 = 0.1;
/// Gap between hub and shell, mm.
const HUB_AIR_MM: f64 = 1.0;
/// Most wall of the hub around the axle, mm: more adds mass and no strength.
const MOST_HUB_WALL_MM: f64 = 8.0;
/// Height of the lug above the hub, mm.
const LUG_MM: f64 = 6.0;
/// Width of the lug, mm.
const LUG_WIDTH_MM: f64 = 8.0;
/// Width of a stop, mm.
const STOP_WIDTH_MM: f64 = 8.0;
/// Gap between hub and stops, mm.
const STOP_AIR_MM: f64 = 0.5;
/// Height of the stops, mm.
const STOP_HEIGHT_MM: f64 = 10.0;
/// Gap between the distal link and what protrudes from the right support, mm.
const LINK_AIR_MM: f64 = 0.8;
/// Distance of guide and anchor from everything that turns past them, mm.
const BLOCK_AIR_MM: f64 = 2.0;
/// Length of guide and anchor along the tendon, mm.
const BLOCK_LENGTH_MM: f64 = 10.0;
/// Thickness of the jaws of guide and anchor, mm.
const JAW_MM: f64 = 3.0;
/// Clearance of the tendon between the jaws, on each side, mm.
const CHANNEL_PLAY_MM: f64 = 0.2;
/// Height of the jaws above the tendon, mm.
const JAW_ABOVE_MM: f64 = 1.0;
/// Distance of the jaws from the edge of their base, mm: coincident walls would not be a solid.
const SETBACK_MM: f64 = 0.5;
/// Radius of the plate of a link at the corners of guide and anchor, mm.
const CORNER_MM: f64 = 1.5;
/// Length of the tendon beyond the anchor, with its crimp sleeve, mm.
pub(crate) const SLEEVE_MM: f64 = 10.0;
/// Length of the tendon beyond the proximal link in pictures, mm.
const LEAD_MM: f64 = 5.0;
/// Distance of the two holes at the end of a link from its centre line, beyond their radius, mm.
const END_HOLES_MM: f64 = 3.0;
/// Protrusion of the axle from its nut, mm.
const AXLE_PROTRUSION_MM: f64 = 1.0;

/// A joint with its links at the flexion of the assembly.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Flexion at the stops, degrees.
    pub flexion_deg: [f64; 2],
    /// Flexion of the assembly, degrees: the wrap angle of the layout.
    pub assembled_deg: f64,
    /// The link that carries the switch.
    pub proximal: Link,
    /// The link that carries the load, at the flexion of the assembly.
    pub distal: Link,
    /// Hub of the distal link and stops of the proximal link.
    pub hub: Hub,
    /// Heights in the assembly.
    pub levels: JointLevels,
    /// The bolt.
    pub axle: AxleBolt,
    /// Length of the bolt; `None` if none is long enough.
    pub axle_length_mm: Option<f64>,
    /// Discs of silicone and pins under the axis of the tendon, the silicone first.
    discs: Vec<Disc>,
}

/// A link in the plane of the assembly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Angle of the link's normal on the tendon's side, from +y towards +x.
    pub angle_rad: f64,
    /// Direction from the axis along the link; a unit vector.
    pub along: Vector2,
    /// Direction from the centre line to the tendon; a unit vector.
    pub outwards: Vector2,
    /// Distance of the end holes from the axis, mm.
    pub length_mm: f64,
    /// Distance of the tendon from the centre line, mm.
    pub tendon_mm: f64,
    /// Start and end of guide or anchor along the link, mm.
    pub block_mm: [f64; 2],
    /// Half of the width of guide or anchor, mm.
    pub half_width_mm: f64,
    /// The holes at the end.
    pub holes: [Hole; 2],
}

impl Link {
    /// Returns the point at `along_mm` from the axis and `outwards_mm` from the centre line.
    pub fn at(&self, along_mm: f64, outwards_mm: f64) -> Point2 {
        Point2::from(self.along * along_mm + self.outwards * outwards_mm)
    }

    /// Returns the end of the channel on the side of the switch, where the free span starts.
    pub fn mouth(&self) -> Point2 {
        self.at(self.block_mm[0] + SETBACK_MM, self.tendon_mm)
    }

    /// Returns the outline of the base of guide or anchor, counter-clockwise.
    pub fn base(&self) -> Contour {
        let ([start, end], half) = (self.block_mm, self.half_width_mm);
        self.quad([start, end], [-half, half])
    }

    /// Returns the outlines of the jaws on both sides of the tendon, counter-clockwise.
    pub fn jaws(&self) -> [Contour; 2] {
        let [start, end] = self.block_mm;
        let (inner, outer) = (self.half_width_mm - SETBACK_MM - JAW_MM, self.half_width_mm - SETBACK_MM);
        [[-outer, -inner], [inner, outer]]
            .map(|across| self.quad([start + SETBACK_MM, end - SETBACK_MM], across))
    }

    /// A rectangle about the tendon, counter-clockwise.
    fn quad(&self, [start, end]: [f64; 2], [low, high]: [f64; 2]) -> Contour {
        let corners = [(start, low), (end, low), (end, high), (start, high)];
        let outline = Contour::polygon(corners.map(|(x, y)| self.at(x, self.tendon_mm + y)).to_vec());
        if outline.area_mm2() < 0.0 { outline.reversed() } else { outline }
    }

    /// Discs at the corners of guide or anchor and around the end holes, for the outline of the
    /// link.
    fn discs(&self, rim_mm: f64) -> impl Iterator<Item = Disc> + '_ {
        let ([start, end], half) = (self.block_mm, self.half_width_mm);
        let corners = [(start, -half), (end, -half), (end, half), (start, half)];
        let corner =
            |(x, y): (f64, f64)| Disc { centre: self.at(x, self.tendon_mm + y), radius_mm: CORNER_MM };
        let ends = self.holes.map(|hole| Disc { centre: hole.centre, radius_mm: hole.radius_mm + rim_mm });
        corners.into_iter().map(corner).chain(ends)
    }
}

/// Hub, lug and stops. The lug is on the hub of the distal link, the stops on the proximal link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hub {
    /// Radius of the bore for the axle, mm.
    pub bore_mm: f64,
    /// Radius of the hub, mm.
    pub radius_mm: f64,
    /// Radius of the lug and the stops, mm.
    pub lug_mm: f64,
    /// Angle of the middle of the lug at the flexion of the assembly, from +y towards +x.
    pub lug_rad: f64,
    /// Half of the angle of the lug.
    pub lug_half_rad: f64,
    /// Half of the angle between the stops.
    pub free_half_rad: f64,
    /// Angle of a stop.
    pub stop_rad: f64,
}

impl Hub {
    /// Returns the outline of hub and lug, counter-clockwise.
    pub fn outline(&self) -> Contour {
        let [first, last] = [self.lug_rad - self.lug_half_rad, self.lug_rad + self.lug_half_rad];
        Pen::at(polar(self.radius_mm, last))
            .line_to(polar(self.lug_mm, last))
            .arc_to(Point2::origin(), polar(self.lug_mm, first), true)
            .line_to(polar(self.radius_mm, first))
            .arc_to(Point2::origin(), polar(self.radius_mm, last), true)
            .close()
    }

    /// Returns the outlines of the stops, counter-clockwise: at the least and at the largest
    /// flexion.
    pub fn stops(&self) -> [Contour; 2] {
        let inner = self.radius_mm + STOP_AIR_MM;
        let near = [PI + self.free_half_rad, PI - self.free_half_rad - self.stop_rad];
        near.map(|first| {
            let last = first + self.stop_rad;
            Pen::at(polar(inner, last))
                .line_to(polar(self.lug_mm, last))
                .arc_to(Point2::origin(), polar(self.lug_mm, first), true)
                .line_to(polar(inner, first))
                .arc_to(Point2::origin(), polar(inner, last), false)
                .close()
        })
    }

    /// Returns the angle from the middle of the wrap to the far side of each stop.
    pub(super) fn clear_half_rad(&self) -> f64 {
        PI - self.free_half_rad - self.stop_rad
    }
}

/// Heights of a joint in the assembly, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLevels {
    /// Inner face of the proximal link.
    pub proximal_mm: f64,
    /// Upper end of the stops.
    pub stop_mm: f64,
    /// Lower end of the hub, on its washer.
    pub hub_mm: f64,
    /// Inner face of the distal link.
    pub distal_mm: f64,
    /// Middle of the tendon.
    pub tendon_mm: f64,
    /// Half of the height of the channels of guide and anchor.
    pub channel_half_mm: f64,
    /// Distance of the ends of the jaws from the middle of the tendon.
    pub jaw_mm: f64,
}

impl Joint {
    /// Returns the pocket for the head of the axle in the outer face of the proximal link. It
    /// prevents rotation of the bolt.
    pub(crate) fn head_recess(&self) -> Recess {
        axle_pocket(&self.axle)
    }

    /// Returns the outline of a link, counter-clockwise, and with the fasteners of the switch for
    /// the proximal one.
    pub(crate) fn outline_discs(&self, dimensions: &Dimensions, is_proximal: bool) -> Vec<Disc> {
        let rim = dimensions.configuration().mount.rim_mm;
        let link = if is_proximal { &self.proximal } else { &self.distal };
        let hub = Disc { centre: Point2::origin(), radius_mm: self.hub.lug_mm + CORNER_MM };
        let fasteners =
            dimensions.fastener_angles_rad().into_iter().filter(|_| is_proximal).map(|angle| Disc {
                centre: polar(dimensions.fastener_radius_mm(), angle),
                radius_mm: dimensions.mount_along_mm() + rim,
            });
        link.discs(rim).chain([hub]).chain(fasteners).collect()
    }

    /// Returns the length of the bearing surface, mm: hub and distal link.
    pub fn bearing_mm(&self, plate_mm: f64) -> f64 {
        self.levels.distal_mm - self.levels.hub_mm + plate_mm
    }

    /// Returns the least distance of the end holes from the axis, mm: beyond supports and blocks.
    pub(super) fn least_link_mm(&self, link: &Link, dimensions: &Dimensions) -> f64 {
        let hole = link.holes[0].radius_mm;
        (dimensions.support_radius_mm() + hole + 1.0).max(link.block_mm[1])
    }

    /// Returns the lengths of the tendon from the foot of the axis on its line: to the end on the
    /// distal and on the proximal link, mm.
    pub(super) fn tendon_ends_mm(&self) -> [f64; 2] {
        [self.distal.block_mm[1] + SLEEVE_MM, self.proximal.length_mm + LEAD_MM]
    }
}

/// Returns the pocket for the head of an axle.
fn axle_pocket(axle: &AxleBolt) -> Recess {
    let radial_mm = (axle.head_mm[0] + RECESS_PLAY_MM) / 2.0;
    let along_mm = radial_mm / libm::cos(std::f64::consts::FRAC_PI_6);
    Recess { radial_mm, along_mm, depth_mm: recess_below(axle.head_mm[1]), is_hexagon: true }
}

impl Dimensions {
    /// Returns the discs under the axis of the tendon: that of silicone or proxy first, then one
    /// for each pin by increasing angle, each with half of the tendon added to its radius.
    pub(crate) fn tendon_discs(&self) -> Vec<Disc> {
        let half = self.tendon_diameter_mm() / 2.0;
        let radius_mm = self.configuration().pins.diameter_mm / 2.0 + half;
        // Pins beyond the wrap can lift the tendon, too.
        let pin = |angle| Disc { centre: polar(self.contact_radius_mm(), angle), radius_mm };
        let bed = Disc { centre: Point2::origin(), radius_mm: self.tendon_axis_radius_mm() };
        std::iter::once(bed).chain(self.pin_angles_rad().into_iter().map(pin)).collect()
    }

    /// Returns the joint; `None` without one.
    pub fn joint(&self) -> Option<Joint> {
        let c = self.configuration();
        let m = &c.mount;
        if m.kind != MountKind::Joint {
            return None;
        }
        let axle = AxleBolt::nearest_to(m.axle_mm);
        let flexion_deg = [m.flexion_min_deg, m.flexion_max_deg];
        let assembled_deg = c.layout.wrap_angle_deg;
        let hub = self.hub(&axle, flexion_deg);
        let levels = self.joint_levels(&axle);
        let discs = self.tendon_discs();
        let half = self.half_wrap_rad();
        let proximal = self.link(half, 1.0, m.proximal_mm, (&hub, &discs));
        let distal = self.link(-half, -1.0, m.distal_mm, (&hub, &discs));
        let stack = m.plate_mm - axle_pocket(&axle).depth_mm + levels.distal_mm - levels.proximal_mm
            + m.plate_mm
            + axle.washer_mm[2]
            + axle.nut_mm
            + AXLE_PROTRUSION_MM;
        let axle_length_mm = axle.at_least_mm(stack);
        Some(Joint { flexion_deg, assembled_deg, proximal, distal, hub, levels, axle, axle_length_mm, discs })
    }

    fn hub(&self, axle: &AxleBolt, [low_deg, high_deg]: [f64; 2]) -> Hub {
        let bore_mm = (axle.diameter_mm + BORE_PLAY_MM) / 2.0;
        let radius_mm = (self.inner_radius_mm() - HUB_AIR_MM).min(bore_mm + MOST_HUB_WALL_MM).max(bore_mm);
        let lug_mm = radius_mm + LUG_MM;
        let middle_mm = f64::midpoint(radius_mm, lug_mm);
        let lug_half_rad = LUG_WIDTH_MM / 2.0 / middle_mm;
        let middle_deg = f64::midpoint(low_deg, high_deg);
        Hub {
            bore_mm,
            radius_mm,
            lug_mm,
            lug_rad: PI + (middle_deg - self.configuration().layout.wrap_angle_deg).to_radians(),
            lug_half_rad,
            free_half_rad: (high_deg - low_deg).to_radians() / 2.0 + lug_half_rad,
            stop_rad: STOP_WIDTH_MM / middle_mm,
        }
    }

    fn joint_levels(&self, axle: &AxleBolt) -> JointLevels {
        let c = self.configuration();
        let proximal_mm = -c.support.plate_mm;
        let distal_mm = c.shell.width_mm + c.support.plate_mm + self.right_protrusion_mm() + LINK_AIR_MM;
        let half = self.tendon_diameter_mm() / 2.0;
        JointLevels {
            proximal_mm,
            stop_mm: proximal_mm + STOP_HEIGHT_MM.min(distal_mm - proximal_mm - LINK_AIR_MM),
            hub_mm: proximal_mm + axle.washer_mm[2],
            distal_mm,
            tendon_mm: c.shell.width_mm / 2.0,
            channel_half_mm: half + CHANNEL_PLAY_MM,
            jaw_mm: half + JAW_ABOVE_MM,
        }
    }

    /// Returns a link whose normal is at `angle_rad`; `side` is 1 for the proximal link and -1 for
    /// the distal one.
    fn link(&self, angle_rad: f64, side: f64, length_mm: f64, (hub, discs): (&Hub, &[Disc])) -> Link {
        let outwards = polar(1.0, angle_rad).coords;
        let along = Vector2::new(outwards.y, -outwards.x) * side;
        // At the flexion of the assembly the free span is parallel to the link.
        let supports = discs.iter().map(|disc| disc.centre.coords.dot(&outwards) + disc.radius_mm);
        let tendon_mm = supports.fold(0.0, f64::max);
        let half_width_mm = self.tendon_diameter_mm() / 2.0 + CHANNEL_PLAY_MM + JAW_MM + SETBACK_MM;
        let on_pins = self.contact_radius_mm()
            + self.configuration().pins.diameter_mm / 2.0
            + self.tendon_diameter_mm();
        let clear = self.support_radius_mm().max(on_pins).max(hub.lug_mm) + BLOCK_AIR_MM;
        let inner = (tendon_mm - half_width_mm).max(0.0);
        let start = (clear.powi(2) - inner.powi(2)).max(0.0).sqrt();
        let radius_mm = self.configuration().mount.hole_diameter_mm / 2.0;
        let aside = radius_mm + END_HOLES_MM;
        let holes = [-aside, aside]
            .map(|by| Hole { centre: Point2::from(along * length_mm + outwards * by), radius_mm });
        Link {
            angle_rad,
            along,
            outwards,
            length_mm,
            tendon_mm,
            block_mm: [start, start + BLOCK_LENGTH_MM],
            half_width_mm,
            holes,
        }
    }
}
