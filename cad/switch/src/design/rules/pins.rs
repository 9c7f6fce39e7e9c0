//! Rules for pins, layer and tendon.

use super::Change::{Ease, Lower, Raise, Say};
use super::{Assessment, Inspection, Rule, Severity, advise, require};
use pinswitch_friction::PinPattern;

/// Gap that the tendon needs on both sides of it.
const TENDON_GAP_MM: f64 = 0.5;
/// A rope bent sharper than this, pulley over rope diameter, breaks soon (cad/doc/print-limits.md).
const MIN_BEND_RATIO: f64 = 10.0;
/// Below this ratio of pulley to rope diameter a wire rope tires early (cad/doc/print-limits.md).
const GOOD_BEND_RATIO: f64 = 20.0;
/// Silicone left between the bottom of its grooves and its inner face.
const MIN_LAYER_MM: f64 = 0.5;

pub(super) const RULES: &[Rule] = &[
    Rule { field: "layout.pins", severity: Severity::Error, assess: pins_in_grooves },
    Rule { field: "layout.pins", severity: Severity::Error, assess: one_pin_per_groove },
    Rule { field: "pins.diameter_mm", severity: Severity::Error, assess: pin_fits_groove },
    Rule { field: "silicone.thickness_mm", severity: Severity::Error, assess: layer_thickness },
    Rule { field: "shell.width_mm", severity: Severity::Error, assess: layer_width },
    Rule { field: "layout.wrap_angle_deg", severity: Severity::Error, assess: wrap_within_segment },
    Rule { field: "layout.wrap_angle_deg", severity: Severity::Error, assess: ends_keep_clear },
    Rule { field: "layout.wrap_angle_deg", severity: Severity::Warning, assess: ends_meet },
    Rule { field: "layout.pins", severity: Severity::Warning, assess: pins_within_wrap },
    Rule { field: "tendon.rope_diameter_mm", severity: Severity::Error, assess: tendon_in_channel },
    Rule { field: "tendon.rope_diameter_mm", severity: Severity::Error, assess: tendon_bend },
    Rule { field: "tendon.length_mm", severity: Severity::Warning, assess: tendon_reaches },
    Rule { field: "shell.outer_radius_mm", severity: Severity::Warning, assess: early_wear },
];

fn pins_in_grooves(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let outside = c.layout.pins.iter().find(|p| **p < 1 || **p > c.segment.grooves);
    require(outside.is_none(), || {
        (
            format!(
                "puts a pin in groove {}; the segment has grooves 1 to {}",
                outside.copied().unwrap_or_default(),
                c.segment.grooves
            ),
            &[Say("move the pin"), Raise("segment.grooves")],
        )
    })
}

fn one_pin_per_groove(i: &Inspection<'_>) -> Assessment {
    let pins = &i.configuration().layout.pins;
    let twice = pins.iter().find(|p| pins.iter().filter(|q| q == p).count() > 1);
    require(twice.is_none(), || {
        (
            format!("puts two pins in groove {}", twice.copied().unwrap_or_default()),
            &[Say("name every groove once")],
        )
    })
}

fn pin_fits_groove(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let most = 2.0 * c.segment.groove_radius_mm - c.pins.tolerance_mm;
    require(c.pins.diameter_mm <= most, || {
        (
            format!(
                "makes pins of {} mm wider than their groove: {most:.3} mm is the most with the pin's tolerance",
                c.pins.diameter_mm
            ),
            &[Lower("pins.diameter_mm"), Raise("segment.groove_radius_mm"), Ease("pins.tolerance_mm")],
        )
    })
}

fn layer_thickness(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let least = c.segment.groove_radius_mm + MIN_LAYER_MM;
    require(c.silicone.thickness_mm >= least, || {
        (
            format!("leaves less than {MIN_LAYER_MM} mm of silicone under its grooves"),
            &[Raise("silicone.thickness_mm"), Lower("segment.groove_radius_mm")],
        )
    })
}

fn layer_width(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let width = i.layer_width_mm();
    let least = 2.0 * c.support.lip_depth_mm + 2.0 * c.print.least_wall_mm;
    require(width >= least, || {
        (
            format!("leaves a layer of {width:.3} mm; the lips and the mould need {least:.3} mm"),
            &[
                Raise("shell.width_mm"),
                Lower("silicone.side_clearance_mm"),
                Lower("support.lip_depth_mm"),
                Ease("print.least_wall_mm"),
            ],
        )
    })
}

