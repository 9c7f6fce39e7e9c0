//! The friction curve as a table.

use std::fmt::Write;

use pinswitch_friction::FrictionCurve;

/// Writes one row for each load, with forces in newtons and four decimals.
pub fn friction_csv(curve: &FrictionCurve) -> String {
    let mut text =
        "load_N,eccentric_N,concentric_N,friction_N,band_low_N,band_high_N,silicone_share\n".to_owned();
    for i in 0..curve.load_n.len() {
        let row = [
            curve.load_n[i],
            curve.eccentric_n[i],
            curve.concentric_n[i],
            curve.friction_n[i],
            curve.band_low_n[i],
            curve.band_high_n[i],
            curve.silicone_share[i],
        ];
        for (column, value) in row.iter().enumerate() {
            let separator = if column == 0 { "" } else { "," };
            // Writing to a string does not fail.
            let _ = write!(text, "{separator}{value:.4}");
        }
        text.push('\n');
    }
    text
}
