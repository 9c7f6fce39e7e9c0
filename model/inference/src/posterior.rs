//! Posterior over hypotheses: probabilities, rivals, verdict and intervals.

use std::collections::{BTreeMap, BTreeSet};

use crate::design::Component;
use crate::expected_error::{ExpectedError, LeftOutErrors};
use crate::fit::{Fit, Start};
use crate::hypothesis::{Hypothesis, Member};
use crate::leave_out::Linearised;
use crate::outliers::Outliers;
use crate::problem::Problem;
use crate::quadrature::{log_sum_exp, normal_cdf};
use crate::score::{Scores, SizeLimits};
use crate::search::{Search, SearchOptions};
use crate::session_view::kernel_curve;

/// Probability above which a member of the best hypothesis is reported, with its rivals.
pub const REPORTED_PROBABILITY: f64 = 0.9;
/// The same threshold for an effect next to a kernel: the basis of a kernel is approximate, and an
/// effect could fit what it leaves.
const REPORTED_NEXT_TO_KERNEL: f64 = 0.99;
/// Probability above which another member is a rival.
const RIVAL_PROBABILITY: f64 = 0.05;

/// Most searches that are repeated without suspected series.
const MOST_EXCLUSIONS: usize = 3;

/// A reported member of the best hypothesis.
#[derive(Clone, Debug, PartialEq)]
pub struct Reported {
    /// The member.
    pub member: Member,
    /// Probability of the hypotheses that contain it.
    pub probability: f64,
    /// Members that may take its place, with their probabilities, most probable first.
    pub rivals: Vec<(Member, f64)>,
}

/// Size of an effect, given that it acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeEstimate {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
    /// 95 % interval.
    pub interval: [f64; 2],
}

/// Posterior over the hypotheses of a problem.
#[derive(Clone, Debug)]
pub struct Posterior {
    /// Fits in Occam's window, best first.
    pub window: Vec<Fit>,
    /// Probability of each hypothesis.
    pub probabilities: Vec<f64>,
    /// Fit of the baseline alone.
    pub baseline: Fit,
    /// Whether each row was excluded from the fits, as part of a series with a suspected gross error;
    /// empty if none was.
    pub excluded: Vec<bool>,
    /// Reported members.
    pub reported: Vec<Reported>,
    /// Fits of the best hypothesis without one of its members each.
    reductions: BTreeMap<Member, Fit>,
    /// Effects that are not reported and change some reading that the best hypothesis does not absorb.
    pub candidates: Vec<Candidate>,
    /// Series and readings with gross errors under the best hypothesis.
    pub outliers: Outliers,
    /// Expected error of a new session.
    pub expected_error: Option<ExpectedError>,
    /// Expected error of the baseline alone, in the unit of the readings.
    pub baseline_error: Option<f64>,
    /// Number of fits.
    pub fit_count: usize,
}

/// Searches the hypotheses of a problem; `None` if no reading of its forward model is finite. The
/// seed is that of the interval of the expected error.
pub fn infer(problem: &Problem, options: SearchOptions, seed: u64) -> Option<Posterior> {
    let mut excluded: Vec<bool> = Vec::new();
    let mut search = Search::new(problem, options, &excluded);
    let mut window = search.run();
    let mut fits = search.fit_count;
    for _ in 0..MOST_EXCLUSIONS {
        let suspected = Outliers::suspected(problem, window.first()?);
        let is_new = suspected
            .iter()
            .enumerate()
            .any(|(row, out)| *out != excluded.get(row).copied().unwrap_or(false));
        if !is_new {
            break;
        }
        excluded = suspected;
        search = Search::new(problem, options, &excluded);
        window = search.run();
        fits += search.fit_count;
    }
    let best = window.first()?;
    let total = log_sum_exp(&window.iter().map(|fit| fit.score).collect::<Vec<f64>>());
    let probabilities: Vec<f64> = window.iter().map(|fit| libm::exp(fit.score - total)).collect();
    let reported = reported(problem, &window, &probabilities);
    let reduction = |member| Some((member, search.fit_of(&best.hypothesis.without(member))?.clone()));
    let reductions = best.hypothesis.members().filter_map(reduction).collect();
    // The baseline alone is a start for other hypotheses, which are scored later.
    let is_baseline = options.members == 0;
    let candidates = if is_baseline { Vec::new() } else { candidates(problem, best, &reported) };
    let mut outliers = Outliers::new(problem, best);
    outliers.add_gross_errors(problem, best, |member| probability(&window, &probabilities, member));
    let left_out = LeftOutErrors::new(problem, &window, &probabilities, &outliers);
    let expected_error = left_out.map(|errors| errors.expected_error(seed));
    window.iter_mut().for_each(|fit| fit.widen_sizes(problem));
    let (fit_count, baseline) = (fits, search.baseline()?);
    let baseline_error = if is_baseline {
        expected_error.map(|error| error.value)
    } else {
        let left_out = LeftOutErrors::new(problem, std::slice::from_ref(&baseline), &[1.0], &outliers);
        left_out.map(|errors| errors.value())
    };
    Some(Posterior {
        window,
        probabilities,
        baseline,
        excluded,
        reported,
        reductions,
        candidates,
        outliers,
        expected_error,
        baseline_error,
        fit_count,
    })
}

