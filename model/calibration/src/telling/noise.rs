//! The parts of the noise, and whether held-out error reaches it.

use crate::inference::{Observations, Selection};
use crate::report::NoisePart;

/// Whether an error on held-out series is no larger than the noise and its scatter over the series allow.
pub(super) fn is_adequate(held_out_n: f64, floor_n: f64, data: &Observations) -> bool {
    let series = data.series.max(1) as f64;
    held_out_n <= floor_n * (1.0 + 3.0 / (2.0 * series).sqrt()) || held_out_n.is_nan()
}

/// Load in newtons at which parts of the noise are told.
const TOLD_AT_N: f64 = 20.0;

/// An interval that reaches further than this factor to both sides says nothing.
const UNKNOWN_FACTOR: f64 = 10.0;

/// The parts of the noise that are there, the smallest groups first.
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
    // Of one repetition in each direction nobody can tell what another one would have read.
    let repeated: usize = data.cells.iter().map(|cell| cell.len().saturating_sub(1)).sum();
    let repetitions = data.counts.iter().sum::<f64>() - data.cells.len() as f64;
    let mut parts = vec![
        part(
            "repetition",
            if repeated > 0 {
                "one reading, from repetition to repetition"
            } else {
                "one reading: unknown, since no series has a second repetition; it counts as an offset of the series"
            },
            if repeated > 0 { noise.repetition.at(TOLD_AT_N) } else { 0.0 },
            "N",
            (repeated > 0).then(|| libm::exp(1.96 / (2.0 * repetitions.max(1.0)).sqrt())),
        ),
        part(
            "series_and_direction",
            "an offset that the rows of one series and direction share",
            noise.white() * noise.series.at(TOLD_AT_N),
            "N",
            bounds.cell,
        ),
        part(
            "series",
            "an offset that both directions of a series share",
            noise.white() * noise.series_common.at(TOLD_AT_N),
            "N",
            bounds.common,
        ),
        part(
            "series_scale",
            "friction from series to series: the tendon is seated anew",
            noise.series_scale,
            "1",
            bounds.scale,
        ),
        part("mount", "friction, or wrap, from mount to mount", noise.mount_scale, "1", bounds.mount),
        part("walk", "an offset that wanders from series to series", noise.wandering_n(TOLD_AT_N), "N", None),
        part(
            "group",
            match (data.operators.len() > 1, data.sessions.len() > 1) {
                (true, false) => {
                    "an offset from operator to operator: they read, or zero the cell, differently"
                }
                (false, _) => "an offset from session to session",
                (true, true) => "an offset from session to session and operator to operator",
            },
            noise.group_offset_n,
            "N",
            None,
        ),
        part("specimen", "friction from specimen to specimen", noise.specimen_scale, "1", None),
    ];
    // A scatter of friction under a twentieth of a per cent changes nothing that is told.
    parts.retain(|p| p.part == "repetition" || p.size > if p.unit == "1" { 5e-4 } else { 0.0 });
    parts
}
