//! Rules for the joint: its axle, its range of flexion, its stops and its links.

use super::Direction::{self, Lower, OneOf, Raise, Set};
use super::{Assessment, Inspection, Rule, Severity, require};
use crate::design::joint::AXLES_MM;
use pinswitch_diagnostic::codes;

/// Least wall of the hub around the axle, mm.
const HUB_WALL_MM: f64 = 2.0;
/// Least flexion between the stops, degrees.
const LEAST_RANGE_DEG: f64 = 5.0;
/// Gap between a stop and the ends of shell and supports, mm.
const STOP_AIR_MM: f64 = 1.0;
/// Allowance for rounding errors in an angle, degrees.
const ROUNDING_DEG: f64 = 1e-9;

pub(super) const RULES: &[Rule] = &[
    Rule {
        code: codes::JOINT_WITH_SHEATH,
        field: "tendon.sheath_diameter_mm",
        severity: Severity::Error,
        assess: joint_without_sheath,
    },
    Rule {
        code: codes::AXLE_NOT_SOLD,
        field: "mount.axle_mm",
        severity: Severity::Error,
        assess: axle_is_available,
    },
    Rule {
        code: codes::HUB_TOO_SMALL,
        field: "mount.axle_mm",
        severity: Severity::Error,
        assess: hub_around_axle,
    },
    Rule {
        code: codes::STOPS_TOO_CLOSE,
        field: "mount.flexion_max_deg",
        severity: Severity::Error,
        assess: stops_are_apart,
    },
    Rule {
        code: codes::WRAP_OUTSIDE_STOPS,
        field: "mount.flexion_max_deg",
        severity: Severity::Error,
        assess: layout_between_stops,
    },
    Rule {
        code: codes::FLEXION_LEAVES_SEGMENT,
        field: "mount.flexion_max_deg",
        severity: Severity::Error,
        assess: wrap_on_segment,
    },
    Rule {
        code: codes::STOPS_DO_NOT_FIT,
        field: "mount.flexion_max_deg",
        severity: Severity::Error,
        assess: stops_beside_switch,
    },
    Rule {
        code: codes::LINK_TOO_SHORT,
        field: "mount.proximal_mm",
        severity: Severity::Error,
        assess: proximal_link_is_long_enough,
    },
    Rule {
        code: codes::LINK_TOO_SHORT,
        field: "mount.distal_mm",
        severity: Severity::Error,
        assess: distal_link_is_long_enough,
    },
    Rule {
        code: codes::AXLE_NOT_SOLD,
        field: "mount.axle_mm",
        severity: Severity::Error,
        assess: axle_is_long_enough,
    },
];

const NO_MOUNT: Direction = Set("mount.kind", "\"none\"");

fn joint_without_sheath(i: &Inspection<'_>) -> Assessment {
    if i.joint().is_none() {
        return Assessment::NotApplicable;
    }
    require(i.configuration().tendon.sheath_diameter_mm == 0.0, || {
        (
            "the proximal link of a joint guides the tendon without a sheath".to_owned(),
            &[Set("tendon.sheath_diameter_mm", "0"), Set("mount.kind", "\"flange\"")],
        )
    })
}

fn axle_is_available(i: &Inspection<'_>) -> Assessment {
    let Some(joint) = i.joint() else { return Assessment::NotApplicable };
    require(joint.axle.has_diameter(i.configuration().mount.axle_mm), || {
        ("no bolt of this diameter is sold (4, 5, 6 or 8 mm)".to_owned(), &[OneOf("mount.axle_mm", AXLES_MM)])
    })
}

fn hub_around_axle(i: &Inspection<'_>) -> Assessment {
    let Some(joint) = i.joint() else { return Assessment::NotApplicable };
    let (wall, least) = (joint.hub.radius_mm - joint.hub.bore_mm, HUB_WALL_MM);
    require(wall >= least && 2.0 * joint.hub.radius_mm >= joint.axle.washer_mm[1], || {
        (
            format!(
                "hub of {:.1} mm inside the shell too narrow for an axle of {} mm and its washer ({wall:.2} mm of wall, at least {least} mm needed)",
                2.0 * joint.hub.radius_mm,
                joint.axle.diameter_mm
            ),
            &[
                OneOf("mount.axle_mm", AXLES_MM),
                Lower("shell.wall_mm"),
                Raise("shell.outer_radius_mm"),
                NO_MOUNT,
            ],
        )
    })
}

