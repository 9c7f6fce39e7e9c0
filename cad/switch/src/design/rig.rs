//! Layout of the test rig (`cad/doc/rig.md`): board, guide pulleys, table, load, cell and drive.
//!
//! The board is upright, in the plane of the switch: gravity acts along -y, and the table is
//! horizontal. The load hangs beyond the table's edge. The drive pulls horizontally.

use super::mounting::{Hole, PULLEY_RADIUS_MM, pulley_outer_mm};
use super::{Dimensions, axle_recess};
use crate::config::{CellKind, DriveKind, MountKind};
use pinswitch_solid::files::BED_EDGE_MM;
use pinswitch_solid::profile::{Disc, Point2, Vector2, polar};

/// Gap between the weights and the table's edge, mm.
pub(crate) const WEIGHT_AIR_MM: f64 = 10.0;
/// Distance of the board from the table's edge, mm.
const EDGE_MM: f64 = 2.0;
/// Width of a foot on the table, and of its web, mm. A clamp presses on both sides of the web.
pub(crate) const FOOT_WIDTH_MM: f64 = 60.0;
pub(crate) const FOOT_WEB_MM: f64 = 18.0;
/// Height of the base and of the web of a foot, mm.
pub(crate) const FOOT_BASE_MM: f64 = 10.0;
pub(crate) const FOOT_HEIGHT_MM: f64 = 46.0;
/// Depth of a foot behind the board, mm: with the board, washers and nut, an M6 x 100 bolt.
pub(crate) const FOOT_DEPTH_MM: f64 = 80.0;
/// Heights of the two bolts of a foot above the table, mm.
const FOOT_BOLTS_MM: [f64; 2] = [12.0, 36.0];
/// Clearance hole of an M6 bolt, mm (ISO 273, medium).
pub(crate) const M6_HOLE_MM: f64 = 6.6;
/// Gap between the bases of the two feet, mm.
const FEET_APART_MM: f64 = 5.0;
/// Radius of the lower corners of the board, mm.
const CORNER_MM: f64 = 3.0;
/// Distance of the screws of the splice from the middle of the joint, mm.
const SPLICE_HALF_MM: f64 = 10.0;
/// Least distance between features on both sides of the joint of a board in two parts, mm.
const JOINT_ROOM_MM: f64 = 30.0;

/// Gap between the guide pulley or the board and the eye bolt of the cell, at the end of the stroke, mm.
const TRAIN_AIR_MM: f64 = 15.0;
/// Length of the eye bolt in front of the cell, mm.
pub(crate) const EYE_MM: f64 = 25.0;
/// Thickness of the wall of the cell mount, along the tendon, mm.
pub(crate) const CELL_WALL_MM: f64 = 16.0;
/// Distance between the wall of the cell mount and the bolt of the drive, mm: a wrench turns there.
pub(crate) const CELL_ROOM_MM: f64 = 30.0;
/// Thickness of the plate of the cell mount, mm.
pub(crate) const CELL_PLATE_MM: f64 = 6.0;
/// Thickness of an M6 or M8 washer, mm (ISO 7089).
pub(crate) const WASHER_MM: f64 = 1.6;
/// Play between the cell mount, and the cell or a head above its plate, mm.
const CELL_PLAY_MM: f64 = 0.5;

/// Depth of the foot of the drive along z, mm.
pub(crate) const DRIVE_DEPTH_MM: f64 = 40.0;
/// Radius of the drum of the crank, mm.
pub(crate) const DRUM_MM: f64 = 20.0;
/// Thickness of the face plate of the drum, and width of the bottom of its groove, mm.
pub(crate) const DRUM_FACE_MM: f64 = 8.0;
pub(crate) const DRUM_GROOVE_MM: f64 = 9.0;
/// Radius and width of the rim of the drum's flange, mm. The slope from the groove to the rim is 45 deg.
pub(crate) const DRUM_FLANGE_MM: f64 = 26.0;
const DRUM_RIM_MM: f64 = 2.0;
/// Height of the middle of the drum's groove over its outer face, mm.
pub(crate) const DRUM_MIDDLE_MM: f64 = DRUM_FACE_MM + DRUM_GROOVE_MM / 2.0;
/// Length of the drum and of the knob of the crank along their axes, mm.
pub(crate) const DRUM_LENGTH_MM: f64 =
    DRUM_FACE_MM + DRUM_GROOVE_MM + (DRUM_FLANGE_MM - DRUM_MM) + DRUM_RIM_MM;
