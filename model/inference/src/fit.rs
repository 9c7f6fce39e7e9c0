//! Mode of a hypothesis by Gauss-Newton steps, with the weights of Student's t noise.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::curved_channels::CurvedChannels;
use crate::design::{Component, Design, Mode, Role};
use crate::evidence::{Integrals, SizePosterior, log_evidence};
use crate::hypothesis::{Element, Hypothesis, Member};
use crate::leave_out::Linearised;
use crate::noise::{EXCLUDED, LOUD, Scales};
use crate::problem::{Problem, SizedEffect, Space};
use crate::quadrature::sum_of_logs;
use crate::scales::{ScalePoint, ScaleProblem};

/// Degrees of freedom of Student's t distribution of the repetition noise.
pub(crate) const DEGREES_OF_FREEDOM: f64 = 5.0;
/// Range of the weights of the scale mixture.
const WEIGHT_RANGE: (f64, f64) = (1e-12, 1.2);
/// Prior standard deviation of a size while its mode is searched, in typical sizes: practically
/// free, since a prior that is tight about a bad start keeps a fit there.
const FREE_SIZE_SD: f64 = 300.0;
/// Largest step of a constant in its coordinate.
const MOST_CONSTANT_STEP: f64 = 0.5;
/// Largest step of a shift of a shape, and its largest value.
const MOST_SHIFT: (f64, f64) = (0.7, 4.0);
/// Smallest size of a one-sided effect, as a share of the typical one.
const LEAST_SHARE: f64 = 0.02;
/// Rounds with free sizes: from scratch, and for an effect that is added to a mode.
const FREE_ROUNDS: (usize, usize) = (6, 2);
/// Most rounds after these, far more than convergence needs. From a mode in which the mounts explain a constant that differs
/// between sessions, the way to the mode of the right hypothesis is long: the noise grows first.
const MOST_FINAL_ROUNDS: usize = 30;
/// Rounds without a gain after which a fit ends: it moves to and fro about its mode.
const MOST_WITHOUT_GAIN: usize = 2;
/// Newton steps of the scales in a round: from scratch, and from the mode of a similar hypothesis.
const SCALE_STEPS: (usize, usize) = (3, 1);
/// Change of the objective in nats below which the last rounds have converged.
const CONVERGED: f64 = 0.05;

/// A fitted hypothesis.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The hypothesis.
    pub hypothesis: Hypothesis,
    /// `ln p(y | H)`.
    pub log_evidence: f64,
    /// `ln p(y | H) + ln p(H)`.
    pub score: f64,
    /// Posterior of the size of each effect that has one.
    pub sizes: BTreeMap<usize, SizePosterior>,
    /// Posterior mean of the variance of each component.
    pub(crate) variances: BTreeMap<Component, f64>,
    /// Constants, sizes, weights and scales at the mode.
    pub(crate) mode: Mode,
    /// Log posterior of the mode, which its last round increased little.
    objective: f64,
}

/// Where a fit starts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Start<'a> {
    /// Mode of a similar hypothesis.
    pub(crate) mode: Option<&'a Mode>,
    /// That hypothesis.
    pub(crate) hypothesis: Option<&'a Hypothesis>,
    /// Log posterior of its mode.
    pub(crate) objective: Option<f64>,
    /// Whether the fit is the last one of its hypothesis, for which every autoregression is tried.
    pub(crate) is_final: bool,
    /// Size of an added effect, from its first-order score.
    pub(crate) hint: Option<(usize, f64)>,
    /// Whether each row is excluded, for a start without a mode; empty if none is.
    pub(crate) excluded: &'a [bool],
}

impl<'a> Start<'a> {
    /// Returns a start at the mode of a fit.
    pub(crate) fn at(fit: &'a Fit, hint: Option<(usize, f64)>) -> Self {
        Self {
            mode: Some(&fit.mode),
            hypothesis: Some(&fit.hypothesis),
            objective: Some(fit.objective),
            is_final: false,
            hint,
            excluded: &[],
        }
    }
}

