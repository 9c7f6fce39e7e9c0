//! What a fit expects of a new session, and how far sessions were from that.

use nalgebra::DVector;

use crate::design::{Component, Role};
use crate::fit::Fit;
use crate::hypothesis::Member;
use crate::leave_out::Linearised;
use crate::problem::{Problem, SessionLevels};
use crate::random::Random;

/// A hypothesis at the rows of the fitted session.
pub(crate) struct SessionView {
    /// What a new session is predicted to read, without its own mounts and noise.
    pub(crate) prediction: Vec<f64>,
    /// What the fitted session drew for itself: effects and kernels of its time, about their mean.
    pub(crate) deviation: Vec<f64>,
    /// How sessions differed from what was to be expected of them.
    pub(crate) steps: Vec<Steps>,
}

/// Differences of the levels of sessions from the levels that were to be expected.
pub(crate) struct Steps {
    /// Level that a new session is expected to have.
    expected: f64,
    /// Mean square of the differences, in the square of the unit of the channel.
    square: f64,
    /// Number of differences from which it is known.
    count: usize,
    /// Probability of a difference.
    share: f64,
    /// Change of each reading per unit of the level.
    pub(crate) channel: Vec<f64>,
}

impl Steps {
    /// Returns those of a curve that is constant in each session. A new session may differ from its expected level as the
    /// sessions did: from the level before, from their mean, which is known from as many sessions, or as one of them did.
    fn of_curve(curve: &[f64], of: SessionLevels, channel: Vec<f64>) -> Self {
        let mut levels = curve.to_vec();
        if of == SessionLevels::Independent {
            levels.sort_by(f64::total_cmp);
        }
        levels.dedup();
        let expected = of.expected(&levels);
        let steps = || levels.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        let count = levels.len().saturating_sub(1);
        let of_all = |sum: f64| sum / f64::max(count as f64, 1.0);
        let (square, count, share) = match of {
            SessionLevels::Independent => {
                let squares = levels.iter().map(|level| (level - expected).powi(2));
                (of_all(squares.sum()) * (1.0 + 1.0 / levels.len().max(1) as f64), count, 1.0)
            }
            SessionLevels::RandomWalk => (of_all(steps().sum()), count, 1.0),
            SessionLevels::OneChange(sessions) | SessionLevels::OneSession(sessions) => {
                let share = 1.0 / sessions.max(1) as f64;
                (share * steps().next().unwrap_or(0.0), count.min(1), share)
            }
        };
        Self { expected, square, count, share, channel }
    }

    /// Draws the difference of a new session. The variance of few differences is known badly: its posterior, with a prior
    /// that is flat in its logarithm, is a scaled inverse chi-squared distribution with their number as degrees of freedom.
    pub(crate) fn draw(&self, random: &mut Random) -> f64 {
        if self.count == 0 || random.uniform() > self.share {
            return 0.0;
        }
        let chi_squared: f64 = (0..self.count).map(|_| random.normal().powi(2)).sum();
        let variance =
            self.square / self.share * self.count as f64 / f64::max(chi_squared, f64::MIN_POSITIVE);
        variance.sqrt() * random.normal()
    }
}

impl SessionView {
    pub(crate) fn new(problem: &Problem, fit: &Fit, linearised: &Linearised) -> Self {
        let effects = fit.mode.sized(&fit.hypothesis);
        let forward = &problem.rows.forward;
        let at = forward.readings(&fit.mode.constants, &effects);
        let mut prediction = forward.session_mean(&fit.mode.constants, &effects);
        let mut deviation: Vec<f64> = at.iter().zip(&prediction).map(|(a, b)| a - b).collect();
        let (design, mean) = (&linearised.design, &linearised.point.solution.mean);
        for (i, role) in design.roles.iter().enumerate() {
            let is_lasting = match role {
                Role::Constant(_) | Role::Size(_) | Role::Shape(..) => false,
                Role::Discrepancy(_) => true,
                Role::Variance(Component::Random(i)) => !problem.space.random_effects[*i].is_redrawn,
                Role::Variance(Component::Kernel(i)) => {
                    let kernel = &problem.space.kernels[*i];
                    !kernel.is_session_bound && kernel.session_levels.is_empty()
                }
            };
            if is_lasting {
                let column = design.matrix.column(i);
                prediction.iter_mut().zip(column.iter()).for_each(|(p, x)| *p += x * mean[i]);
            }
        }
        let mut steps = Vec::new();
        for (kernel, form) in fit.hypothesis.kernels() {
            let of = &problem.space.kernels[kernel];
            let session_levels = of.session_levels.get(form).copied();
            if of.is_gross_error || (!of.is_session_bound && session_levels.is_none()) {
                continue;
            }
            let channel = design.sensitivity(&problem.space, Component::Kernel(kernel));
            let curve =
                kernel_curve(problem, fit, kernel, &design.columns_of(Component::Kernel(kernel)), mean);
            if let Some(levels) = session_levels {
                let of_kernel = Steps::of_curve(&curve, levels, channel);
                let next = of_kernel.channel.iter().map(|x| x * of_kernel.expected);
                prediction.iter_mut().zip(next).for_each(|(p, next)| *p += next);
                steps.push(of_kernel);
                continue;
            }
            let level = curve.iter().sum::<f64>() / curve.len() as f64;
            for (row, value) in curve.iter().enumerate() {
                prediction[row] += channel[row] * level;
                deviation[row] += channel[row] * (value - level);
            }
        }
        Self { prediction, deviation, steps }
    }

