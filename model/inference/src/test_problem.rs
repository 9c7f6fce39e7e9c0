//! A small linear problem for tests: a slope, an offset as an effect, levels as a kernel, and mounts.

use std::ops::Range;

use nalgebra::DVector;

use crate::covariance::Noise;
use crate::design::{Design, Mode};
use crate::fit::{Fit, Start, size_variances};
use crate::hypothesis::{Element, Hypothesis, Member};
use crate::kernel;
use crate::noise::{EXCLUDED, NoiseReference, Scales};
use crate::problem::{
    Constant, Effect, ForwardModel, Kernel, Problem, RandomEffect, Rows, SizedEffect, Space,
};
use crate::random::Random;
use crate::scales::{ScalePoint, ScaleProblem};

/// `slope * load + offset`.
struct Line(Vec<f64>);

impl ForwardModel for Line {
    fn readings(&self, constants: &[f64], effects: &[SizedEffect]) -> Vec<f64> {
        let offset: f64 = effects.iter().map(|e| e.size).sum();
        self.0.iter().map(|load| constants[0] * load + offset).collect()
    }

    fn channels(&self, constants: &[f64], _: &[SizedEffect]) -> Vec<Vec<f64>> {
        vec![vec![1.0; self.0.len()], self.0.iter().map(|load| constants[0] * load).collect()]
    }

    fn of_rows(&self, rows: &[usize]) -> Box<dyn ForwardModel> {
        Box::new(Self(rows.iter().map(|row| self.0[*row]).collect()))
    }
}

/// Rows of each series.
pub(crate) const ROWS_PER_SERIES: usize = 5;

/// Conditions of `count` series at loads 1, 2, 3, 1, ...
pub(crate) fn rows(count: usize) -> Rows {
    long_rows(count, ROWS_PER_SERIES)
}

pub(crate) fn long_rows(count: usize, length: usize) -> Rows {
    let total = count * length;
    let series: Vec<usize> = (0..total).map(|i| i / length).collect();
    let load: Vec<f64> = series.iter().map(|s| 1.0 + (s % 3) as f64).collect();
    let level: Vec<Option<usize>> = series.iter().map(|s| Some(s % 3)).collect();
    Rows {
        direction: (0..total).map(|i| i % 2 == 1).collect(),
        sessions: vec![0; total],
        order: (0..total).map(|i| i % length).collect(),
        levels: vec![series.iter().map(|s| Some(s / 2 % 2)).collect()],
        bases: vec![vec![kernel::levels(&level, 3).into()]],
        discrepancies: vec![vec![load.iter().map(|f| f - 2.0).collect()]],
        relevant: vec![vec![0.05; total]],
        is_new_session: false,
        forward: Box::new(Line(load.clone())),
        series,
        load,
    }
}

pub(crate) fn space() -> Space {
    Space {
        constants: vec![Constant { name: "slope".to_owned(), mean: 1.0, sd: 1.0 }],
        effects: vec![Effect {
            name: "offset".to_owned(),
            typical_size: Some(0.5),
            is_one_sided: false,
            probability: 0.1,
            starts: vec![0.15],
            shape_probabilities: vec![],
            shape_constants: 0,
        }],
        kernels: vec![Kernel {
            name: "load levels".to_owned(),
            covariate: "load".to_owned(),
            bases: 0,
            channel: 0,
            scale: 0.3,
            variants: vec![1.0],
            is_session_bound: false,
            is_of_specimens: false,
            session_levels: Vec::new(),
            noise_probability: None,
            is_gross_error: false,
        }],
        random_effects: vec![RandomEffect {
            name: "mount".to_owned(),
            channel: 1,
            scale: 0.02,
            levels: 2,
            is_redrawn: true,
        }],
        usual_effects: vec![0],
        structure_probability: 0.2,
        series_scale_channel: 1,
        curved_channels: Vec::new(),
        joint_channels: Vec::new(),
    }
}

/// A problem with an offset, noise, and an offset per series.
pub(crate) fn problem(series: usize, offset: f64) -> Problem {
    problem_with(series, offset, |_| 0.0)
}