/// Returns the fits of a window that contain a member, with their probabilities.
fn containing<'a>(
    window: &'a [Fit],
    probabilities: &'a [f64],
    member: Member,
) -> impl Iterator<Item = (&'a Fit, f64)> {
    let fits = window.iter().zip(probabilities.iter().copied());
    fits.filter(move |(fit, _)| fit.hypothesis.contains(member))
}

/// Returns the probability of a member.
fn probability(window: &[Fit], probabilities: &[f64], member: Member) -> f64 {
    // A sum of rounded probabilities may exceed 1.
    containing(window, probabilities, member).map(|(_, probability)| probability).sum::<f64>().min(1.0)
}

/// An effect that is not reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Index of the effect.
    pub effect: usize,
    /// Index of the shape with the widest limits.
    pub shape: usize,
    /// Logarithm of the posterior odds of adding it to the best hypothesis, to first order.
    pub log_odds: f64,
    /// Limits of its size for this shape.
    pub size: SizeLimits,
}

impl Candidate {
    /// Returns whether the data would report the effect if it had its smallest relevant size.
    pub fn is_detectable(&self) -> bool {
        self.size.expected_gain > libm::log(REPORTED_PROBABILITY / (1.0 - REPORTED_PROBABILITY))
    }
}

/// Returns the effects that could be added to a fit, and those of its members that are not reported, in
/// the order of the space.
fn candidates(problem: &Problem, fit: &Fit, reported: &[Reported]) -> Vec<Candidate> {
    let is_effect = |member| matches!(member, Member::Effect(_));
    let Some(scores) = Scores::of(problem, fit, is_effect) else { return Vec::new() };
    let mut additions = scores.additions(None);
    let is_reported = |member: &Member| reported.iter().any(|r| r.member == *member);
    for member in fit.hypothesis.members().filter(|member| !is_reported(member)) {
        let alone = scores.additions(Some(member)).into_iter();
        additions.extend(alone.filter(|addition| addition.element.member == member));
    }
    let mut candidates: BTreeMap<usize, Candidate> = BTreeMap::new();
    for addition in additions {
        let (Member::Effect(effect), Some(size)) = (addition.element.member, addition.size) else { continue };
        if size.is_absorbed() {
            continue;
        }
        let new = Candidate { effect, shape: addition.element.form, log_odds: addition.gain, size };
        let known = candidates.entry(effect).or_insert(new);
        let log_odds = known.log_odds.max(new.log_odds);
        if new.size.largest_change() > known.size.largest_change() {
            *known = new;
        }
        known.log_odds = log_odds;
    }
    candidates.into_values().collect()
}

/// Returns the members of the best hypothesis that are probable, or that have only rivals instead.
fn reported(problem: &Problem, window: &[Fit], probabilities: &[f64]) -> Vec<Reported> {
    let Some(best) = window.first().map(|fit| &fit.hypothesis) else { return Vec::new() };
    let hypotheses: Vec<(&Hypothesis, f64)> =
        window.iter().map(|fit| &fit.hypothesis).zip(probabilities.iter().copied()).collect();
    // Noise is in the sum of all hypotheses, but it is neither reported nor a rival.
    let is_noise = |member: &Member| match member {
        Member::Kernel(kernel) => problem.space.kernels[*kernel].noise_probability.is_some(),
        Member::Effect(_) => false,
    };
    let has_kernel = best.members().any(|m| matches!(m, Member::Kernel(_)) && !is_noise(&m));
    let mut reported = Vec::new();
    for member in best.members().filter(|member| !is_noise(member)) {
        let mut places: BTreeMap<Member, f64> = BTreeMap::new();
        for (hypothesis, probability) in hypotheses.iter().filter(|(h, _)| !h.contains(member)) {
            for other in hypothesis.members().filter(|other| !best.contains(*other) && !is_noise(other)) {
                *places.entry(other).or_insert(0.0) += probability;
            }
        }
        places.retain(|_, probability| *probability > RIVAL_PROBABILITY);
        let in_place = |h: &Hypothesis| h.contains(member) || places.keys().any(|other| h.contains(*other));
        let explained: f64 = hypotheses.iter().filter(|(h, _)| in_place(h)).map(|(_, p)| p).sum();
        let is_effect = matches!(member, Member::Effect(_));
        let least = if is_effect && has_kernel { REPORTED_NEXT_TO_KERNEL } else { REPORTED_PROBABILITY };
        if explained < least {
            continue;
        }
        let inside = hypotheses.iter().filter(|(h, _)| h.contains(member)).map(|(_, p)| p);
        let probability = inside.sum::<f64>().min(1.0);
        let mut rivals: Vec<(Member, f64)> = places.into_iter().collect();
        rivals.sort_by(|a, b| b.1.total_cmp(&a.1));
        reported.push(Reported { member, probability, rivals });
    }
    reported
}

