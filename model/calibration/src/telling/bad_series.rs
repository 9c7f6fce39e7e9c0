//! Series and readings with gross errors.

use crate::inference::{Selection, Weighed, cell_deviation};
use crate::median::median;
use crate::report::BadSeries;
use crate::table::PlateauRow;

/// Mean residual of a series and direction, in standard deviations, above which it is listed.
const BAD_SERIES_SD: f64 = 4.5;
/// Residual of a reading, in standard deviations of noise, above which it is an error.
pub(crate) const BAD_READING_SD: f64 = 20.0;

/// Returns the series whose mean residual, or single readings, exceed the noise.
pub(super) fn bad_series(
    rows: &[PlateauRow],
    selection: &Selection,
    weighed: &Weighed<'_>,
) -> Vec<BadSeries> {
    let data = weighed.data;
    let residual_n = &selection.augmented.residual_n;
    let mut bad = Vec::new();
    for (index, (cell, load)) in data.cells.iter().zip(&data.cell_load_n).enumerate() {
        let Some(first) = cell.first() else { continue };
        let (mean, sd) = cell_deviation(&selection.augmented, weighed, index);
        let middle = median(&mut cell.iter().map(|r| residual_n[*r]).collect::<Vec<_>>());
        let reading_sd = selection.noise.at(*load, data.friction_n[*first]);
        let off: Vec<usize> =
            cell.iter().copied().filter(|r| residual_n[*r].abs() > BAD_READING_SD * reading_sd).collect();
        let worst = off.iter().copied().max_by(|a, b| residual_n[*a].abs().total_cmp(&residual_n[*b].abs()));
        let as_a_whole = mean.abs() > BAD_SERIES_SD * sd;
        // A few wrong readings move the mean of the others, but not the median.
        let alone = worst.filter(|_| middle.abs() < 0.5 * mean.abs() || !as_a_whole);
        let (at, offset_n, sd) = match alone {
            Some(row) => (row, residual_n[row], reading_sd),
            None if as_a_whole => (*first, mean, sd),
            None => continue,
        };
        if let Some(row) = rows.get(data.source[at]) {
            bad.push(BadSeries {
                series: row.series.clone(),
                direction: row.direction.as_str().to_owned(),
                offset_n,
                standard_deviations: offset_n / sd,
                // The repetition of a row that represents several is undefined.
                repetition: alone.filter(|r| data.counts[*r] <= 1.0).map(|_| row.repetition),
                readings: alone.map(|_| off.len()),
            });
        }
    }
    bad
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::{Levels, Model, Observations, select};
    use crate::table::Frame;
    use crate::test_session::session;

    fn listed(rows: &[PlateauRow]) -> Vec<BadSeries> {
        let frame = Frame::new(rows);
        let mut data = Observations::new(&frame, rows).unwrap();
        let selection = select(&Model::baseline(frame), &mut data, Levels::default());
        let noise = selection.noise;
        bad_series(rows, &selection, &Weighed::new(&data, noise))
    }

    #[test]
    fn wrong_readings_differ_from_wrong_series() {
        assert!(listed(&session(8)).is_empty());
        for offset_n in [3.0, 30.0, 300.0] {
            let mut rows = session(8);
            rows[200].force_n += offset_n;
            let (series, repetition) = (rows[200].series.clone(), rows[200].repetition);
            let [bad] = listed(&rows).try_into().unwrap();
            assert_eq!((&bad.series, bad.repetition, bad.readings), (&series, Some(repetition), Some(1)));
            assert!((bad.offset_n - offset_n).abs() < 0.5, "{bad:?}");
            assert!(bad.place().starts_with(&format!("repetition {repetition} of series {series}")));
        }
        let mut rows = session(8);
        let series = rows[200].series.clone();
        rows.iter_mut().filter(|r| r.series == series).for_each(|r| r.force_n -= 3.0);
        let bad = listed(&rows);
        assert_eq!(bad.len(), 2, "both directions: {bad:?}");
        assert!(bad.iter().all(|b| b.series == series && b.repetition.is_none() && b.readings.is_none()));
    }

    #[test]
    fn wrong_readings_are_counted() {
        let mut rows = session(8);
        let series = rows[200].series.clone();
        for (i, row) in rows.iter_mut().filter(|r| r.series == series && r.repetition <= 2).enumerate() {
            row.force_n += if i % 2 == 0 { 20.0 } else { 25.0 };
        }
        let bad = listed(&rows);
        assert_eq!(bad.len(), 2, "{bad:?}");
        assert!(bad.iter().all(|b| b.repetition == Some(2) && b.readings == Some(2)), "{bad:?}");
        assert!(bad[0].place().starts_with("2 readings of series"), "{}", bad[0].place());
        assert_ne!(bad[0].direction, bad[1].direction);
    }
}