impl Fit {
    /// Fits a hypothesis; `None` if its readings are not finite at any mode.
    pub(crate) fn new(problem: &Problem, hypothesis: &Hypothesis, start: Start<'_>) -> Option<Self> {
        let mut mode = start_mode(problem, hypothesis, start);
        let is_cold = start.mode.is_none();
        let free = match (is_cold, start.hint) {
            (true, _) => FREE_ROUNDS.0,
            (false, Some(_)) => FREE_ROUNDS.1,
            (false, None) => 0,
        };
        let steps = if is_cold { SCALE_STEPS.0 } else { SCALE_STEPS.1 };
        let rounds = free + MOST_FINAL_ROUNDS;
        // A fit from its own mode may have converged.
        let known = start.objective.filter(|_| start.hypothesis == Some(hypothesis));
        let mut before = known.unwrap_or(f64::NEG_INFINITY);
        let (mut best, mut without_gain) = (f64::NEG_INFINITY, 0);
        for round in 0..rounds {
            let is_final = round >= free;
            let size_variances = size_variances(&problem.space, hypothesis, &mode, is_final);
            let design = Design::new(problem, hypothesis, &mode)?;
            let scale_problem = ScaleProblem {
                problem,
                design: &design,
                weights: &mode.weights,
                size_variances: &size_variances,
            };
            let mut point = scale_problem.maximum(&mode, steps)?;
            if round == free && (is_cold || start.is_final) {
                point = scale_problem.best_autoregression(point);
            }
            let objective = point.log_posterior + log_weight_term(&mode.weights);
            without_gain = if is_final && objective < best + CONVERGED { without_gain + 1 } else { 0 };
            let has_converged = (objective - before).abs() < CONVERGED || without_gain == MOST_WITHOUT_GAIN;
            if round + 1 == rounds || (is_final && has_converged) {
                return Some(Self::of_point(hypothesis, &scale_problem, mode.clone(), point));
            }
            before = if is_final { objective } else { f64::NEG_INFINITY };
            best = before.max(best);
            let weights = student_weights(&scale_problem, &point);
            move_coefficients(&problem.space, &design, &point, &mut mode);
            mode.scales = point.scales;
            mode.log_sd = point.log_sd;
            mode.weights = weights;
        }
        None
    }

    fn of_point(hypothesis: &Hypothesis, at: &ScaleProblem<'_>, mut mode: Mode, point: ScalePoint) -> Self {
        let (problem, design) = (at.problem, at.design);
        let integrals = log_evidence(at, &point, log_weight_term(&mode.weights));
        let before = mode.clone();
        move_coefficients(&problem.space, design, &point, &mut mode);
        let Integrals { log_evidence, sizes, variances } = integrals;
        let log_evidence = log_evidence + loss_by_curvature(at, hypothesis, &before, &mode, &point);
        mode.scales = point.scales;
        mode.log_sd = point.log_sd;
        let score = log_evidence + hypothesis.log_prior_odds(&problem.space);
        let objective = point.log_posterior + log_weight_term(&before.weights);
        Self { hypothesis: hypothesis.clone(), log_evidence, score, sizes, variances, mode, objective }
    }

    /// Returns the scales of the noise.
    pub fn scales(&self) -> Scales {
        self.mode.scales
    }

    /// Widens the posteriors of the sizes for weights and scales that are not known.
    pub(crate) fn widen_sizes(&mut self, problem: &Problem) {
        if self.sizes.is_empty() {
            return;
        }
        let Some(linearised) = Linearised::new(problem, self) else { return };
        let Some(covariance) = linearised.covariance(problem, self) else { return };
        for (i, role) in linearised.design.roles.iter().enumerate() {
            let Role::Size(effect) = role else { continue };
            let Some(size) = self.sizes.get_mut(effect) else { continue };
            let known = linearised.point.solution.covariance[(i, i)];
            if known > 0.0 {
                size.sd *= (covariance[(i, i)] / known).max(1.0).sqrt();
            }
        }
    }

    /// Returns the fit with the usual noise of repeated readings and random effects of their prior scales, where its own are
    /// larger; `None` if they are not much larger.
    pub(crate) fn quiet(&self, problem: &Problem) -> Option<Self> {
        let mut quiet = self.clone();
        let scales = self.mode.scales.quiet(&problem.reference);
        let mut is_loud = scales.is_some();
        quiet.mode.scales = scales.unwrap_or(self.mode.scales);
        for (i, random) in problem.space.random_effects.iter().enumerate() {
            let usual = libm::log(random.scale);
            if let Some(log) = quiet.mode.log_sd.get_mut(&Component::Random(i)) {
                is_loud |= *log > usual + LOUD;
                *log = log.min(usual);
            }
        }
        is_loud.then_some(quiet)
    }

    /// Returns the standard deviation of a random effect of the space, the root of its posterior mean
    /// variance.
    pub fn random_effect_sd(&self, index: usize) -> Option<f64> {
        self.variances.get(&Component::Random(index)).map(|variance| variance.sqrt())
    }

    /// Returns the standard deviation of a kernel of the hypothesis.
    pub fn kernel_sd(&self, index: usize) -> Option<f64> {
        self.variances.get(&Component::Kernel(index)).map(|variance| variance.sqrt())
    }