pub(crate) const KNOB_LENGTH_MM: f64 = 45.0;
/// Length of the lever of the crank without a table below it, and its least distance from the table, mm: for the knob and
/// the fingers around it.
const LEVER_MM: f64 = 75.0;
const LEVER_ROOM_MM: f64 = 18.0;
/// Radius of the circle of the drum's locking holes, mm, and their number.
pub(crate) const LOCK_MM: f64 = 30.0;
pub(crate) const LOCKS: usize = 24;
/// Distance between the axis of the drum and the cell mount at the end of the stroke, mm.
const DRUM_APART_MM: f64 = 70.0;

/// Positions of the rig in the frame of the assembly, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct RigLayout {
    /// Axis of the guide pulley on the side of the load.
    pub load_axle: Point2,
    /// Axis of the guide pulley on the side of the drive.
    pub drive_axle: Point2,
    /// x of the hanging tendon.
    pub load_x_mm: f64,
    /// y of the tendon between the guide pulley and the drive.
    pub line_y_mm: f64,
    /// y of the table's top. Weights stay below it.
    pub table_y_mm: f64,
    /// x of the table's edge; the table is at larger x.
    pub edge_x_mm: f64,
    /// Left and right end of the board on the table.
    pub board_x_mm: [f64; 2],
    /// x of the middles of the feet.
    pub feet_x_mm: [f64; 2],
    /// Holes for the bolts of the feet.
    pub foot_bolts: [Hole; 4],
    /// x of the bolt between cell mount and drive: with the load lowered, and with it lifted.
    pub pin_x_mm: [f64; 2],
    /// Height of the axis of the tendon above the plate of the cell mount.
    pub cell_height_mm: f64,
    /// Number of washers under the eye of the actuator.
    pub packing: usize,
    /// Axis of the drive: of the actuator's rear bolt, or of the drum.
    pub drive: Point2,
    /// The joint of a board in two parts.
    pub joint: Option<BoardJoint>,
}

/// The joint of a board in two parts, which a splice behind it connects.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardJoint {
    /// Holes for the screws in the left part.
    pub left: [Hole; 2],
    /// Holes for the screws in the right part.
    pub right: [Hole; 2],
}

/// Width across flats of a hexagon head for a metric thread, mm; at least that of ISO 4014.
pub(crate) fn flats_mm(thread_mm: f64) -> f64 {
    1.5 * thread_mm + 1.0
}

/// Half of the width across corners of a hexagon head, mm.
fn half_corners_mm(thread_mm: f64) -> f64 {
    flats_mm(thread_mm) / 3f64.sqrt()
}

impl Dimensions {
    /// Returns whether the design has the guide pulley on the side of the drive. A sheath replaces it.
    pub(crate) fn has_drive_pulley(&self) -> bool {
        let c = self.configuration();
        c.mount.kind == MountKind::Rig && c.tendon.sheath_diameter_mm == 0.0
    }

