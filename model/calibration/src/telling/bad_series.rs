//! Series and readings that are wrong as a whole.

use crate::inference::{Selection, Weighed, cell_deviation};
use crate::report::BadSeries;
use crate::table::PlateauRow;

/// Mean residual of a series and direction, in standard deviations, beyond which it is listed as bad.
const BAD_SERIES_SD: f64 = 4.5;
/// Readings further off than this many standard deviations of noise are bad ones.
pub(crate) const BAD_READING_SD: f64 = 20.0;

/// Series whose mean residual, or one reading, is further off than noise can make it.
pub(super) fn bad_series(
    rows: &[PlateauRow],
    selection: &Selection,
    weighed: &Weighed<'_>,
) -> Vec<BadSeries> {
    let data = weighed.data;
    let mut bad = Vec::new();
    for (index, (cell, load)) in data.cells.iter().zip(&data.cell_load_n).enumerate() {
        let (mean, sd) = cell_deviation(&selection.augmented, weighed, index);
        let worst = cell
            .iter()
            .map(|r| selection.augmented.residual_n[*r])
            .fold(0.0f64, |a, b| if b.abs() > a.abs() { b } else { a });
        let friction_n = cell.first().map_or(0.0, |r| data.friction_n[*r]);
        let reading_sd = selection.noise.at(*load, friction_n);
        let (offset_n, sd) = if mean.abs() > BAD_SERIES_SD * sd {
            (mean, sd)
        } else if worst.abs() > BAD_READING_SD * reading_sd {
            (worst, reading_sd)
        } else {
            continue;
        };
        if let Some(row) = cell.first().and_then(|r| rows.get(data.source[*r])) {
            bad.push(BadSeries {
                series: row.series.clone(),
                direction: row.direction.as_str().to_owned(),
                offset_n,
                standard_deviations: offset_n / sd,
            });
        }
    }
    bad
}
