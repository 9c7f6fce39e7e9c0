//! Robust least squares of the paper's model with drag, offset and gain: the reference that any
//! calibration has to reach.

use nalgebra::{DMatrix, DVector};

use crate::effects::effect_named;
use crate::model::{Model, Term, jacobian};
use crate::table::Point;

/// Iterations of reweighted Gauss-Newton steps.
const STEPS: usize = 25;
/// Residual, in robust standard deviations, above which a reading has reduced weight (Huber 1964).
const HUBER: f64 = 1.345;
/// Step of a coordinate below which a fit has converged.
const CONVERGED: f64 = 1e-5;
/// Largest step of a coordinate.
const MOST_STEP: f64 = 0.5;

/// Returns a model with drag, offset and gain, all zero.
pub(crate) fn with_rig_terms(baseline: &Model) -> Model {
    let named = |id| effect_named(id).map(Term::named);
    let terms = ["guide_drag", "load_cell_offset", "load_cell_gain"].into_iter().filter_map(named);
    terms.fold(baseline.clone(), |model, term| model.with_term(term, &[0.0]))
}

/// Returns a model, fitted from its constants to readings in newtons at points. Each reading has equal
/// weight up to 1.345 robust standard deviations.
pub(crate) fn least_squares(start: &Model, points: &[Point], readings_n: &[f64]) -> Model {
    let mut model = start.clone();
    for _ in 0..STEPS {
        let predicted = model.predict(points);
        let residual: Vec<f64> = readings_n.iter().zip(&predicted).map(|(y, p)| y - p).collect();
        let weights = huber_weights(&residual);
        let columns = jacobian(&model, points);
        let matrix = DMatrix::from_fn(points.len(), columns.len(), |i, j| columns[j][i] * weights[i].sqrt());
        let target = DVector::from_fn(points.len(), |i, _| residual[i] * weights[i].sqrt());
        let mut gram = matrix.tr_mul(&matrix);
        let mut moment = matrix.tr_mul(&target);
        // The weak priors decide where the readings do not.
        let variance = target.norm_squared() / points.len().max(1) as f64;
        for (i, prior) in model.priors().iter().enumerate() {
            let precision = variance.max(1e-12) / (prior.sd * prior.sd);
            gram[(i, i)] += precision;
            moment[i] += precision * (prior.mean - model.coordinates[i]);
        }
        let Some(step) = gram.cholesky().map(|factor| factor.solve(&moment)) else { break };
        let largest = step.amax();
        for (coordinate, step) in model.coordinates.iter_mut().zip(step.iter()) {
            *coordinate += step.clamp(-MOST_STEP, MOST_STEP);
        }
        if largest < CONVERGED {
            break;
        }
    }
    model
}

fn huber_weights(residual: &[f64]) -> Vec<f64> {
    let mut sizes: Vec<f64> = residual.iter().map(|r| r.abs()).collect();
    let scale = (1.4826 * pinswitch_measurements::median(&mut sizes)).max(1e-9);
    residual.iter().map(|r| (HUBER * scale / r.abs().max(1e-12)).min(1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Frame;
    use crate::test_session::session_with;

    /// Drag, offset and gain are recovered, although one reading in twenty is wrong.
    #[test]
    fn gross_errors_do_not_move_the_constants() {
        let named = |id| Term::named(effect_named(id).unwrap());
        let terms: [(Term, &[f64]); 3] = [
            (named("guide_drag"), &[0.5]),
            (named("load_cell_offset"), &[-0.3]),
            (named("load_cell_gain"), &[0.04]),
        ];
        let mut rows = session_with(3, &terms);
        rows.iter_mut().step_by(20).for_each(|row| row.force_n += 15.0);
        let baseline = Model::baseline(Frame::new(&rows));
        let points = baseline.frame.points(&rows).unwrap();
        let readings: Vec<f64> = rows.iter().map(|row| row.force_n).collect();
        let fitted = least_squares(&with_rig_terms(&baseline), &points, &readings);
        let values = fitted.values();
        let [.., drag, offset, gain] = values[..] else { panic!("no terms") };
        assert!((drag - 0.5).abs() < 0.1 && (offset + 0.3).abs() < 0.1 && (gain - 0.04).abs() < 0.01);
    }
}
