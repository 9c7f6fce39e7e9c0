//! Rules of the printer: errors, warnings, and checks for a person.

use super::Direction::{Lower, Raise};
use super::{Assessment, Inspection, Remedy, Rule, Severity, advise, require};
use crate::config::MountKind;
use crate::design::axle_recess;
use pinswitch_diagnostic::codes;

/// Least chamfer of a bottom edge.
const MIN_CHAMFER_MM: f64 = 0.02;
/// Longest bridge that prints without sagging, mm (cad/doc/print-limits.md).
const LONGEST_BRIDGE_MM: f64 = 10.0;
/// Difference under which two bridges are the same, mm.
const SAME_BRIDGE_MM: f64 = 0.01;
/// Gap under which slicers close it, mm (cad/doc/print-limits.md).
const MIN_GAP_MM: f64 = 0.1;
/// Good thickness of the wall around a screw hole, mm.
const GOOD_RIM_MM: f64 = 1.0;

pub(super) const RULES: &[Rule] = &[
    Rule {
        code: codes::CHAMFER_TOO_SMALL,
        field: "print.elephant_foot_mm",
        severity: Severity::Error,
        assess: chamfer_prints,
    },
    Rule {
        code: codes::LABEL_STROKE_TOO_THIN,
        field: "label.stroke_mm",
        severity: Severity::Warning,
        assess: label_stroke,
    },
    Rule {
        code: codes::GROOVES_UNDER_FOUR_LAYERS,
        field: "print.layer_mm",
        severity: Severity::Warning,
        assess: layers_per_groove,
    },
    Rule {
        code: codes::LINE_UNDER_NOZZLE,
        field: "print.line_mm",
        severity: Severity::Checklist,
        assess: line_of_nozzle,
    },
    Rule {
        code: codes::LAYER_TOO_THICK,
        field: "print.layer_mm",
        severity: Severity::Checklist,
        assess: layer_of_nozzle,
    },
    Rule {
        code: codes::SLOTS_CLOSE_WHEN_SLICED,
        field: "support.slot_clearance_mm",
        severity: Severity::Checklist,
        assess: open_slots,
    },
    Rule {
        code: codes::SLOT_FLOOR_TOO_THIN,
        field: "support.slot_floor_mm",
        severity: Severity::Checklist,
        assess: slot_floor,
    },
    Rule {
        code: codes::BRIDGE_TOO_LONG,
        field: "pins.diameter_mm",
        severity: Severity::Checklist,
        assess: bridges,
    },
    Rule {
        code: codes::NARROW_LAND,
        field: "shell.outer_radius_mm",
        severity: Severity::Checklist,
        assess: lands,
    },
    Rule {
        code: codes::THIN_RIM_OF_HOLES,
        field: "shell.wall_mm",
        severity: Severity::Checklist,
        assess: rim_of_holes,
    },
];

/// A line of the checklist, with the same statement whether it is satisfied or not.
fn check(is_satisfied: bool, statement: String, remedy: &str) -> Assessment {
    if is_satisfied {
        Assessment::Satisfied(statement)
    } else {
        Assessment::Broken { problem: statement, remedy: Remedy::Text(remedy.to_owned()) }
    }
}

/// A chamfer is either omitted or large enough to print. A smaller one would also make facets that are too thin.
fn chamfer_prints(i: &Inspection<'_>) -> Assessment {
    let chamfer = i.configuration().print.elephant_foot_mm;
    require(chamfer == 0.0 || chamfer >= MIN_CHAMFER_MM, || {
        (
            format!("chamfer too small to print (at least {MIN_CHAMFER_MM} mm needed, or 0 for no chamfer)"),
            &[Raise("print.elephant_foot_mm"), Lower("print.elephant_foot_mm")],
        )
    })
}

fn label_stroke(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    advise(!c.label.engrave || c.label.stroke_mm >= c.print.line_mm, || {
        (
            format!(
                "label.stroke_mm = {} is less than one printed line ({} mm)",
                c.label.stroke_mm, c.print.line_mm
            ),
            "raise it".to_owned(),
        )
    })
}

fn layers_per_groove(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    advise(4.0 * c.print.layer_mm <= 2.0 * c.segment.groove_radius_mm, || {
        (
            format!("grooves are narrower than four layers of print.layer_mm = {}", c.print.layer_mm),
            "use thinner layers".to_owned(),
        )
    })
}

