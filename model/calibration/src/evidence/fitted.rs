//! A fitted hypothesis as a model for files: constants, terms, noise and covariance.

use nalgebra::{DMatrix, DVector};
use pinswitch_inference::{Coefficient, Coefficients, Fit, Member, Outliers, SizedEffect};

use super::forward::Channel;
use super::priors::EffectPrior;
use super::structure::{Record, Structure};
use super::table_kernels::MEMORY_REPETITIONS;
use super::{Evidence, SPECIMEN};
use crate::effects::{self, Abscissa, Covariate, REFERENCE_LOAD_N, Shape};
use crate::model::{Discrepancy, Model, Noise, Spread, Term, Wandering};
use crate::table::Point;

/// Most nodes of a table.
const MOST_NODES: usize = 128;

/// A fitted hypothesis.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The model.
    pub model: Model,
    /// The noise.
    pub noise: Noise,
    /// Posterior covariance of the coordinates of the model's constants.
    pub covariance: DMatrix<f64>,
    /// Expectation of each row of the table in newtons, in its order, with its mount and without the
    /// offsets of its series.
    pub predicted_n: Vec<f64>,
}

impl Evidence {
    /// Converts a fit to a model; `None` if the fit is not finite.
    pub fn fitted(&self, fit: &Fit) -> Option<Fitted> {
        let setup = &self.setup;
        let coefficients = Coefficients::new(&self.problem, fit)?;
        let mut model = Model::baseline(setup.frame.clone()).among(&setup.vocabulary);
        // Coordinate of the model, coefficient, and the derivative of one by the other.
        let mut places: Vec<(usize, Coefficient, f64)> = Vec::new();
        for (constant, coordinate) in setup.baseline.coordinates(&setup.frame).into_iter().enumerate() {
            model.coordinates[coordinate] = fit.constants()[constant];
            places.push((coordinate, Coefficient::Constant(constant), 1.0));
        }
        let mut variances: Vec<(usize, f64)> = Vec::new();
        for sized in fit.effects() {
            model = self.with_effect(model, &sized, &coefficients, &mut places);
        }
        for member in fit.hypothesis.members() {
            let Member::Kernel(kernel) = member else { continue };
            let structure = &setup.structures[kernel];
            let curve = self.curve(fit, kernel, &coefficients)?;
            for (term, size, variance) in self.terms(structure, kernel, &curve, &coefficients) {
                let at = model.coordinates.len();
                model = model.with_term(Term::Structure(term), &[size]);
                variances.push((at, variance));
            }
        }
        if let Some((term, variance)) = self.specimens(&coefficients) {
            variances.push((model.coordinates.len(), variance));
            model = model.with_term(Term::Structure(term), &[1.0]);
        }
        let n = model.coordinates.len();
        let mut covariance = DMatrix::zeros(n, n);
        // Constants that the table does not have keep their prior.
        for (i, prior) in model.priors().iter().enumerate().take(model.baseline_len()) {
            covariance[(i, i)] = prior.sd.powi(2);
        }
        variances.iter().for_each(|(i, variance)| covariance[(*i, *i)] = *variance);
        let known: Vec<(usize, usize, f64)> = places
            .iter()
            .filter_map(|(coordinate, role, slope)| Some((*coordinate, coefficients.index(*role)?, *slope)))
            .collect();
        for (i, a, slope_a) in &known {
            for (j, b, slope_b) in &known {
                covariance[(*i, *j)] = slope_a * slope_b * coefficients.covariance[(*a, *b)];
            }
        }
        let mut predicted_n = vec![0.0; self.source.len()];
        for (row, predicted) in self.source.iter().zip(&coefficients.predicted) {
            predicted_n[*row] = *predicted;
        }
        Some(Fitted { model, noise: self.noise(fit), covariance, predicted_n })
    }

    fn with_effect(
        &self,
        model: Model,
        sized: &SizedEffect,
        coefficients: &Coefficients,
        places: &mut Vec<(usize, Coefficient, f64)>,
    ) -> Model {
        let prior = &self.setup.priors[sized.effect];
        let values = prior.values(sized);
        let (term, first) = (model.terms.len(), model.coordinates.len());
        let mut model = model.with_term(Term::Named(prior.effect.clone()), &values);
        if !values.is_empty() {
            let slope = if prior.is_limit() { -1.0 } else { 1.0 };
            places.push((first, Coefficient::Size(sized.effect), slope / model.value(first).1));
        }
        for (i, coordinate) in (first + 1..model.coordinates.len()).enumerate() {
            if i >= sized.shifts.len() {
                break;
            }
            let slope = prior.shift_slope(i + 1, values[i + 1]) / model.value(coordinate).1.max(1e-12);
            places.push((coordinate, Coefficient::Shape(sized.effect, i), slope));
        }
        for (i, factor) in self.setup.discrepancy_factors(prior).into_iter().enumerate() {
            let role = Coefficient::Discrepancy(sized.effect, i);
            if let Some(at) = coefficients.index(role) {
                let (value, sd) = (coefficients.mean[at], coefficients.covariance[(at, at)].max(0.0).sqrt());
                model = model.with_discrepancy(Discrepancy { term, value, sd, factor });
            }
        }
        model
    }

