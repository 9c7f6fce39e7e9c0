//! Rules for the mounting plate and the sheath stop.

use super::Direction::{self, Lower, Raise, Restore, Set};
use super::{Assessment, Inspection, Rule, Severity, require};
use crate::config::MountKind;
use crate::design::fastening::{HEAD_BELOW_MM, axle_recess, stop_recess};
use crate::design::mounting::{Hole, PULLEY_AIR_MM, PULLEY_RADIUS_MM, SheathStop};
use crate::design::{pulley_outer_mm, pulley_width_mm};
use pinswitch_diagnostic::codes;

/// Least wall between two holes of the plate, mm.
const HOLE_WALL_MM: f64 = 1.0;
/// Least length of the spacer of the pulley, and least height of the base of the sheath stop, mm.
const LEAST_PIECE_MM: f64 = 1.0;
/// Least clearance of the tendon in its sheath, on the diameter, mm.
const SHEATH_WALL_MM: f64 = 0.4;

pub(super) const RULES: &[Rule] = &[
    Rule {
        code: codes::SHEATH_WITHOUT_PLATE,
        field: "tendon.sheath_diameter_mm",
        severity: Severity::Error,
        assess: sheath_on_plate,
    },
    Rule {
        code: codes::SHEATH_DOES_NOT_FIT,
        field: "tendon.sheath_diameter_mm",
        severity: Severity::Error,
        assess: sheath_around_tendon,
    },
    Rule {
        code: codes::PLATE_WITHOUT_SCREWS,
        field: "mount.kind",
        severity: Severity::Error,
        assess: plate_is_fastened,
    },
    Rule {
        code: codes::PLATE_HOLES_CROWDED,
        field: "mount.kind",
        severity: Severity::Error,
        assess: holes_clear_each_other,
    },
    Rule {
        code: codes::PULLEY_NEAR_SWITCH,
        field: "mount.pulley_distance_mm",
        severity: Severity::Error,
        assess: pulley_beside_switch,
    },
    Rule {
        code: codes::PULLEY_NEAR_PLATE,
        field: "mount.kind",
        severity: Severity::Error,
        assess: pulley_over_plate,
    },
    Rule {
        code: codes::SHEATH_STOP_IN_THE_WAY,
        field: "tendon.sheath_diameter_mm",
        severity: Severity::Error,
        assess: stop_out_of_the_way,
    },
    Rule {
        code: codes::PLATE_TOO_THIN,
        field: "mount.plate_mm",
        severity: Severity::Error,
        assess: heads_within_plate,
    },
];

const NO_MOUNT: Direction = Set("mount.kind", "\"none\"");

fn sheath_on_plate(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    require(c.tendon.sheath_diameter_mm == 0.0 || c.mount.kind != MountKind::None, || {
        (
            "a sheath stop needs a mounting plate".to_owned(),
            &[Set("mount.kind", "\"flange\""), Lower("tendon.sheath_diameter_mm")],
        )
    })
}

fn sheath_around_tendon(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let sheath = c.tendon.sheath_diameter_mm;
    if sheath == 0.0 {
        return Assessment::NotApplicable;
    }
    let (least, floor) = (i.tendon_diameter_mm() + SHEATH_WALL_MM, i.sheath_floor_mm());
    require(sheath >= least && floor >= LEAST_PIECE_MM, || {
        let problem = if sheath < least {
            format!(
                "sheath too narrow for a tendon of {:.3} mm (at least {least:.3} mm needed, or 0 for no sheath)",
                i.tendon_diameter_mm()
            )
        } else {
            format!(
                "sheath too close to the plate ({floor:.3} mm above it, at least {LEAST_PIECE_MM} mm needed)"
            )
        };
        (
            problem,
            &[
                Raise("tendon.sheath_diameter_mm"),
                Lower("tendon.sheath_diameter_mm"),
                Raise("shell.width_mm"),
            ],
        )
    })
}

fn plate_is_fastened(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    require(c.mount.kind == MountKind::None || c.fasteners.count > 0, || {
        ("the plate needs a screw".to_owned(), &[NO_MOUNT, Raise("fasteners.count")])
    })
}

/// Distance of a hole from the base of the sheath stop, mm.
fn distance_to_stop_mm(hole: &Hole, stop: &SheathStop) -> f64 {
    let from = hole.centre - stop.start;
    let (along, across) = (from.dot(&stop.along), from.perp(&stop.along).abs());
    let out = [(along - stop.length_mm).max(-along).max(0.0), (across - stop.half_width_mm).max(0.0)];
    libm::hypot(out[0], out[1]) - hole.radius_mm
}

