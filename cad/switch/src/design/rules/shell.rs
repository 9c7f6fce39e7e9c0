//! Rules for the grooved sector of the shell.

use super::Direction::{Lower, Raise, Restore};
use super::{Assessment, Inspection, Rule, Severity, advise, least_wall_mm, require};
use pinswitch_diagnostic::codes;

/// Least inner radius of the shell, mm: leaves room for the core of a mould.
pub(super) const MIN_INNER_RADIUS_MM: f64 = 1.0;

pub(super) const RULES: &[Rule] = &[
    Rule {
        code: codes::SHELL_INNER_RADIUS,
        field: "shell.wall_mm",
        severity: Severity::Error,
        assess: inner_radius,
    },
    Rule {
        code: codes::WALL_UNDER_GROOVES,
        field: "shell.wall_mm",
        severity: Severity::Error,
        assess: wall_under_grooves,
    },
    Rule { code: codes::GROOVES_OVERLAP, field: "segment.grooves", severity: Severity::Error, assess: land },
    Rule {
        code: codes::END_WALL_TOO_THIN,
        field: "segment.end_margin_mm",
        severity: Severity::Error,
        assess: end_walls,
    },
    Rule {
        code: codes::NARROW_LAND,
        field: "shell.outer_radius_mm",
        severity: Severity::Warning,
        assess: thin_land,
    },
    Rule {
        code: codes::NARROW_END_WALL,
        field: "segment.end_margin_mm",
        severity: Severity::Warning,
        assess: thin_end_walls,
    },
];

fn inner_radius(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let inside = i.inner_radius_mm();
    require(c.shell.wall_mm <= c.shell.outer_radius_mm - MIN_INNER_RADIUS_MM, || {
        (
            format!(
                "inner radius of the shell too small ({inside:.3} mm, at least {MIN_INNER_RADIUS_MM} mm needed)"
            ),
            &[Lower("shell.wall_mm"), Raise("shell.outer_radius_mm")],
        )
    })
}

fn wall_under_grooves(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let least = c.segment.groove_radius_mm + 2.0 * c.print.least_wall_mm;
    require(c.shell.wall_mm >= least, || {
        (
            format!(
                "wall under the grooves too thin (at least {least:.3} mm needed, two walls and a groove)"
            ),
            &[Raise("shell.wall_mm"), Lower("segment.groove_radius_mm"), Restore("print.least_wall_mm")],
        )
    })
}

/// The land between grooves is narrowest on the shell (cad/doc/print-limits.md).
fn land(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.segment.grooves < 2 {
        return Assessment::NotApplicable;
    }
    let needed = 2.0 * c.segment.groove_radius_mm + least_wall_mm(c, 1.0);
    let chord = i.groove_chord_mm();
    require(chord >= needed, || {
        (
            format!("grooves overlap ({chord:.3} mm apart, at least {needed:.3} mm needed)"),
            &[
                Lower("segment.grooves"),
                Raise("shell.outer_radius_mm"),
                Lower("segment.groove_radius_mm"),
                Raise("segment.span_deg"),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

/// The wall between the outermost groove and the end of the sector is half a land plus the margin.
fn end_walls(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let left = c.shell.outer_radius_mm * libm::sin(i.half_pitch_rad()) + c.segment.end_margin_mm
        - c.segment.groove_radius_mm;
    let least = least_wall_mm(c, 0.5);
    require(left >= least, || {
        (
            format!(
                "wall beyond the outermost groove too thin ({left:.3} mm, at least {least:.3} mm needed)"
            ),
            &[
                Raise("segment.end_margin_mm"),
                Lower("segment.groove_radius_mm"),
                Lower("segment.grooves"),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

fn thin_land(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let (land, two_lines) = (i.land_mm(), 2.0 * c.print.line_mm);
    advise(c.segment.grooves < 2 || land >= two_lines, || {
        (
            format!("land between grooves is {land:.2} mm wide, under two printed lines ({two_lines:.2} mm)"),
            "raise shell.outer_radius_mm or lower segment.grooves".to_owned(),
        )
    })
}

fn thin_end_walls(i: &Inspection<'_>) -> Assessment {
    let (end, two_lines) = (i.end_wall_mm(), 2.0 * i.configuration().print.line_mm);
    advise(end >= two_lines, || {
        (
            format!("end walls are {end:.2} mm thick, under two printed lines ({two_lines:.2} mm)"),
            format!("raise segment.end_margin_mm by {:.2}", (100.0 * (two_lines - end)).ceil() / 100.0),
        )
    })
}
