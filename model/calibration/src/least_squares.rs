//! Robust least squares of the paper's model with drag, offset and gain: the reference that any
//! calibration has to reach.

use std::collections::HashMap;

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
/// weight up to 1.345 robust standard deviations. The model has no terms over time or repetition, so that it predicts each setting
/// once.
pub(crate) fn least_squares(start: &Model, points: &[Point], readings_n: &[f64]) -> Model {
    let mut model = start.clone();
    let (settings, of_point) = settings(points);
    for _ in 0..STEPS {
        let predicted = model.predict(&settings);
        let residual: Vec<f64> = readings_n.iter().zip(&of_point).map(|(y, i)| y - predicted[*i]).collect();
        let weights = huber_weights(&residual);
        let columns = jacobian(&model, &settings);
        let slope = |i: usize, j: usize| columns[j][of_point[i]] * weights[i].sqrt();
        let matrix = DMatrix::from_fn(points.len(), columns.len(), slope);
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

/// Returns points with different settings, and the number of that of each point.
fn settings(points: &[Point]) -> (Vec<Point>, Vec<usize>) {
    let mut different: Vec<Point> = Vec::new();
    // Settings with the same condition, load and direction are few.
    let mut known: HashMap<(usize, u64, u64), Vec<usize>> = HashMap::new();
    let mut number = |point: &Point| {
        let alike = known.entry((point.condition, point.load_n.to_bits(), point.sign.to_bits())).or_default();
        if let Some(number) = alike.iter().find(|number| different[**number].has_setting_of(point)) {
            return *number;
        }
        alike.push(different.len());
        different.push(*point);
        different.len() - 1
    };
    let of_point = points.iter().map(&mut number).collect();
    (different, of_point)
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
