//! Rules for the mounting plate and the sheath stop.

use super::Change::{self, Ease, Lower, Raise, Set};
use super::{Assessment, Inspection, Rule, Severity, require};
use crate::config::MountKind;
use crate::design::fastening::{HEAD_BELOW_MM, axle_recess, stop_recess};
use crate::design::mounting::{Hole, PULLEY_AIR_MM, PULLEY_RADIUS_MM, SheathStop};
use crate::design::{pulley_outer_mm, pulley_width_mm};

/// Least wall between two holes of the plate.
const HOLE_WALL_MM: f64 = 1.0;
/// Least length of the pulley's spacer, and least height of the sheath stop's base.
const LEAST_PIECE_MM: f64 = 1.0;
/// What a sheath is wider than the tendon.
const SHEATH_WALL_MM: f64 = 0.4;

pub(super) const RULES: &[Rule] = &[
    Rule { field: "tendon.sheath_diameter_mm", severity: Severity::Error, assess: sheath_on_plate },
    Rule { field: "tendon.sheath_diameter_mm", severity: Severity::Error, assess: sheath_around_tendon },
    Rule { field: "mount.kind", severity: Severity::Error, assess: plate_is_fastened },
    Rule { field: "mount.kind", severity: Severity::Error, assess: holes_clear_each_other },
    Rule { field: "mount.pulley_distance_mm", severity: Severity::Error, assess: pulley_beside_switch },
    Rule { field: "mount.kind", severity: Severity::Error, assess: pulley_over_plate },
    Rule { field: "tendon.sheath_diameter_mm", severity: Severity::Error, assess: stop_out_of_the_way },
    Rule { field: "mount.bore_offset_mm", severity: Severity::Error, assess: bores_beside_support },
    Rule { field: "mount.plate_mm", severity: Severity::Error, assess: heads_within_plate },
];

const NO_MOUNT: Change = Set("mount.kind", "\"none\"");

fn sheath_on_plate(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    require(c.tendon.sheath_diameter_mm == 0.0 || c.mount.kind != MountKind::None, || {
        (
            "asks for a sheath stop, which stands on a mounting plate".to_owned(),
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
                "is too narrow for a tendon of {:.3} mm: {least:.3} mm is the least, or 0 for no sheath",
                i.tendon_diameter_mm()
            )
        } else {
            "reaches below the plate: the tendon's axis lies too near to it".to_owned()
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
        ("has a plate that no screw holds".to_owned(), &[NO_MOUNT, Raise("fasteners.count")])
    })
}

/// How far a hole stays from the sheath stop's base, mm.
fn beside_stop_mm(hole: &Hole, stop: &SheathStop) -> f64 {
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
    let own = mounting.holes.iter().chain(&mounting.axle);
    let clear =
        mounting.sheath.is_none_or(|stop| own.into_iter().all(|h| beside_stop_mm(h, &stop) >= HOLE_WALL_MM));
    require(pairs && clear, || {
        (
            "brings holes of the mounting plate together, or under the sheath stop".to_owned(),
            &[
                Raise("mount.bore_distance_mm"),
                Raise("mount.pulley_distance_mm"),
                Lower("mount.bore_offset_mm"),
                Lower("mount.hole_diameter_mm"),
                Lower("tendon.sheath_diameter_mm"),
                NO_MOUNT,
            ],
        )
    })
}

fn pulley_beside_switch(i: &Inspection<'_>) -> Assessment {
    let Some(axle) = i.mounting().and_then(|m| m.axle) else { return Assessment::NotApplicable };
    let least = i.support_radius_mm() + pulley_outer_mm(i.tendon_diameter_mm()) + PULLEY_AIR_MM;
    let distance = axle.centre.coords.norm();
    require(distance >= least, || {
        (
            format!(
                "brings the pulley of {PULLEY_RADIUS_MM} mm into the switch: its axis is {distance:.1} mm away, {least:.1} mm is the least"
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
            "guide pulley, or the tendon that runs to it"
        } else {
            "tendon on the load's side"
        };
        (
            format!("puts the sheath stop {nearer_mm:.2} mm too near to the {what}"),
            &[
                Lower("layout.wrap_angle_deg"),
                Raise("mount.pulley_distance_mm"),
                Set("tendon.sheath_diameter_mm", "0"),
            ],
        )
    })
}

/// A bore of a finger link that a support covers takes no pivot.
fn bores_beside_support(i: &Inspection<'_>) -> Assessment {
    let c = i.configuration();
    let Some(mounting) = i.mounting().filter(|_| c.mount.kind == MountKind::FingerLink) else {
        return Assessment::NotApplicable;
    };
    let clear = |hole: &Hole| i.beside_support_mm(hole.centre) >= hole.radius_mm + HOLE_WALL_MM;
    require(mounting.holes.iter().all(clear), || {
        (
            "puts a bore behind the left support, where no pivot passes".to_owned(),
            &[
                Lower("mount.bore_offset_mm"),
                Raise("mount.bore_distance_mm"),
                Lower("mount.bore_distance_mm"),
                Raise("mount.bore_offset_mm"),
                Lower("mount.hole_diameter_mm"),
                NO_MOUNT,
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
            format!("leaves {spacer:.2} mm between plate and pulley; {LEAST_PIECE_MM} mm is the least"),
            &[Raise("shell.width_mm"), Raise("support.plate_mm"), Lower("tendon.rope_diameter_mm"), NO_MOUNT],
        )
    })
}

/// The heads of all screws that stand in the plate from below must lie within it.
fn heads_within_plate(i: &Inspection<'_>) -> Assessment {
    let Some(mounting) = i.mounting() else { return Assessment::NotApplicable };
    let c = i.configuration();
    let fastening = i.fastening();
    let stop = mounting.sheath.map(|_| ("the sheath stop's screws", stop_recess().depth_mm));
    let axle = mounting.axle.map(|_| ("the axle's bolt", axle_recess().depth_mm));
    let heads = fastening.thread.filter(|_| i.lies_on_a_table() && c.fasteners.count > 0);
    let heads = heads.map(|t| ("the screws", (t.head_mm[1] + HEAD_BELOW_MM).max(c.fasteners.head_recess_mm)));
    let deepest = [stop, axle, heads].into_iter().flatten().max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((whose, depth)) = deepest else { return Assessment::NotApplicable };
    let needed = i.seated_mm(depth);
    let is_crowded = heads.is_some() && fastening.mount_counterbore.is_none();
    require(c.mount.plate_mm + 1e-9 >= needed && !is_crowded, || {
        let problem = if c.mount.plate_mm + 1e-9 < needed {
            format!(
                "is too thin for the heads of {whose}, which sink in its outer face: {needed:.3} mm is the least"
            )
        } else {
            "has no room between the screws for the recesses of their heads".to_owned()
        };
        (
            problem,
            &[
                Raise("mount.plate_mm"),
                Ease("fasteners.head_recess_mm"),
                Ease("print.layer_mm"),
                Lower("fasteners.hole_diameter_mm"),
                Lower("fasteners.count"),
                Raise("shell.outer_radius_mm"),
                NO_MOUNT,
            ],
        )
    })
}
