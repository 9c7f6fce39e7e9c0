//! The section of use: loads, and how to read the curve.

use super::document::{Block, Table};
use crate::design::Design;
use crate::documents::Manifest;
use crate::prediction::Prediction;

/// Number of rows of the table of forces.
const ROWS: usize = 6;

pub(super) fn usage(design: &Design, prediction: &Prediction, manifest: &Manifest) -> Vec<Block> {
    let c = design.configuration();
    let curve = &prediction.curve;
    let switching = manifest.friction.threshold_n.map_or_else(String::new, |n| {
        format!(" Below {n:.1} N most of the friction comes from the pins, above from the silicone.")
    });
    let range = format!(
        "Fasten the switch to a rigid base. Hang the load on the end of the tendon on the side of groove 1, and pull at the other end. The curve applies \
         from {:.1} to {:.1} N of load.{switching}",
        c.friction.load_min_n, c.friction.load_max_n
    );
    let reading = "To lift the load slowly, the pull is the load plus about the friction; to lower it slowly, the load minus about \
                   the friction. Between these two forces the tendon does not move. The table has all three forces, and the \
                   curve the friction.";
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
