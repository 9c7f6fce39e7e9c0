//! Expected error of a new session.
//!
//! Each series is predicted from the others, and its residual gets the spread of a new series at
//! the same conditions. A hypothesis counts by its probability without that
//! series, so that it is held out of the choice of effects too. New mounts and what a session draws again
//! (a drift, a level) add their variance. The interval is that of a bootstrap over series and of simulated
//! sessions, whose mounts have standard deviations drawn from their posterior.

use nalgebra::DVector;

use crate::design::{Component, Role};
use crate::evidence::component_gain;
use crate::fit::Fit;
use crate::hypothesis::Member;
use crate::leave_out::Linearised;
use crate::outliers::Outliers;
use crate::problem::{Problem, SessionLevels};
use crate::quadrature::log_sum_exp;
use crate::random::Random;

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

/// Returns the expected error of the average over a window of fits with these probabilities; `None`
/// if no fit can be linearised.
pub(crate) fn expected_error(
    problem: &Problem,
    window: &[Fit],
    probabilities: &[f64],
    outliers: &Outliers,
    seed: u64,
) -> Option<ExpectedError> {
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
    let (_, fit, linearised, _) = parts.first()?;
    // A new session is not expected to have gross errors.
    let sound: Vec<usize> = (0..problem.len()).filter(|row| !outliers.contains(*row)).collect();
    let mut squares = vec![(0.0, 0.0); problem.ranges.len()];
    for row in &sound {
        let (sum, count) = &mut squares[problem.rows.series[*row]];
        *sum += residuals[*row].powi(2);
        *count += 1.0;
    }
    squares.retain(|(_, count)| *count > 0.0);
    let mut random = Random::new(seed);
    let views: Vec<(f64, SessionView)> = parts
        .iter()
        .map(|(p, fit, linearised, _)| (libm::exp(*p), SessionView::new(problem, fit, linearised)))
        .collect();
    let simulation = Simulation::new(problem, fit, linearised);
    let added = simulation.new_level_variance(&sound) + session_variance(&views, &sound);
    let relative_squares = simulation.run(&mut random, &sound, &views[0].1);
    let mut errors: Vec<f64> = relative_squares
        .iter()
        .map(|relative| {
            let drawn = (0..squares.len()).map(|_| squares[random.index(squares.len())]);
            let square = mean_square(drawn) + added;
            (square * relative).sqrt()
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    let quantile = |share: usize| errors[(share * (SIMULATIONS - 1)) / 100];
    let value = (mean_square(squares.iter().copied()) + added).sqrt();
    Some(ExpectedError { value, interval: [quantile(5), quantile(95)] })
}

fn mean_square(series: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, count) = series.fold((0.0, 0.0), |(s, n), (square, rows)| (s + square, n + rows));
    sum / f64::max(count, 1.0)
}

/// A hypothesis at the rows of the fitted session.
pub(crate) struct SessionView {
    /// What a new session is predicted to read, without its own mounts and noise.
    prediction: Vec<f64>,
    /// What the fitted session drew for itself: effects and kernels of its time, about their mean.
    pub(crate) deviation: Vec<f64>,
    /// How sessions differed from what was to be expected of them.
    steps: Vec<Steps>,
}

/// Differences of the levels of sessions from the levels that were to be expected.
struct Steps {
    /// Level that a new session is expected to have.
    expected: f64,
    /// Mean square of the differences, in the square of the unit of the channel.
    square: f64,
    /// Number of differences from which it is known.
    count: usize,
    /// Probability of a difference.
    share: f64,
    /// Change of each reading per unit of the level.
    channel: Vec<f64>,
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
    fn draw(&self, random: &mut Random) -> f64 {
        if self.count == 0 || (self.share < 1.0 && random.uniform() > self.share) {
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
    fn step_square(&self, row: usize) -> f64 {
        self.steps.iter().map(|steps| steps.square * steps.channel[row].powi(2)).sum()
    }
}

/// Returns the mean square of what a session draws again, of the steps between sessions, and of the difference between
/// hypotheses in the prediction of a new session.
fn session_variance(views: &[(f64, SessionView)], sound: &[usize]) -> f64 {
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

/// Sessions of the rows of a problem, drawn from a fit.
struct Simulation<'a> {
    problem: &'a Problem,
    fit: &'a Fit,
    linearised: &'a Linearised,
    /// Standard deviations of each random effect that a new session draws again, with the sum of the probabilities up to each.
    redrawn: Vec<(usize, Vec<(f64, f64)>)>,
}

impl<'a> Simulation<'a> {
    fn new(problem: &'a Problem, fit: &'a Fit, linearised: &'a Linearised) -> Self {
        let mut redrawn = Vec::new();
        for (i, effect) in problem.space.random_effects.iter().enumerate().filter(|(_, e)| e.is_redrawn) {
            let gain = component_gain(&linearised.design, &linearised.point, Component::Random(i));
            let terms = gain.map_or_else(Vec::new, |(_, gain)| gain.fine_terms(effect.predictive_prior()));
            let total = log_sum_exp(&terms.iter().map(|(_, term)| *term).collect::<Vec<f64>>());
            let mut sum = 0.0;
            let up_to = terms.into_iter().map(|(sd, term)| {
                sum += libm::exp(term - total);
                (sd, sum)
            });
            redrawn.push((i, up_to.collect()));
        }
        Self { problem, fit, linearised, redrawn }
    }

    /// Returns the mean square of each session, divided by their expected value. The levels of a session differ from the last ones
    /// by the steps of `view`. The expected value uses the mean square of the steps so far.
    fn run(&self, random: &mut Random, sound: &[usize], view: &SessionView) -> Vec<f64> {
        let mean = |value: &dyn Fn(usize) -> f64| -> f64 {
            sound.iter().map(|row| value(*row)).sum::<f64>() / sound.len().max(1) as f64
        };
        let mut without_steps = 0.0;
        let squares: Vec<f64> = (0..SIMULATIONS)
            .map(|_| {
                let mut errors = self.session(random);
                self.add_new_levels(random, &mut errors);
                without_steps += mean(&|row| errors[row].powi(2)) / SIMULATIONS as f64;
                for steps in &view.steps {
                    let step = steps.draw(random);
                    errors.iter_mut().zip(&steps.channel).for_each(|(error, x)| *error += step * x);
                }
                mean(&|row| errors[row].powi(2))
            })
            .collect();
        let expected = (without_steps + mean(&|row| view.step_square(row))).max(1e-300);
        squares.iter().map(|square| square / expected).collect()
    }

    /// Returns the mean square that new levels of random effects add.
    fn new_level_variance(&self, sound: &[usize]) -> f64 {
        let (problem, design) = (self.problem, &self.linearised.design);
        let redrawn = problem.space.random_effects.iter().enumerate().filter(|(_, e)| e.is_redrawn);
        let mean_squares = redrawn.map(|(i, _)| {
            let sd = self.fit.random_effect_sd(i).unwrap_or(0.0);
            let channel = design.sensitivity(&problem.space, Component::Random(i));
            let has_level = |row: &&usize| problem.rows.levels[i][**row].is_some();
            let squares = sound.iter().filter(has_level).map(|row| (sd * channel[*row]).powi(2));
            squares.sum::<f64>() / sound.len().max(1) as f64
        });
        mean_squares.sum()
    }

    /// Returns errors of a session: uncertainty of constants and sizes, and noise.
    fn session(&self, random: &mut Random) -> Vec<f64> {
        let (problem, solution) = (self.problem, &self.linearised.point.solution);
        let normal = DVector::from_fn(solution.root.nrows(), |_, _| random.normal());
        let mut coefficients = solution.root.tr_mul(&normal);
        for (i, role) in self.linearised.design.roles.iter().enumerate() {
            if !matches!(role, Role::Constant(_) | Role::Size(_) | Role::Shape(..)) {
                coefficients[i] = 0.0;
            }
        }
        let mut errors: Vec<f64> = (&self.linearised.design.matrix * coefficients).iter().copied().collect();
        let [sigma, growth, direction, series, scale, by_load] = self.fit.scales().values();
        let friction = &self.linearised.design.channels[problem.space.series_scale_channel];
        for range in &problem.ranges {
            let offset = series * random.normal();
            let sides = [direction * random.normal(), direction * random.normal()];
            let slopes = [by_load * random.normal(), by_load * random.normal()];
            let factor = scale * random.normal();
            for row in range.clone() {
                let load = problem.rows.load[row] / problem.reference.mean_load;
                let own = sigma * (1.0 + (growth * load).powi(2)).sqrt() * random.student();
                let side = usize::from(problem.rows.direction[row]);
                errors[row] += offset + sides[side] + load * slopes[side] + factor * friction[row] + own;
            }
        }
        errors
    }

    /// Adds new levels of the random effects that a new session draws again, with standard deviations from their posterior.
    fn add_new_levels(&self, random: &mut Random, errors: &mut [f64]) {
        for (i, standard_deviations) in &self.redrawn {
            let (share, effect) = (random.uniform(), &self.problem.space.random_effects[*i]);
            let drawn = standard_deviations.iter().find(|(_, up_to)| share < *up_to);
            let Some((sd, _)) = drawn.or(standard_deviations.last()) else { continue };
            let values: Vec<f64> = (0..effect.levels).map(|_| sd * random.normal()).collect();
            let channel = self.linearised.design.sensitivity(&self.problem.space, Component::Random(*i));
            for (row, level) in self.problem.rows.levels[*i].iter().enumerate() {
                errors[row] += level.map_or(0.0, |level| values[level] * channel[row]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{SessionView, Steps, session_variance};
    use crate::problem::{Problem, SessionLevels};
    use crate::random::Random;
    use crate::test_problem::{problem, rows, space};
    use crate::{SearchOptions, infer};

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

    #[test]
    fn equal_seeds_give_equal_intervals() {
        let problem = problem(8, 0.3);
        let error = |seed| infer(&problem, SearchOptions::default(), seed).unwrap().expected_error.unwrap();
        assert_eq!(error(3), error(3));
        assert_ne!(error(3).interval, error(4).interval);
    }
}
