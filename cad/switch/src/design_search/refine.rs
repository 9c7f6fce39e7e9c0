//! Optimisation of the continuous parameters of a pattern with the simplex of Nelder and Mead.

use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;

use super::candidate::Trial;
use super::linear::{Linear, guessed_cost};
use super::space::Space;

/// First step of a parameter, as a share of its range.
const FIRST_STEP: f64 = 0.2;
/// Cost per unit of distance beyond the ranges.
const OUTSIDE_COST: f64 = 50.0;
/// Cost of a place that cannot be predicted or printed; finite, as the optimiser requires.
const INVALID_COST: f64 = 1e4;
/// Standard deviation of the costs of the simplex at which the optimisation ends: a hundredth of a
/// probability.
const COST_TOLERANCE: f64 = 0.01;

/// The quantity to minimise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aim {
    /// Minus the logarithm of the probability, with guessed standard deviations: one curve per
    /// step.
    Guessed,
    /// Minus the logarithm of the probability: a dozen curves per step.
    Probable,
    /// The miss of the best estimate, without its uncertainty.
    Nearest,
}

/// A material, a pattern, and values of the continuous parameters.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub(super) material: usize,
    pub(super) pins: Vec<usize>,
    /// Continuous parameters, each scaled from 0 to 1 over its range.
    pub(super) at: Vec<f64>,
}

struct Cost<'a> {
    trial: &'a Trial<'a>,
    space: &'a Space,
    place: &'a Place,
    aim: Aim,
}

impl CostFunction for Cost<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, at: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        let outside: f64 = at.iter().map(|x| (x - x.clamp(0.0, 1.0)).abs()).sum();
        let inside = cost(self.trial, self.space, &Place { at: at.clone(), ..self.place.clone() }, self.aim);
        Ok(inside.unwrap_or(INVALID_COST) + OUTSIDE_COST * outside)
    }
}

/// Returns the cost of a place; `None` if it cannot be predicted or printed, or violates a limit.
pub(super) fn cost(trial: &Trial<'_>, space: &Space, place: &Place, aim: Aim) -> Option<f64> {
    let configuration = space.configuration(place.material, &place.pins, &place.at);
    if !trial.keeps_limits(&configuration) {
        return None;
    }
    let cost = match aim {
        Aim::Guessed => guessed_cost(trial, &trial.median(&configuration)?),
        Aim::Probable => Linear::of(trial, &configuration)?.cost(trial),
        Aim::Nearest => trial.shortfall(&configuration)?,
    };
    cost.is_finite().then_some(cost)
}

/// Returns the place with the continuous parameters that minimise `aim`; unchanged without
/// continuous parameters.
pub(super) fn refined(trial: &Trial<'_>, space: &Space, place: &Place, aim: Aim, steps: u64) -> Place {
    let start = &place.at;
    if start.is_empty() {
        return place.clone();
    }
    let mut simplex = vec![start.clone()];
    for i in 0..start.len() {
        let mut vertex = start.clone();
        // Towards the middle of the range, so that the vertex is inside.
        vertex[i] += if vertex[i] < 0.5 { FIRST_STEP } else { -FIRST_STEP };
        simplex.push(vertex);
    }
    let Ok(solver) = NelderMead::new(simplex).with_sd_tolerance(COST_TOLERANCE) else { return place.clone() };
    let best = Executor::new(Cost { trial, space, place, aim }, solver)
        .configure(|state| state.max_iters(steps))
        .timer(false)
        .run()
        .ok()
        .and_then(|result| result.state.best_param);
    let at = best.map_or_else(|| start.clone(), |x| x.iter().map(|x| x.clamp(0.0, 1.0)).collect());
    Place { at, ..place.clone() }
}