fn stops_are_apart(i: &Inspection<'_>) -> Assessment {
    let Some(joint) = i.joint() else { return Assessment::NotApplicable };
    let [low, high] = joint.flexion_deg;
    require(high - low >= LEAST_RANGE_DEG, || {
        (
            format!(
                "stops too close to each other ({:.1} deg of flexion, at least {LEAST_RANGE_DEG} deg needed)",
                high - low
            ),
            &[Raise("mount.flexion_max_deg"), Lower("mount.flexion_min_deg")],
        )
    })
}

/// The parts are constructed, and the curve is predicted, at a flexion of the wrap angle of the layout.
fn layout_between_stops(i: &Inspection<'_>) -> Assessment {
    let Some(joint) = i.joint() else { return Assessment::NotApplicable };
    let [low, high] = joint.flexion_deg;
    require((low..=high).contains(&joint.assembled_deg), || {
        (
            format!(
                "the joint never reaches the wrap of the layout ({} deg, stops at {low} and {high} deg)",
                joint.assembled_deg
            ),
            &[
                Raise("mount.flexion_max_deg"),
                Lower("mount.flexion_min_deg"),
                Lower("layout.wrap_angle_deg"),
                Raise("layout.wrap_angle_deg"),
                NO_MOUNT,
            ],
        )
    })
}

fn wrap_on_segment(i: &Inspection<'_>) -> Assessment {
    let Some(joint) = i.joint() else { return Assessment::NotApplicable };
    let [_, high] = joint.flexion_deg;
    let end_deg = i.configuration().segment.span_deg / 2.0;
    let beyond_deg = -joint.contact(high).from_rad.to_degrees() - end_deg;
    require(beyond_deg <= ROUNDING_DEG, || {
        (
            format!("at full flexion the wrap ends {beyond_deg:.2} deg beyond the segment"),
            &[
                Lower("mount.flexion_max_deg"),
                Raise("segment.span_deg"),
                Raise("layout.wrap_angle_deg"),
                NO_MOUNT,
            ],
        )
    })
}

fn stops_beside_switch(i: &Inspection<'_>) -> Assessment {
    let Some(joint) = i.joint() else { return Assessment::NotApplicable };
    let inner = i.inner_radius_mm();
    let end = libm::asin((i.shell_end_shift_mm() / inner).min(1.0));
    let air = STOP_AIR_MM / inner;
    let lacking = i.half_span_rad() + end + air - joint.hub.clear_half_rad();
    require(lacking <= 0.0, || {
        (
            format!(
                "stops at both ends of flexion do not fit next to the shell ({:.1} deg too wide)",
                2.0 * lacking.to_degrees()
            ),
            &[
                Lower("mount.flexion_max_deg"),
                Raise("mount.flexion_min_deg"),
                Lower("segment.span_deg"),
                NO_MOUNT,
            ],
        )
    })
}

fn proximal_link_is_long_enough(i: &Inspection<'_>) -> Assessment {
    let Some(joint) = i.joint() else { return Assessment::NotApplicable };
    let least = joint.least_link_mm(&joint.proximal, i.dimensions);
    require(joint.proximal.length_mm >= least, || {
        (
            format!(
                "holes of the proximal link under the switch or its guide (at least {least:.1} mm needed)"
            ),
            &[Raise("mount.proximal_mm"), NO_MOUNT],
        )
    })
}

fn distal_link_is_long_enough(i: &Inspection<'_>) -> Assessment {
    let Some(joint) = i.joint() else { return Assessment::NotApplicable };
    let least = joint.least_link_mm(&joint.distal, i.dimensions);
    require(joint.distal.length_mm >= least, || {
        (
            format!("holes of the distal link over the switch or its anchor (at least {least:.1} mm needed)"),
            &[Raise("mount.distal_mm"), NO_MOUNT],
        )
    })
}

fn axle_is_long_enough(i: &Inspection<'_>) -> Assessment {
    let Some(joint) = i.joint() else { return Assessment::NotApplicable };
    require(joint.axle_length_mm.is_some(), || {
        (
            format!("no {} bolt of ISO 4014 is long enough for the joint", joint.axle.name),
            &[
                OneOf("mount.axle_mm", AXLES_MM),
                Lower("mount.plate_mm"),
                Lower("shell.width_mm"),
                Lower("support.plate_mm"),
                NO_MOUNT,
            ],
        )
    })
}
