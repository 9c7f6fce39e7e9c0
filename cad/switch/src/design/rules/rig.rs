//! Rules for the test rig: load, cell and drive.

use super::Direction::{self, Lower, Raise, Set};
use super::{Assessment, Inspection, Rule, Severity, require};
use crate::config::{CellKind, DriveKind, MountKind};
use pinswitch_diagnostic::codes;
use pinswitch_friction::published;

/// Largest wrap at which the tendon leaves the switch toward a guide pulley that lets the load hang, degrees.
const MOST_WRAP_DEG: f64 = 150.0;
/// Wall between two slots of the cell mount, and around a thread in a cell, mm.
const SLOT_WALL_MM: f64 = 3.0;
const THREAD_WALL_MM: f64 = 1.0;
/// Least distance between the inner holes of a bar cell: its measuring section, mm.
const MEASURING_MM: f64 = 10.0;
/// Least difference between the retracted length and the stroke of an actuator, mm: its ends and eyes.
const ACTUATOR_ENDS_MM: f64 = 45.0;

pub(super) const RULES: &[Rule] = &[
    Rule {
        code: codes::LOAD_CANNOT_HANG,
        field: "layout.wrap_angle_deg",
        severity: Severity::Error,
        assess: load_hangs,
    },
    Rule {
        code: codes::CELL_TOO_WEAK,
        field: "rig.cell_limit_n",
        severity: Severity::Error,
        assess: cell_in_range,
    },
    Rule {
        code: codes::CELL_THREAD_TOO_WIDE,
        field: "rig.s_beam_thread_mm",
        severity: Severity::Error,
        assess: thread_in_s_beam,
    },
    Rule {
        code: codes::BAR_CELL_TOO_SHORT,
        field: "rig.bar_length_mm",
        severity: Severity::Error,
        assess: bar_holes_apart,
    },
    Rule {
        code: codes::BAR_HOLES_TOO_CLOSE,
        field: "rig.bar_hole_spacing_mm",
        severity: Severity::Error,
        assess: slots_apart,
    },
    Rule {
        code: codes::CELL_THREAD_TOO_WIDE,
        field: "rig.bar_screw_mm",
        severity: Severity::Error,
        assess: threads_in_bar,
    },
    Rule {
        code: codes::ACTUATOR_TOO_SHORT,
        field: "rig.retracted_mm",
        severity: Severity::Error,
        assess: actuator_holds_stroke,
    },
];

const NO_MOUNT: Direction = Set("mount.kind", "\"none\"");

/// Returns whether the design has a rig with this cell; any if `None`.
fn has_cell(i: &Inspection<'_>, cell: Option<CellKind>) -> bool {
    let c = i.configuration();
    c.mount.kind == MountKind::Rig && cell.is_none_or(|cell| c.rig.cell == cell)
}

fn load_hangs(i: &Inspection<'_>) -> Assessment {
    if !has_cell(i, None) {
        return Assessment::NotApplicable;
    }
    let wrap = i.configuration().layout.wrap_angle_deg;
    require(wrap <= MOST_WRAP_DEG, || {
        (
            format!("the load of the rig cannot hang free ({wrap} deg, at most {MOST_WRAP_DEG} deg)"),
            &[Lower("layout.wrap_angle_deg"), Set("mount.kind", "\"flange\""), NO_MOUNT],
        )
    })
}

/// The cell must measure the heaviest load of the paper with the largest measured friction.
fn cell_in_range(i: &Inspection<'_>) -> Assessment {
    if !has_cell(i, None) {
        return Assessment::NotApplicable;
    }
    let rig = &i.configuration().rig;
    let heaviest_g = published::WEIGHTS_G.iter().copied().fold(0.0, f64::max) + rig.hook_mass_g;
    let least = heaviest_g * 1e-3 * published::GRAVITY_M_S2 + published::SILICONE_ALONE_MAX_N;
    require(rig.cell_limit_n >= least, || {
        (
            format!(
                "load cell too weak for the paper's heaviest load with its friction (at least {least:.1} N needed)"
            ),
            &[Raise("rig.cell_limit_n"), Lower("rig.hook_mass_g"), NO_MOUNT],
        )
    })
}

