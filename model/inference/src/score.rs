//! First-order scores of all elements that could be added to a fit, or take the place of a member.
//!
//! For the residual `r` with precision `P` (the coefficients of the fit integrated), a column `x`
//! has the score `u = x'Pr` and the information `S = x'Px`. A size with prior variance `v` then
//! gains `-ln(1 + vS)/2 + v u^2 / (2 (1 + vS))`. The columns of a kernel have a vector `u` and a matrix
//! `S`, whose eigenvalues give the gain for every standard deviation.

use nalgebra::{DMatrix, DVector};

use crate::candidates::{Candidate, Candidates, Pair};
use crate::design::{AddedColumns, Component, Design, Role};
use crate::fit::Fit;
use crate::half_t::HalfT;
use crate::hypothesis::{Element, Hypothesis, Member};
use crate::problem::Problem;
use crate::quadrature::{Mixture, largest, log_normal_cdf, log_sum_exp};
use crate::scales::ScaleProblem;
use crate::variance_gain::VarianceGain;

/// Prior standard deviation of the sizes of a fit for scores, in typical sizes: nearly free.
const FREE_SIZE_SD: f64 = 100.0;
/// Share of its squared norm below which what the fit leaves of a column is rounding. Above, the noise decides whether it shows.
const ROUNDING_SHARE: f64 = 1e-9;
/// Smallest start of a one-sided size, as a share of the typical one.
const LEAST_START: f64 = 0.05;

/// Two-sided 95 % quantile of the standard normal distribution.
const NORMAL_95: f64 = 1.96;

/// An element that could be added, with its expected score.
#[derive(Clone, Debug)]
pub(crate) struct Addition {
    /// Expected `ln p(y | H) + ln p(H)` of the hypothesis minus `ln p(y | H0)` of the fit.
    pub(crate) score: f64,
    /// Expected change of the score by this element.
    pub(crate) gain: f64,
    pub(crate) hypothesis: Hypothesis,
    /// The first one of a pair.
    pub(crate) element: Element,
    /// Expected size, for an effect that has one.
    pub(crate) hint: Option<(usize, f64)>,
    /// What the data say about the size of the effect; `None` for a kernel.
    pub(crate) size: Option<SizeLimits>,
}

/// First-order posterior of the size of an effect in addition to a fit, if it acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeLimits {
    /// Size that the data prefer, with a flat prior.
    pub size: f64,
    /// Standard deviation of it.
    pub sd: f64,
    /// Smallest relevant size: the one that changes a reading by its smallest relevant change.
    pub relevant: f64,
    /// Expected gain of the score if the effect had its smallest relevant size.
    pub expected_gain: f64,
    /// Share of the squared norm of its column that the fit leaves.
    pub share: f64,
}

/// Share below which the fit absorbs an effect: limits of its size would be those of the linearisation.
const ABSORBED_SHARE: f64 = 2e-3;

impl SizeLimits {
    /// Returns whether the fit has nearly the same column, so that the table sets no limits.
    pub fn is_absorbed(&self) -> bool {
        self.share < ABSORBED_SHARE
    }

    /// Returns the 95 % interval of the size.
    pub fn interval(&self) -> [f64; 2] {
        [self.size - NORMAL_95 * self.sd, self.size + NORMAL_95 * self.sd]
    }

    /// Returns the largest change of a reading that the interval allows, relative to the smallest
    /// relevant one.
    pub fn largest_change(&self) -> f64 {
        let [low, high] = self.interval();
        low.abs().max(high.abs()) / self.relevant
    }

    /// Returns whether every size in the interval is smaller than the smallest relevant one.
    pub fn is_excluded(&self) -> bool {
        self.largest_change() < 1.0
    }
}

/// All candidates at the mode of a fit.
pub(crate) struct Scores<'a> {
    problem: &'a Problem,
    hypothesis: Hypothesis,
    design: Design,
    gram: DMatrix<f64>,
    moment: DVector<f64>,
    variances: Vec<f64>,
    candidates: Vec<Candidate>,
    pairs: Vec<Pair>,
    /// `A'V^-1 x` of their columns.
    cross: DMatrix<f64>,
    cauchy: Mixture,
}

/// First-order result for an element.
struct EffectGain {
    /// Gain of the log evidence.
    gain: f64,
    /// Expected size.
    size: Option<f64>,
    limits: SizeLimits,
}

impl<'a> Scores<'a> {
    /// Prepares the candidates; `None` if the fit's design is not finite.
    pub(crate) fn new(problem: &'a Problem, fit: &Fit) -> Option<Self> {
        Self::of(problem, fit, |_| true)
    }