fn line_of_nozzle(i: &Inspection<'_>) -> Assessment {
    let p = &i.configuration().print;
    check(
        p.line_mm >= p.nozzle_mm,
        format!("a line of {} mm from a nozzle of {} mm", p.line_mm, p.nozzle_mm),
        "raise print.line_mm to the nozzle or more",
    )
}

fn layer_of_nozzle(i: &Inspection<'_>) -> Assessment {
    let p = &i.configuration().print;
    check(
        p.layer_mm <= 0.8 * p.nozzle_mm,
        format!("layers of {} mm, at most four fifths of the nozzle", p.layer_mm),
        "lower print.layer_mm",
    )
}

fn open_slots(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let clearance = c.support.slot_clearance_mm;
    if c.layout.pins.is_empty() {
        return Assessment::NotApplicable;
    }
    check(
        clearance >= MIN_GAP_MM,
        format!(
            "slots {clearance} mm wider than a pin of {} mm; slicers close gaps under {MIN_GAP_MM:.2} mm",
            c.pins.diameter_mm
        ),
        "raise support.slot_clearance_mm",
    )
}

fn slot_floor(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    check(
        c.support.slot_floor_mm >= 3.0 * c.print.layer_mm,
        format!("slot floors of {} mm, three layers or more", c.support.slot_floor_mm),
        "raise support.slot_floor_mm",
    )
}

fn bridges(i: &Inspection<'_>) -> Assessment {
    let pocket = match i.configuration().mount.kind {
        MountKind::Rig => Some(axle_recess()),
        _ => i.joint().map(|joint| joint.head_recess()),
    };
    i.widest_bridge_mm.map_or(Assessment::NotApplicable, |bridge| {
        let is_pocket = pocket.is_some_and(|p| (bridge - 2.0 * p.radial_mm).abs() < SAME_BRIDGE_MM);
        check(
            bridge <= LONGEST_BRIDGE_MM,
            format!("bridges of up to {bridge:.2} mm, up to {LONGEST_BRIDGE_MM} mm print well"),
            match i.configuration().mount.kind {
                MountKind::Rig if is_pocket => {
                    "ignore it: it is the skin over the pocket for the bolt in rig-plate, which the bolt breaks"
                }
                MountKind::Joint if is_pocket => {
                    "ignore it: it is the skin over the pocket for the axle in link-proximal, which the axle breaks"
                }
                _ => "lower pins.diameter_mm or mould.key_diameter_mm",
            },
        )
    })
}

fn lands(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.segment.grooves < 2 {
        return Assessment::NotApplicable;
    }
    let (land, two_lines) = (i.land_mm(), 2.0 * c.print.line_mm);
    check(
        land >= two_lines,
        format!("lands of {land:.2} mm between grooves, two lines are {two_lines:.2} mm"),
        "raise shell.outer_radius_mm or lower segment.grooves",
    )
}

fn rim_of_holes(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.fasteners.count == 0 {
        return Assessment::NotApplicable;
    }
    // Greatest width of a fastener across the wall: its hole or insert in the shell, its recess in the supports.
    let fastening = i.fastening();
    let (middle, hole) = (i.fastener_radius_mm(), c.fasteners.hole_diameter_mm / 2.0);
    let in_shell = i.shell_hole_mm();
    let recesses = [fastening.nut_trap, fastening.counterbore].into_iter().flatten();
    let in_support = recesses.fold(hole, |widest, r| widest.max(r.radial_mm));
    let of_shell = (c.shell.wall_mm - c.segment.groove_radius_mm) / 2.0 - in_shell;
    let of_support = (middle - i.inner_radius_mm()).min(i.slot().inner_edge_mm() - middle) - in_support;
    let rim = of_shell.min(of_support);
    let what = match (in_shell > hole, in_support > hole && of_support < of_shell) {
        (_, true) => "the recesses for heads or nuts",
        (true, false) => "the inserts",
        (false, false) => "the screw holes",
    };
    check(
        rim >= GOOD_RIM_MM,
        format!("{rim:.2} mm of wall around {what}, {GOOD_RIM_MM:.1} is good"),
        "raise shell.wall_mm or lower fasteners.hole_diameter_mm",
    )
}
