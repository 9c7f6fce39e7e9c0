//! Positions of the holes of a mounting plate (cad/doc/dimensions.md, "Mounting").

use super::Dimensions;
use super::fastening::{axle_recess, stop_recess};
use crate::config::MountKind;
use pinswitch_solid::profile::{Disc, Point2, Vector2, polar};

/// Radius of the guide pulley of the rig at the bottom of its groove (paper), mm.
pub(crate) const PULLEY_RADIUS_MM: f64 = 22.0;
/// Hole in the plate for the M8 bolt that fits the bore of a 608 bearing, mm.
const AXLE_HOLE_MM: f64 = 8.4;
/// Diameter of the seat of the guide pulley for a 608 bearing, mm. The outer ring measures 22 mm
/// (ISO 15); the rest is an allowance for the press fit.
pub(crate) const BEARING_SEAT_MM: f64 = 22.1;
/// Width of the rim of each flange of the guide pulley, mm.
const PULLEY_RIM_MM: f64 = 1.2;
/// Least width of the guide pulley, mm: a 608 bearing of 7 mm over its ledge.
const LEAST_PULLEY_MM: f64 = 8.5;
/// Gap between guide pulley and switch, mm.
pub(super) const PULLEY_AIR_MM: f64 = 2.0;
/// Length of the sheath stop along the tendon, mm.
const STOP_LENGTH_MM: f64 = 14.0;
/// Clearance hole of the M3 screws of the sheath stop, mm.
const STOP_HOLE_MM: f64 = 3.4;
/// Wall around the sheath and the screws of the sheath stop, mm.
const STOP_WALL_MM: f64 = 2.0;

/// Height of the flanges of the guide pulley above the bottom of its groove, in tendon diameters.
const PULLEY_DEPTH: f64 = 1.5;

/// Returns the outer radius of the flanges of the guide pulley.
pub(crate) fn pulley_outer_mm(tendon_mm: f64) -> f64 {
    PULLEY_RADIUS_MM + PULLEY_DEPTH * tendon_mm
}

/// Returns the width of the guide pulley for a tendon.
pub(crate) fn pulley_width_mm(tendon_mm: f64) -> f64 {
    (2.0 * (PULLEY_RIM_MM + PULLEY_DEPTH * tendon_mm) + 1.2 * tendon_mm).max(LEAST_PULLEY_MM)
}

/// A through hole in the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// Centre.
    pub centre: Point2,
    /// Radius, mm.
    pub radius_mm: f64,
}

/// The sheath stop: a block around the tendon, on the side away from the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheathStop {
    /// Entry point of the tendon from the switch.
    pub start: Point2,
    /// Direction of the tendon away from the switch; a unit vector.
    pub along: Vector2,
    /// Length along the tendon, mm.
    pub length_mm: f64,
    /// Half of the width of the block across the tendon, mm.
    pub half_width_mm: f64,
    /// Holes for its screws.
    pub screws: [Hole; 2],
}

impl SheathStop {
    /// Returns the stop at the origin, with the tendon along +x.
    pub fn along_the_paper(&self) -> Self {
        let outwards = Vector2::new(-self.along.y, self.along.x);
        let screws = self.screws.map(|hole| {
            let from = hole.centre - self.start;
            Hole { centre: Point2::new(from.dot(&self.along), from.dot(&outwards)), ..hole }
        });
        Self { start: Point2::origin(), along: Vector2::x(), screws, ..*self }
    }
}

impl Mounting {
    /// Returns the axles of the guide pulleys, that on the side of the load first.
    pub fn axles(&self) -> impl Iterator<Item = Hole> {
        self.axle.into_iter().chain(self.drive_axle)
    }
}

/// A mounting plate with its holes.
#[derive(Clone, Debug, PartialEq)]
pub struct Mounting {
    /// Holes for the screws of the plate, or at the end of the proximal link.
    pub holes: Vec<Hole>,
    /// Axle of the guide pulley on the side of the load, on the rig.
    pub axle: Option<Hole>,
    /// Axle of the guide pulley on the side of the drive, on the rig without a sheath.
    pub drive_axle: Option<Hole>,
    /// The sheath stop.
    pub sheath: Option<SheathStop>,
    /// Areas of all holes, including those of the fasteners, with their recesses.
    pub taken: Vec<Hole>,
    /// Discs whose convex hull is the plate, or the left part of a board in two parts.
    pub discs: Vec<Disc>,
}

impl Dimensions {
    /// Returns the radius of the axis of the tendon where it rests on the silicone.
    pub fn tendon_axis_radius_mm(&self) -> f64 {
        self.contact_radius_mm() + self.tendon_diameter_mm() / 2.0
    }

    /// Returns half of the wrap angle.
    pub fn half_wrap_rad(&self) -> f64 {
        self.configuration().layout.wrap_angle_deg.to_radians() / 2.0
    }

    /// Returns the height of the base of the sheath stop above the plate, mm. The sheath rests on
    /// the base, with its axis in the middle of the switch.
    pub fn sheath_floor_mm(&self) -> f64 {
        let c = self.configuration();
        c.support.plate_mm + c.shell.width_mm / 2.0 - c.tendon.sheath_diameter_mm / 2.0
    }

