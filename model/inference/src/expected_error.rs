//! Expected error of a new session.
//!
//! Each series is predicted from the others, and its residual gets the spread of a new series at
//! the same conditions. A hypothesis counts by its probability without that
//! series, so that it is held out of the choice of effects too. New mounts and what a session draws again
//! (a drift, a level) add their variance. The interval is that of a bootstrap over series and of simulated
//! sessions, whose mounts have standard deviations drawn from their posterior.

use crate::fit::Fit;
use crate::leave_out::Linearised;
use crate::outliers::Outliers;
use crate::problem::Problem;
use crate::quadrature::log_sum_exp;
use crate::random::Random;
use crate::session_view::{SessionView, new_level_variance, session_variance, step_variance};
use crate::simulated_sessions::SimulatedSessions;

/// Most hypotheses that are averaged.
const MOST_HYPOTHESES: usize = 12;
/// Simulated sessions, and resamples of the series.
const SIMULATIONS: usize = 300;

/// Root mean square error expected on a new session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedError {
    /// Expected value.
    pub value: f64,
    /// 90 % interval.
    pub interval: [f64; 2],
}

/// Errors of the average over a window of fits, each series left out.
pub(crate) struct LeftOutErrors<'a> {
    problem: &'a Problem,
    /// The best fit, and what is simulated of it.
    best: (&'a Fit, Linearised),
    /// Rows without gross errors.
    sound: Vec<usize>,
    /// Sum of the squared errors of each series, and their number.
    squares: Vec<(f64, f64)>,
    /// A new session by each fit, with its probability among them.
    views: Vec<(f64, SessionView)>,
    /// Variance of what a new session draws again, without steps between sessions.
    added: f64,
}

impl<'a> LeftOutErrors<'a> {
    /// Leaves out each series; `None` if no fit can be linearised.
    pub(crate) fn new(
        problem: &'a Problem,
        window: &'a [Fit],
        probabilities: &[f64],
        outliers: &Outliers,
    ) -> Option<Self> {
        let fits = window.iter().zip(probabilities).take(MOST_HYPOTHESES);
        let mut parts = Vec::new();
        for (fit, probability) in fits {
            let Some(linearised) = Linearised::new(problem, fit) else { continue };
            if let Some(left_out) = linearised.leave_series_out() {
                parts.push((libm::log(*probability), fit, linearised, left_out));
            }
        }
        let mut residuals = vec![0.0; problem.len()];
        for (series, range) in problem.ranges.iter().enumerate() {
            let logs: Vec<f64> = parts.iter().map(|(p, _, _, out)| p - out.log_predictive[series]).collect();
            let total = log_sum_exp(&logs);
            for ((_, _, _, out), log) in parts.iter().zip(&logs) {
                let share = libm::exp(log - total);
                range.clone().for_each(|row| residuals[row] += share * out.of_new_series[row]);
            }
        }
        // A new session is not expected to have gross errors.
        let sound: Vec<usize> = (0..problem.len()).filter(|row| !outliers.contains(*row)).collect();
        let mut squares = vec![(0.0, 0.0); problem.ranges.len()];
        for row in &sound {
            let (sum, count) = &mut squares[problem.rows.series[*row]];
            *sum += residuals[*row].powi(2);
            *count += 1.0;
        }
        squares.retain(|(_, count)| *count > 0.0);
        let total = log_sum_exp(&parts.iter().map(|(p, ..)| *p).collect::<Vec<f64>>());
        let view = |(p, fit, linearised, _): &(f64, &Fit, Linearised, _)| {
            (libm::exp(p - total), SessionView::new(problem, fit, linearised))
        };
        let views: Vec<(f64, SessionView)> = parts.iter().map(view).collect();
        let (_, fit, linearised, _) = parts.into_iter().next()?;
        let added = new_level_variance(problem, fit, &linearised, &sound) + session_variance(&views, &sound);
        Some(Self { problem, best: (fit, linearised), sound, squares, views, added })
    }

    /// Returns the expected error of a new session.
    pub(crate) fn value(&self) -> f64 {
        let of_steps = step_variance(&self.views, &self.sound);
        (mean_square(self.squares.iter().copied()) + self.added + of_steps).sqrt()
    }

    /// Returns the expected error with the interval of that of one session, from simulated ones.
    pub(crate) fn expected_error(&self, seed: u64) -> ExpectedError {
        let mut random = Random::new(seed);
        let (fit, linearised) = &self.best;
        let simulated = SimulatedSessions::new(self.problem, fit, linearised, &self.sound);
        let sessions = simulated.squares(&mut random, &self.views, SIMULATIONS);
        let squares = &self.squares;
        let mut errors: Vec<f64> = sessions
            .iter()
            .map(|session| {
                let drawn = (0..squares.len()).map(|_| squares[random.index(squares.len())]);
                session.at(mean_square(drawn) + self.added).sqrt()
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        let quantile = |share: usize| errors[(share * (SIMULATIONS - 1)) / 100];
        ExpectedError { value: self.value(), interval: [quantile(5), quantile(95)] }
    }
}

fn mean_square(series: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, count) = series.fold((0.0, 0.0), |(s, n), (square, rows)| (s + square, n + rows));
    sum / f64::max(count, 1.0)
}

#[cfg(test)]
mod tests {
    use crate::problem::Problem;
    use crate::random::Random;
    use crate::test_problem::{problem, rows, space};
    use crate::{SearchOptions, infer};