fn thread_in_s_beam(i: &Inspection<'_>) -> Assessment {
    if !has_cell(i, Some(CellKind::SBeam)) {
        return Assessment::NotApplicable;
    }
    let rig = &i.configuration().rig;
    let most = rig.s_beam_thickness_mm.min(rig.s_beam_width_mm) - 2.0 * THREAD_WALL_MM;
    require(rig.s_beam_thread_mm <= most, || {
        (
            format!("thread too wide for the S-beam (M{}, at most M{most:.1})", rig.s_beam_thread_mm),
            &[
                Lower("rig.s_beam_thread_mm"),
                Raise("rig.s_beam_thickness_mm"),
                Raise("rig.s_beam_width_mm"),
                Set("rig.cell", "\"bar\""),
                NO_MOUNT,
            ],
        )
    })
}

fn bar_holes_apart(i: &Inspection<'_>) -> Assessment {
    if !has_cell(i, Some(CellKind::Bar)) {
        return Assessment::NotApplicable;
    }
    let rig = &i.configuration().rig;
    let least = 2.0 * (rig.bar_hole_inset_mm + rig.bar_hole_spacing_mm) + MEASURING_MM;
    require(rig.bar_length_mm >= least, || {
        (
            format!("bar too short for its holes (at least {least:.1} mm needed)"),
            &[
                Raise("rig.bar_length_mm"),
                Lower("rig.bar_hole_spacing_mm"),
                Lower("rig.bar_hole_inset_mm"),
                Set("rig.cell", "\"s-beam\""),
                NO_MOUNT,
            ],
        )
    })
}

/// A wall remains between the slots for the screws of a bar.
fn slots_apart(i: &Inspection<'_>) -> Assessment {
    if !has_cell(i, Some(CellKind::Bar)) {
        return Assessment::NotApplicable;
    }
    let rig = &i.configuration().rig;
    let least = 1.5 * rig.bar_screw_mm + SLOT_WALL_MM;
    require(rig.bar_hole_spacing_mm >= least, || {
        (
            format!(
                "holes of the bar too close for the heads of M{} (at least {least:.1} mm needed)",
                rig.bar_screw_mm
            ),
            &[
                Raise("rig.bar_hole_spacing_mm"),
                Lower("rig.bar_screw_mm"),
                Set("rig.cell", "\"s-beam\""),
                NO_MOUNT,
            ],
        )
    })
}

fn threads_in_bar(i: &Inspection<'_>) -> Assessment {
    if !has_cell(i, Some(CellKind::Bar)) {
        return Assessment::NotApplicable;
    }
    let rig = &i.configuration().rig;
    let most =
        (rig.bar_side_mm - 2.0 * THREAD_WALL_MM).min(2.0 * (rig.bar_hole_inset_mm - THREAD_WALL_MM / 2.0));
    let widest = rig.bar_screw_mm.max(rig.bar_load_thread_mm);
    require(widest <= most, || {
        (
            format!("thread too wide for the bar (M{widest}, at most M{most:.1})"),
            &[
                Lower("rig.bar_screw_mm"),
                Raise("rig.bar_hole_inset_mm"),
                Raise("rig.bar_side_mm"),
                Lower("rig.bar_load_thread_mm"),
                Set("rig.cell", "\"s-beam\""),
                NO_MOUNT,
            ],
        )
    })
}

fn actuator_holds_stroke(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.mount.kind != MountKind::Rig || c.rig.drive != DriveKind::Actuator {
        return Assessment::NotApplicable;
    }
    let least = c.rig.stroke_mm + ACTUATOR_ENDS_MM;
    require(c.rig.retracted_mm >= least, || {
        (
            format!("actuator too short for its stroke (at least {least:.1} mm between its holes needed)"),
            &[Raise("rig.retracted_mm"), Lower("rig.stroke_mm"), Set("rig.drive", "\"crank\""), NO_MOUNT],
        )
    })
}