    /// Prepares some of them.
    pub(crate) fn of(problem: &'a Problem, fit: &Fit, is_candidate: impl Fn(Member) -> bool) -> Option<Self> {
        let space = &problem.space;
        let free = |effect: usize| (FREE_SIZE_SD * space.effects[effect].typical_size.unwrap_or(1.0)).powi(2);
        let sizes = fit.hypothesis.effects().map(|(effect, _)| (effect, free(effect))).collect();
        let design = Design::new(problem, &fit.hypothesis, &fit.mode)?;
        let scale_problem =
            ScaleProblem { problem, design: &design, weights: &fit.mode.weights, size_variances: &sizes };
        let point = scale_problem.at(fit.mode.scales, &fit.mode.log_sd)?;
        let (channels, joint) = (&design.channels, &space.joint_channels);
        let mut collected = Candidates::new(&point.marginal, channels, &problem.rows.direction, joint);
        let added = AddedColumns::new(problem, &fit.hypothesis, &fit.mode);
        let effects = (0..space.effects.len()).filter(|index| is_candidate(Member::Effect(*index)));
        for index in effects {
            for (form, column) in added.of_effect(index) {
                let element = Element { member: Member::Effect(index), form };
                let relevance = relevance(&column, &problem.rows.relevant[index]);
                collected.add_effect(element, relevance, &column);
            }
        }
        for group in problem.kernels_of_bases() {
            let kernels = group.kernels.iter().filter(|kernel| is_candidate(Member::Kernel(**kernel)));
            for (form, basis) in group.bases.iter().enumerate() {
                let element = |kernel: &usize| {
                    (Element { member: Member::Kernel(*kernel), form }, space.kernels[*kernel].channel)
                };
                collected.add_kernels(kernels.clone().map(element), basis);
            }
        }
        let (candidates, pairs, cross) = collected.finish();
        let (gram, moment) = (point.marginal.gram.clone(), point.marginal.moment.clone());
        let variances = point.variances;
        let cauchy = Mixture::cauchy();
        let hypothesis = fit.hypothesis.clone();
        Some(Self { problem, hypothesis, design, gram, moment, variances, candidates, pairs, cross, cauchy })
    }

    /// Returns the additions, best first; with `removed`, those that take the place of a member,
    /// including its own elements.
    pub(crate) fn additions(&self, removed: Option<Member>) -> Vec<Addition> {
        let rest = removed.map_or_else(|| self.hypothesis.clone(), |member| self.hypothesis.without(member));
        let is_kept = |role: &Role| match (role, removed) {
            (
                Role::Size(effect) | Role::Shape(effect, _) | Role::Discrepancy(effect),
                Some(Member::Effect(gone)),
            ) => *effect != gone,
            (Role::Variance(Component::Kernel(kernel)), Some(Member::Kernel(gone))) => *kernel != gone,
            _ => true,
        };
        let kept: Vec<usize> =
            (0..self.design.roles.len()).filter(|i| is_kept(&self.design.roles[*i])).collect();
        let sd = DVector::from_iterator(kept.len(), kept.iter().map(|i| self.variances[*i].sqrt()));
        let mut scaled = self.gram.select_rows(&kept).select_columns(&kept);
        for i in 0..kept.len() {
            for j in 0..kept.len() {
                scaled[(i, j)] *= sd[i] * sd[j];
            }
            scaled[(i, i)] += 1.0;
        }
        let Some(factor) = scaled.cholesky().map(nalgebra::Cholesky::unpack) else { return Vec::new() };
        let mut root = DMatrix::from_diagonal(&sd);
        factor.solve_lower_triangular_mut(&mut root);
        let moment = &root * self.moment.select_rows(&kept);
        let cross_of_all = &root * self.cross.select_rows(&kept);
        let prior = rest.log_prior_odds(&self.problem.space);
        let mut additions: Vec<Addition> = self
            .candidates
            .iter()
            .filter(|candidate| !rest.contains(candidate.element.member))
            .filter_map(|candidate| {
                let cross = cross_of_all.columns(candidate.columns.start, candidate.columns.len());
                let information = &candidate.gram - cross.tr_mul(&cross);
                let score = &candidate.moment - cross.tr_mul(&moment);
                let element = candidate.element;
                let odds = rest.log_prior_odds_of(&self.problem.space, element);
                let (gain, hint, size) = match element.member {
                    Member::Effect(effect) => {
                        let found = self.effect_gain(effect, candidate, &information, &score)?;
                        let mut limits = found.limits;
                        limits.expected_gain += odds;
                        (found.gain, found.size.map(|size| (effect, size)), Some(limits))
                    }
                    Member::Kernel(kernel) => {
                        let prior = HalfT::cauchy(self.problem.space.kernels[kernel].scale);
                        (VarianceGain::new(information, &score).integral(prior), None, None)
                    }
                };
                Some(Addition {
                    score: gain + prior + odds,
                    gain: gain + odds,
                    hypothesis: rest.with(element),
                    element,
                    hint,
                    size,
                })
            })
            .collect();
        if removed.is_none() {
            let pairs = self.pairs.iter().filter_map(|pair| self.pair(pair, prior, &cross_of_all, &moment));
            additions.extend(pairs);
        }
        additions.sort_by(|a, b| b.score.total_cmp(&a.score));
        additions
    }

