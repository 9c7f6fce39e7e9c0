//! Rules for the side supports, their slots and the fasteners.

use super::Direction::{self, Lower, OneOf, Raise, Restore, Set};
use super::{Assessment, Inspection, Rule, Severity, advise, least_wall_mm, require};
use crate::config::{FastenerKind, SlotKind};
use crate::design::fastening::{
    CLEARANCE_HOLES_MM, DOWELS_MM, HOLE_EDGE_MM, INSERT_SHOULDER_MM, INSERT_TIP_MM,
};
use pinswitch_diagnostic::codes;

/// Clearance above which pins have noticeable play (cad/doc/print-limits.md), mm.
const WIDE_CLEARANCE_MM: f64 = 0.3;

pub(super) const RULES: &[Rule] = &[
    Rule {
        code: codes::PLATE_OUTSIDE_SLOTS,
        field: "support.rise_mm",
        severity: Severity::Error,
        assess: slots_in_plate,
    },
    Rule {
        code: codes::SLOTS_TOO_CLOSE,
        field: "support.slot_clearance_mm",
        severity: Severity::Error,
        assess: land_between_slots,
    },
    Rule {
        code: codes::WALL_BEYOND_SLOTS,
        field: "segment.end_margin_mm",
        severity: Severity::Error,
        assess: wall_beyond_slots,
    },
    Rule {
        code: codes::CORNERS_TOO_ROUND,
        field: "support.corner_radius_mm",
        severity: Severity::Error,
        assess: corners_in_plate,
    },
    Rule {
        code: codes::SLOT_TOO_SHALLOW,
        field: "support.slot_floor_mm",
        severity: Severity::Error,
        assess: blind_slot_depth,
    },
    Rule {
        code: codes::PIN_REACHES_SHELL,
        field: "support.travel_margin_mm",
        severity: Severity::Error,
        assess: slot_travel,
    },
    Rule {
        code: codes::PIN_ENGAGES_TOO_LITTLE,
        field: "support.plate_mm",
        severity: Severity::Error,
        assess: pin_engagement,
    },
    Rule {
        code: codes::SCREW_HOLES_TOO_LARGE,
        field: "fasteners.hole_diameter_mm",
        severity: Severity::Error,
        assess: holes_in_wall,
    },
    Rule {
        code: codes::SCREW_HOLE_NEAR_END,
        field: "fasteners.end_distance_mm",
        severity: Severity::Error,
        assess: holes_in_sector,
    },
    Rule {
        code: codes::SCREW_HOLES_CROWDED,
        field: "fasteners.count",
        severity: Severity::Error,
        assess: holes_apart,
    },
    Rule {
        code: codes::INSERT_DOES_NOT_FIT,
        field: "fasteners.kind",
        severity: Severity::Error,
        assess: inserts_in_shell,
    },
    Rule {
        code: codes::SCREW_NOT_SOLD,
        field: "fasteners.hole_diameter_mm",
        severity: Severity::Error,
        assess: screws_are_sold,
    },
    Rule {
        code: codes::DOWEL_NOT_SOLD,
        field: "fasteners.dowel_diameter_mm",
        severity: Severity::Error,
        assess: dowels_are_sold,
    },
    Rule {
        code: codes::DOWEL_WALL_TOO_THIN,
        field: "fasteners.dowel_diameter_mm",
        severity: Severity::Error,
        assess: dowels_in_wall,
    },
    Rule {
        code: codes::LOOSE_PINS,
        field: "support.slot_kind",
        severity: Severity::Warning,
        assess: loose_pins,
    },
    Rule {
        code: codes::SLOTS_TOO_WIDE,
        field: "support.slot_clearance_mm",
        severity: Severity::Warning,
        assess: wide_clearance,
    },
];

