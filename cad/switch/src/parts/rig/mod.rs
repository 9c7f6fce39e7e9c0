//! Printed parts of the test rig (cad/doc/rig.md): board, feet, cell mount and drive. All are prisms along the axis of the
//! switch, so that the board is upright when it is printed flat.

mod board;
mod cell_mount;
mod drive;
mod foot;

pub(super) use board::{left_board, right_board, splice};
pub(crate) use cell_mount::cell_bolts;
pub(super) use cell_mount::cell_mount;
pub(crate) use drive::front_mm;
use drive::{AXLE_HOLE_MM, LOCK_HOLE_MM};
pub(super) use drive::{actuator_foot, crank_drum, crank_foot, crank_knob};
pub(super) use foot::{left as left_foot, right as right_foot};
use pinswitch_diagnostic::codes;

use crate::config::{CellKind, ConfigError, Configuration, DriveKind, MountKind, field_location};
use crate::design::rig::{LOCK_MM, M6_HOLE_MM};
use crate::design::{Design, Dimensions, Hole, RigLayout};
use pinswitch_solid::profile::Point2;

/// Clearance of a bolt in its hole, mm.
const PLAY_MM: f64 = 0.5;

/// Returns whether a configuration has a rig.
pub(super) fn is_rig(c: &Configuration) -> bool {
    c.mount.kind == MountKind::Rig
}

/// Returns whether the board of the rig has two parts.
pub(super) fn has_joint(c: &Configuration) -> bool {
    is_rig(c) && Dimensions::new(c.clone()).has_board_joint()
}

/// Returns whether the rig has a guide pulley on the side of the drive.
pub(super) fn has_drive_pulley(c: &Configuration) -> bool {
    Dimensions::new(c.clone()).has_drive_pulley()
}

/// Returns whether the rig has this drive.
pub(super) fn has_drive(c: &Configuration, drive: DriveKind) -> bool {
    is_rig(c) && c.rig.drive == drive
}

fn layout(design: &Design) -> Result<RigLayout, ConfigError> {
    design.rig_layout().ok_or_else(|| {
        ConfigError::new(codes::INTERNAL_ERROR, "no rig").with_location(field_location("mount.kind"))
    })
}

/// Height of the middle of the switch in the assembly, mm: that of the tendon.
pub(crate) fn middle_mm(design: &Dimensions) -> f64 {
    design.configuration().shell.width_mm / 2.0
}

/// Length of the cell along the tendon, mm.
pub(crate) fn cell_length_mm(c: &Configuration) -> f64 {
    match c.rig.cell {
        CellKind::SBeam => c.rig.s_beam_length_mm,
        CellKind::Bar => c.rig.bar_side_mm,
    }
}

/// Returns the holes for bolts of a part of the stand, about the origin of its drawing.
pub(crate) fn stand_holes(design: &Design, name: &str) -> Vec<Hole> {
    let Some(layout) = design.rig_layout() else { return Vec::new() };
    let rig = &design.configuration().rig;
    let hole = |x: f64, y: f64, radius_mm: f64| Hole { centre: Point2::new(x, y), radius_mm };
    let pin = (rig.clevis_pin_mm + PLAY_MM) / 2.0;
    match name {
        "rig-foot-left" | "rig-foot-right" => layout.foot_bolts[..2]
            .iter()
            .map(|h| hole(0.0, h.centre.y - layout.table_y_mm, h.radius_mm))
            .collect(),
        "cell-mount" | "actuator-foot" => vec![hole(0.0, 0.0, pin)],
        "crank-foot" => vec![hole(0.0, 0.0, AXLE_HOLE_MM / 2.0), hole(0.0, -LOCK_MM, LOCK_HOLE_MM / 2.0)],
        "crank-knob" => vec![hole(0.0, 0.0, M6_HOLE_MM / 2.0)],
        "crank-drum" => drive::drum_holes(design, Point2::origin()),
        _ => Vec::new(),
    }
}