/// The same with gross errors of some rows.
pub(crate) fn problem_with(series: usize, offset: f64, error: impl Fn(usize) -> f64) -> Problem {
    problem_of(rows(series), offset, error)
}

/// A problem with series of `length` rows.
pub(crate) fn long_problem(series: usize, length: usize, offset: f64) -> Problem {
    problem_of(long_rows(series, length), offset, |_| 0.0)
}

fn problem_of(rows: Rows, offset: f64, error: impl Fn(usize) -> f64) -> Problem {
    let series = rows.ranges().len();
    let mut random = Random::new(11);
    let shared: Vec<f64> = (0..series).map(|_| 0.05 * random.normal()).collect();
    let readings = (0..rows.len())
        .map(|i| 2.0 * rows.load[i] + offset + shared[rows.series[i]] + 0.03 * random.normal() + error(i))
        .collect();
    Problem::new(space(), rows, readings).unwrap()
}

/// The hypothesis of the offset and the kernel.
pub(crate) fn full_hypothesis() -> Hypothesis {
    let element = |member| Element { member, form: 0 };
    Hypothesis::from_elements([element(Member::Effect(0)), element(Member::Kernel(0))])
}

/// A fit, its design and its scales.
pub(crate) fn fitted(problem: &Problem, hypothesis: &Hypothesis) -> (Fit, Design, ScalePoint) {
    let fit = Fit::new(problem, hypothesis, Start::default()).unwrap();
    let (design, point) = at_mode(problem, hypothesis, &fit.mode);
    (fit, design, point)
}

/// Design and scales of a hypothesis at a mode.
pub(crate) fn at_mode(problem: &Problem, hypothesis: &Hypothesis, mode: &Mode) -> (Design, ScalePoint) {
    let design = Design::new(problem, hypothesis, mode).unwrap();
    let variances = size_variances(&problem.space, hypothesis, mode, true);
    let at = ScaleProblem { problem, design: &design, weights: &mode.weights, size_variances: &variances };
    let point = at.at(mode.scales, &mode.log_sd).unwrap();
    (design, point)
}

/// The noise of a fit.
pub(crate) fn noise_of<'a>(
    problem: &'a Problem,
    fit: &'a Fit,
    design: &'a Design,
    point: &ScalePoint,
) -> Noise<'a> {
    Noise::new(&problem.rows, &problem.reference, &point.scales, &fit.mode.weights, &design.channels[1])
}

/// Weights of 1 for every row.
pub(crate) fn unit_weights(problem: &Problem) -> DVector<f64> {
    DVector::from_element(problem.len(), 1.0)
}

/// Checks the noise of rows of one series: with one load and with several, in one direction and in both, some excluded.
pub(crate) fn with_noise(autoregression: usize, check: impl Fn(&Noise<'_>, &Range<usize>)) {
    let mut random = Random::new(8);
    for (is_one_load, is_one_direction, is_excluded) in
        [(true, false, false), (false, false, false), (true, true, false), (false, true, true)]
    {
        let mut rows = long_rows(1, 12);
        for row in 0..rows.len() {
            rows.load[row] = if is_one_load { 3.0 } else { 1.0 + random.uniform() };
            rows.direction[row] = !is_one_direction && row % 3 == 1;
            // Neither consecutive nor in the order of the rows.
            rows.order[row] = (5 * row) % 13;
        }
        let readings: Vec<f64> = rows.load.iter().map(|load| load + 0.1 * random.normal()).collect();
        let reference = NoiseReference { quantum: 0.03, ..NoiseReference::of_readings(&readings, &rows) };
        let scales = Scales { log: [-2.0, -0.4, -1.5, -3.0, -1.0, -2.6], autoregression };
        let weight = |row: usize| if is_excluded && row == 4 { EXCLUDED } else { 0.3 + random.uniform() };
        let weights = DVector::from_iterator(rows.len(), (0..rows.len()).map(weight));
        let friction: Vec<f64> = (0..rows.len()).map(|row| 0.3 + 0.1 * (row % 4) as f64).collect();
        let noise = Noise::new(&rows, &reference, &scales, &weights, &friction);
        check(&noise, &(0..rows.len()));
    }
}
