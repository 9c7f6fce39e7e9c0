//! Simulated sessions of a fit: how far the mean square error of a session scatters about its expected value.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::design::{Component, Design, Role};
use crate::evidence::component_gain;
use crate::fit::Fit;
use crate::leave_out::Linearised;
use crate::problem::Problem;
use crate::random::Random;
use crate::sd_posterior::SdPosterior;
use crate::session_view::SessionView;

/// Readings of a simulated session, at most: as many as possible at equal distances. Those of a longer one scatter less about
/// what their series and mounts share.
const MOST_READINGS: usize = 4000;

/// Sessions of the rows of a problem, drawn from a fit.
pub(crate) struct SimulatedSessions<'a> {
    problem: &'a Problem,
    fit: &'a Fit,
    linearised: &'a Linearised,
    /// Simulated rows.
    rows: Vec<usize>,
    /// Places of the rows of each series among them.
    series: Vec<Range<usize>>,
    /// Places of the rows of each session among them.
    sessions: Vec<Vec<usize>>,
    /// The columns of the design of a new session that are drawn.
    matrix: DMatrix<f64>,
    /// `R` with `R'R` equal to the covariance of their coefficients.
    root: DMatrix<f64>,
    redrawn: Vec<Redrawn>,
}

/// Mean squares of a simulated session.
pub(crate) struct SimulatedSquare {
    /// Of errors without steps between sessions, over their expected value.
    errors: f64,
    /// Mean product of the same errors with the steps, over the root of that value.
    products: f64,
    /// Of the steps.
    steps: f64,
}

impl SimulatedSquare {
    /// Returns the mean square of the errors where that without steps is expected to be `square`.
    pub(crate) fn at(&self, square: f64) -> f64 {
        (square * self.errors + 2.0 * square.sqrt() * self.products + self.steps).max(0.0)
    }
}

/// A random effect whose levels a new session draws again.
struct Redrawn {
    effect: usize,
    levels: usize,
    sd: SdPosterior,
    /// Change of each simulated row per unit of its level.
    channel: Vec<f64>,
}

impl<'a> SimulatedSessions<'a> {
    /// Simulates sessions with the readings at the rows that are `sound`.
    pub(crate) fn new(
        problem: &'a Problem,
        fit: &'a Fit,
        linearised: &'a Linearised,
        sound: &[usize],
    ) -> Self {
        // An odd distance: directions may alternate.
        let distance = sound.len().div_ceil(MOST_READINGS) | 1;
        let rows: Vec<usize> = sound.iter().copied().step_by(distance).collect();
        let of_series = |range: &Range<usize>| {
            rows.partition_point(|row| *row < range.start)..rows.partition_point(|row| *row < range.end)
        };
        let mut redrawn = Vec::new();
        for (i, effect) in problem.space.random_effects.iter().enumerate().filter(|(_, e)| e.is_redrawn) {
            let gain = component_gain(&linearised.design, &linearised.point, Component::Random(i));
            let terms = gain.map_or_else(Vec::new, |(_, gain)| gain.fine_terms(effect.predictive_prior()));
            let channel = linearised.design.sensitivity(&problem.space, Component::Random(i));
            redrawn.push(Redrawn {
                effect: i,
                levels: effect.levels,
                sd: SdPosterior::new(terms),
                channel: rows.iter().map(|row| channel[*row]).collect(),
            });
        }
        let series = problem.ranges.iter().map(of_series).collect();
        let mut sessions: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (place, row) in rows.iter().enumerate() {
            sessions.entry(problem.rows.sessions[*row]).or_default().push(place);
        }
        let sessions = sessions.into_values().collect();
        let (matrix, drawn) = new_session(problem, fit, &linearised.design, &rows);
        let root = linearised.point.solution.root.select_columns(&drawn);
        Self { problem, fit, linearised, rows, series, sessions, matrix, root, redrawn }
    }

    /// Simulates this many sessions. Each has the rows of one of the fitted sessions, since a mean square of fewer series scatters
    /// more, and differs from its expected levels by the steps of one of the `views`, by their probability.
    pub(crate) fn squares(
        &self,
        random: &mut Random,
        views: &[(f64, SessionView)],
        simulations: usize,
    ) -> Vec<SimulatedSquare> {
        let has_steps = views.iter().any(|(_, view)| !view.steps.is_empty());
        let all: Vec<usize> = (0..self.rows.len()).collect();
        let mut squares: Vec<SimulatedSquare> = (0..simulations)
            .map(|_| {
                let mut errors = self.session(random);
                self.add_new_levels(random, &mut errors);
                let places = match self.sessions.as_slice() {
                    [] | [_] => &all,
                    sessions => &sessions[random.index(sessions.len())],
                };
                let probabilities = views.iter().map(|(probability, _)| *probability);
                let drawn = if has_steps { random.by_probability(probabilities) } else { None };
                let steps = self.steps(random, drawn.map(|view| &views[view].1));
                let mean = |value: &dyn Fn(usize) -> f64| {
                    places.iter().map(|place| value(*place)).sum::<f64>() / places.len().max(1) as f64
                };
                SimulatedSquare {
                    errors: mean(&|place| errors[place].powi(2)),
                    products: mean(&|place| errors[place] * steps[place]),
                    steps: mean(&|place| steps[place].powi(2)),
                }
            })
            .collect();
        let sum: f64 = squares.iter().map(|square| square.errors).sum();
        let expected = (sum / simulations.max(1) as f64).max(f64::MIN_POSITIVE);
        for square in &mut squares {
            square.errors /= expected;
            square.products /= expected.sqrt();
        }
        squares
    }