fn slots_in_plate(i: &Inspection<'_>) -> Assessment {
    let (slot, wall) = (i.slot(), least_wall_mm(i.configuration(), 1.0));
    let outer_edge = i.support_radius_mm() - slot.outer_mm - slot.width_mm / 2.0;
    require(outer_edge >= wall, || {
        (
            format!("plate outside the slots too thin ({outer_edge:.3} mm, at least {wall:.3} mm needed)"),
            &[
                Raise("support.rise_mm"),
                Lower("support.slot_clearance_mm"),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

fn land_between_slots(i: &Inspection<'_>) -> Assessment {
    let (slot, wall) = (i.slot(), least_wall_mm(i.configuration(), 1.0));
    let half = slot.width_mm / 2.0;
    let land = 2.0 * slot.inner_edge_mm() * libm::sin(i.pitch_rad() / 2.0) - 2.0 * half;
    require(i.configuration().segment.grooves < 2 || land >= wall, || {
        (
            format!("wall between neighbouring slots too thin ({land:.3} mm, at least {wall:.3} mm needed)"),
            &[
                Lower("support.slot_clearance_mm"),
                Lower("segment.grooves"),
                Raise("shell.outer_radius_mm"),
                Raise("segment.span_deg"),
                Restore("support.travel_margin_mm"),
                Restore("pins.diameter_mm"),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

fn wall_beyond_slots(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let slot = i.slot();
    let half = slot.width_mm / 2.0;
    let end = slot.inner_edge_mm() * libm::sin(i.half_pitch_rad()) + i.shell_end_shift_mm() - half;
    let least = least_wall_mm(c, 0.5);
    require(end >= least, || {
        (
            format!("wall beyond the outermost slot too thin ({end:.3} mm, at least {least:.3} mm needed)"),
            &[
                Raise("segment.end_margin_mm"),
                Lower("segment.grooves"),
                Raise("shell.outer_radius_mm"),
                Restore("support.slot_clearance_mm"),
                Restore("support.travel_margin_mm"),
                Restore("pins.diameter_mm"),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

/// Rounded corners must leave a wall around the outermost slots and holes, and a part of the ends.
fn corners_in_plate(i: &Inspection<'_>) -> Assessment {
    let radius = i.configuration().support.corner_radius_mm;
    require(corner_fits(i, radius), || {
        (
            "rounded corner reaches the outermost slot or hole, or the whole end of the plate".to_owned(),
            &[
                Lower("support.corner_radius_mm"),
                Raise("segment.end_margin_mm"),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

fn corner_fits(i: &Inspection<'_>, radius_mm: f64) -> bool {
    if radius_mm <= 0.0 {
        return true;
    }
    let c = i.configuration();
    let (half_span, shift) = (i.half_span_rad(), i.shell_end_shift_mm());
    // Coordinates of an end: along its radial plane, and outwards across it. A slot has round ends.
    let at =
        |mm: f64, rad: f64| [mm * libm::cos(half_span - rad.abs()), -mm * libm::sin(half_span - rad.abs())];
    let (across, reach) = (shift - radius_mm, i.support_radius_mm() - radius_mm);
    if reach <= across.abs() {
        return false;
    }
    let centre = [(reach * reach - across * across).sqrt(), across];
    let slot = i.slot();
    let slots = i.slot_angles_rad().into_iter().flat_map(|rad| {
        [slot.inner_mm, slot.outer_mm].map(|mm| (at(mm, rad), slot.width_mm / 2.0 + least_wall_mm(c, 0.5)))
    });
    let hole_mm = c.fasteners.hole_diameter_mm / 2.0 + hole_edge_mm(i);
    let holes = i.fastener_angles_rad().into_iter().map(|rad| (at(i.fastener_radius_mm(), rad), hole_mm));
    let is_inside = |(point, room_mm): ([f64; 2], f64)| {
        let from = [point[0] - centre[0], point[1] - centre[1]];
        // The outline is the rounded corner only beyond its centre, both outwards and along the end.
        let is_beyond = from[0] > 0.0 && from[1] * centre[0] > from[0] * centre[1];
        !is_beyond || libm::hypot(from[0], from[1]) + room_mm <= radius_mm
    };
    let ends_outside = libm::hypot(centre[0], shift) >= i.inner_radius_mm() + least_wall_mm(c, 1.0);
    let before_middle = half_span + libm::asin(across / reach) > 0.0;
    ends_outside && before_middle && slots.chain(holes).all(is_inside)
}

fn blind_slot_depth(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let depth = i.slot().depth_mm;
    require(c.support.slot_kind != SlotKind::Blind || depth >= least_wall_mm(c, 1.0), || {
        (
            format!(
                "slots too shallow in a plate of {} mm ({depth:.3} mm, at least {:.3} mm needed)",
                c.support.plate_mm,
                least_wall_mm(c, 1.0)
            ),
            &[
                Lower("support.slot_floor_mm"),
                Raise("support.plate_mm"),
                Set("support.slot_kind", "\"through\""),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

/// A pin at the inner end of its slot must not reach the shell.
fn slot_travel(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let left = c.silicone.thickness_mm - c.pins.diameter_mm - c.support.travel_margin_mm;
    require(left >= 0.0, || {
        (
            format!("a sunk pin reaches {:.3} mm into the shell", -left),
            &[Lower("support.travel_margin_mm"), Lower("pins.diameter_mm"), Raise("silicone.thickness_mm")],
        )
    })
}

fn pin_engagement(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let engagement = i.pin_overhang_mm();
    let least = c.pins.diameter_mm;
    require(engagement >= least, || {
        (
            format!(
                "pins engage too little at each end ({engagement:.3} mm, at least one diameter, {least:.3} mm, needed)"
            ),
            &[
                Raise("support.plate_mm"),
                Lower("support.slot_floor_mm"),
                Lower("pins.end_play_mm"),
                Lower("pins.diameter_mm"),
            ],
        )
    })
}

/// Least wall around a fastener hole, mm.
fn hole_edge_mm(i: &Inspection<'_>) -> f64 {
    HOLE_EDGE_MM.max(least_wall_mm(i.configuration(), 1.0))
}

fn holes_in_wall(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.fasteners.count == 0 {
        return Assessment::NotApplicable;
    }
    let edge = hole_edge_mm(i);
    let radial = c.shell.wall_mm - c.segment.groove_radius_mm - 2.0 * edge;
    // The slots of the supports may reach below the face of the shell.
    let slot = i.slot();
    let under_slots = 2.0 * (slot.inner_edge_mm() - edge - i.fastener_radius_mm());
    let most = radial.min(under_slots);
    require(c.fasteners.hole_diameter_mm <= most, || {
        (
            format!(
                "holes too large for the wall ({} mm, {} with {edge} mm of wall around them)",
                c.fasteners.hole_diameter_mm,
                if most > 0.0 { format!("at most {most:.3} mm") } else { "no hole fits".to_owned() }
            ),
            &[
                Lower("fasteners.hole_diameter_mm"),
                Raise("shell.wall_mm"),
                Set("fasteners.count", "0"),
                Restore("segment.groove_radius_mm"),
                Restore("support.travel_margin_mm"),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

fn holes_in_sector(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.fasteners.count == 0 {
        return Assessment::NotApplicable;
    }
    let needed = c.fasteners.hole_diameter_mm / 2.0 + hole_edge_mm(i);
    require(c.fasteners.end_distance_mm + i.shell_end_shift_mm() >= needed, || {
        (
            format!(
                "outermost hole too close to the end of the sector ({:.3} mm, at least {needed:.3} mm needed)",
                c.fasteners.end_distance_mm + i.shell_end_shift_mm()
            ),
            &[
                Raise("fasteners.end_distance_mm"),
                Raise("segment.end_margin_mm"),
                Lower("fasteners.hole_diameter_mm"),
                Set("fasteners.count", "0"),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

fn holes_apart(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.fasteners.count == 0 {
        return Assessment::NotApplicable;
    }
    let (diameter, edge) = (c.fasteners.hole_diameter_mm, hole_edge_mm(i));
    let needed = diameter + edge;
    let angles = i.fastener_angles_rad();
    let apart = |w: &[f64]| 2.0 * i.fastener_radius_mm() * libm::sin((w[1] - w[0]) / 2.0);
    let crowded = angles.windows(2).any(|w| w[1] <= w[0] || apart(w) < needed);
    let single = c.fasteners.count == 1
        && i.fastener_radius_mm() * libm::sin(i.half_span_rad().min(1.5)) < needed / 2.0 + edge;
    require(!crowded && !single, || {
        (
            format!(
                "{} holes of {diameter} mm do not fit on an arc of {} deg ({needed:.3} mm apart needed)",
                c.fasteners.count, c.segment.span_deg
            ),
            &[
                Lower("fasteners.count"),
                Lower("fasteners.end_distance_mm"),
                Lower("fasteners.hole_diameter_mm"),
                Raise("segment.span_deg"),
                Raise("shell.outer_radius_mm"),
                Restore("print.elephant_foot_mm"),
                Restore("print.least_wall_mm"),
            ],
        )
    })
}

/// Inserts need a thread for which they are sold, walls around them, and room for two in the width of the shell.
fn inserts_in_shell(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.fasteners.kind != FastenerKind::Insert || c.fasteners.count == 0 {
        return Assessment::NotApplicable;
    }
    const DIRECTIONS: &[Direction] = &[
        Set("fasteners.kind", "\"screw\""),
        OneOf("fasteners.hole_diameter_mm", CLEARANCE_HOLES_MM),
        Raise("shell.width_mm"),
        Raise("shell.wall_mm"),
    ];
    let hole = c.fasteners.hole_diameter_mm;
    let Some([bore, length]) = i.fastening().insert_mm else {
        return require(false, || {
            (format!("no inserts for holes of {hole} mm (known are M2 to M4)"), DIRECTIONS)
        });
    };
    let (radius, edge) = (i.fastener_radius_mm(), hole_edge_mm(i));
    let wall = (radius - i.inner_radius_mm())
        .min(c.shell.outer_radius_mm - c.segment.groove_radius_mm - radius)
        .min(c.fasteners.end_distance_mm + i.shell_end_shift_mm())
        - bore / 2.0;
    if hole > bore - 2.0 * INSERT_SHOULDER_MM + 1e-9 {
        return require(false, || {
            (
                format!(
                    "no shoulder for inserts (a screw hole of {hole} mm under an insert hole of {bore} mm, at most {:.1} mm)",
                    bore - 2.0 * INSERT_SHOULDER_MM
                ),
                DIRECTIONS,
            )
        });
    }
    if wall < edge {
        return require(false, || {
            (
                format!(
                    "wall around insert holes of {bore} mm too thin ({wall:.3} mm, at least {edge} mm needed)"
                ),
                DIRECTIONS,
            )
        });
    }
    let needed = 2.0 * length + INSERT_TIP_MM;
    require(c.shell.width_mm >= needed, || {
        (
            format!(
                "shell too narrow for inserts of {length} mm from both sides ({} mm, at least {needed:.1} mm needed)",
                c.shell.width_mm
            ),
            DIRECTIONS,
        )
    })
}

/// Screws are sold in certain lengths: ISO 4762 lists them for each thread.
fn screws_are_sold(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.fasteners.count == 0 || i.screw_lengths_mm().is_some() {
        return Assessment::NotApplicable;
    }
    const DIRECTIONS: &[Direction] = &[
        OneOf("fasteners.hole_diameter_mm", CLEARANCE_HOLES_MM),
        Lower("shell.width_mm"),
        Restore("support.plate_mm"),
        Restore("mount.plate_mm"),
        Raise("fasteners.head_recess_mm"),
        Set("fasteners.kind", "\"insert\""),
        Set("fasteners.kind", "\"screw\""),
        Set("fasteners.count", "0"),
    ];
    let hole = c.fasteners.hole_diameter_mm;
    let Some(thread) = i.fastening().thread else {
        return require(false, || {
            (
                format!("holes of {hole} mm too small for a screw (at least 1.7 mm needed, for M1.6)"),
                DIRECTIONS,
            )
        });
    };
    let [low, high] = thread.lengths_mm;
    require(false, || {
        (
            format!(
                "no {} screw joins shell and plates (sold from {low} to {high} mm long, ISO 4762)",
                thread.name
            ),
            DIRECTIONS,
        )
    })
}

/// Dowels are sold in certain diameters (ISO 2338).
fn dowels_are_sold(i: &Inspection<'_>) -> Assessment {
    let diameter = i.configuration().fasteners.dowel_diameter_mm;
    require(diameter == 0.0 || DOWELS_MM.iter().any(|d| (d - diameter).abs() < 1e-9), || {
        (
            "dowels are not sold in this diameter (ISO 2338)".to_owned(),
            &[OneOf("fasteners.dowel_diameter_mm", DOWELS_MM), Set("fasteners.dowel_diameter_mm", "0")],
        )
    })
}

fn dowels_in_wall(i: &Inspection<'_>) -> Assessment {
    require(i.dowels_fit(), || {
        (
            "wall around the dowels next to the outermost screws too thin".to_owned(),
            &[
                OneOf("fasteners.dowel_diameter_mm", DOWELS_MM),
                Raise("shell.wall_mm"),
                Lower("fasteners.count"),
                Set("fasteners.dowel_diameter_mm", "0"),
            ],
        )
    })
}

/// Friction alone retains a pin in a through slot.
fn loose_pins(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    advise(c.support.slot_kind != SlotKind::Through || c.layout.pins.is_empty(), || {
        (
            "through slots do not retain the pins axially".to_owned(),
            "cover the outside of the plates, or set support.slot_kind = \"blind\"".to_owned(),
        )
    })
}

fn wide_clearance(i: &Inspection<'_>) -> Assessment {
    let clearance = i.configuration().support.slot_clearance_mm;
    advise(clearance <= WIDE_CLEARANCE_MM, || {
        (
            format!("support.slot_clearance_mm = {clearance} gives the pins too much play"),
            "print the coupon and lower it".to_owned(),
        )
    })
}