fn holes_clear_each_other(i: &Inspection<'_>) -> Assessment {
    let Some(mounting) = i.mounting() else { return Assessment::NotApplicable };
    let all = &mounting.taken;
    let apart = |a: &Hole, b: &Hole| (a.centre - b.centre).norm() >= a.radius_mm + b.radius_mm + HOLE_WALL_MM;
    let pairs = all.iter().enumerate().all(|(k, a)| all[k + 1..].iter().all(|b| apart(a, b)));
    let own = mounting.holes.iter().chain(&mounting.axle).chain(&mounting.drive_axle);
    let clear = mounting
        .sheath
        .is_none_or(|stop| own.into_iter().all(|h| distance_to_stop_mm(h, &stop) >= HOLE_WALL_MM));
    require(pairs && clear, || {
        (
            format!(
                "holes of the mounting plate too close to each other or to the sheath stop (at least {HOLE_WALL_MM} mm needed)"
            ),
            &[
                Raise("mount.proximal_mm"),
                Raise("mount.pulley_distance_mm"),
                Raise("shell.outer_radius_mm"),
                Lower("mount.hole_diameter_mm"),
                Lower("tendon.sheath_diameter_mm"),
                NO_MOUNT,
            ],
        )
    })
}

fn pulley_beside_switch(i: &Inspection<'_>) -> Assessment {
    let Some(mounting) = i.mounting().filter(|m| m.axle.is_some()) else {
        return Assessment::NotApplicable;
    };
    let least = i.support_radius_mm() + pulley_outer_mm(i.tendon_diameter_mm()) + PULLEY_AIR_MM;
    let distance = mounting.axles().map(|axle| axle.centre.coords.norm()).fold(f64::INFINITY, f64::min);
    require(distance >= least, || {
        (
            format!(
                "guide pulley of {PULLEY_RADIUS_MM} mm too close to the switch ({distance:.1} mm between the axes, at least {least:.1} mm needed)"
            ),
            &[Raise("mount.pulley_distance_mm"), NO_MOUNT],
        )
    })
}

fn stop_out_of_the_way(i: &Inspection<'_>) -> Assessment {
    let Some(mounting) = i.mounting().filter(|m| m.sheath.is_some()) else {
        return Assessment::NotApplicable;
    };
    let nearer_mm = i.stop_in_the_way_mm(&mounting);
    require(nearer_mm <= 0.0, || {
        let what = if mounting.axle.is_some() {
            "guide pulley or the tendon to it"
        } else {
            "tendon on the side of the load"
        };
        (
            format!("sheath stop {nearer_mm:.2} mm too close to the {what}"),
            &[
                Lower("layout.wrap_angle_deg"),
                Raise("mount.pulley_distance_mm"),
                Set("tendon.sheath_diameter_mm", "0"),
            ],
        )
    })
}

fn pulley_over_plate(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    if c.mount.kind != MountKind::Rig {
        return Assessment::NotApplicable;
    }
    let spacer = c.support.plate_mm + c.shell.width_mm / 2.0 - pulley_width_mm(i.tendon_diameter_mm()) / 2.0;
    require(spacer >= LEAST_PIECE_MM, || {
        (
            format!("pulley too close to the plate ({spacer:.2} mm, at least {LEAST_PIECE_MM} mm needed)"),
            &[Raise("shell.width_mm"), Raise("support.plate_mm"), Lower("tendon.rope_diameter_mm"), NO_MOUNT],
        )
    })
}

/// The plate must be thick enough for the heads of all screws in its outer face.
fn heads_within_plate(i: &Inspection<'_>) -> Assessment {
    let Some(mounting) = i.mounting() else { return Assessment::NotApplicable };
    let c = i.configuration();
    let fastening = i.fastening();
    let stop = mounting.sheath.map(|_| ("the screws of the sheath stop", stop_recess().depth_mm));
    let axle = mounting.axle.map(|_| axle_recess()).or_else(|| i.joint().map(|joint| joint.head_recess()));
    let axle = axle.map(|recess| ("the bolt of the axle", recess.depth_mm));
    let heads = fastening.thread.filter(|_| i.rests_on_a_table() && c.fasteners.count > 0);
    let heads = heads.map(|t| ("the screws", (t.head_mm[1] + HEAD_BELOW_MM).max(c.fasteners.head_recess_mm)));
    let deepest = [stop, axle, heads].into_iter().flatten().max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((whose, depth)) = deepest else { return Assessment::NotApplicable };
    let needed = i.seated_mm(depth);
    let is_crowded = heads.is_some() && fastening.mount_counterbore.is_none();
    require(c.mount.plate_mm + 1e-9 >= needed && !is_crowded, || {
        let problem = if c.mount.plate_mm + 1e-9 < needed {
            format!(
                "plate too thin for the recessed heads of {whose} ({} mm, at least {needed:.3} mm needed)",
                c.mount.plate_mm
            )
        } else {
            "recesses for the heads of the screws do not fit next to each other".to_owned()
        };
        (
            problem,
            &[
                Raise("mount.plate_mm"),
                Restore("fasteners.head_recess_mm"),
                Restore("print.layer_mm"),
                Lower("fasteners.hole_diameter_mm"),
                Lower("fasteners.count"),
                Raise("shell.outer_radius_mm"),
                NO_MOUNT,
            ],
        )
    })
}
