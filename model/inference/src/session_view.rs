//! What a fit expects of a new session, and how far sessions were from that.

use nalgebra::DVector;

use crate::design::{Component, Role};
use crate::fit::Fit;
use crate::hypothesis::Member;
use crate::leave_out::Linearised;
use crate::problem::Problem;
use crate::session_steps::{Steps, prior_of_steps};

/// A hypothesis at the rows of the fitted session.
pub(crate) struct SessionView {
    /// What a new session is predicted to read, without its own mounts and noise.
    pub(crate) prediction: Vec<f64>,
    /// What the fitted session drew for itself: effects and kernels of its time, about their mean.
    pub(crate) deviation: Vec<f64>,
    /// How sessions differed from what was to be expected of them.
    pub(crate) steps: Vec<Steps>,
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
                let change = problem.rows.bases[kernel][form].largest();
                let of_kernel = Steps::of_curve(&curve, levels, prior_of_steps(of, change), channel);
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
        self.steps.iter().map(|steps| steps.square_at(row)).sum()
    }
}

/// Returns the mean square of what a session draws again, and of the difference between hypotheses in the prediction of a new
/// session.
pub(crate) fn session_variance(views: &[(f64, SessionView)], sound: &[usize]) -> f64 {
    let of_row = |row: &usize| {
        let mean = average(views, &|view| view.prediction[*row]);
        average(views, &|view| view.deviation[*row].powi(2) + (view.prediction[*row] - mean).powi(2))
    };
    sound.iter().map(of_row).sum::<f64>() / sound.len().max(1) as f64
}

/// Returns the mean square of the steps between sessions.
pub(crate) fn step_variance(views: &[(f64, SessionView)], sound: &[usize]) -> f64 {
    let of_row = |row: &usize| average(views, &|view| view.step_square(*row));
    sound.iter().map(of_row).sum::<f64>() / sound.len().max(1) as f64
}

/// Returns the mean over the hypotheses by their probabilities, which sum to 1.
fn average(views: &[(f64, SessionView)], value: &dyn Fn(&SessionView) -> f64) -> f64 {
    views.iter().map(|(p, view)| p * value(view)).sum()
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
    use crate::half_t::HalfT;
    use crate::problem::SessionLevels;

    const HALF_T: HalfT = HalfT { scale: 0.1, degrees: 3.0 };

    /// Two hypotheses of equal probability that predict 1 and 3 differ by 1 from their mean; one row of two is sound.
    #[test]
    fn a_session_varies_by_its_draws_steps_and_hypotheses() {
        let view = |prediction, deviation, levels: &[f64]| SessionView {
            prediction: vec![prediction, 100.0],
            deviation: vec![deviation, 100.0],
            steps: vec![Steps::of_curve(levels, SessionLevels::RandomWalk, HALF_T, vec![1.0, 100.0])],
        };
        let step = view(0.0, 0.0, &[0.0, 2.0]).step_square(0);
        assert!(step > 0.0);
        let views = [(0.5, view(1.0, 0.0, &[0.0, 2.0])), (0.5, view(3.0, 2.0, &[0.0]))];
        assert_eq!(session_variance(&views, &[0]), 0.5 * 2f64.powi(2) + 1.0);
        assert_eq!(step_variance(&views, &[0]), 0.5 * step);
    }
}