    /// Returns the effects of the hypothesis with sizes and shapes.
    pub fn effects(&self) -> Vec<SizedEffect> {
        self.mode.sized(&self.hypothesis)
    }

    /// Returns the baseline's constants.
    pub fn constants(&self) -> &[f64] {
        &self.mode.constants
    }

    /// Returns the weight of each row under the heavy-tailed noise; small for outliers.
    pub fn weights(&self) -> impl Iterator<Item = f64> + '_ {
        self.mode.weights.iter().copied()
    }
}

/// Returns what the readings lose in log likelihood where the model is not linear between the mode and
/// its posterior mean, to which it moved; zero at convergence. The evidence of a fit that has not
/// converged is that of a model which the readings do not follow.
fn loss_by_curvature(
    at: &ScaleProblem<'_>,
    hypothesis: &Hypothesis,
    before: &Mode,
    after: &Mode,
    point: &ScalePoint,
) -> f64 {
    let forward = &at.problem.rows.forward;
    let (space, rows) = (&at.problem.space, &at.problem.rows);
    let (curved_from, curved_to) = (&at.design.curved, CurvedChannels::new(after, space, rows, hypothesis));
    let from = forward.readings_at(&before.constants, &before.sized(hypothesis), &curved_from.values);
    let to = forward.readings_at(&after.constants, &after.sized(hypothesis), &curved_to.values);
    let value = |mode: &Mode, role: &Role| match role {
        Role::Constant(i) => mode.constants[*i],
        Role::Size(effect) => mode.sizes.get(effect).copied().unwrap_or(0.0),
        Role::Shape(effect, i) => mode.shifts.get(effect).map_or(0.0, |shifts| shifts[*i]),
        Role::Discrepancy(_) | Role::Variance(_) => 0.0,
    };
    let mut change = DVector::from_iterator(to.len(), to.iter().zip(&from).map(|(to, from)| to - from));
    let slopes = |component: Component| at.design.channels[component.channel(space)].as_slice();
    change -= DVector::from_vec(curved_from.linear_change(&curved_to, to.len(), slopes));
    let mut coefficients = point.solution.mean.clone();
    for (i, role) in at.design.roles.iter().enumerate() {
        if matches!(role, Role::Discrepancy(_) | Role::Variance(_)) {
            continue;
        }
        change.axpy(value(before, role) - value(after, role), &at.design.matrix.column(i), 1.0);
        coefficients[i] = value(after, role) - at.design.prior_mean[i];
    }
    let white = point.marginal.white_residual(&coefficients);
    let curved = &white - point.marginal.whitening.whiten_vector(&change);
    let loss = 0.5 * (white.norm_squared() - curved.norm_squared());
    if loss.is_finite() { loss.min(0.0) } else { f64::NEG_INFINITY }
}

/// Returns the prior variance of each size: practically free, or about twice the square of the
/// size, which the evidence replaces by the Cauchy prior.
pub(crate) fn size_variances(
    space: &Space,
    hypothesis: &Hypothesis,
    mode: &Mode,
    is_final: bool,
) -> BTreeMap<usize, f64> {
    let mut variances = BTreeMap::new();
    for (effect, _) in hypothesis.effects() {
        let Some(typical) = space.effects[effect].typical_size else { continue };
        let size = mode.sizes.get(&effect).copied().unwrap_or(typical);
        let variance = if is_final {
            2.0 * size.powi(2).max((0.5 * typical).powi(2))
        } else {
            (FREE_SIZE_SD * typical).powi(2)
        };
        variances.insert(effect, variance);
    }
    variances
}