    /// Returns the function of a kernel at each row of the problem.
    fn curve(&self, fit: &Fit, kernel: usize, coefficients: &Coefficients) -> Option<Vec<f64>> {
        let form = fit.hypothesis.elements().find(|e| e.member == Member::Kernel(kernel))?.form;
        let basis = &self.problem.rows().bases[kernel][form];
        let weight = |i: usize| coefficients.index(Coefficient::Kernel(kernel, i));
        let weights: Vec<f64> =
            (0..basis.coefficients()).filter_map(|i| weight(i).map(|at| coefficients.mean[at])).collect();
        Some(basis.function(&weights))
    }

    /// Returns the terms of a kernel with this function, each with its size and the variance of it.
    fn terms(
        &self,
        structure: &Structure,
        kernel: usize,
        curve: &[f64],
        coefficients: &Coefficients,
    ) -> Vec<(effects::Structure, f64, f64)> {
        let covariate = covariate_of(structure.covariate);
        let channel = channel_of(structure.channel);
        let only_in = match structure.channel {
            Channel::HalfLoadOf(device) => {
                self.setup.conditions.iter().position(|condition| condition.device == Some(device))
            }
            _ => None,
        };
        let of = |form: Shape| effects::Structure { covariate, channel, only_in, form };
        let columns: Vec<usize> =
            (0..).map_while(|i| coefficients.index(Coefficient::Kernel(kernel, i))).collect();
        let relative = relative_variance(coefficients, &columns);
        match structure.record {
            Record::Nothing => Vec::new(),
            Record::Time => {
                let over = Abscissa::Time;
                let (at, value) = table(&self.points, curve, |p| over.value(p), false);
                vec![(of(Shape::Table { over, at, value, is_factor: false }), 1.0, relative)]
            }
            Record::Memory => {
                // The curve is in proportion to one of the forms.
                let fitted = MEMORY_REPETITIONS.map(|r0| {
                    let form = Shape::Memory { r0, unit_n: REFERENCE_LOAD_N };
                    let size = slope(curve, &self.points, |p| form.value(p));
                    let left =
                        curve.iter().zip(&self.points).map(|(y, p)| (y - size * form.value(p)).powi(2));
                    (left.sum::<f64>(), form, size)
                });
                let best = fitted.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
                best.map(|(_, form, size)| (of(form), size, relative * size * size)).into_iter().collect()
            }
            Record::Sessions => {
                let over = Abscissa::Session;
                let (mut at, mut value) = table(&self.points, curve, |p| over.value(p), true);
                let next = self.level_of_next_session(kernel, &value);
                at.push(at.last().map_or(0.0, |last| last + 1.0));
                value.push(next);
                vec![(of(Shape::Table { over, at, value, is_factor: true }), 1.0, relative)]
            }
            Record::Table(over, is_factor) => {
                let (at, value) = table(&self.points, curve, |p| over.value(p), is_factor);
                vec![(of(Shape::Table { over, at, value, is_factor }), 1.0, relative)]
            }
        }
    }

    /// Returns the level that a new session is expected to have, given those of the sessions: a mean over the forms of the kernel
    /// by their probabilities.
    fn level_of_next_session(&self, kernel: usize, levels: &[f64]) -> f64 {
        let mut sum = (0.0, 0.0);
        for (fit, probability) in self.posterior.window.iter().zip(&self.posterior.probabilities) {
            let element = fit.hypothesis.elements().find(|e| e.member == Member::Kernel(kernel));
            let form = element.and_then(|e| self.setup.structures[kernel].session_levels.get(e.form));
            if let Some(form) = form {
                sum = (sum.0 + probability * form.expected(levels), sum.1 + probability);
            }
        }
        sum.0 / sum.1.max(f64::MIN_POSITIVE)
    }

    /// Returns the friction of each specimen, which a later session has too, and the mean relative
    /// variance of it; `None` if specimens are not a random effect.
    fn specimens(&self, coefficients: &Coefficients) -> Option<(effects::Structure, f64)> {
        let random = &self.problem.space().random_effects;
        let index = random.iter().position(|effect| effect.name == SPECIMEN && effect.levels > 0)?;
        let over = Abscissa::Specimen;
        let of_row = |row: usize| self.problem.rows().levels[index][row];
        let places = (0..self.points.len()).filter_map(|row| {
            let coefficient = coefficients.index(Coefficient::Level(index, of_row(row)?))?;
            Some((over.value(&self.points[row]), coefficient))
        });
        let mut places: Vec<(f64, usize)> = places.collect();
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        places.dedup_by(|a, b| a.1 == b.1);
        let square: f64 = places.iter().map(|(_, i)| coefficients.mean[*i].powi(2)).sum();
        let variance: f64 = places.iter().map(|(_, i)| coefficients.covariance[(*i, *i)]).sum();
        let (at, value) = places.iter().map(|(at, i)| (*at, coefficients.mean[*i])).unzip();
        let channel =
            if random[index].channel == Channel::Pins.index() { Channel::Pins } else { Channel::Friction };
        let structure = effects::Structure {
            covariate: Covariate::Condition,
            channel: channel_of(channel),
            only_in: None,
            form: Shape::Table { over, at, value, is_factor: true },
        };
        Some((structure, variance / square.max(1e-300)))
    }

