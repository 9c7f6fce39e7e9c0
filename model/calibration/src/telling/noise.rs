//! Components of the noise, and comparison of the held-out error with them.

use crate::inference::{Observations, Selection};
use crate::report::NoisePart;

/// Returns whether an error on held-out series is within the noise and its scatter over the series.
pub(super) fn is_adequate(held_out_n: f64, floor_n: f64, data: &Observations) -> bool {
    let series = data.series.max(1) as f64;
    held_out_n <= floor_n * (1.0 + 3.0 / (2.0 * series).sqrt()) || held_out_n.is_nan()
}

/// Load in newtons at which components of the noise are reported.
const REPORTED_AT_N: f64 = 20.0;

/// Factor of an interval, to both sides, above which the component counts as unknown.
const UNKNOWN_FACTOR: f64 = 10.0;

/// Returns the nonzero components of the noise, from the smallest groups to the largest.
pub(super) fn noise_parts(selection: &Selection, data: &Observations) -> Vec<NoisePart> {
    let noise = selection.noise;
    let bounds = selection.noise_factors;
    let part = |part: &str, what: &str, size: f64, unit: &str, factor: Option<f64>| NoisePart {
        part: part.to_owned(),
        what: what.to_owned(),
        size,
        ci95: factor.filter(|f| *f < UNKNOWN_FACTOR).map(|f| [size / f, size * f]),
        unit: unit.to_owned(),
    };
    // A single repetition in each direction does not determine the scatter between repetitions.
    let repeated: usize = data.cells.iter().map(|cell| cell.len().saturating_sub(1)).sum();
    let repetitions = data.counts.iter().sum::<f64>() - data.cells.len() as f64;
    let mut parts = vec![
        part(
            "repetition",
            if repeated > 0 {
                "one reading: variation between repetitions"
            } else {
                "one reading: unknown, since no series has a second repetition (included in the offset of the series)"
            },
            if repeated > 0 { noise.repetition.at(REPORTED_AT_N) } else { 0.0 },
            "N",
            (repeated > 0).then(|| libm::exp(1.96 / (2.0 * repetitions.max(1.0)).sqrt())),
        ),
        part(
            "series_and_direction",
            "an offset common to the rows of one series and direction",
            noise.white() * noise.series.at(REPORTED_AT_N),
            "N",
            bounds.cell,
        ),
        part(
            "series",
            "an offset common to both directions of a series",
            noise.white() * noise.series_common.at(REPORTED_AT_N),
            "N",
            bounds.common,
        ),
        part(
            "series_scale",
            "variation of friction between series (tendon seating)",
            noise.series_scale,
            "1",
            bounds.scale,
        ),
        part("mount", "variation of friction or wrap between mounts", noise.mount_scale, "1", bounds.mount),
        part(
            "walk",
            "an offset that drifts from series to series",
            noise.wandering_n(REPORTED_AT_N),
            "N",
            None,
        ),
        part(
            "group",
            match (data.operators.len() > 1, data.sessions.len() > 1) {
                (true, false) => {
                    "variation of the offset between operators (reading or zeroing of the load cell)"
                }
                (false, _) => "variation of the offset between sessions",
                (true, true) => "variation of the offset between sessions and operators",
            },
            noise.group_offset_n,
            "N",
            None,
        ),
        part("specimen", "variation of friction between specimens", noise.specimen_scale, "1", None),
    ];
    // A component below 0.05 % of friction changes no reported digit.
    parts.retain(|p| p.part == "repetition" || p.size > if p.unit == "1" { 5e-4 } else { 0.0 });
    parts
}