    /// Returns the addition of a pair to a fit of log prior odds `prior`, given `A'V^-1 x` of all candidates and `A'V^-1 r`, both
    /// multiplied by the root of the posterior covariance.
    fn pair(&self, pair: &Pair, prior: f64, cross: &DMatrix<f64>, moment: &DVector<f64>) -> Option<Addition> {
        let both = pair.places.map(|place| &self.candidates[place]);
        let [first, second] = both.map(|candidate| candidate.element);
        if self.hypothesis.contains(first.member) || self.hypothesis.contains(second.member) {
            return None;
        }
        let Member::Kernel(kernel) = first.member else { return None };
        let cross = cross.select_columns(&both.map(|candidate| candidate.columns.start));
        let [a, b] = both.map(|candidate| (candidate.gram[(0, 0)], candidate.moment[0]));
        let gram = DMatrix::from_row_slice(2, 2, &[a.0, pair.between, pair.between, b.0]);
        let information = gram - cross.tr_mul(&cross);
        let score = DVector::from_column_slice(&[a.1, b.1]) - cross.tr_mul(moment);
        let hypothesis = self.hypothesis.with(first).with(second);
        let odds = hypothesis.log_prior_odds(&self.problem.space) - prior;
        let scale = HalfT::cauchy(self.problem.space.kernels[kernel].scale);
        let gain = VarianceGain::new(information, &score).integral(scale) + odds;
        Some(Addition { score: gain + prior, gain, hypothesis, element: first, hint: None, size: None })
    }

    /// Returns the gain of an effect; `None` if the fit has the same column.
    fn effect_gain(
        &self,
        effect: usize,
        candidate: &Candidate,
        information: &DMatrix<f64>,
        score: &DVector<f64>,
    ) -> Option<EffectGain> {
        let (s, u) = (information[(0, 0)], score[0]);
        if s < ROUNDING_SHARE * candidate.gram[(0, 0)] {
            return None;
        }
        let prior = &self.problem.space.effects[effect];
        let relevant = 1.0 / candidate.relevance.max(1e-300);
        let share = s / candidate.gram[(0, 0)];
        let mut limits = SizeLimits { size: u / s, sd: 1.0 / s.sqrt(), relevant, expected_gain: 0.0, share };
        let Some(typical) = prior.typical_size else {
            // The whole effect has size 1; if that is irrelevant, the data need not exclude it.
            if limits.relevant > 1.0 {
                (limits.size, limits.sd) = (limits.size.clamp(0.0, 1.0), 0.0);
            }
            limits.expected_gain = 0.5 * s;
            return Some(EffectGain { gain: u - 0.5 * s, size: None, limits });
        };
        let (gain, size) = self.size_gain(typical, prior.is_one_sided, u, s);
        limits.expected_gain = self.size_gain(typical, prior.is_one_sided, s * limits.relevant, s).0;
        let size = if prior.is_one_sided { size.max(LEAST_START * typical) } else { size };
        Some(EffectGain { gain, size: Some(size), limits })
    }

    /// Returns the gain of the log evidence by a size with score `u` and information `s`, and the
    /// expected size.
    fn size_gain(&self, typical: f64, is_one_sided: bool, u: f64, s: f64) -> (f64, f64) {
        let variances: Vec<f64> = self.cauchy.nodes.iter().map(|node| node * typical * typical).collect();
        let terms: Vec<f64> = variances
            .iter()
            .zip(&self.cauchy.log_weights)
            .map(|(v, w)| w - 0.5 * libm::log1p(v * s) + 0.5 * u * u * v / (1.0 + v * s))
            .collect();
        let precision = s + 1.0 / variances[largest(&terms)];
        let (mut gain, size) = (log_sum_exp(&terms), u / precision);
        if is_one_sided {
            gain += libm::log(2.0) + log_normal_cdf(size * precision.sqrt());
        }
        (gain, size)
    }
}

/// Returns the largest change of a reading, relative to the smallest relevant one.
fn relevance(column: &DVector<f64>, relevant: &[f64]) -> f64 {
    column.iter().zip(relevant).map(|(x, least)| x.abs() / least).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_problem::{fitted, problem};

    /// The expected score of a small linear effect is close to that of its fit. A large one gains more
    /// than expected, since the noise then shrinks.
    #[test]
    fn first_order_score_predicts_the_fit() {
        let problem = problem(12, 0.02);
        let (null, ..) = fitted(&problem, &Hypothesis::default());
        let additions = Scores::new(&problem, &null).unwrap().additions(None);
        let offset = additions.iter().find(|a| a.element.member == Member::Effect(0)).unwrap();
        let (fit, ..) = fitted(&problem, &offset.hypothesis);
        let expected = null.log_evidence + offset.score;
        assert!((expected - fit.score).abs() < 1.0, "{expected} {}", fit.score);
    }
}
