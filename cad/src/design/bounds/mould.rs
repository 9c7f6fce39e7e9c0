//! Rules for fasteners, the ends of sectors, the mould, the bed, and the loads.

use super::{LEAST_INNER_RADIUS_MM, least_mm, refuse};
use crate::config::{ConfigError, Configuration, MouldKind};
use crate::design::{contact_radius_mm, fastener_angles_rad, fastener_radius_mm, slot, support_radius_mm};

/// Largest shift of a sector's ends, as a share of its inner radius: beyond it they miss the circle.
const LARGEST_SHIFT: f64 = 0.9;
/// How far the base or the basin of a mould reaches beyond what it holds.
const MOULD_MARGIN_MM: f64 = 1.0;
/// What must stay open behind a sector, so that its ends do not meet.
const LEAST_GAP_MM: f64 = 0.5;
/// Wall left around a fastener hole (printing.md: refuse under 0.5).
const HOLE_EDGE_MM: f64 = 0.5;

pub(super) fn fasteners_fit(c: &Configuration) -> Result<(), ConfigError> {
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
pub(super) fn ends_stay_apart(c: &Configuration) -> Result<(), ConfigError> {
    let inner = c.shell.outer_radius_mm - c.shell.wall_mm;
    sector_ends(c, "segment.end_margin_mm", c.segment.end_margin_mm, inner, c.segment.end_margin_mm)
}

/// The mould goes around the sector, with an end wall at both ends.
pub(super) fn mould_fits(c: &Configuration) -> Result<(), ConfigError> {
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
pub(super) fn sector_ends(
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

pub(super) fn load_range(c: &Configuration) -> Result<(), ConfigError> {
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

pub(super) fn on_bed(c: &Configuration) -> Result<(), ConfigError> {
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
