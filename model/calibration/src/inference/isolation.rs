//! Detection of a single series with a gross error, such as a mislabelled weight or condition, or a
//! bad run.
//!
//! Its rows agree with each other, so that down-weighting single rows does not help, and it must
//! not determine which effect is attributed. An effect differs from it by changing several series.

use super::fit::Fit;
use super::noise::{Noise, Spread};
use super::observations::Observations;
use super::screening::Screen;
use super::weighed::Weighed;

/// Smallest reduction of the deviance by offsets of one series in both directions.
const MIN_GAIN: f64 = 60.0;
/// Ratio by which it must exceed that of any effect or structure.
const AHEAD: f64 = 1.3;
/// Fewest series for the detection.
const MIN_SERIES: usize = 8;

/// Returns the mean residual of a cell over its standard deviation. Excluded rows count as if they
/// were sound.
pub(crate) fn cell_deviation(fitted: &Fit, weighed: &Weighed<'_>, cell: usize) -> (f64, f64) {
    let (data, noise) = (weighed.data, weighed.noise);
    let rows = &data.cells[cell];
    let weights: Vec<f64> = rows.iter().map(|r| data.weights[*r]).collect();
    let total: f64 = weights.iter().sum();
    let mean = rows.iter().zip(&weights).map(|(r, w)| w * fitted.residual_n[*r]).sum::<f64>() / total;
    let excluded = rows.first().is_some_and(|r| data.is_excluded(*r));
    let count = if excluded { rows.len() as f64 } else { total };
    let load = data.cell_load_n[cell];
    let friction_n = rows.first().map_or(0.0, |r| data.friction_n[*r]);
    let shared = Noise { repetition: Spread::default(), ..noise }.at(load, friction_n);
    (mean, libm::hypot(noise.repetition.at(load) / count.sqrt(), shared))
}

/// Returns the series whose own offsets explain the residuals better than any effect or structure,
/// if there is one. `best_gain` is that of the best effect or structure.
pub(super) fn isolated_series(screen: &Screen<'_>, data: &Observations, best_gain: f64) -> Option<usize> {
    if data.series < MIN_SERIES {
        return None;
    }
    let (series, gain) = screen.series_offsets().into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (gain > MIN_GAIN && gain > AHEAD * best_gain).then_some(series)
}