    /// Returns the layout of the rig; `None` for another mount.
    pub fn rig_layout(&self) -> Option<RigLayout> {
        let c = self.configuration();
        if c.mount.kind != MountKind::Rig {
            return None;
        }
        let rig = &c.rig;
        let half = self.half_wrap_rad();
        let groove_mm = PULLEY_RADIUS_MM + self.tendon_diameter_mm() / 2.0;
        let outer_mm = pulley_outer_mm(self.tendon_diameter_mm());
        // On the side of the load the tendon bends in the same sense, on the other side it bends back.
        let axle = |side: f64, drop_mm: f64| {
            let outwards = polar(1.0, side * half).coords;
            let along = Vector2::new(outwards.y, -outwards.x) * side;
            Point2::from(outwards * drop_mm + along * c.mount.pulley_distance_mm)
        };
        let load_axle = axle(-1.0, self.tendon_axis_radius_mm() - groove_mm);
        let drive_axle = axle(1.0, self.tendon_axis_radius_mm() + groove_mm);
        let load_x_mm = load_axle.x - groove_mm;
        let line_y_mm = drive_axle.y - groove_mm;
        let table_y_mm = line_y_mm - rig.tendon_height_mm;
        let edge_x_mm = load_x_mm + rig.weight_diameter_mm / 2.0 + WEIGHT_AIR_MM;
        let left = edge_x_mm + EDGE_MM;
        let right = (drive_axle.x + outer_mm).max(left + 2.0 * FOOT_WIDTH_MM + FEET_APART_MM);
        let feet_x_mm = [left + FOOT_WIDTH_MM / 2.0, right - FOOT_WIDTH_MM / 2.0];
        let bolt =
            |x: f64, up: f64| Hole { centre: Point2::new(x, table_y_mm + up), radius_mm: M6_HOLE_MM / 2.0 };
        let [low, high] = FOOT_BOLTS_MM;
        let foot_bolts = [
            bolt(feet_x_mm[0], low),
            bolt(feet_x_mm[0], high),
            bolt(feet_x_mm[1], low),
            bolt(feet_x_mm[1], high),
        ];
        let (needed_mm, cell_mm) = match rig.cell {
            CellKind::SBeam => (
                half_corners_mm(rig.s_beam_thread_mm).max(rig.s_beam_thickness_mm / 2.0),
                rig.s_beam_length_mm,
            ),
            CellKind::Bar => (half_corners_mm(rig.bar_screw_mm).max(rig.bar_side_mm / 2.0), rig.bar_side_mm),
        };
        let half_eye = rig.clevis_mm / 2.0;
        let packing = ((needed_mm + CELL_PLAY_MM - half_eye) / WASHER_MM).ceil().max(1.0);
        let (packing, cell_height_mm) = match rig.drive {
            DriveKind::Actuator => (packing, half_eye + packing * WASHER_MM),
            DriveKind::Crank => (0.0, needed_mm + CELL_PLAY_MM),
        };
        let lowered = right.max(drive_axle.x + outer_mm)
            + TRAIN_AIR_MM
            + EYE_MM
            + cell_mm
            + CELL_WALL_MM
            + CELL_ROOM_MM;
        let pin_x_mm = [lowered, lowered + rig.stroke_mm];
        let drive = match rig.drive {
            DriveKind::Actuator => Point2::new(lowered + rig.retracted_mm + rig.stroke_mm, line_y_mm),
            DriveKind::Crank => {
                let winding_mm = DRUM_MM + self.tendon_diameter_mm() / 2.0;
                Point2::new(pin_x_mm[1] + DRUM_APART_MM, line_y_mm + winding_mm)
            }
        };
        let mut layout = RigLayout {
            load_axle,
            drive_axle,
            load_x_mm,
            line_y_mm,
            table_y_mm,
            edge_x_mm,
            board_x_mm: [left, right],
            feet_x_mm,
            foot_bolts,
            pin_x_mm,
            cell_height_mm,
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            packing: packing as usize,
            drive,
            joint: None,
        };
        layout.joint = self.board_joint(&layout);
        Some(layout)
    }

    /// Returns the discs whose convex hull is the board, left of `x` and right of it.
    fn board_discs(&self, layout: &RigLayout, x: f64) -> [Vec<Disc>; 2] {
        let rim = self.configuration().mount.rim_mm;
        let disc = |centre: Point2, radius_mm: f64| Disc { centre, radius_mm };
        let recess = axle_recess().along_mm + rim;
        let fasteners = self
            .fastener_angles_rad()
            .into_iter()
            .map(|a| disc(polar(self.fastener_radius_mm(), a), self.mount_along_mm() + rim));
        let corners = layout.board_x_mm.into_iter().zip([CORNER_MM, -CORNER_MM]);
        let corners =
            corners.map(|(x, by)| disc(Point2::new(x + by, layout.table_y_mm + CORNER_MM), CORNER_MM));
        let bolts = layout.foot_bolts.iter().map(|h| disc(h.centre, h.radius_mm + rim));
        let drive = self.has_drive_pulley().then(|| disc(layout.drive_axle, recess));
        let stop = self.sheath_stop().into_iter().flat_map(|stop| stop.screws);
        let stop = stop.map(|h| disc(h.centre, super::stop_recess().along_mm + rim));
        let all = fasteners
            .chain(corners)
            .chain(bolts)
            .chain(drive)
            .chain(stop)
            .chain([disc(layout.load_axle, recess)]);
        let (left, right) = all.partition(|d: &Disc| d.centre.x < x);
        [left, right]
    }