fn start_mode(problem: &Problem, hypothesis: &Hypothesis, start: Start<'_>) -> Mode {
    let space = &problem.space;
    let mut mode = start.mode.cloned().unwrap_or_else(|| Mode {
        constants: space.constants.iter().map(|c| c.mean).collect(),
        sizes: BTreeMap::new(),
        shifts: BTreeMap::new(),
        weights: DVector::from_fn(problem.len(), |row, _| match start.excluded.get(row) {
            Some(true) => EXCLUDED,
            _ => 1.0,
        }),
        scales: Scales::typical(&problem.reference),
        log_sd: BTreeMap::new(),
        curved: BTreeMap::new(),
    });
    // The coefficients of a kernel are those of its form.
    mode.curved.retain(|component, _| matches!(component, Component::Random(_)));
    mode.scales = mode.scales.raised(&problem.reference);
    let (mut sizes, mut shifts) = (BTreeMap::new(), BTreeMap::new());
    for (effect, shape) in hypothesis.effects() {
        let Some(typical) = space.effects[effect].typical_size else { continue };
        let hint = start.hint.filter(|(of, _)| *of == effect).map(|(_, size)| size);
        let cold = space.effects[effect].starts.get(shape).copied().unwrap_or(typical);
        // Shifts are relative to the shape, so that those of another shape do not apply.
        let is_same = start.hypothesis.is_some_and(|h| h.effects().any(|known| known == (effect, shape)));
        if let Some(known) = mode.shifts.get(&effect).filter(|_| is_same) {
            shifts.insert(effect, *known);
        }
        sizes.insert(effect, hint.or(mode.sizes.get(&effect).copied()).unwrap_or(cold));
    }
    mode.sizes = sizes;
    mode.shifts = shifts;
    let mut log_sd = BTreeMap::new();
    let random = (0..space.random_effects.len()).map(Component::Random);
    let kernels = hypothesis.kernels().map(|(kernel, _)| Component::Kernel(kernel));
    for component in random.chain(kernels) {
        let scale = component.prior(space).scale;
        let cold = libm::log(if matches!(component, Component::Random(_)) { 0.5 * scale } else { scale });
        let warm = mode.log_sd.get(&component).map_or(cold, |log| log.max(cold - 2.0));
        log_sd.insert(component, warm);
    }
    mode.log_sd = log_sd;
    mode
}

/// Returns the logarithm of the mixing density of the weights, relative to weights of 1. With the
/// weights at their mode the mixture is Student's t distribution.
fn log_weight_term(weights: &DVector<f64>) -> f64 {
    let included = || weights.iter().copied().filter(|w| *w != EXCLUDED);
    DEGREES_OF_FREEDOM / 2.0 * (sum_of_logs(included()) + included().map(|w| 1.0 - w).sum::<f64>())
}

/// Returns the weights that maximise the posterior, given the part of each residual that a row
/// shares with no other row.
fn student_weights(at: &ScaleProblem<'_>, point: &ScalePoint) -> DVector<f64> {
    let noise = at.noise(&point.scales);
    let white = point.marginal.white_residual(&point.solution.mean);
    let precision_residual = point.marginal.whitening.whiten_transposed(&white);
    let quantum = noise.quantum_variance();
    DVector::from_fn(at.problem.len(), |row, _| {
        if at.weights[row] == EXCLUDED {
            return EXCLUDED;
        }
        let variance = noise.independent_variance(row);
        let own = (noise.own_variance(row) + quantum) * precision_residual[row];
        student_weight(own * own / (variance + quantum).max(1e-12))
    })
}

/// Returns the weight of a row whose residual has this square, in units of its variance.
fn student_weight(square: f64) -> f64 {
    let weight = (DEGREES_OF_FREEDOM + 1.0) / (DEGREES_OF_FREEDOM + square);
    weight.clamp(WEIGHT_RANGE.0, WEIGHT_RANGE.1)
}

/// Moves constants and sizes to the mean of their posterior, by limited steps. Where a limit holds one back, the others move to
/// their mean given its value: on a ridge they compensate each other.
fn move_coefficients(space: &Space, design: &Design, point: &ScalePoint, mode: &mut Mode) {
    let prior_mean = DVector::from_column_slice(&design.prior_mean);
    let mut mean = &point.solution.mean + &prior_mean;
    let mut covariance: Option<DMatrix<f64>> = None;
    for (i, role) in design.roles.iter().enumerate() {
        let limited = within_limits(space, mode, role, mean[i]);
        if limited != mean[i] {
            let covariance = covariance.get_or_insert_with(|| point.solution.covariance.clone());
            condition(&mut mean, covariance, i, limited);
        }
    }
    for (i, role) in design.roles.iter().enumerate() {
        let value = within_limits(space, mode, role, mean[i]);
        match role {
            Role::Constant(constant) => mode.constants[*constant] = value,
            Role::Size(effect) => {
                mode.sizes.insert(*effect, value);
            }
            Role::Shape(effect, i) => mode.shifts.entry(*effect).or_default()[*i] = value,
            Role::Discrepancy(_) | Role::Variance(_) => {}
        }
    }
    mean -= prior_mean;
    let is_curved = |component: &Component| space.curved_channels.contains(&component.channel(space));
    let coefficients =
        |component: Component| design.columns_of(component).into_iter().map(|i| mean[i]).collect();
    let curved = design.components().into_iter().filter(is_curved);
    mode.curved = curved.map(|component| (component, coefficients(component))).collect();
}

