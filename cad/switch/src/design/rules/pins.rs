//! Rules for pins, layer and tendon.

use super::Direction::{Lower, Raise, Restore};
use super::{Assessment, Inspection, Rule, Severity, advise, require};
use pinswitch_diagnostic::codes;
use pinswitch_friction::PinPattern;

/// Least gap on both sides of the tendon, mm.
const TENDON_GAP_MM: f64 = 0.5;
/// Least ratio of pulley to rope diameter: below it, a rope breaks soon (cad/doc/print-limits.md).
const MIN_BEND_RATIO: f64 = 10.0;
/// Ratio of pulley to rope diameter from which on a wire rope lasts (cad/doc/print-limits.md).
const GOOD_BEND_RATIO: f64 = 20.0;
/// Least thickness of silicone between the bottom of the grooves and the inner face, mm.
const MIN_LAYER_MM: f64 = 0.5;

pub(super) const RULES: &[Rule] = &[
    Rule {
        code: codes::PIN_OUTSIDE_GROOVES,
        field: "layout.pins",
        severity: Severity::Error,
        assess: pins_in_grooves,
    },
    Rule {
        code: codes::GROOVE_OCCUPIED_TWICE,
        field: "layout.pins",
        severity: Severity::Error,
        assess: one_pin_per_groove,
    },
    Rule {
        code: codes::PIN_WIDER_THAN_GROOVE,
        field: "pins.diameter_mm",
        severity: Severity::Error,
        assess: pin_fits_groove,
    },
    Rule {
        code: codes::SILICONE_TOO_THIN,
        field: "silicone.thickness_mm",
        severity: Severity::Error,
        assess: layer_thickness,
    },
    Rule {
        code: codes::SILICONE_TOO_NARROW,
        field: "shell.width_mm",
        severity: Severity::Error,
        assess: layer_width,
    },
    Rule {
        code: codes::WRAP_EXCEEDS_SEGMENT,
        field: "layout.wrap_angle_deg",
        severity: Severity::Error,
        assess: wrap_within_segment,
    },
    Rule {
        code: codes::TENDON_ENDS_COLLIDE,
        field: "layout.wrap_angle_deg",
        severity: Severity::Error,
        assess: ends_keep_clear,
    },
    Rule {
        code: codes::TENDON_ENDS_MEET,
        field: "layout.wrap_angle_deg",
        severity: Severity::Warning,
        assess: ends_meet,
    },
    Rule {
        code: codes::PINS_OUTSIDE_WRAP,
        field: "layout.pins",
        severity: Severity::Warning,
        assess: pins_within_wrap,
    },
    Rule {
        code: codes::TENDON_TOO_THICK,
        field: "tendon.rope_diameter_mm",
        severity: Severity::Error,
        assess: tendon_in_channel,
    },
    Rule {
        code: codes::TENDON_BENT_TOO_SHARPLY,
        field: "tendon.rope_diameter_mm",
        severity: Severity::Error,
        assess: tendon_bend,
    },
    Rule {
        code: codes::TENDON_TOO_SHORT,
        field: "tendon.length_mm",
        severity: Severity::Warning,
        assess: tendon_reaches,
    },
    Rule {
        code: codes::TENDON_WEARS_EARLY,
        field: "shell.outer_radius_mm",
        severity: Severity::Warning,
        assess: early_wear,
    },
];

fn pins_in_grooves(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let outside = c.layout.pins.iter().find(|p| **p < 1 || **p > c.segment.grooves);
    require(outside.is_none(), || {
        (
            format!(
                "pin in groove {}, outside grooves 1 to {}",
                outside.copied().unwrap_or_default(),
                c.segment.grooves
            ),
            &[Raise("segment.grooves")],
        )
    })
}

fn one_pin_per_groove(i: &Inspection<'_>) -> Assessment {
    let pins = &i.configuration().layout.pins;
    let twice = pins.iter().find(|p| pins.iter().filter(|q| q == p).count() > 1);
    require(twice.is_none(), || (format!("two pins in groove {}", twice.copied().unwrap_or_default()), &[]))
}

fn pin_fits_groove(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let most = i.widest_pin_mm();
    require(c.pins.diameter_mm <= most, || {
        (
            format!(
                "pins wider than their grooves ({} mm, at most {most:.3} mm with the pin's tolerance)",
                c.pins.diameter_mm
            ),
            &[Lower("pins.diameter_mm"), Raise("segment.groove_radius_mm"), Restore("pins.tolerance_mm")],
        )
    })
}

fn layer_thickness(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let least = c.segment.groove_radius_mm + MIN_LAYER_MM;
    require(c.silicone.thickness_mm >= least, || {
        (
            format!("silicone under the grooves too thin (at least {least:.3} mm of layer needed)"),
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
            format!("silicone layer too narrow for the lips ({width:.3} mm, at least {least:.3} mm needed)"),
            &[
                Raise("shell.width_mm"),
                Lower("silicone.side_clearance_mm"),
                Lower("support.lip_depth_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

fn wrap_within_segment(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    require(c.layout.wrap_angle_deg <= c.segment.span_deg, || {
        (
            format!(
                "wrap exceeds the segment ({} deg, at most {} deg)",
                c.layout.wrap_angle_deg, c.segment.span_deg
            ),
            &[Lower("layout.wrap_angle_deg"), Raise("segment.span_deg")],
        )
    })
}

fn ends_keep_clear(i: &Inspection<'_>) -> Assessment {
    require(i.ends_keep_clear(), || {
        (
            "an end of the tendon meets the other end or the guide pulley where it leaves the wrap"
                .to_owned(),
            &[
                Lower("layout.wrap_angle_deg"),
                Raise("mount.pulley_distance_mm"),
                Raise("shell.outer_radius_mm"),
            ],
        )
    })
}

fn ends_meet(i: &Inspection<'_>) -> Assessment {
    let meet = i.ends_meet_mm();
    advise(meet.is_none(), || {
        (
            format!("the ends of the tendon meet {:.1} mm beyond the wrap", meet.unwrap_or_default()),
            "guide them past each other, or lower layout.wrap_angle_deg".to_owned(),
        )
    })
}

/// Pins outside the wrap carry no load.
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
                "{} outside the wrap of {} deg and {} no load",
                if outside == 1 { "1 pin is".to_owned() } else { format!("{outside} pins are") },
                c.layout.wrap_angle_deg,
                if outside == 1 { "carries" } else { "carry" },
            ),
            format!(
                "move {} closer to the middle groove (layout.pins){raise}",
                if outside == 1 { "it" } else { "them" }
            ),
        )
    })
}

fn tendon_reaches(i: &Inspection<'_>) -> Assessment {
    let (length, least) = (i.tendon_length_mm(), i.least_tendon_mm());
    advise(length >= least, || {
        (
            format!("tendon of {length} mm is too short: wrap, ends and pulleys need {least:.0} mm"),
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
                "coated tendon too thick for the channel of {channel:.3} mm ({tendon:.3} mm, at most {most:.3} mm)"
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
                "coated tendon too thick for the bend radius ({tendon:.3} mm, at most {most:.3} mm at this radius)"
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
            format!("ratio of pulley to tendon diameter is {ratio:.1}; ropes last from {GOOD_BEND_RATIO} on"),
            "raise shell.outer_radius_mm".to_owned(),
        )
    })
}
