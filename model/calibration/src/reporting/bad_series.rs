//! Series and readings with gross errors.

use crate::evidence::Evidence;
use crate::report::BadSeries;
use crate::table::PlateauRow;
use pinswitch_friction::Direction;

/// Returns whether a finding is about the series and session of a row, in a direction.
fn is_of(bad: &BadSeries, row: &PlateauRow, direction: &str) -> bool {
    bad.session == row.labels.session && bad.series == row.series && bad.direction == direction
}

/// Returns the series that are wrong as a whole, and for every other series its wrong readings.
pub(super) fn bad_series(evidence: &Evidence, rows: &[PlateauRow]) -> Vec<BadSeries> {
    let outliers = &evidence.posterior().outliers;
    let mut bad: Vec<BadSeries> = Vec::new();
    for wrong in &outliers.series {
        let direction = if wrong.direction { Direction::Concentric } else { Direction::Eccentric };
        let Some(row) = evidence.row_of_series(wrong.series).and_then(|row| rows.get(row)) else { continue };
        bad.push(BadSeries {
            session: row.labels.session.clone(),
            series: row.series.clone(),
            direction: direction.as_str().to_owned(),
            offset_n: wrong.offset,
            standard_deviations: wrong.offset / wrong.sd,
            probability: Some(wrong.probability),
            repetition: None,
            readings: None,
        });
    }
    for wrong in &outliers.readings {
        let Some(row) = evidence.source(wrong.row).and_then(|row| rows.get(row)) else { continue };
        let direction = row.direction.as_str();
        let known = bad.iter_mut().find(|b| is_of(b, row, direction));
        let is_worse = |b: &BadSeries| wrong.offset.abs() > b.offset_n.abs();
        match known {
            Some(known) if known.readings.is_none() => {}
            Some(known) => {
                known.readings = known.readings.map(|n| n + 1);
                if is_worse(known) {
                    known.offset_n = wrong.offset;
                    known.standard_deviations = wrong.offset / wrong.sd;
                    known.repetition = Some(row.repetition);
                }
            }
            None => bad.push(BadSeries {
                session: row.labels.session.clone(),
                series: row.series.clone(),
                direction: direction.to_owned(),
                offset_n: wrong.offset,
                standard_deviations: wrong.offset / wrong.sd,
                probability: None,
                repetition: Some(row.repetition),
                readings: Some(1),
            }),
        }
    }
    bad
}