    /// Mean square by which a new session differs from its expected levels at a row.
    pub(crate) fn step_square(&self, row: usize) -> f64 {
        self.steps.iter().map(|steps| steps.square * steps.channel[row].powi(2)).sum()
    }
}

/// Returns the mean square of what a session draws again, of the steps between sessions, and of the difference between
/// hypotheses in the prediction of a new session.
pub(crate) fn session_variance(views: &[(f64, SessionView)], sound: &[usize]) -> f64 {
    let total: f64 = views.iter().map(|(p, _)| p).sum();
    let average = |value: &dyn Fn(&SessionView) -> f64| -> f64 {
        views.iter().map(|(p, view)| p * value(view)).sum::<f64>() / total
    };
    let of_row = |row: &usize| {
        let mean = average(&|view| view.prediction[*row]);
        average(&|view| {
            view.deviation[*row].powi(2) + view.step_square(*row) + (view.prediction[*row] - mean).powi(2)
        })
    };
    sound.iter().map(of_row).sum::<f64>() / sound.len().max(1) as f64
}

/// Returns the mean square that new levels of the random effects of a fit add, which a new session draws again.
pub(crate) fn new_level_variance(
    problem: &Problem,
    fit: &Fit,
    linearised: &Linearised,
    sound: &[usize],
) -> f64 {
    let design = &linearised.design;
    let redrawn = problem.space.random_effects.iter().enumerate().filter(|(_, e)| e.is_redrawn);
    let mean_squares = redrawn.map(|(i, _)| {
        let sd = fit.random_effect_sd(i).unwrap_or(0.0);
        let channel = design.sensitivity(&problem.space, Component::Random(i));
        let has_level = |row: &&usize| problem.rows.levels[i][**row].is_some();
        let squares = sound.iter().filter(has_level).map(|row| (sd * channel[*row]).powi(2));
        squares.sum::<f64>() / sound.len().max(1) as f64
    });
    mean_squares.sum()
}

/// Returns the posterior mean of a kernel's function at each row, in the unit of its channel.
pub(crate) fn kernel_curve(
    problem: &Problem,
    fit: &Fit,
    kernel: usize,
    columns: &[usize],
    mean: &DVector<f64>,
) -> Vec<f64> {
    let Some(element) = fit.element(Member::Kernel(kernel)) else { return vec![0.0; problem.len()] };
    let basis = &problem.rows.bases[kernel][element.form];
    let coefficients = mean.select_rows(columns);
    basis.function(coefficients.as_slice())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_between_sessions_are_counted_once_each() {
        let of = |curve: &[f64], levels| {
            let steps = Steps::of_curve(curve, levels, vec![1.0; curve.len()]);
            (steps.expected, steps.square, steps.count)
        };
        let curve = [0.0, 0.0, 0.0, 1.0, 3.0, 3.0, -4.0];
        assert_eq!(of(&curve, SessionLevels::RandomWalk), (-4.0, (1.0 + 4.0 + 49.0) / 3.0, 3));
        assert_eq!(of(&curve, SessionLevels::Independent), (0.0, 26.0 / 3.0 * 1.25, 3));
        assert_eq!(of(&[0.0, 0.0, 2.0, 2.0], SessionLevels::OneChange(4)), (2.0, 1.0, 1));
        assert_eq!(of(&[0.0, 0.0, 2.0, 0.0], SessionLevels::OneSession(4)), (0.0, 1.0, 1));
        use SessionLevels::{Independent, OneChange, OneSession, RandomWalk};
        for levels in [Independent, RandomWalk, OneChange(3), OneSession(3)] {
            assert_eq!(of(&[0.3, 0.3, 0.3], levels), (0.3, 0.0, 0));
            assert_eq!(of(&[], levels), (0.0, 0.0, 0));
        }
    }

    /// Two thirds of the levels of a new session are within the tabulated quantile of Student's t distribution with as many
    /// degrees of freedom as differences.
    #[test]
    fn the_step_of_a_new_session_has_the_t_distribution_of_few_steps() {
        let mut random = Random::new(8);
        for (count, two_thirds) in [(1, 1.732), (3, 1.152)] {
            let steps = Steps { expected: 0.0, square: 0.25, count, share: 1.0, channel: Vec::new() };
            let within = (0..9000).filter(|_| steps.draw(&mut random).abs() < 0.5 * two_thirds).count();
            assert!((5850..6150).contains(&within), "{count} steps: {within}");
        }
    }

    /// Two hypotheses of equal probability that predict 1 and 3 differ by 1 from their mean; one row of two is sound.
    #[test]
    fn a_session_varies_by_its_draws_its_step_and_the_hypotheses() {
        let view = |prediction, deviation, step| SessionView {
            prediction: vec![prediction, 100.0],
            deviation: vec![deviation, 100.0],
            steps: vec![Steps {
                expected: 0.0,
                square: step,
                count: 1,
                share: 1.0,
                channel: vec![1.0, 100.0],
            }],
        };
        let views = [(0.5, view(1.0, 0.0, 4.0)), (0.5, view(3.0, 2.0, 0.0))];
        assert_eq!(session_variance(&views, &[0]), 0.5 * 2f64.powi(2) + 0.5 * 4.0 + 1.0);
    }
}