    /// Series differ by 0.05 and readings by 0.03, so a new session differs by their root sum of
    /// squares.
    #[test]
    fn expected_error_covers_series_offsets() {
        let problem = problem(24, 0.0);
        let posterior = infer(&problem, SearchOptions::default(), 5).unwrap();
        let error = posterior.expected_error.unwrap();
        let truth = (0.05f64.powi(2) + 0.03f64.powi(2)).sqrt();
        assert!(error.interval[0] < truth && truth < error.interval[1], "{error:?}");
        assert!((error.value / truth - 1.0).abs() < 0.3, "{error:?}");
    }

    /// Twelve mounts that differ by twenty scales of the prior: the error of a session in new mounts is that of the mounts.
    #[test]
    fn expected_error_believes_mounts_that_differ_by_far_more_than_the_prior() {
        const MOUNTS: usize = 12;
        let mut rows = rows(3 * MOUNTS);
        rows.levels = vec![rows.series.iter().map(|series| Some(series / 3)).collect()];
        let mut space = space();
        space.random_effects[0].levels = MOUNTS;
        let sd = 20.0 * space.random_effects[0].scale;
        let mut random = Random::new(3);
        let mounts: Vec<f64> = (0..MOUNTS).map(|_| sd * random.normal()).collect();
        let reading =
            |i: usize| 2.0 * rows.load[i] * (1.0 + mounts[rows.series[i] / 3]) + 0.03 * random.normal();
        let readings: Vec<f64> = (0..rows.len()).map(reading).collect();
        let mean = mounts.iter().sum::<f64>() / MOUNTS as f64;
        let spread = (mounts.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (MOUNTS - 1) as f64).sqrt();
        let square = rows.load.iter().map(|load| (2.0 * load).powi(2)).sum::<f64>() / rows.len() as f64;
        let problem = Problem::new(space, rows, readings).unwrap();
        let error = infer(&problem, SearchOptions::default(), 5).unwrap().expected_error.unwrap();
        let truth = spread * square.sqrt();
        assert!((error.value / truth - 1.0).abs() < 0.25, "{error:?}, {truth}");
    }

    /// Three specimens that differ: their mean is uncertain, but each of them is not, and another session measures them again.
    #[test]
    fn the_error_on_known_specimens_is_that_of_readings() {
        let mut rows = rows(24);
        rows.levels = vec![rows.series.iter().map(|series| Some(series % 3)).collect()];
        let mut space = space();
        // With structure over the load the slope is known badly, which is another reason.
        space.kernels.clear();
        rows.bases.clear();
        space.random_effects[0] = crate::RandomEffect {
            levels: 3,
            scale: 0.06,
            is_redrawn: false,
            ..space.random_effects[0].clone()
        };
        let mut random = Random::new(3);
        let reading = |i: usize| {
            let specimen = [0.8, 1.0, 1.2][rows.series[i] % 3];
            2.0 * rows.load[i] * specimen + 0.03 * random.normal()
        };
        let readings: Vec<f64> = (0..rows.len()).map(reading).collect();
        let problem = Problem::new(space, rows, readings).unwrap();
        let error = infer(&problem, SearchOptions::default(), 5).unwrap().expected_error.unwrap();
        assert!(error.interval[0] > 0.02 && error.interval[1] < 0.05, "{error:?}");
    }

    /// One session of eight has an eighth of the series, whose mean square scatters more than that of all.
    #[test]
    fn the_error_of_one_of_many_sessions_scatters_more() {
        let width = |sessions: usize| {
            let mut rows = rows(48);
            rows.sessions = rows.series.iter().map(|series| series * sessions / 48).collect();
            let mut random = Random::new(3);
            let shared: Vec<f64> = (0..48).map(|_| 0.05 * random.normal()).collect();
            let reading = |i: usize| 2.0 * rows.load[i] + shared[rows.series[i]] + 0.03 * random.normal();
            let readings: Vec<f64> = (0..rows.len()).map(reading).collect();
            let problem = Problem::new(space(), rows, readings).unwrap();
            let error = infer(&problem, SearchOptions::default(), 5).unwrap().expected_error.unwrap();
            error.interval[1] / error.interval[0]
        };
        assert!(width(8) > 1.3 * width(1), "{} {}", width(8), width(1));
    }

    #[test]
    fn equal_seeds_give_equal_intervals() {
        let problem = problem(8, 0.3);
        let error = |seed| infer(&problem, SearchOptions::default(), seed).unwrap().expected_error.unwrap();
        assert_eq!(error(3), error(3));
        assert_ne!(error(3).interval, error(4).interval);
    }
}
