//! Rules for pins, layer, tendon, and the slots that hold the pins.

use super::{least_mm, refuse};
use crate::config::{ConfigError, Configuration, SlotKind};
use crate::design::{
    contact_radius_mm, pin_length_mm, pitch_rad, slot, support_radius_mm, tendon_diameter_mm,
};

/// Gap that the tendon needs on both sides of it.
const TENDON_GAP_MM: f64 = 0.5;
/// A rope bent sharper than this, pulley over rope diameter, breaks soon (printing.md).
const LEAST_BEND_RATIO: f64 = 10.0;
/// Silicone left between the bottom of its grooves and its inner face.
const LEAST_LAYER_MM: f64 = 0.5;

pub(super) fn pins_in_grooves(c: &Configuration) -> Result<(), ConfigError> {
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

pub(super) fn pin_fits_groove(c: &Configuration) -> Result<(), ConfigError> {
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

pub(super) fn layer_thickness(c: &Configuration) -> Result<(), ConfigError> {
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

pub(super) fn layer_width(c: &Configuration) -> Result<(), ConfigError> {
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

pub(super) fn wrap_within_segment(c: &Configuration) -> Result<(), ConfigError> {
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

pub(super) fn tendon_in_channel(c: &Configuration) -> Result<(), ConfigError> {
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

pub(super) fn tendon_bend(c: &Configuration) -> Result<(), ConfigError> {
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

pub(super) fn slot_in_plate(c: &Configuration) -> Result<(), ConfigError> {
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
pub(super) fn slot_travel(c: &Configuration) -> Result<(), ConfigError> {
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

pub(super) fn pin_engagement(c: &Configuration) -> Result<(), ConfigError> {
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
