//! The readings of a calibration, with the residuals of both models.

use pinswitch_calibration::Calibration;
use pinswitch_calibration::table::Point;

/// Readings, series after series; all lists have the same order.
pub(super) struct Readings<'a> {
    /// Covariates.
    pub(super) points: Vec<&'a Point>,
    /// Number of the series.
    pub(super) series: Vec<usize>,
    /// Row of the table.
    pub(super) rows: Vec<usize>,
    /// Reading in newtons.
    pub(super) reading_n: Vec<f64>,
    /// Reading minus baseline in newtons.
    pub(super) baseline_n: Vec<f64>,
    /// Reading minus augmented model in newtons.
    pub(super) augmented_n: Vec<f64>,
    /// Weight in the fit.
    pub(super) weights: Vec<f64>,
}

impl<'a> Readings<'a> {
    /// Returns the readings of a calibration.
    pub(super) fn new(calibration: &'a Calibration) -> Self {
        let evidence = &calibration.evidence;
        let (mut points, mut series, mut rows) = (Vec::new(), Vec::new(), Vec::new());
        for (row, number, point) in evidence.rows() {
            points.push(point);
            series.push(number);
            rows.push(row);
        }
        let readings = evidence.readings_n();
        let residual = |predicted_n: &[f64]| -> Vec<f64> {
            rows.iter().map(|row| readings[*row] - predicted_n[*row]).collect()
        };
        let ordered = |values: &[f64]| -> Vec<f64> { rows.iter().map(|row| values[*row]).collect() };
        Self {
            reading_n: ordered(&readings),
            baseline_n: residual(&calibration.baseline.predicted_n),
            augmented_n: residual(&calibration.augmented.predicted_n),
            weights: ordered(&evidence.weights()),
            points,
            series,
            rows,
        }
    }

    /// Returns the number of readings.
    pub(super) fn len(&self) -> usize {
        self.points.len()
    }
}
