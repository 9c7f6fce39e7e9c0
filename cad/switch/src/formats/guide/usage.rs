//! The section of use: loads, and how to read the curve.

use super::document::{Block, Step, Table};
use super::scenes::{JOINT_VIEW, scene};
use crate::config::MountKind;
use crate::design::Design;
use crate::documents::Manifest;
use crate::prediction::Prediction;
use crate::scene::{Bench, Bodies, FROM_LEFT, Illustration, ToolArrow, Upright};
use pinswitch_friction::published;
use pinswitch_solid::mesh::Point3;
use pinswitch_solid::profile::{Point2, Vector2};

/// Number of rows of the table of forces.
const ROWS: usize = 6;

/// How the switch is clamped, and how load and pull act on the tendon.
fn arrangement(design: &Design) -> String {
    let c = design.configuration();
    if let Some(joint) = design.joint() {
        return format!(
            "Clamp `link-proximal`, and fix `link-distal` at a flexion of {} deg. Hang the load on the end of the tendon beyond `link-distal`, \
             on the side of groove 1, before a sleeve is crimped on it, and pull at the end of the motor.",
            joint.assembled_deg
        );
    }
    let hold = match c.mount.kind {
        MountKind::None => "Clamp the switch by the lower edges of its supports in a vice with soft jaws.",
        MountKind::Flange => "Fasten the flange to a rigid base.",
        MountKind::Joint | MountKind::Rig => "The rig holds the switch, and its pulleys lead the tendon.",
    };
    if c.mount.kind == MountKind::Rig {
        return hold.to_owned();
    }
    let above_deg = 90.0 - c.layout.wrap_angle_deg;
    let direction = if above_deg >= 0.0 {
        format!("upward, {above_deg:.1} deg above the horizontal")
    } else {
        format!("downward, {:.1} deg below the horizontal", -above_deg)
    };
    format!(
        "{hold} Make a loop at each end of the tendon with a clip or a sleeve. Hang the load on the end on the side of groove 1, so that it hangs \
         straight down, and pull at the other end, {direction}: the tendon then turns by {:.2} deg.",
        c.layout.wrap_angle_deg
    )
}

/// Length of the arrows of load and pull, mm.
const FORCE_MM: f64 = 12.0;

/// The switch as it is used: with the load hanging down, or on its joint; `None` on a rig, which leads the tendon.
fn forces(design: &Design, bodies: &Bodies) -> Option<Illustration> {
    let (low, high) = bodies.find(Bench::Switch, "tendon")?.mesh.bounds()?;
    let z = f64::midpoint(low.z, high.z);
    let arrow = |(tip, along): (Point2, Vector2), label: &str| {
        let at = |mm: f64| Point3::new(tip.x + mm * along.x, tip.y + mm * along.y, z);
        ToolArrow { ends: [at(1.0), at(1.0 + FORCE_MM)], label: label.to_owned() }
    };
    let [load, pull] = design.tendon_tips();
    let (upright, view) = match design.configuration().mount.kind {
        MountKind::Rig => return None,
        MountKind::Joint => (Upright::Grooves, JOINT_VIEW),
        // The direction of the load becomes that of gravity.
        MountKind::None | MountKind::Flange => (Upright::Turned(libm::atan2(load.1.x, -load.1.y)), FROM_LEFT),
    };
    let mut picture = scene(Bench::Switch, upright, view, Vec::new());
    picture.arrows = vec![arrow(load, "load"), arrow(pull, "pull")];
    Some(picture)
}

pub(super) fn usage(
    design: &Design,
    prediction: &Prediction,
    manifest: &Manifest,
    bodies: &Bodies,
) -> Vec<Block> {
    let c = design.configuration();
    let curve = &prediction.curve;
    let switching = manifest.friction.threshold_n.map_or_else(String::new, |n| {
        format!(" Below {n:.1} N most of the friction comes from the pins, above from the silicone.")
    });
    let range = format!(
        "The curve applies from {:.1} to {:.1} N of load (10 N are the weight of 1.02 kg).{switching}",
        c.friction.load_min_n, c.friction.load_max_n
    );
    let reading = "Lift the load slowly, read the pull, lower it slowly, and read it again. The friction is half of the difference of the \
                   two pulls. Between them the tendon does not move. The table has all three forces, and the curve the friction.";
    let safety = format!(
        "Keep hands and feet from under the load, up to {:.1} kg, and wear eye protection: a rope under tension can slip or break.",
        c.friction.load_max_n / published::GRAVITY_M_S2
    );
    let points: Vec<usize> =
        (0..ROWS).map(|i| i * curve.load_n.len().saturating_sub(1) / (ROWS - 1)).collect();
    let rows = points.into_iter().filter(|i| *i < curve.load_n.len()).map(|i| {
        [
            format!("{:.2} N", curve.load_n[i]),
            format!("{:.2} N", curve.concentric_n[i]),
            format!("{:.2} N", curve.eccentric_n[i]),
            format!("{:.2} N", curve.friction_n[i]),
            format!("{:.2} to {:.2} N", curve.band_low_n[i], curve.band_high_n[i]),
        ]
    });
    let mut hang = Step::new("Hang the load, and pull").text(arrangement(design)).text(safety).risk(
        "A clip or sleeve slips.",
        "The tendon moves in it under a small load; press it again before you add more.",
    );
    hang.picture = forces(design, bodies).map(|picture| (0, picture));
    vec![
        Block::Step(hang),
        Block::Paragraph(range),
        Block::Paragraph(reading.to_owned()),
        Table::block(
            ["load", "pull to lift it", "pull to lower it", "friction", "95 % band of friction"],
            rows,
        ),
        Block::List(vec![
            "Move the tendon ten times over its full stroke before you measure, to seat it.".to_owned(),
            "If the friction is outside the band at every load, repeat the checks of the section before."
                .to_owned(),
            "Replace the tendon when its coating is worn where it slides.".to_owned(),
            "`pinswitch calibrate` fits the curve to your own measurements.".to_owned(),
        ]),
    ]
}
