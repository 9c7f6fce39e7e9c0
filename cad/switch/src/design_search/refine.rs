//! The continuous parameters of a pattern, moved until its cost is least (Nelder and Mead's simplex).

use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;

use super::candidate::Trial;
use super::linear::{Linear, guessed_cost};
use super::space::Space;

/// First step of a parameter, as a share of its range.
const FIRST_STEP: f64 = 0.2;
/// Cost of a place outside of the ranges, a unit beyond.
const OUTSIDE: f64 = 50.0;
/// Cost of what cannot be predicted or printed; finite, as the optimiser needs it.
const REFUSED: f64 = 1e4;
/// Scatter of the simplex's costs at which it is done: a hundredth of a probability.
const ENOUGH: f64 = 0.01;

/// What is made small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aim {
    /// The improbability, with standard deviations that are only guessed: one curve a step.
    Guessed,
    /// The improbability: a dozen curves a step.
    Probable,
    /// How far the best guess misses the targets, whatever the uncertainty.
    Nearest,
}

/// A material and a pattern at a place.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub(super) material: usize,
    pub(super) pins: Vec<usize>,
    /// Continuous parameters, each from 0 to 1 within its range.
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
        Ok(inside.unwrap_or(REFUSED) + OUTSIDE * outside)
    }
}

/// The cost at a place; `None` if it cannot be predicted, printed, or breaks a limit.
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

/// The place with its continuous parameters moved to where `aim` is least; itself where nothing varies.
pub(super) fn refined(trial: &Trial<'_>, space: &Space, place: &Place, aim: Aim, steps: u64) -> Place {
    let start = &place.at;
    if start.is_empty() {
        return place.clone();
    }
    let mut simplex = vec![start.clone()];
    for i in 0..start.len() {
        let mut vertex = start.clone();
        // Towards the middle, so that it stays inside.
        vertex[i] += if vertex[i] < 0.5 { FIRST_STEP } else { -FIRST_STEP };
        simplex.push(vertex);
    }
    let Ok(solver) = NelderMead::new(simplex).with_sd_tolerance(ENOUGH) else { return place.clone() };
    let best = Executor::new(Cost { trial, space, place, aim }, solver)
        .configure(|state| state.max_iters(steps))
        .timer(false)
        .run()
        .ok()
        .and_then(|result| result.state.best_param);
    let at = best.map_or_else(|| start.clone(), |x| x.iter().map(|x| x.clamp(0.0, 1.0)).collect());
    Place { at, ..place.clone() }
}