fn wrap_within_segment(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    require(c.layout.wrap_angle_deg <= c.segment.span_deg, || {
        (
            format!(
                "takes the wrap of {} deg beyond the segment of {} deg",
                c.layout.wrap_angle_deg, c.segment.span_deg
            ),
            &[Lower("layout.wrap_angle_deg"), Raise("segment.span_deg")],
        )
    })
}

fn ends_keep_clear(i: &Inspection<'_>) -> Assessment {
    require(i.ends_keep_clear(), || {
        (
            "brings the two ends of the tendon together, or one into the guide pulley, where they leave the wrap".to_owned(),
            &[Lower("layout.wrap_angle_deg"), Raise("mount.pulley_distance_mm"), Raise("shell.outer_radius_mm")],
        )
    })
}

fn ends_meet(i: &Inspection<'_>) -> Assessment {
    let meet = i.ends_meet_mm();
    advise(meet.is_none(), || {
        (
            format!(
                "the two ends of the tendon would meet {:.1} mm beyond the wrap",
                meet.unwrap_or_default()
            ),
            "lead them past each other, or lower layout.wrap_angle_deg".to_owned(),
        )
    })
}

/// Pins that the tendon does not reach carry nothing.
fn pins_within_wrap(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let pins = PinPattern::new(i.pin_angles_rad());
    let outside = pins.count() - pins.within(c.layout.wrap_angle_deg.to_radians()).count();
    advise(outside == 0, || {
        let furthest = pins.angles_rad().iter().map(|a| a.abs()).fold(0.0, f64::max);
        let needed_deg = (20.0 * furthest.to_degrees()).ceil() / 10.0;
        let raise = if needed_deg <= c.segment.span_deg {
            format!(", or raise layout.wrap_angle_deg to {needed_deg:.1}")
        } else {
            String::new()
        };
        (
            format!(
                "{} outside the wrap of {} deg, where no tendon runs, and {} nothing",
                if outside == 1 { "1 pin lies".to_owned() } else { format!("{outside} pins lie") },
                c.layout.wrap_angle_deg,
                if outside == 1 { "carries" } else { "carry" },
            ),
            format!("move them nearer to the middle groove (layout.pins){raise}"),
        )
    })
}

fn tendon_reaches(i: &Inspection<'_>) -> Assessment {
    let (length, least) = (i.configuration().tendon.length_mm, i.least_tendon_mm());
    advise(length >= least, || {
        (
            format!(
                "the tendon of {length} mm does not reach: wrap, ends and what it runs over need {least:.0} mm"
            ),
            format!("raise tendon.length_mm to {least:.0}"),
        )
    })
}

fn tendon_in_channel(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let channel = c.shell.width_mm - 2.0 * c.support.lip_depth_mm;
    let most = channel - 2.0 * TENDON_GAP_MM;
    let tendon = i.tendon_diameter_mm();
    require(tendon <= most, || {
        (
            format!(
                "gives the coated tendon, of {tendon:.3} mm, too little room: the channel of {channel:.3} mm takes \
                 {most:.3} mm"
            ),
            &[
                Lower("tendon.rope_diameter_mm"),
                Lower("tendon.coating_mm"),
                Raise("shell.width_mm"),
                Lower("support.lip_depth_mm"),
            ],
        )
    })
}

fn tendon_bend(i: &Inspection<'_>) -> Assessment {
    let most = 2.0 * i.contact_radius_mm() / MIN_BEND_RATIO;
    let tendon = i.tendon_diameter_mm();
    require(tendon <= most, || {
        (
            format!(
                "bends the coated tendon, of {tendon:.3} mm, too sharply: {most:.3} mm with the coating is the most \
                 at this radius"
            ),
            &[
                Lower("tendon.rope_diameter_mm"),
                Lower("tendon.coating_mm"),
                Raise("shell.outer_radius_mm"),
                Raise("silicone.thickness_mm"),
            ],
        )
    })
}

fn early_wear(i: &Inspection<'_>) -> Assessment {
    let ratio = i.bend_ratio();
    advise(ratio >= GOOD_BEND_RATIO, || {
        (
            format!("pulley over tendon diameter is {ratio:.1}; ropes last from {GOOD_BEND_RATIO} on"),
            "raise shell.outer_radius_mm".to_owned(),
        )
    })
}
