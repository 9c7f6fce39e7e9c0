//! One series that is wrong as a whole: a mislabelled weight or condition, a bad run.
//!
//! Its rows agree with each other, so that weighing single rows down does not help, and it must not decide which effect
//! is named. It is told from an effect by standing alone: an effect moves several series.

use super::fit::Fit;
use super::noise::Noise;
use super::observations::Observations;

/// Standard deviations beyond which a series may be wrong as a whole.
const FAR: f64 = 8.0;
/// ... if no other one is off by more than this share of it.
const ALONE: f64 = 0.4;
/// With fewer series none can be said to stand alone.
const LEAST_SERIES: usize = 8;

/// Mean residual of a cell over its standard deviation. What was set aside counts with its rows as if sound.
pub(crate) fn cell_deviation(fitted: &Fit, data: &Observations, noise: Noise, cell: usize) -> (f64, f64) {
    let rows = &data.cells[cell];
    let weights: Vec<f64> = rows.iter().map(|r| data.weights[*r]).collect();
    let total: f64 = weights.iter().sum();
    let mean = rows.iter().zip(&weights).map(|(r, w)| w * fitted.residual_n[*r]).sum::<f64>() / total;
    let aside = rows.first().is_some_and(|r| data.is_aside(*r));
    let count = if aside { rows.len() as f64 } else { total };
    let load = data.cell_load_n[cell];
    (mean, (noise.repetition.at(load) / count.sqrt()).hypot(noise.series.at(load)))
}

/// The series that stands alone by more than noise and effects allow, if there is one.
pub(super) fn isolated_series(fitted: &Fit, data: &Observations, noise: Noise) -> Option<usize> {
    if data.series < LEAST_SERIES {
        return None;
    }
    let mut worst = vec![0.0f64; data.series];
    for (cell, rows) in data.cells.iter().enumerate() {
        let Some(row) = rows.first().filter(|r| !data.is_aside(**r)) else { continue };
        let (mean, sd) = cell_deviation(fitted, data, noise, cell);
        let at = &mut worst[data.series_of[*row]];
        *at = at.max((mean / sd).abs());
    }
    let (series, most) = worst.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let next = worst.iter().enumerate().filter(|(i, _)| *i != series).map(|(_, v)| *v).fold(0.0, f64::max);
    (most > FAR && next < ALONE * most).then_some(series)
}
