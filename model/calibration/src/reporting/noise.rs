//! Components of the noise.

use crate::evidence::{CONSEQUENCE, Channel, Evidence, Fitted, change_of_consequence};
use crate::model::Noise;
use crate::report::NoisePart;
use crate::table::PlateauRow;

/// Load in newtons at which components of the noise are reported.
const REPORTED_AT_N: f64 = 20.0;
/// Share of friction below which a component changes no reported digit.
const LEAST_SHARE: f64 = 5e-4;

/// Returns the components of the noise, from the smallest groups to the largest, at 20 N or at the highest
/// load of the table, if that is lower.
pub(super) fn noise_parts(noise: Noise, evidence: &Evidence, rows: &[PlateauRow]) -> Vec<NoisePart> {
    let highest_n = rows.iter().map(|row| row.load_n).fold(0.0, f64::max);
    let at_n = REPORTED_AT_N.min(highest_n);
    let part = |part: &str, what: &str, size: f64, unit: &str| NoisePart {
        part: part.to_owned(),
        what: what.to_owned(),
        size,
        unit: unit.to_owned(),
    };
    let mut parts = vec![
        part("repetition", "one reading: variation between repetitions", noise.repetition.at(at_n), "N"),
        part(
            "series_and_direction",
            "an offset common to the rows of one series and direction",
            noise.series.at(at_n),
            "N",
        ),
        part("series", "an offset common to both directions of a series", noise.series_common.at(at_n), "N"),
        part(
            "series_scale",
            "variation of friction between series (tendon seating)",
            noise.series_scale,
            "1",
        ),
        part("mount", "variation of friction or wrap between mounts", noise.mount_scale, "1"),
        part("specimen", "variation of friction between specimens", noise.specimen_scale, "1"),
    ];
    for (channel, size) in evidence.wandering() {
        let (name, what, unit) = match channel {
            Channel::Drag => ("wandering_drag", "a drag that wanders from series to series", "N"),
            Channel::Gain => {
                ("wandering_gain", "a gain of the load cell that wanders from series to series", "1")
            }
            _ => ("wandering_reading", "an offset that wanders from series to series", "N"),
        };
        parts.push(part(name, what, size, unit));
    }
    parts.retain(|p| p.part == "repetition" || p.size > if p.unit == "1" { LEAST_SHARE } else { 0.0 });
    parts
}

/// Returns the root mean square of the standard deviations of the table's readings, in newtons.
pub(super) fn floor_n(fitted: &Fitted, rows: &[PlateauRow]) -> f64 {
    let points = fitted.model.frame.points(rows).unwrap_or_default();
    let friction = fitted.model.friction_n(&points);
    let sum: f64 =
        points.iter().zip(&friction).map(|(p, friction)| fitted.noise.at(p.load_n, *friction).powi(2)).sum();
    (sum / points.len().max(1) as f64).sqrt()
}

/// Returns the root mean square of what differs between series, mounts and specimens, as a share of that of the friction.
pub(super) fn series_scatter(evidence: &Evidence, fitted: &Fitted, rows: &[PlateauRow]) -> f64 {
    let points = fitted.model.frame.points(rows).unwrap_or_default();
    let (friction, readings) = (fitted.model.friction_n(&points), fitted.model.predict(&points));
    let (noise, wandering) = (&fitted.noise, evidence.wandering());
    let (mut scatter, mut consequence) = (0.0, 0.0);
    for ((point, friction), reading) in points.iter().zip(&friction).zip(&readings) {
        let of_friction = [noise.series_scale, noise.mount_scale, noise.specimen_scale];
        let of_reading = [noise.series.at(point.load_n), noise.series_common.at(point.load_n)];
        scatter += of_friction.iter().map(|share| (share * friction).powi(2)).sum::<f64>();
        scatter += of_reading.iter().map(|sd| sd.powi(2)).sum::<f64>();
        for (channel, sd) in &wandering {
            scatter += (sd * if *channel == Channel::Gain { *reading } else { 1.0 }).powi(2);
        }
        consequence += change_of_consequence(point, *friction).powi(2);
    }
    CONSEQUENCE * (scatter / f64::max(consequence, 1e-300)).sqrt()
}
