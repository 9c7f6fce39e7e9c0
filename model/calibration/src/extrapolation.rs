//! Extrapolation test: fit at low loads, evaluation at higher ones.

use crate::calibrate::{Calibration, CalibrationError, calibrate};
use crate::effects::Vocabulary;
use crate::model::Model;
use crate::report::Extrapolation;
use crate::table::PlateauRow;
use pinswitch_measurements::median;

/// Error, in standard deviations of noise, above which a reading is a bad one: an error of the model
/// hardly reaches it.
const BAD_READING_SD: f64 = 20.0;

/// Calibrates on loads up to a share of the highest one and evaluates both models on the rest.
///
/// # Errors
/// [`CalibrationError::TooFewRows`] if too few rows are below that load.
pub fn calibrate_below(
    rows: &[PlateauRow],
    share: f64,
    vocabulary: &Vocabulary,
    seed: u64,
) -> Result<Calibration, CalibrationError> {
    let highest = rows.iter().map(|r| r.load_n).fold(0.0, f64::max);
    let (seen, rest): (Vec<_>, Vec<_>) = rows.iter().cloned().partition(|r| r.load_n <= share * highest);
    let mut calibration = calibrate(&seen, vocabulary, seed)?;
    let misses = |model: &Model| -> Vec<f64> {
        let points = model.frame.points(&rest).unwrap_or_default();
        model.predict(&points).iter().zip(&rest).map(|(p, r)| p - r.force_n).collect()
    };
    let before = misses(&calibration.baseline.model);
    let after = misses(&calibration.augmented.model);
    let model = &calibration.augmented.model;
    let friction_n = model.friction_n(&model.frame.points(&rest).unwrap_or_default());
    let sound: Vec<f64> = after
        .iter()
        .zip(&rest)
        .zip(&friction_n)
        .filter(|((miss, r), u)| miss.abs() <= BAD_READING_SD * calibration.augmented.noise.at(r.load_n, **u))
        .map(|((miss, _), _)| *miss)
        .collect();
    calibration.report.extrapolation = Some(Extrapolation {
        fitted_below_n: share * highest,
        rows: rest.len(),
        rmse_before_n: root_mean_square(&before),
        rmse_after_n: root_mean_square(&after),
        rmse_after_without_bad_n: root_mean_square(&sound),
        bad_rows: rest.len() - sound.len(),
        median_before_n: median(&mut sizes(&before)),
        median_after_n: median(&mut sizes(&after)),
    });
    Ok(calibration)
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

fn sizes(values: &[f64]) -> Vec<f64> {
    values.iter().map(|v| v.abs()).collect()
}
