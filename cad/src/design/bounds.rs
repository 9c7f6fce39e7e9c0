//! The rules between parameters: what can be built, printed and assembled. One rule, one function, one complaint.

use super::{
    contact_radius_mm, fastener_angles_rad, fastener_radius_mm, pin_length_mm, pitch_rad, slot,
    support_radius_mm, tendon_diameter_mm,
};
use crate::config::{ConfigError, Configuration, MouldKind, SlotKind};

/// Least radius inside the shell: below it there is no room for a core.
const LEAST_INNER_RADIUS_MM: f64 = 1.0;
/// Silicone left between the bottom of its grooves and its inner face.
const LEAST_LAYER_MM: f64 = 0.5;
/// Wall left around a fastener hole (printing.md: refuse under 0.5).
const HOLE_EDGE_MM: f64 = 0.5;
/// A rope bent sharper than this, pulley over rope diameter, breaks soon (printing.md).
const LEAST_BEND_RATIO: f64 = 10.0;
/// Gap that the tendon needs on both sides of it.
const TENDON_GAP_MM: f64 = 0.5;
/// What must stay open behind a sector, so that its ends do not meet.
const LEAST_GAP_MM: f64 = 0.5;

/// How far the base or the basin of a mould reaches beyond what it holds.
const MOULD_MARGIN_MM: f64 = 1.0;
/// Largest shift of a sector's ends, as a share of its inner radius: beyond it they miss the circle.
const LARGEST_SHIFT: f64 = 0.9;
/// What chamfers on both sides leave of a wall on the bed.
const LEAST_FOOT_MM: f64 = 0.05;

type Rule = fn(&Configuration) -> Result<(), ConfigError>;

