//! Posterior over hypotheses: probabilities, rivals, verdict and intervals.

use std::collections::{BTreeMap, BTreeSet};

use crate::design::Component;
use crate::expected_error::{ExpectedError, expected_error, kernel_curve};
use crate::fit::Fit;
use crate::hypothesis::{Hypothesis, Member};
use crate::leave_out::Linearised;
use crate::problem::Problem;
use crate::quadrature::{log_sum_exp, normal_cdf};
use crate::score::Scores;
use crate::search::{Search, SearchOptions};

/// Probability above which a member of the best hypothesis is reported, with its rivals.
const REPORTED_PROBABILITY: f64 = 0.9;
/// The same threshold for an effect next to a kernel: the basis of a kernel is approximate, and an
/// effect could fit what it leaves.
const REPORTED_NEXT_TO_KERNEL: f64 = 0.99;
/// Probability above which another member is a rival.
const RIVAL_PROBABILITY: f64 = 0.05;

/// Conclusion from a posterior.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No effect is reported, and every effect is smaller than the smallest relevant one.
    None,
    /// No effect is reported, but the data do not exclude all.
    Inconclusive,
    /// All reported members are effects without rivals.
    Attributed,
    /// A reported effect has a rival.
    Ambiguous,
    /// Unnamed structure is reported.
    Unattributed,
}

impl Verdict {
    /// Returns its word in reports.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Inconclusive => "inconclusive",
            Self::Attributed => "attributed",
            Self::Ambiguous => "ambiguous",
            Self::Unattributed => "unattributed",
        }
    }
}

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
    /// Conclusion.
    pub verdict: Verdict,
    /// Reported members.
    pub reported: Vec<Reported>,
    /// Expected error of a new session.
    pub expected_error: Option<ExpectedError>,
    /// Number of fits.
    pub fit_count: usize,
}

/// Searches the hypotheses of a problem; `None` if no reading of its forward model is finite. The
/// seed is that of the interval of the expected error.
pub fn infer(problem: &Problem, options: SearchOptions, seed: u64) -> Option<Posterior> {
    let mut search = Search::new(problem, options);
    let window = search.run();
    let best = window.first()?;
    let total = log_sum_exp(&window.iter().map(|fit| fit.score).collect::<Vec<f64>>());
    let probabilities: Vec<f64> = window.iter().map(|fit| libm::exp(fit.score - total)).collect();
    let reported = reported(&window, &probabilities);
    let is_kernel = |member: Member| matches!(member, Member::Kernel(_));
    let verdict = if reported.iter().any(|r| is_kernel(r.member)) {
        Verdict::Unattributed
    } else if reported.iter().any(|r| !r.rivals.is_empty()) {
        Verdict::Ambiguous
    } else if !reported.is_empty() {
        Verdict::Attributed
    } else if excludes_all(problem, best) {
        Verdict::None
    } else {
        Verdict::Inconclusive
    };
    let expected_error = expected_error(problem, &window, &probabilities, seed);
    let fit_count = search.fit_count;
    Some(Posterior { window, probabilities, verdict, reported, expected_error, fit_count })
}

/// Returns whether the limits of every effect that is not in a fit are below its smallest relevant
/// size.
fn excludes_all(problem: &Problem, fit: &Fit) -> bool {
    let additions = Scores::new(problem, fit).map_or_else(Vec::new, |scores| scores.additions(None));
    // Without any score the data determine nothing.
    fit.hypothesis.is_empty()
        && !additions.is_empty()
        && additions.iter().all(|addition| addition.limit < 1.0)
}

/// Returns the members of the best hypothesis that are probable, or that have only rivals instead.
fn reported(window: &[Fit], probabilities: &[f64]) -> Vec<Reported> {
    let Some(best) = window.first().map(|fit| &fit.hypothesis) else { return Vec::new() };
    let hypotheses: Vec<(&Hypothesis, f64)> =
        window.iter().map(|fit| &fit.hypothesis).zip(probabilities.iter().copied()).collect();
    let has_kernel = best.kernels().next().is_some();
    let mut reported = Vec::new();
    for member in best.members() {
        let mut places: BTreeMap<Member, f64> = BTreeMap::new();
        for (hypothesis, probability) in hypotheses.iter().filter(|(h, _)| !h.contains(member)) {
            for other in hypothesis.members().filter(|other| !best.contains(*other)) {
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
        let probability = hypotheses.iter().filter(|(h, _)| h.contains(member)).map(|(_, p)| p).sum();
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
        self.containing(member).map(|(_, probability)| probability).sum()
    }

    fn containing(&self, member: Member) -> impl Iterator<Item = (&Fit, f64)> {
        let fits = self.window.iter().zip(self.probabilities.iter().copied());
        fits.filter(move |(fit, _)| fit.hypothesis.contains(member))
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

    /// Returns the function of a kernel at each row, in the unit of its channel, under the best
    /// hypothesis that contains it.
    pub fn curve(&self, problem: &Problem, kernel: usize) -> Option<Vec<f64>> {
        let (fit, _) = self.containing(Member::Kernel(kernel)).next()?;
        let linearised = Linearised::new(problem, fit)?;
        let columns = linearised.design.columns_of(Component::Kernel(kernel));
        Some(kernel_curve(problem, fit, kernel, &columns, &linearised.point.solution.mean))
    }
}
