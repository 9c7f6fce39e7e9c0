//! Rules for the grooved sector of the shell.

use super::Change::{Ease, Lower, Raise, Set};
use super::{Assessment, Inspection, Rule, Severity, advise, least_wall_mm, require};

/// Least radius inside the shell: below it there is no room for a core.
pub(super) const MIN_INNER_RADIUS_MM: f64 = 1.0;

/// How far the stops stay below the silicone's surface.
const MIN_STOP_DEPTH_MM: f64 = 0.2;

pub(super) const RULES: &[Rule] = &[
    Rule { field: "shell.wall_mm", severity: Severity::Error, assess: inner_radius },
    Rule { field: "shell.wall_mm", severity: Severity::Error, assess: wall_under_grooves },
    Rule { field: "segment.grooves", severity: Severity::Error, assess: land },
    Rule { field: "segment.end_margin_mm", severity: Severity::Error, assess: end_walls },
    Rule { field: "shell.stop_mm", severity: Severity::Error, assess: stops_print },
    Rule { field: "shell.stop_height_mm", severity: Severity::Error, assess: stops_under_tendon },
    Rule { field: "shell.outer_radius_mm", severity: Severity::Warning, assess: thin_land },
    Rule { field: "segment.end_margin_mm", severity: Severity::Warning, assess: thin_end_walls },
];

fn inner_radius(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let inside = i.inner_radius_mm();
    require(c.shell.wall_mm <= c.shell.outer_radius_mm - MIN_INNER_RADIUS_MM, || {
        (
            format!(
                "leaves {inside:.3} mm of radius inside the shell; {MIN_INNER_RADIUS_MM} mm is the least"
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
            format!("leaves less than two walls of {} mm under the grooves", c.print.least_wall_mm),
            &[Raise("shell.wall_mm"), Lower("segment.groove_radius_mm"), Ease("print.least_wall_mm")],
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
                "makes grooves overlap: neighbours are {chord:.3} mm apart on the shell, a groove with its land takes \
                 {needed:.3} mm"
            ),
            &[
                Lower("segment.grooves"),
                Raise("shell.outer_radius_mm"),
                Lower("segment.groove_radius_mm"),
                Raise("segment.span_deg"),
                Ease("print.elephant_foot_mm"),
                Ease("print.least_wall_mm"),
            ],
        )
    })
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
            &[
                Raise("segment.end_margin_mm"),
                Lower("segment.groove_radius_mm"),
                Lower("segment.grooves"),
                Ease("print.elephant_foot_mm"),
                Ease("print.least_wall_mm"),
            ],
        )
    })
}

/// A stop is left out, or thick enough to print.
fn stops_print(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let least = least_wall_mm(c, 1.0);
    require(c.shell.stop_mm == 0.0 || c.shell.stop_mm >= least, || {
        (
            format!("makes stops thinner than {least:.3} mm, the least wall; 0 leaves them out"),
            &[
                Raise("shell.stop_mm"),
                Lower("shell.stop_mm"),
                Ease("print.elephant_foot_mm"),
                Ease("print.least_wall_mm"),
            ],
        )
    })
}

/// The tendon runs over the stops where the wrap is as wide as the span: they stay below the silicone's surface.
fn stops_under_tendon(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.shell.stop_mm == 0.0 {
        return Assessment::NotApplicable;
    }
    let most = c.silicone.thickness_mm - MIN_STOP_DEPTH_MM;
    require(c.shell.stop_height_mm <= most, || {
        (
            format!(
                "brings the stops to the tendon: {most:.3} mm is the most over a layer of {} mm",
                c.silicone.thickness_mm
            ),
            &[Lower("shell.stop_height_mm"), Raise("silicone.thickness_mm"), Set("shell.stop_mm", "0")],
        )
    })
}

fn thin_land(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let (land, two_lines) = (i.land_mm(), 2.0 * c.print.line_mm);
    advise(c.segment.grooves < 2 || land >= two_lines, || {
        (
            format!("the land between grooves is {land:.2} mm, under two printed lines ({two_lines:.2} mm)"),
            "raise shell.outer_radius_mm or lower segment.grooves".to_owned(),
        )
    })
}

fn thin_end_walls(i: &Inspection<'_>) -> Assessment {
    let (end, two_lines) = (i.end_wall_mm(), 2.0 * i.configuration().print.line_mm);
    advise(end >= two_lines, || {
        (
            format!("the end walls are {end:.2} mm, under two printed lines ({two_lines:.2} mm)"),
            format!("raise segment.end_margin_mm by {:.2}", two_lines - end),
        )
    })
}
