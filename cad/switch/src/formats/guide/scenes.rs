//! Pictures of steps: their moves and views.

use crate::parts::SPACER;
use crate::scene::{Arrows, Bench, Bodies, FROM_RIGHT, GUIDE_PULLEY, Illustration, Motion, Move, Upright};
use pinswitch_solid::mesh::Vector3;
use pinswitch_solid::render::View;

/// Camera of a switch on the workbench, with its axis vertical and its grooves toward the camera.
pub(super) const ON_BENCH: View = View { turn_deg: 148.0, rise_deg: 30.0 };
/// The same, from below the bench, for parts that are put in from below.
pub(super) const FROM_BELOW: View = View { turn_deg: 148.0, rise_deg: -24.0 };
/// Camera above a joint, whose links hide the tendon from the side.
pub(super) const JOINT_VIEW: View = View { turn_deg: FROM_RIGHT.turn_deg, rise_deg: 62.0 };
/// Camera of small bodies on a table.
const ON_TABLE: View = View { turn_deg: 20.0, rise_deg: 50.0 };

/// A displacement along the axis.
pub(super) fn along(mm: f64) -> Vector3 {
    Vector3::new(0.0, 0.0, mm)
}

/// A displacement away from the axis, in the middle of the wrap.
pub(super) fn outward(mm: f64) -> Vector3 {
    Vector3::new(0.0, mm, 0.0)
}

/// Bodies with a call-out that move together along `by`.
pub(super) fn moving(bodies: Vec<String>, label: impl Into<String>, motion: Motion, by: Vector3) -> Move {
    Move { bodies, label: label.into(), motion, by, arrows: Arrows::One }
}

/// The same, with an arrow for each body.
pub(super) fn each(bodies: Vec<String>, label: impl Into<String>, motion: Motion, by: Vector3) -> Move {
    Move { arrows: Arrows::Each, ..moving(bodies, label, motion, by) }
}

/// The same with the arrow on the axis of the pulley.
pub(super) fn on_axis(bodies: Vec<String>, label: impl Into<String>, motion: Motion, by: Vector3) -> Move {
    Move { arrows: Arrows::OnAxis, ..moving(bodies, label, motion, by) }
}

/// The same without an arrow, along with other bodies of the step.
pub(super) fn along_with(bodies: Vec<String>, label: impl Into<String>, motion: Motion, by: Vector3) -> Move {
    Move { arrows: Arrows::None, ..moving(bodies, label, motion, by) }
}

/// Bodies in their place, without an arrow.
pub(super) fn placed(bodies: Vec<String>, label: impl Into<String>) -> Move {
    moving(bodies, label, Motion::Still, Vector3::zeros())
}

/// A picture of moves.
pub(super) fn scene(bench: Bench, upright: Upright, view: View, moves: Vec<Move>) -> Illustration {
    let moves = moves.into_iter().filter(|m| !m.bodies.is_empty()).collect();
    Illustration { bench, present: Vec::new(), moves, notes: Vec::new(), arrows: Vec::new(), upright, view }
}

/// Distances of the parts of the switch from their places in the picture with all names, mm.
const NAMED_SIDE_MM: f64 = 16.0;
const NAMED_BED_MM: f64 = 12.0;
const NAMED_PINS_MM: f64 = 24.0;
const NAMED_TENDON_MM: f64 = 36.0;
const NAMED_SCREWS_MM: f64 = 40.0;
const NAMED_NUTS_MM: f64 = 26.0;
const NAMED_AXLE_MM: f64 = 75.0;
const NAMED_MOUNT_MM: f64 = 30.0;

/// The exploded switch with the names of its parts.
pub(crate) fn named_parts(bodies: &Bodies) -> Illustration {
    let names = |stems: &[&str]| -> Vec<String> {
        stems.iter().flat_map(|stem| bodies.names(Bench::Switch, stem)).collect()
    };
    let is_right = |name: &String| bodies.find(Bench::Switch, name).is_some_and(|item| item.from_right);
    let (right_screws, left_screws): (Vec<_>, Vec<_>) = names(&["screw"]).into_iter().partition(is_right);
    let (right_inserts, left_inserts): (Vec<_>, Vec<_>) = names(&["insert"]).into_iter().partition(is_right);
    let at = |bodies, label: &str, by| moving(bodies, label, Motion::Still, by);
    let moves = vec![
        placed(names(&["shell"]), "shell"),
        at(names(&["silicone-layer"]), "silicone layer", outward(NAMED_BED_MM)),
        at(names(&["proxy"]), "proxy", outward(NAMED_BED_MM)),
        at(names(&["pin"]), "pins", outward(NAMED_PINS_MM)),
        at(names(&["tendon"]), "tendon", outward(NAMED_TENDON_MM)),
        at(names(&["support-left"]), "left support L", along(-NAMED_SIDE_MM)),
        at(names(&["support-right"]), "right support R", along(NAMED_SIDE_MM)),
        at(names(&["dowel"]), "dowels", along(NAMED_SIDE_MM / 2.0)),
        at(left_inserts, "inserts", along(-NAMED_SIDE_MM / 2.0)),
        at(right_inserts, "", along(NAMED_SIDE_MM / 2.0)),
        at(left_screws, "screws", along(-NAMED_SCREWS_MM)),
        at(right_screws, "", along(NAMED_SCREWS_MM)),
        at(names(&["nut"]), "nuts", along(NAMED_NUTS_MM)),
        at(names(&["base-flange", "link-proximal", "rig-plate"]), "mounting plate", along(-NAMED_MOUNT_MM)),
        at(names(&["bolt"]), "bolt", along(-NAMED_MOUNT_MM)),
        at(names(&["axle"]), "axle", along(-NAMED_AXLE_MM)),
        at(names(&["axle-washer", "axle-nut"]), "washers and nut of the axle", along(NAMED_AXLE_MM)),
        at(names(&["link-distal"]), "distal link", along(NAMED_SCREWS_MM)),
        at(names(&["sheath-stop"]), "sheath stop", along(-NAMED_SIDE_MM)),
        at(names(&[SPACER]), "spacer", along(-NAMED_SIDE_MM)),
        at(names(&[GUIDE_PULLEY]), "guide pulley", along(NAMED_SIDE_MM)),
    ];
    scene(Bench::Switch, Upright::Axis, ON_BENCH, moves)
}

/// A picture of bodies in their place.
pub(super) fn still(bench: Bench, bodies: Vec<String>, label: &str) -> Illustration {
    scene(bench, Upright::Axis, ON_TABLE, vec![placed(bodies, label)])
}