    /// Draws the steps of a session at each simulated row.
    fn steps(&self, random: &mut Random, view: Option<&SessionView>) -> Vec<f64> {
        let mut steps = vec![0.0; self.rows.len()];
        for of_kernel in view.map_or(&[][..], |view| &view.steps) {
            let step = of_kernel.draw(random);
            steps.iter_mut().zip(&self.rows).for_each(|(sum, row)| *sum += step * of_kernel.channel[*row]);
        }
        steps
    }

    /// Returns errors of a session: the uncertainty of its expected readings, and noise.
    fn session(&self, random: &mut Random) -> DVector<f64> {
        let problem = self.problem;
        let normal = DVector::from_fn(self.root.nrows(), |_, _| random.normal());
        let mut errors = &self.matrix * self.root.tr_mul(&normal);
        let [sigma, growth, direction, series, scale, by_load] = self.fit.scales().values();
        let friction = &self.linearised.design.channels[problem.space.series_scale_channel];
        for places in &self.series {
            let offset = series * random.normal();
            let sides = [direction * random.normal(), direction * random.normal()];
            let slopes = [by_load * random.normal(), by_load * random.normal()];
            let factor = scale * random.normal();
            for place in places.clone() {
                let row = self.rows[place];
                let load = problem.rows.load[row] / problem.reference.mean_load;
                let own = sigma * (1.0 + (growth * load).powi(2)).sqrt() * random.student();
                let side = usize::from(problem.rows.direction[row]);
                errors[place] += offset + sides[side] + load * slopes[side] + factor * friction[row] + own;
            }
        }
        errors
    }

    /// Adds new levels of the random effects that a new session draws again, with standard deviations from their posterior.
    fn add_new_levels(&self, random: &mut Random, errors: &mut DVector<f64>) {
        for redrawn in &self.redrawn {
            let Some(sd) = redrawn.sd.draw(random) else { continue };
            let values: Vec<f64> = (0..redrawn.levels).map(|_| sd * random.normal()).collect();
            let level_of = &self.problem.rows.levels[redrawn.effect];
            for (place, row) in self.rows.iter().enumerate() {
                errors[place] += level_of[*row].map_or(0.0, |level| values[level] * redrawn.channel[place]);
            }
        }
    }
}

/// Returns the design of some rows in a new session, and the columns that it has: without structure, mounts and drifts, whose
/// uncertainty is in the errors of series that are left out, or which a new session draws again.
///
/// Levels of specimens and of sessions are known from the same readings as the constants, with which they are correlated: their
/// sum is certain where neither is.
fn new_session(problem: &Problem, fit: &Fit, design: &Design, rows: &[usize]) -> (DMatrix<f64>, Vec<usize>) {
    let space = &problem.space;
    let forms: BTreeMap<usize, usize> = fit.hypothesis.kernels().collect();
    let session_levels = |kernel: usize| space.kernels[kernel].session_levels.get(*forms.get(&kernel)?);
    let is_drawn = |role: &Role| match role {
        Role::Constant(_) | Role::Size(_) | Role::Shape(..) => true,
        Role::Discrepancy(_) => false,
        Role::Variance(Component::Random(i)) => !space.random_effects[*i].is_redrawn,
        Role::Variance(Component::Kernel(i)) => {
            space.kernels[*i].is_of_specimens || session_levels(*i).is_some()
        }
    };
    let drawn: Vec<usize> = (0..design.roles.len()).filter(|i| is_drawn(&design.roles[*i])).collect();
    let mut matrix = design.matrix.select_columns(&drawn).select_rows(rows);
    for (kernel, form) in &forms {
        let Some(levels) = session_levels(*kernel) else { continue };
        let component = Component::Kernel(*kernel);
        let channel = design.sensitivity(space, component);
        let expected = levels.expected_row(&problem.rows.bases[*kernel][*form]);
        for (column, value) in design.columns_of(component).into_iter().zip(expected) {
            let column = drawn.partition_point(|drawn| *drawn < column);
            rows.iter().enumerate().for_each(|(i, row)| matrix[(i, column)] = channel[*row] * value);
        }
    }
    (matrix, drawn)
}
