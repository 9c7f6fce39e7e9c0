//! Prediction of the rows of new series, with the constants and effects of the fitted ones.

use crate::covariance::Noise;
use crate::design::{Component, Design};
use crate::fit::{DEGREES_OF_FREEDOM, Fit};
use crate::leave_out::Linearised;
use crate::posterior::Posterior;
use crate::problem::{Problem, ProblemError, Rows, check_rows};
use crate::session_view::SessionView;

/// Most hypotheses that are averaged.
const MOST_HYPOTHESES: usize = 12;

/// Prediction of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Mean.
    pub mean: f64,
    /// Standard deviation of a reading about it.
    pub sd: f64,
}

impl Posterior {
    /// Predicts rows of new series, as the average over the window. Rows of a new session have no
    /// level of random effects that it draws again, and for kernels of its time the mean of their
    /// bases over the fitted session.
    ///
    /// # Errors
    /// [`ProblemError`] if the rows do not fit the space of the problem.
    pub fn predict(&self, problem: &Problem, rows: &Rows) -> Result<Vec<Prediction>, ProblemError> {
        check_rows(&problem.space, rows)?;
        let mut parts = Vec::new();
        for (fit, probability) in self.window.iter().zip(&self.probabilities).take(MOST_HYPOTHESES) {
            if let Some(predictions) = predictions_of_fit(problem, fit, rows) {
                parts.push((*probability, predictions));
            }
        }
        let total: f64 = parts.iter().map(|(p, _)| p).sum();
        let average = |value: &dyn Fn(&Prediction) -> f64, row: usize| -> f64 {
            parts.iter().map(|(p, predictions)| p * value(&predictions[row])).sum::<f64>() / total
        };
        Ok((0..rows.len())
            .map(|row| {
                let mean = average(&|p| p.mean, row);
                let variance = average(&|p| p.sd.powi(2) + (p.mean - mean).powi(2), row);
                Prediction { mean, sd: variance.sqrt() }
            })
            .collect())
    }
}

fn predictions_of_fit(problem: &Problem, fit: &Fit, rows: &Rows) -> Option<Vec<Prediction>> {
    let space = &problem.space;
    let linearised = Linearised::new(problem, fit)?;
    // A new session draws again what the fitted one drew for itself.
    let redrawn = if rows.is_new_session {
        let deviation = SessionView::new(problem, fit, &linearised).deviation;
        deviation.iter().map(|d| d * d).sum::<f64>() / deviation.len() as f64
    } else {
        0.0
    };
    let solution = linearised.point.solution;
    let design = Design::of_rows(space, rows, &fit.hypothesis, &fit.mode)?;
    let mut new_variance = vec![redrawn; rows.len()];
    for (i, random) in space.random_effects.iter().enumerate() {
        let variance = fit.random_effect_sd(i).unwrap_or(0.0).powi(2);
        let channel = design.sensitivity(space, Component::Random(i));
        for row in (0..rows.len()).filter(|row| random.levels > 0 && rows.levels[i][*row].is_none()) {
            new_variance[row] += variance * channel[row].powi(2);
        }
    }
    let mean = &design.matrix * &solution.mean - &design.target;
    let spread = &design.matrix * solution.root.transpose();
    let ones = nalgebra::DVector::from_element(rows.len(), 1.0);
    let scales = fit.scales();
    let friction = &design.channels[space.series_scale_channel];
    let noise = Noise::new(rows, &problem.reference, &scales, &ones, friction);
    // The variance of Student's t distribution is larger than the square of its scale.
    let tails = 2.0 / (DEGREES_OF_FREEDOM - 2.0);
    Some(
        (0..rows.len())
            .map(|row| {
                let own = noise.variance(row);
                let heavy = tails * noise.independent_variance(row);
                let variance = spread.row(row).norm_squared() + new_variance[row] + own + heavy;
                Prediction { mean: mean[row], sd: variance.sqrt() }
            })
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use crate::test_problem::{problem, rows};
    use crate::{SearchOptions, infer};

    /// Rows without a mount are less certain by the variance between mounts.
    #[test]
    fn unknown_mounts_add_variance() {
        let problem = problem(12, 0.0);
        let posterior = infer(&problem, SearchOptions::default(), 1).unwrap();
        let known = posterior.predict(&problem, &rows(3)).unwrap();
        let mut new = rows(3);
        new.levels[0].fill(None);
        let unknown = posterior.predict(&problem, &new).unwrap();
        assert!(known.iter().zip(&unknown).all(|(known, unknown)| unknown.sd > known.sd));
    }

    #[test]
    fn predictions_include_the_effect() {
        let problem = problem(12, 0.6);
        let posterior = infer(&problem, SearchOptions::default(), 1).unwrap();
        let new = rows(3);
        for (prediction, load) in posterior.predict(&problem, &new).unwrap().iter().zip(&new.load) {
            assert!((prediction.mean - 2.0 * load - 0.6).abs() < 0.08, "{prediction:?}");
            assert!(prediction.sd > 0.03 && prediction.sd < 0.15, "{prediction:?}");
        }
    }
}
