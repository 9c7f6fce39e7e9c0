//! What can be built but is not ideal: each warning names the parameter to change.

use super::{contact_radius_mm, pitch_rad, tendon_diameter_mm};
use crate::config::Configuration;

/// Below this ratio of pulley to rope diameter a wire rope tires early (printing.md).
const GOOD_BEND_RATIO: f64 = 20.0;
/// Beyond this clearance the pins walk noticeably (printing.md).
const WIDE_CLEARANCE_MM: f64 = 0.3;

pub(super) fn of(c: &Configuration) -> Vec<String> {
    let two_lines = 2.0 * c.print.line_mm;
    let half_pitch = pitch_rad(c) / 2.0;
    let land = 2.0 * (c.shell.outer_radius_mm * half_pitch.sin() - c.segment.groove_radius_mm);
    let end = land / 2.0 + c.segment.end_margin_mm;
    let bend = 2.0 * contact_radius_mm(c) / tendon_diameter_mm(c);
    let mut all = Vec::new();
    let mut warn = |wrong: bool, text: String| {
        if wrong {
            all.push(text);
        }
    };
    warn(
        c.segment.grooves > 1 && land < two_lines,
        format!(
            "the land between grooves is {land:.2} mm, under two printed lines ({two_lines:.2} mm): \
             raise shell.outer_radius_mm or lower segment.grooves"
        ),
    );
    warn(
        end < two_lines,
        format!(
            "the end walls are {end:.2} mm, under two printed lines ({two_lines:.2} mm): \
             raise segment.end_margin_mm by {:.2}",
            two_lines - end
        ),
    );
    warn(
        bend < GOOD_BEND_RATIO,
        format!(
            "pulley over tendon diameter is {bend:.1}; ropes last from {GOOD_BEND_RATIO} on: raise shell.outer_radius_mm"
        ),
    );
    warn(
        c.support.slot_clearance_mm > WIDE_CLEARANCE_MM,
        format!(
            "support.slot_clearance_mm = {} lets the pins walk; print the coupon and lower it",
            c.support.slot_clearance_mm
        ),
    );
    warn(
        c.label.engrave && c.label.stroke_mm < c.print.line_mm,
        format!("label.stroke_mm = {} is under one printed line ({} mm)", c.label.stroke_mm, c.print.line_mm),
    );
    warn(
        4.0 * c.print.layer_mm > 2.0 * c.segment.groove_radius_mm,
        format!(
            "the grooves are narrower than four layers of print.layer_mm = {}: use thinner layers",
            c.print.layer_mm
        ),
    );
    all
}
