//! The rules between parameters: what can be built, printed and assembled. One rule, one function, one complaint.

mod mould;
mod pins;

use super::pitch_rad;
use crate::config::{ConfigError, Configuration};
use mould::{ends_stay_apart, fasteners_fit, load_range, mould_fits, on_bed};
use pins::{
    layer_thickness, layer_width, pin_engagement, pin_fits_groove, pins_in_grooves, slot_in_plate,
    slot_travel, tendon_bend, tendon_in_channel, wrap_within_segment,
};

/// Least radius inside the shell: below it there is no room for a core.
const LEAST_INNER_RADIUS_MM: f64 = 1.0;

/// What chamfers on both sides leave of a wall on the bed.
const LEAST_FOOT_MM: f64 = 0.05;

/// Least chamfer of a bottom edge.
const LEAST_CHAMFER_MM: f64 = 0.02;

type Rule = fn(&Configuration) -> Result<(), ConfigError>;

/// All rules, in the order in which a reader would fix them.
const RULES: [Rule; 19] = [
    inner_radius,
    wall_under_grooves,
    land,
    end_walls,
    pins_in_grooves,
    pin_fits_groove,
    layer_thickness,
    layer_width,
    wrap_within_segment,
    tendon_in_channel,
    tendon_bend,
    slot_in_plate,
    slot_travel,
    pin_engagement,
    fasteners_fit,
    ends_stay_apart,
    mould_fits,
    load_range,
    chamfer_prints,
];

pub(super) fn check(c: &Configuration) -> Result<(), ConfigError> {
    RULES.iter().try_for_each(|rule| rule(c))?;
    on_bed(c)
}

fn refuse(
    field: &str,
    value: impl std::fmt::Display,
    problem: String,
    remedy: String,
) -> Result<(), ConfigError> {
    Err(ConfigError { field: field.to_owned(), value: Some(value.to_string()), problem, remedy, place: None })
}

/// The least thickness of a wall that may be as thin as `lines` times the thinnest accepted one: chamfers on both of
/// its bottom edges must leave it a foot.
fn least_mm(c: &Configuration, lines: f64) -> f64 {
    (lines * c.print.least_wall_mm).max(2.0 * c.print.elephant_foot_mm + LEAST_FOOT_MM)
}

fn inner_radius(c: &Configuration) -> Result<(), ConfigError> {
    let most = c.shell.outer_radius_mm - LEAST_INNER_RADIUS_MM;
    if c.shell.wall_mm <= most {
        return Ok(());
    }
    refuse(
        "shell.wall_mm",
        c.shell.wall_mm,
        format!("leaves less than {LEAST_INNER_RADIUS_MM} mm of radius inside the shell"),
        format!("lower it to {most:.3} or raise shell.outer_radius_mm"),
    )
}

fn wall_under_grooves(c: &Configuration) -> Result<(), ConfigError> {
    let least = c.segment.groove_radius_mm + 2.0 * c.print.least_wall_mm;
    if c.shell.wall_mm >= least {
        return Ok(());
    }
    refuse(
        "shell.wall_mm",
        c.shell.wall_mm,
        format!("leaves less than two walls of {} mm under the grooves", c.print.least_wall_mm),
        format!("raise it to {least:.3} or lower segment.groove_radius_mm"),
    )
}

/// The land between grooves is tightest on the shell (printing.md, land rule).
fn land(c: &Configuration) -> Result<(), ConfigError> {
    if c.segment.grooves < 2 {
        return Ok(());
    }
    let needed = 2.0 * c.segment.groove_radius_mm + least_mm(c, 1.0);
    let chord = 2.0 * c.shell.outer_radius_mm * (pitch_rad(c) / 2.0).sin();
    if chord >= needed {
        return Ok(());
    }
    let fitting = most_grooves(c, needed);
    refuse(
        "segment.grooves",
        c.segment.grooves,
        format!(
            "overlap: neighbours are {chord:.3} mm apart on the shell, a groove with its land takes {needed:.3} mm"
        ),
        format!("lower it to {fitting}, raise shell.outer_radius_mm, or lower segment.groove_radius_mm"),
    )
}

fn most_grooves(c: &Configuration, needed_mm: f64) -> usize {
    let span = c.segment.span_deg.to_radians();
    (1..c.segment.grooves)
        .rev()
        .find(|n| 2.0 * c.shell.outer_radius_mm * (span / *n as f64 / 2.0).sin() >= needed_mm)
        .unwrap_or(1)
}

/// The wall between the last groove and the end of the sector is half a land, plus the margin.
fn end_walls(c: &Configuration) -> Result<(), ConfigError> {
    let half_pitch = (pitch_rad(c) / 2.0).min(std::f64::consts::FRAC_PI_2);
    let left =
        c.shell.outer_radius_mm * half_pitch.sin() + c.segment.end_margin_mm - c.segment.groove_radius_mm;
    let least = least_mm(c, 0.5);
    if left >= least {
        return Ok(());
    }
    refuse(
        "segment.end_margin_mm",
        c.segment.end_margin_mm,
        format!("leaves {left:.3} mm of wall beyond the outermost groove; {least:.3} mm is the least"),
        format!("raise it by {:.3} or lower segment.groove_radius_mm", least - left),
    )
}

/// A chamfer is left out or large enough to print: a sliver of one would also be thinner than a facet may be.
fn chamfer_prints(c: &Configuration) -> Result<(), ConfigError> {
    let chamfer = c.print.elephant_foot_mm;
    if chamfer == 0.0 || chamfer >= LEAST_CHAMFER_MM {
        return Ok(());
    }
    refuse(
        "print.elephant_foot_mm",
        chamfer,
        format!("is too small to print; the least is {LEAST_CHAMFER_MM} mm"),
        format!("raise it to {LEAST_CHAMFER_MM}, or set 0 to leave the chamfer out"),
    )
}
