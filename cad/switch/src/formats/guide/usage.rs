//! The section of use: loads, and how to read the curve.

use super::document::{Block, Table};
use crate::config::MountKind;
use crate::design::Design;
use crate::documents::Manifest;
use crate::prediction::Prediction;
use pinswitch_friction::published;

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

pub(super) fn usage(design: &Design, prediction: &Prediction, manifest: &Manifest) -> Vec<Block> {
    let c = design.configuration();
    let curve = &prediction.curve;
    let switching = manifest.friction.threshold_n.map_or_else(String::new, |n| {
        format!(" Below {n:.1} N most of the friction comes from the pins, above from the silicone.")
    });
    let range = format!(
        "{} The curve applies from {:.1} to {:.1} N of load (10 N are the weight of 1.02 kg).{switching}",
        arrangement(design),
        c.friction.load_min_n,
        c.friction.load_max_n
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
    vec![
        Block::Paragraph(range),
        Block::Paragraph(reading.to_owned()),
        Block::Paragraph(safety),
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