impl Posterior {
    /// Returns the probability of each member of a hypothesis in the window, most probable first.
    pub fn members(&self) -> Vec<(Member, f64)> {
        let all: BTreeSet<Member> = self.window.iter().flat_map(|fit| fit.hypothesis.members()).collect();
        let mut members: Vec<(Member, f64)> =
            all.into_iter().map(|member| (member, self.probability(member))).collect();
        members.sort_by(|a, b| b.1.total_cmp(&a.1));
        members
    }

    /// Returns the probability of a member.
    pub fn probability(&self, member: Member) -> f64 {
        probability(&self.window, &self.probabilities, member)
    }

    /// Returns the probability of the hypotheses with a member that meets a condition.
    pub fn probability_of_any(&self, is_meant: impl Fn(Member) -> bool) -> f64 {
        let fits = self.window.iter().zip(&self.probabilities);
        fits.filter(|(fit, _)| fit.hypothesis.members().any(&is_meant)).map(|(_, p)| p).sum::<f64>().min(1.0)
    }

    fn containing(&self, member: Member) -> impl Iterator<Item = (&Fit, f64)> {
        containing(&self.window, &self.probabilities, member)
    }

    /// Returns the size of an effect, given that it acts: a mixture over the window. `None` for an effect
    /// without a size, or outside the window.
    pub fn size(&self, effect: usize) -> Option<SizeEstimate> {
        let parts: Vec<(f64, f64, f64)> = self
            .containing(Member::Effect(effect))
            .filter_map(|(fit, p)| fit.sizes.get(&effect).map(|size| (p, size.mean, size.sd.max(1e-300))))
            .collect();
        let total: f64 = parts.iter().map(|(p, ..)| p).sum();
        if total <= 0.0 {
            return None;
        }
        let mean = parts.iter().map(|(p, m, _)| p * m).sum::<f64>() / total;
        let square = parts.iter().map(|(p, m, s)| p * (s * s + (m - mean).powi(2))).sum::<f64>() / total;
        let quantile = |share: f64| {
            let reach = 8.0 * square.sqrt();
            let (mut low, mut high) = (mean - reach, mean + reach);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                let below: f64 = parts.iter().map(|(p, m, s)| p * normal_cdf((middle - m) / s)).sum();
                if below < share * total { low = middle } else { high = middle }
            }
            0.5 * (low + high)
        };
        Some(SizeEstimate { mean, sd: square.sqrt(), interval: [quantile(0.025), quantile(0.975)] })
    }

    /// Returns the fit of the best hypothesis without a member.
    pub fn best_without(&self, member: Member) -> Option<&Fit> {
        self.reductions.get(&member)
    }

    /// Returns the function of a kernel at each row, in the unit of its channel, under the best
    /// hypothesis that contains it.
    pub fn curve(&self, problem: &Problem, kernel: usize) -> Option<Vec<f64>> {
        let (fit, _) = self.containing(Member::Kernel(kernel)).next()?;
        let linearised = Linearised::new(problem, fit)?;
        let columns = linearised.design.columns_of(Component::Kernel(kernel));
        Some(kernel_curve(problem, fit, kernel, &columns, &linearised.point.solution.mean))
    }
}

/// Fits the best additions of some effects to a fit, one at a time, by their first-order scores; best
/// first, and at most one form of each effect.
pub fn best_additions(problem: &Problem, fit: &Fit, effects: &[usize], most: usize) -> Vec<Fit> {
    let is_wanted = |member| matches!(member, Member::Effect(effect) if effects.contains(&effect));
    let scores = Scores::of(problem, fit, is_wanted);
    let additions = scores.map_or_else(Vec::new, |scores| scores.additions(None));
    let mut tried: BTreeSet<Member> = BTreeSet::new();
    let mut fits = Vec::new();
    for addition in additions {
        let member = addition.element.member;
        if tried.len() < most && tried.insert(member) {
            fits.extend(Fit::new(problem, &addition.hypothesis, Start::at(fit, addition.hint)));
        }
    }
    fits.sort_by(|a, b| b.score.total_cmp(&a.score));
    fits
}

impl Fit {
    /// Fits its hypothesis without a member, from its own mode; `None` if the readings are not finite there.
    pub fn without(&self, problem: &Problem, member: Member) -> Option<Self> {
        Self::new(problem, &self.hypothesis.without(member), Start::at(self, None))
    }

    /// Fits a hypothesis from scratch without the rows that are `excluded`, a list that may be empty;
    /// `None` if its readings are not finite at any mode.
    pub fn of_hypothesis(problem: &Problem, hypothesis: &Hypothesis, excluded: &[bool]) -> Option<Self> {
        Self::new(problem, hypothesis, Start { is_final: true, excluded, ..Start::default() })
    }
}