    /// Returns the joint of a board that is too large for the bed in one part; `None` if it fits, or if there is no room
    /// for a joint.
    fn board_joint(&self, layout: &RigLayout) -> Option<BoardJoint> {
        let c = self.configuration();
        let [all, _] = self.board_discs(layout, f64::INFINITY);
        let extent = |of: fn(&Disc) -> [f64; 2]| {
            let ends = all
                .iter()
                .map(of)
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [c, d]| [a.min(c), b.max(d)]);
            ends[1] - ends[0]
        };
        let x = extent(|d| [d.centre.x - d.radius_mm, d.centre.x + d.radius_mm]);
        let y = extent(|d| [d.centre.y - d.radius_mm, d.centre.y + d.radius_mm]);
        if x.max(y) + 2.0 * BED_EDGE_MM <= c.print.bed_mm {
            return None;
        }
        let middle = layout.feet_x_mm[0].midpoint(layout.feet_x_mm[1]);
        let is_left = |angle: f64| polar(self.fastener_radius_mm(), angle).x < middle;
        if !self.fastener_angles_rad().into_iter().all(is_left) {
            return None;
        }
        let [left, right] = self.board_discs(layout, middle);
        let from = left.iter().map(|d| d.centre.x + d.radius_mm).fold(f64::NEG_INFINITY, f64::max);
        let to = right.iter().map(|d| d.centre.x - d.radius_mm).fold(f64::INFINITY, f64::min);
        if to - from < JOINT_ROOM_MM {
            return None;
        }
        let middle = from.midpoint(to);
        let radius_mm = c.mount.hole_diameter_mm / 2.0;
        let (low, high) = (layout.table_y_mm + FOOT_BASE_MM, layout.line_y_mm);
        let low = low + radius_mm + c.mount.rim_mm + 1.0;
        let at = |x: f64| [low, high.max(low + 20.0)].map(|y| Hole { centre: Point2::new(x, y), radius_mm });
        Some(BoardJoint { left: at(middle - SPLICE_HALF_MM), right: at(middle + SPLICE_HALF_MM) })
    }

    /// Returns the discs whose convex hulls are the parts of the board: one part, or two from left to right.
    pub(crate) fn board_parts(&self, layout: &RigLayout) -> Vec<Vec<Disc>> {
        let rim = self.configuration().mount.rim_mm;
        let Some(joint) = &layout.joint else {
            let [all, _] = self.board_discs(layout, f64::INFINITY);
            return vec![all];
        };
        let middle = joint.left[0].centre.x.midpoint(joint.right[0].centre.x);
        let [mut left, mut right] = self.board_discs(layout, middle);
        for (discs, holes) in [(&mut left, &joint.left), (&mut right, &joint.right)] {
            discs.extend(holes.iter().map(|h| Disc { centre: h.centre, radius_mm: h.radius_mm + rim }));
            let x = holes[0].centre.x;
            discs.push(Disc { centre: Point2::new(x, layout.table_y_mm + CORNER_MM), radius_mm: CORNER_MM });
        }
        vec![left, right]
    }

    /// Returns whether the board of the rig has two parts.
    pub(crate) fn has_board_joint(&self) -> bool {
        self.rig_layout().is_some_and(|layout| layout.joint.is_some())
    }

    /// Returns the length of the lever of the crank, mm: it clears the table.
    pub(crate) fn lever_mm(&self) -> f64 {
        (self.configuration().rig.tendon_height_mm + DRUM_MM - LEVER_ROOM_MM).min(LEVER_MM)
    }
}