/// All rules, in the order in which a reader would fix them.
const RULES: [Rule; 18] = [
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

fn pins_in_grooves(c: &Configuration) -> Result<(), ConfigError> {
    let pins = &c.layout.pins;
    if let Some(pin) = pins.iter().find(|p| **p < 1 || **p > c.segment.grooves) {
        return refuse(
            "layout.pins",
            format!("{pins:?}"),
            format!("has groove {pin}; the segment has grooves 1 to {}", c.segment.grooves),
            "move the pin or raise segment.grooves".to_owned(),
        );
    }
    if let Some(pin) = pins.iter().find(|p| pins.iter().filter(|q| q == p).count() > 1) {
        return refuse(
            "layout.pins",
            format!("{pins:?}"),
            format!("puts two pins in groove {pin}"),
            "name every groove once".to_owned(),
        );
    }
    Ok(())
}

fn pin_fits_groove(c: &Configuration) -> Result<(), ConfigError> {
    let most = 2.0 * c.segment.groove_radius_mm - c.pins.tolerance_mm;
    if c.pins.diameter_mm <= most {
        return Ok(());
    }
    refuse(
        "pins.diameter_mm",
        c.pins.diameter_mm,
        format!("is wider than its groove: {most:.3} mm is the most with the pin's tolerance"),
        "use thinner pins or raise segment.groove_radius_mm".to_owned(),
    )
}

fn layer_thickness(c: &Configuration) -> Result<(), ConfigError> {
    let least = c.segment.groove_radius_mm + LEAST_LAYER_MM;
    if c.silicone.thickness_mm >= least {
        return Ok(());
    }
    refuse(
        "silicone.thickness_mm",
        c.silicone.thickness_mm,
        format!("leaves less than {LEAST_LAYER_MM} mm of silicone under its grooves"),
        format!("raise it to {least:.3} or lower segment.groove_radius_mm"),
    )
}

fn layer_width(c: &Configuration) -> Result<(), ConfigError> {
    let width = c.shell.width_mm - 2.0 * c.silicone.side_clearance_mm;
    let least = 2.0 * c.support.lip_depth_mm + 2.0 * c.print.least_wall_mm;
    if width >= least {
        return Ok(());
    }
    refuse(
        "shell.width_mm",
        c.shell.width_mm,
        format!("leaves a layer of {width:.3} mm; the lips and the mould need {least:.3} mm"),
        "raise it or lower silicone.side_clearance_mm or support.lip_depth_mm".to_owned(),
    )
}

fn wrap_within_segment(c: &Configuration) -> Result<(), ConfigError> {
    if c.layout.wrap_angle_deg <= c.segment.span_deg {
        return Ok(());
    }
    refuse(
        "layout.wrap_angle_deg",
        c.layout.wrap_angle_deg,
        format!("is beyond the segment of {} deg", c.segment.span_deg),
        "lower it or raise segment.span_deg".to_owned(),
    )
}

fn tendon_in_channel(c: &Configuration) -> Result<(), ConfigError> {
    let channel = c.shell.width_mm - 2.0 * c.support.lip_depth_mm;
    let most = channel - 2.0 * TENDON_GAP_MM;
    let tendon = tendon_diameter_mm(c);
    if tendon <= most {
        return Ok(());
    }
    refuse(
        "tendon.rope_diameter_mm",
        c.tendon.rope_diameter_mm,
        format!(
            "makes a tendon of {tendon:.3} mm, wider than the channel of {channel:.3} mm takes ({most:.3} mm)"
        ),
        "use a thinner tendon, raise shell.width_mm or lower support.lip_depth_mm".to_owned(),
    )
}

fn tendon_bend(c: &Configuration) -> Result<(), ConfigError> {
    let most = 2.0 * contact_radius_mm(c) / LEAST_BEND_RATIO;
    if tendon_diameter_mm(c) <= most {
        return Ok(());
    }
    refuse(
        "tendon.rope_diameter_mm",
        c.tendon.rope_diameter_mm,
        format!("makes a tendon that the pulley bends too sharply: {most:.3} mm is the most at this radius"),
        "use a thinner tendon or raise shell.outer_radius_mm".to_owned(),
    )
}

fn slot_in_plate(c: &Configuration) -> Result<(), ConfigError> {
    let (slot, wall) = (slot(c), least_mm(c, 1.0));
    let half = slot.width_mm / 2.0;
    let outer_edge = support_radius_mm(c) - slot.outer_mm - half;
    if outer_edge < wall {
        return refuse(
            "support.rise_mm",
            c.support.rise_mm,
            format!(
                "lets the slots leave the plate: {outer_edge:.3} mm is left outside them, {wall:.3} mm is the least"
            ),
            format!("raise it by {:.3}", wall - outer_edge),
        );
    }
    let land = 2.0 * (slot.inner_mm - half) * (pitch_rad(c) / 2.0).sin() - 2.0 * half;
    if c.segment.grooves > 1 && land < wall {
        return refuse(
            "support.slot_clearance_mm",
            c.support.slot_clearance_mm,
            format!("leaves {land:.3} mm between neighbouring slots; {wall:.3} mm is the least"),
            "lower it, use fewer grooves, or raise shell.outer_radius_mm".to_owned(),
        );
    }
    let half_pitch = (pitch_rad(c) / 2.0).min(std::f64::consts::FRAC_PI_2);
    let end = (slot.inner_mm - half) * half_pitch.sin() + c.segment.end_margin_mm - half;
    let least = least_mm(c, 0.5);
    if end < least {
        return refuse(
            "segment.end_margin_mm",
            c.segment.end_margin_mm,
            format!("leaves {end:.3} mm beyond the outermost slot; {least:.3} mm is the least"),
            format!("raise it by {:.3}", least - end),
        );
    }
    if c.support.slot_kind == SlotKind::Blind && slot.depth_mm < wall {
        return refuse(
            "support.slot_floor_mm",
            c.support.slot_floor_mm,
            format!("leaves a slot of {:.3} mm in a plate of {} mm", slot.depth_mm, c.support.plate_mm),
            "lower it, raise support.plate_mm, or use through slots".to_owned(),
        );
    }
    Ok(())
}

/// A pin at the end of its slot must not reach the shell.
fn slot_travel(c: &Configuration) -> Result<(), ConfigError> {
    let left = c.silicone.thickness_mm - c.pins.diameter_mm - c.support.travel_margin_mm;
    if left >= 0.0 {
        return Ok(());
    }
    refuse(
        "support.travel_margin_mm",
        c.support.travel_margin_mm,
        format!("lets a sunk pin reach {:.3} mm into the shell", -left),
        "lower it, use thinner pins, or raise silicone.thickness_mm".to_owned(),
    )
}

fn pin_engagement(c: &Configuration) -> Result<(), ConfigError> {
    let engagement = (pin_length_mm(c) - c.shell.width_mm) / 2.0;
    let least = c.pins.diameter_mm;
    if engagement >= least {
        return Ok(());
    }
    refuse(
        "support.plate_mm",
        c.support.plate_mm,
        format!(
            "holds the pins by {engagement:.3} mm at each end; one diameter, {least:.3} mm, is the least"
        ),
        "raise it or lower support.slot_floor_mm or pins.end_play_mm".to_owned(),
    )
}

fn fasteners_fit(c: &Configuration) -> Result<(), ConfigError> {
    if c.fasteners.count == 0 {
        return Ok(());
    }
    let edge = HOLE_EDGE_MM.max(least_mm(c, 1.0));
    let diameter = c.fasteners.hole_diameter_mm;
    let radial = c.shell.wall_mm - c.segment.groove_radius_mm - 2.0 * edge;
    // The slots of the supports may reach below the shell's face.
    let slot = slot(c);
    let under_slots = 2.0 * (slot.inner_mm - slot.width_mm / 2.0 - edge - fastener_radius_mm(c));
    let most = radial.min(under_slots);
    if diameter > most {
        return refuse(
            "fasteners.hole_diameter_mm",
            diameter,
            format!("does not fit in the wall: {most:.3} mm is the most with {edge} mm around it"),
            "use a smaller screw, raise shell.wall_mm, or set fasteners.count = 0".to_owned(),
        );
    }
    let needed = diameter + edge;
    let end = c.fasteners.end_distance_mm + c.segment.end_margin_mm;
    if end < diameter / 2.0 + edge {
        return refuse(
            "fasteners.end_distance_mm",
            c.fasteners.end_distance_mm,
            "lets the outermost hole leave the sector".to_owned(),
            format!("raise it to {:.3}", diameter / 2.0 + edge - c.segment.end_margin_mm),
        );
    }
    let angles = fastener_angles_rad(c);
    let apart = |w: &[f64]| 2.0 * fastener_radius_mm(c) * ((w[1] - w[0]) / 2.0).sin();
    let crowded = angles.windows(2).any(|w| w[1] <= w[0] || apart(w) < needed);
    let half_span = c.segment.span_deg.to_radians() / 2.0;
    let single =
        c.fasteners.count == 1 && fastener_radius_mm(c) * half_span.min(1.5).sin() < needed / 2.0 + edge;
    if crowded || single {
        return refuse(
            "fasteners.count",
            c.fasteners.count,
            format!("holes of {diameter} mm do not fit on an arc of {} deg", c.segment.span_deg),
            "lower it, lower fasteners.end_distance_mm, or set it to 0".to_owned(),
        );
    }
    Ok(())
}

/// The ends of a sector are parallel to radial planes: at its inner radius they are furthest around the axis, and must
/// neither leave the circle nor meet behind it.
fn ends_stay_apart(c: &Configuration) -> Result<(), ConfigError> {
    let inner = c.shell.outer_radius_mm - c.shell.wall_mm;
    sector_ends(c, "segment.end_margin_mm", c.segment.end_margin_mm, inner, c.segment.end_margin_mm)
}

/// The mould goes around the sector, with an end wall at both ends.
fn mould_fits(c: &Configuration) -> Result<(), ConfigError> {
    let inner = c.shell.outer_radius_mm - c.shell.wall_mm;
    let scale = 1.0 / (1.0 - c.mould.shrinkage_pct / 100.0);
    let margin = c.segment.end_margin_mm * scale;
    match c.mould.kind {
        MouldKind::None => Ok(()),
        MouldKind::OnePiece => {
            let depth = (c.shell.width_mm - 2.0 * c.silicone.side_clearance_mm) * scale;
            let around = c.mould.wall_mm + MOULD_MARGIN_MM + depth * c.mould.draft_deg.to_radians().tan();
            let inner_wall = c.shell.outer_radius_mm * scale - around;
            if inner_wall < LEAST_INNER_RADIUS_MM {
                return refuse(
                    "mould.wall_mm",
                    c.mould.wall_mm,
                    "leaves no room inside the inner wall of the mould".to_owned(),
                    format!("lower it by {:.3}", LEAST_INNER_RADIUS_MM - inner_wall),
                );
            }
            sector_ends(c, "mould.wall_mm", c.mould.wall_mm, inner_wall, margin + around)
        }
        MouldKind::Split => {
            let base = inner - MOULD_MARGIN_MM.min(inner / 2.0);
            sector_ends(c, "mould.wall_mm", c.mould.wall_mm, base, margin + c.mould.wall_mm + MOULD_MARGIN_MM)
        }
    }
}

/// Refuses `field` if ends shifted by `shift_mm` do not fit a sector of the inner radius `radius_mm`.
fn sector_ends(
    c: &Configuration,
    field: &str,
    value: f64,
    radius_mm: f64,
    shift_mm: f64,
) -> Result<(), ConfigError> {
    let most = LARGEST_SHIFT * radius_mm;
    if shift_mm > most {
        return refuse(
            field,
            value,
            format!("shifts the ends by {shift_mm:.3} mm, at an inner radius of {radius_mm:.3} mm"),
            format!("lower it by {:.3}, lower shell.wall_mm, or set mould.kind = \"none\"", shift_mm - most),
        );
    }
    let half_rad = c.segment.span_deg.to_radians() / 2.0 + (shift_mm / radius_mm).asin();
    let most_rad = std::f64::consts::PI - (LEAST_GAP_MM / 2.0 / radius_mm).min(1.0).asin();
    if half_rad <= most_rad {
        return Ok(());
    }
    refuse(
        "segment.span_deg",
        c.segment.span_deg,
        format!("lets the ends meet behind the axis; {LEAST_GAP_MM} mm must stay between them"),
        format!(
            "lower it by {:.1}, raise shell.outer_radius_mm, or set mould.kind = \"none\"",
            2.0 * (half_rad - most_rad).to_degrees()
        ),
    )
}

fn load_range(c: &Configuration) -> Result<(), ConfigError> {
    if c.friction.load_min_n < c.friction.load_max_n {
        return Ok(());
    }
    refuse(
        "friction.load_min_n",
        c.friction.load_min_n,
        format!("is not below friction.load_max_n = {}", c.friction.load_max_n),
        "lower it or raise friction.load_max_n".to_owned(),
    )
}

fn on_bed(c: &Configuration) -> Result<(), ConfigError> {
    let reach =
        support_radius_mm(c).max(contact_radius_mm(c) + c.mould.wall_mm + c.mould.key_diameter_mm + 3.0);
    if 2.0 * reach <= c.print.bed_mm {
        return Ok(());
    }
    let half = (c.segment.span_deg.to_radians() / 2.0).min(std::f64::consts::FRAC_PI_2);
    let width = 2.0 * reach * half.sin() + 2.0 * (c.segment.end_margin_mm + c.mould.wall_mm);
    if width <= c.print.bed_mm {
        return Ok(());
    }
    refuse(
        "print.bed_mm",
        c.print.bed_mm,
        format!("is smaller than the parts, which are {width:.1} mm wide"),
        "use a larger printer or lower shell.outer_radius_mm or segment.span_deg".to_owned(),
    )
}
