//! What a calibration shows of a person's readings: friction at each load, and residuals before and after.

use std::collections::BTreeMap;

use pinswitch_calibration::Calibration;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_friction::{Direction, Substrate};
use serde::Serialize;

/// Most residuals that are returned: more than a plot of the page can show apart.
const MOST_RESIDUALS: usize = 400;

/// Measured friction of one condition at one load.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct MeasuredPoint {
    /// Substrate in the words of a configuration; absent for a plain contact.
    substrate: Option<&'static str>,
    /// Occupied grooves, ascending.
    pins: Vec<usize>,
    /// Wrap angle, degrees.
    wrap_angle_deg: f64,
    /// Load, N.
    load_n: f64,
    /// Half the difference of the mean readings of both directions, N.
    friction_n: f64,
    /// Number of readings.
    readings: usize,
}

/// Residuals of one reading, N: reading minus model.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Residual {
    /// Load, N.
    load_n: f64,
    /// By the published model, refitted.
    before_n: f64,
    /// By the calibrated model.
    after_n: f64,
}

/// Returns the measured friction of every condition at every load at which both directions were read.
pub(crate) fn points(table: &PlateauTable) -> Vec<MeasuredPoint> {
    // Bits of positive numbers are in the order of the numbers.
    type Key = (Option<Substrate>, Vec<usize>, u64, u64);
    let mut groups: BTreeMap<Key, [(f64, usize); 2]> = BTreeMap::new();
    for row in &table.rows {
        let key = (row.substrate, row.pins.clone(), row.wrap_angle_deg.to_bits(), row.load_n.to_bits());
        let of_direction = usize::from(row.direction == Direction::Concentric);
        let (sum, count) = &mut groups.entry(key).or_default()[of_direction];
        *sum += row.force_n;
        *count += 1;
    }
    let mean = |(sum, count): (f64, usize)| (count > 0).then(|| sum / count as f64);
    groups
        .into_iter()
        .filter_map(|((substrate, pins, wrap, load), [eccentric, concentric])| {
            Some(MeasuredPoint {
                substrate: substrate.map(|s| s.as_str()),
                pins,
                wrap_angle_deg: f64::from_bits(wrap),
                load_n: f64::from_bits(load),
                friction_n: (mean(concentric)? - mean(eccentric)?) / 2.0,
                readings: eccentric.1 + concentric.1,
            })
        })
        .collect()
}

/// Returns residuals before and after, evenly thinned in each direction: the directions of a table alternate.
pub(crate) fn residuals(table: &PlateauTable, calibration: &Calibration) -> Vec<Residual> {
    let readings = calibration.evidence.readings_n();
    let step = readings.len().div_ceil(MOST_RESIDUALS).max(1);
    let mut seen = [0usize; 2];
    readings
        .iter()
        .enumerate()
        .filter(|(row, _)| {
            let is_pull = table.rows.get(*row).is_some_and(|row| row.direction == Direction::Concentric);
            let earlier = &mut seen[usize::from(is_pull)];
            *earlier += 1;
            (*earlier - 1).is_multiple_of(step)
        })
        .filter_map(|(row, reading)| {
            Some(Residual {
                load_n: table.rows.get(row)?.load_n,
                before_n: reading - calibration.baseline.predicted_n.get(row)?,
                after_n: reading - calibration.augmented.predicted_n.get(row)?,
            })
        })
        .collect()
}