/// Returns the nearest value of a coefficient that one step from the mode may reach.
fn within_limits(space: &Space, mode: &Mode, role: &Role, value: f64) -> f64 {
    match role {
        Role::Constant(constant) => {
            let from = mode.constants[*constant];
            value.clamp(from - MOST_CONSTANT_STEP, from + MOST_CONSTANT_STEP)
        }
        Role::Size(effect) => {
            let prior = &space.effects[*effect];
            let typical = prior.typical_size.unwrap_or(1.0);
            let value = if prior.is_one_sided { value.max(LEAST_SHARE * typical) } else { value };
            let Some(size) = mode.sizes.get(effect) else { return value };
            let most = (FREE_SIZE_SD * typical).max(2.0 * size.abs());
            value.clamp(size - most, size + most)
        }
        Role::Shape(effect, i) => {
            let shift = mode.shifts.get(effect).map_or(0.0, |shifts| shifts[*i]);
            let value = value.clamp(shift - MOST_SHIFT.0, shift + MOST_SHIFT.0);
            value.clamp(-MOST_SHIFT.1, MOST_SHIFT.1)
        }
        Role::Discrepancy(_) | Role::Variance(_) => value,
    }
}

/// Conditions a normal distribution on the value of a coordinate.
fn condition(mean: &mut DVector<f64>, covariance: &mut DMatrix<f64>, at: usize, value: f64) {
    let variance = covariance[(at, at)];
    if variance > 0.0 {
        let shares: Vec<f64> = covariance.column(at).iter().map(|with| with / variance).collect();
        let change = value - mean[at];
        for (i, share) in shares.iter().enumerate() {
            mean[i] += share * change;
            for (j, other) in shares.iter().enumerate() {
                covariance[(i, j)] -= variance * share * other;
            }
        }
    }
    mean[at] = value;
}

impl Fit {
    /// Returns the element of a member of the hypothesis.
    pub(crate) fn element(&self, member: Member) -> Option<Element> {
        self.hypothesis.elements().find(|element| element.member == member)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_problem::{full_hypothesis, problem};

    /// A fit that starts at its own mode stays there, and one that starts beside it returns, although its objective is known.
    #[test]
    fn a_fit_ends_at_its_mode() {
        let (problem, hypothesis) = (problem(12, 0.4), full_hypothesis());
        let fit = Fit::new(&problem, &hypothesis, Start::default()).unwrap();
        let mut beside = fit.clone();
        beside.mode.constants.iter_mut().for_each(|constant| *constant += 0.4);
        beside.mode.scales.log.iter_mut().for_each(|log| *log += 0.7);
        for start in [&fit, &beside] {
            let again = Fit::new(&problem, &hypothesis, Start::at(start, None)).unwrap();
            assert!((again.score - fit.score).abs() < 2.0 * CONVERGED, "{} {}", again.score, fit.score);
            for (constant, known) in again.constants().iter().zip(fit.constants()) {
                assert!((constant - known).abs() < 0.02, "{constant} {known}");
            }
        }
    }

    /// Two coefficients whose sum is known: where one is held back, the other compensates it.
    #[test]
    fn a_limited_step_keeps_to_the_ridge() {
        let mut mean = DVector::from_vec(vec![3.0, -2.0, 7.0]);
        let ridge = [[4.0, -4.0, 0.0], [-4.0, 4.000_1, 0.0], [0.0, 0.0, 1.0]];
        let mut covariance = DMatrix::from_fn(3, 3, |i, j| ridge[i][j]);
        condition(&mut mean, &mut covariance, 0, 0.5);
        assert!((mean[0] - 0.5).abs() < 1e-12 && (mean[1] - 0.5).abs() < 1e-3 && mean[2] == 7.0, "{mean}");
        assert!(covariance[(0, 0)].abs() < 1e-9 && (covariance[(1, 1)] - 1e-4).abs() < 1e-6, "{covariance}");
    }

    /// With the weight at its mode, the log density of the mixture is that of Student's t, up to
    /// a constant.
    #[test]
    fn weights_give_student_density() {
        let nu = DEGREES_OF_FREEDOM;
        let mixture = |z: f64| {
            let w = student_weight(z * z);
            0.5 * libm::log(w) - 0.5 * w * z * z + nu / 2.0 * (libm::log(w) - w + 1.0)
        };
        let student = |z: f64| -(nu + 1.0) / 2.0 * libm::log1p(z * z / nu);
        for z in [0.5, 1.0, 3.0, 10.0] {
            let difference = mixture(z) - mixture(0.0) - student(z);
            assert!(difference.abs() < 1e-9, "{z}: {difference}");
        }
    }
}
