//! Growth of the prediction error beyond the fitted loads, estimated within the table.

use crate::inference::{Model, Weighed, fit};

/// Share of the highest load up to which the model is refitted for the estimate.
const INNER: f64 = 0.6;
/// Residuals of cells above this multiple of the median are ignored.
const FURTHEST: f64 = 6.0;

/// Returns the growth of the error with the distance from the fitted loads, in newtons per newton.
/// The model is refitted to loads up to 60 % of the highest one and evaluated above. Zero if there
/// are too few loads.
pub(crate) fn error_beyond_range(model: &Model, weighed: &Weighed<'_>) -> f64 {
    let data = weighed.data;
    let highest = data.points.iter().map(|p| p.load_n).fold(0.0, f64::max);
    let cut = INNER * highest;
    let seen = data.subset(|i| data.points[i].load_n <= cut);
    let mut loads: Vec<f64> = seen.points.iter().map(|p| p.load_n).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    if loads.len() < 3 || seen.points.len() < model.values().len() + 8 {
        return 0.0;
    }
    let from = loads.last().copied().unwrap_or(cut);
    let lower = fit(model, &Weighed::new(&seen, weighed.noise)).model;
    let predicted = lower.predict(&data.points);
    let mut rates: Vec<f64> = data
        .cells
        .iter()
        .zip(&data.cell_load_n)
        .filter(|(cell, load)| **load > cut && cell.first().is_some_and(|r| !data.is_excluded(*r)))
        .map(|(cell, load)| {
            let total: f64 = cell.iter().map(|r| data.weights[*r]).sum();
            let miss: f64 = cell.iter().map(|r| data.weights[*r] * (data.force_n[*r] - predicted[*r])).sum();
            (miss / total / (load - from)).abs()
        })
        .collect();
    if rates.is_empty() {
        return 0.0;
    }
    rates.sort_by(f64::total_cmp);
    let most = FURTHEST * rates[rates.len() / 2];
    let (sum, count) =
        rates.iter().filter(|r| **r <= most).fold((0.0, 0.0), |(s, n), r| (s + r * r, n + 1.0));
    f64::sqrt(sum / f64::max(count, 1.0))
}
