//! Rules for the grooved sector of the shell.

use super::{Assessment, Inspection, Rule, Severity, least_wall_mm, require};

/// Least radius inside the shell: below it there is no room for a core.
pub(super) const MIN_INNER_RADIUS_MM: f64 = 1.0;

pub(super) const RULES: &[Rule] = &[
    Rule { field: "shell.wall_mm", severity: Severity::Error, assess: inner_radius },
    Rule { field: "shell.wall_mm", severity: Severity::Error, assess: wall_under_grooves },
    Rule { field: "segment.grooves", severity: Severity::Error, assess: land },
    Rule { field: "segment.end_margin_mm", severity: Severity::Error, assess: end_walls },
    Rule { field: "shell.outer_radius_mm", severity: Severity::Warning, assess: thin_land },
    Rule { field: "segment.end_margin_mm", severity: Severity::Warning, assess: thin_end_walls },
];

fn inner_radius(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let most = c.shell.outer_radius_mm - MIN_INNER_RADIUS_MM;
    require(c.shell.wall_mm <= most, || {
        (
            format!("leaves less than {MIN_INNER_RADIUS_MM} mm of radius inside the shell"),
            format!("lower it to {most:.3} or raise shell.outer_radius_mm"),
        )
    })
}

fn wall_under_grooves(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let least = c.segment.groove_radius_mm + 2.0 * c.print.least_wall_mm;
    require(c.shell.wall_mm >= least, || {
        (
            format!("leaves less than two walls of {} mm under the grooves", c.print.least_wall_mm),
            format!("raise it to {least:.3} or lower segment.groove_radius_mm"),
        )
    })
}

/// The land between grooves is tightest on the shell (cad/doc/print-limits.md).
fn land(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.segment.grooves < 2 {
        return Assessment::NotApplicable;
    }
    let needed = 2.0 * c.segment.groove_radius_mm + least_wall_mm(c, 1.0);
    let chord = i.groove_chord_mm();
    require(chord >= needed, || {
        (
            format!(
                "overlap: neighbours are {chord:.3} mm apart on the shell, a groove with its land takes {needed:.3} mm"
            ),
            format!(
                "lower it to {}, raise shell.outer_radius_mm, or lower segment.groove_radius_mm",
                max_grooves(i, needed)
            ),
        )
    })
}

fn max_grooves(i: &Inspection<'_>, needed_mm: f64) -> usize {
    let c = i.configuration();
    let span = c.segment.span_deg.to_radians();
    (1..c.segment.grooves)
        .rev()
        .find(|n| 2.0 * c.shell.outer_radius_mm * (span / *n as f64 / 2.0).sin() >= needed_mm)
        .unwrap_or(1)
}

/// The wall between the last groove and the end of the sector is half a land, plus the margin.
fn end_walls(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let left = c.shell.outer_radius_mm * i.half_pitch_rad().sin() + c.segment.end_margin_mm
        - c.segment.groove_radius_mm;
    let least = least_wall_mm(c, 0.5);
    require(left >= least, || {
        (
            format!("leaves {left:.3} mm of wall beyond the outermost groove; {least:.3} mm is the least"),
            format!("raise it by {:.3} or lower segment.groove_radius_mm", least - left),
        )
    })
}

fn thin_land(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let (land, two_lines) = (i.land_mm(), 2.0 * c.print.line_mm);
    require(c.segment.grooves < 2 || land >= two_lines, || {
        (
            format!("the land between grooves is {land:.2} mm, under two printed lines ({two_lines:.2} mm)"),
            "raise shell.outer_radius_mm or lower segment.grooves".to_owned(),
        )
    })
}

fn thin_end_walls(i: &Inspection<'_>) -> Assessment {
    let (end, two_lines) = (i.end_wall_mm(), 2.0 * i.configuration().print.line_mm);
    require(end >= two_lines, || {
        (
            format!("the end walls are {end:.2} mm, under two printed lines ({two_lines:.2} mm)"),
            format!("raise segment.end_margin_mm by {:.2}", two_lines - end),
        )
    })
}
