//! Sensitivities of predictions to the constants, and the standard deviation of a reading.

use nalgebra::DMatrix;
use pinswitch_friction::LayoutLaw;

use super::{Model, Noise};
use crate::table::Point;

/// Step of a coordinate for its finite difference, relative to the coordinate, and its least size.
const STEP: (f64, f64) = (1e-5, 0.1);

/// Returns the derivatives of the predictions in newtons with respect to the coordinates of the
/// constants: one column per constant.
pub(crate) fn jacobian(model: &Model, points: &[Point]) -> Vec<Vec<f64>> {
    let at = model.predict(points);
    let mut moved = model.clone();
    let column = |j: usize| -> Vec<f64> {
        let step = STEP.0 * model.coordinates[j].abs().max(STEP.1);
        moved.coordinates[j] = model.coordinates[j] + step;
        let after = moved.predict(points);
        moved.coordinates[j] = model.coordinates[j];
        after.iter().zip(&at).map(|(a, b)| (a - b) / step).collect()
    };
    (0..model.coordinates.len()).map(column).collect()
}

/// Returns the standard deviation in newtons of readings at points, by the covariance of the constants
/// and the noise. A covariance of fewer constants than the model has is that of a model without the
/// layout of the points.
pub(crate) fn prediction_sd_n(
    model: &Model,
    points: &[Point],
    covariance: &DMatrix<f64>,
    noise: Noise,
) -> Vec<f64> {
    let (at, friction) = (model.predict(points), model.friction_n(points));
    let columns = jacobian(model, points);
    let discrepant = discrepancies_n(model, points, &at);
    let is_measured = covariance.nrows() == columns.len();
    (0..points.len())
        .map(|row| {
            let mut variance = noise.at(points[row].load_n, friction[row]).powi(2);
            variance += discrepant.iter().map(|change| change[row] * change[row]).sum::<f64>();
            if is_measured {
                let slope = nalgebra::DVector::from_fn(columns.len(), |j, _| columns[j][row]);
                variance += slope.dot(&(covariance * &slope));
            } else {
                // The uncertainty of the layout law, relative to the friction force.
                variance += (LayoutLaw::UNCERTAINTY * (at[row] - points[row].load_n)).powi(2);
            }
            variance.max(0.0).sqrt()
        })
        .collect()
}

/// Returns the change of the predictions in newtons by one standard deviation of each discrepancy. Beyond
/// the fitted loads its factor grows, and with it the change.
fn discrepancies_n(model: &Model, points: &[Point], at: &[f64]) -> Vec<Vec<f64>> {
    let change = |index: usize| -> Vec<f64> {
        let mut moved = model.clone();
        moved.discrepancies[index].value += moved.discrepancies[index].sd;
        moved.predict(points).iter().zip(at).map(|(after, before)| after - before).collect()
    };
    (0..model.discrepancies.len()).map(change).collect()
}