    /// Returns the mounting plate; `None` without one.
    pub fn mounting(&self) -> Option<Mounting> {
        let c = self.configuration();
        let m = &c.mount;
        let radius_mm = m.hole_diameter_mm / 2.0;
        let hole = |centre: Point2| Hole { centre, radius_mm };
        let rig = self.rig_layout();
        let holes = match m.kind {
            MountKind::None => return None,
            MountKind::Flange => self.flange_holes().map(hole).to_vec(),
            MountKind::Joint => self.joint().map_or(Vec::new(), |j| j.proximal.holes.to_vec()),
            MountKind::Rig => {
                let joint = rig.iter().filter_map(|rig| rig.joint.as_ref());
                let joint = joint.flat_map(|joint| joint.left.into_iter().chain(joint.right));
                rig.iter().flat_map(|rig| rig.foot_bolts).chain(joint).collect()
            }
        };
        let pulley = |centre: Point2| Hole { centre, radius_mm: AXLE_HOLE_MM / 2.0 };
        let axle = rig.as_ref().map(|rig| pulley(rig.load_axle));
        let drive_axle = rig.as_ref().filter(|_| self.has_drive_pulley()).map(|rig| pulley(rig.drive_axle));
        let sheath = self.sheath_stop();
        let rim = m.rim_mm;
        let axles: Vec<Hole> = axle.into_iter().chain(drive_axle).collect();
        let mut all = self.taken(&holes, &axles, sheath.as_ref());
        if let Some(joint) = self.joint() {
            all.push(Hole { centre: Point2::origin(), radius_mm: joint.head_recess().along_mm });
            let discs = joint.outline_discs(self, true);
            return Some(Mounting { holes, axle, drive_axle, sheath, taken: all, discs });
        }
        let discs = match &rig {
            Some(rig) => self.board_parts(rig).swap_remove(0),
            None => all.iter().map(|h| Disc { centre: h.centre, radius_mm: h.radius_mm + rim }).collect(),
        };
        Some(Mounting { holes, axle, drive_axle, sheath, taken: all, discs })
    }

    /// Returns the areas of all holes with their recesses: those of the plate, the axle, the
    /// fasteners and the sheath stop.
    fn taken(&self, holes: &[Hole], axles: &[Hole], sheath: Option<&SheathStop>) -> Vec<Hole> {
        let fasteners = self
            .fastener_angles_rad()
            .into_iter()
            .map(|a| Hole { centre: polar(self.fastener_radius_mm(), a), radius_mm: self.mount_along_mm() });
        let axles = axles.iter().map(|h| Hole { radius_mm: axle_recess().along_mm, ..*h });
        let screws = sheath.map_or(Vec::new(), |s| s.screws.to_vec()).into_iter();
        let screws = screws.map(|h| Hole { radius_mm: stop_recess().along_mm, ..h });
        holes.iter().copied().chain(axles).chain(fasteners).chain(screws).collect()
    }

    /// Returns the centres of the four holes around the supports.
    fn flange_holes(&self) -> [Point2; 4] {
        let m = &self.configuration().mount;
        let half = self.half_span_rad();
        let reach = self.support_radius_mm();
        let beside = m.rim_mm + m.hole_diameter_mm / 2.0;
        let x = reach * libm::sin(half.min(std::f64::consts::FRAC_PI_2)) + self.shell_end_shift_mm() + beside;
        let (low, high) = (self.inner_radius_mm() * libm::cos(half), reach);
        [[-x, low], [x, low], [-x, high], [x, high]].map(|[x, y]| Point2::new(x, y))
    }

    /// Returns the sheath stop on the side away from the load; `None` without a sheath.
    pub(super) fn sheath_stop(&self) -> Option<SheathStop> {
        let sheath = self.configuration().tendon.sheath_diameter_mm;
        if sheath <= 0.0 {
            return None;
        }
        let leaves = self.half_wrap_rad();
        let outwards = polar(1.0, leaves).coords;
        let along = Vector2::new(outwards.y, -outwards.x);
        let axis = self.tendon_axis_radius_mm();
        // Beyond the supports, whose corners are within their outer radius.
        let clear = self.support_radius_mm() + STOP_WALL_MM;
        let half_width_mm = sheath / 2.0 + 2.0 * STOP_WALL_MM + STOP_HOLE_MM + STOP_WALL_MM;
        let inner = (axis - half_width_mm).max(0.0);
        let start = Point2::from(outwards * axis) + along * (clear.powi(2) - inner.powi(2)).max(0.0).sqrt();
        let aside = half_width_mm - STOP_WALL_MM - STOP_HOLE_MM / 2.0;
        let middle = start + along * (STOP_LENGTH_MM / 2.0);
        let screws =
            [-aside, aside].map(|by| Hole { centre: middle + outwards * by, radius_mm: STOP_HOLE_MM / 2.0 });
        Some(SheathStop { start, along, length_mm: STOP_LENGTH_MM, half_width_mm, screws })
    }
}