    /// Returns the noise of a fit.
    fn noise(&self, fit: &Fit) -> Noise {
        let [sigma, growth, direction, series, scale, by_load] = fit.scales().values();
        let mean_load = self.problem.noise_reference().mean_load;
        let is_baseline = fit.hypothesis.is_empty();
        let outliers = &self.posterior.outliers;
        let scatter = if is_baseline { Outliers::new(&self.problem, fit).scatter } else { outliers.scatter };
        let (share, correlation) = fit.scales().autoregression();
        let random = |name: &str| {
            let effects = &self.problem.space().random_effects;
            let at = effects.iter().position(|effect| effect.name == name && effect.levels > 0);
            at.and_then(|at| fit.random_effect_sd(at)).unwrap_or(0.0)
        };
        Noise {
            repetition: Spread {
                constant_n: scatter * sigma,
                per_load: scatter * sigma * growth / mean_load,
            },
            series: Spread { constant_n: direction, per_load: by_load / mean_load },
            correlation: share * correlation,
            series_common: Spread { constant_n: series, per_load: 0.0 },
            series_scale: scale,
            mount_scale: random("mount"),
            walk: Wandering::default(),
            group_offset_n: 0.0,
            specimen_scale: random("specimen"),
        }
    }
}

/// Returns the variance of a factor of a function whose course is known: `1/(m' C^-1 m)` for the mean `m` and the covariance `C` of
/// its coefficients.
fn relative_variance(coefficients: &Coefficients, columns: &[usize]) -> f64 {
    let mean = DVector::from_iterator(columns.len(), columns.iter().map(|i| coefficients.mean[*i]));
    let covariance = coefficients.covariance.select_rows(columns).select_columns(columns);
    let precision: f64 = covariance.cholesky().map_or(0.0, |factors| mean.dot(&factors.solve(&mean)));
    1.0 / precision.max(f64::MIN_POSITIVE)
}

pub(super) fn channel_of(channel: Channel) -> effects::Channel {
    match channel {
        Channel::Reading => effects::Channel::Reading,
        Channel::Drag => effects::Channel::Drag,
        Channel::Friction => effects::Channel::Friction,
        Channel::Pins => effects::Channel::Pins,
        Channel::Silicone => effects::Channel::Silicone,
        Channel::Gain => effects::Channel::Gain,
        Channel::DirectionFriction => effects::Channel::FrictionByDirection,
        Channel::HalfLoad | Channel::HalfLoadOf(_) => effects::Channel::HalfLoad,
    }
}

/// Returns the covariate of a kernel; a factor of the protocol counts as a condition.
fn covariate_of(name: &str) -> Covariate {
    Covariate::ALL.into_iter().find(|covariate| covariate.as_str() == name).unwrap_or(Covariate::Condition)
}

/// Returns the factor that takes a function of the points to a curve, by least squares.
fn slope(curve: &[f64], points: &[Point], of: impl Fn(&Point) -> f64) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
    for (value, point) in curve.iter().zip(points) {
        let x = of(point);
        product += x * value;
        square += x * x;
    }
    if square > 0.0 { product / square } else { 0.0 }
}

/// Returns ascending nodes with the mean of a curve near each; of a factor, every level.
fn table(
    points: &[Point],
    curve: &[f64],
    over: impl Fn(&Point) -> f64,
    is_factor: bool,
) -> (Vec<f64>, Vec<f64>) {
    let mut pairs: Vec<(f64, f64)> = points.iter().map(over).zip(curve.iter().copied()).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let same = if is_factor { 0.006 } else { 1e-9 };
    let mut groups: Vec<Vec<(f64, f64)>> = Vec::new();
    for pair in pairs {
        match groups.last_mut() {
            Some(group) if pair.0 - group[0].0 < same => group.push(pair),
            _ => groups.push(vec![pair]),
        }
    }
    let at_once = if is_factor { 1 } else { groups.len().div_ceil(MOST_NODES).max(1) };
    let mean = |chunk: &[Vec<(f64, f64)>]| {
        let all: Vec<&(f64, f64)> = chunk.iter().flatten().collect();
        let n = all.len().max(1) as f64;
        (all.iter().map(|p| p.0).sum::<f64>() / n, all.iter().map(|p| p.1).sum::<f64>() / n)
    };
    groups.chunks(at_once).map(mean).unzip()
}

impl EffectPrior {
    /// Returns whether the effect is the limit of the load cell, whose size is measured downwards.
    pub(super) fn is_limit(&self) -> bool {
        self.limit_from_n.is_some()
    }
}
