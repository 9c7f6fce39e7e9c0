//! Search of the hypotheses with the highest posterior probability.
//!
//! 1. Start from the best hypotheses of a search on some of the readings, if there are many. Otherwise start from nothing, and
//!    from the usual effects of the space, thinned out: effects that explain something only together are invisible one by one.
//! 2. Expand the best hypothesis that has not been expanded, within 3 nats of the best: score every
//!    addition to first order, fit the best few, every removal, and the best exchanges. After a number of expansions only the
//!    best hypothesis is expanded.
//! 3. Fit the hypotheses near the best again from their own modes, and the best one without each member.

use std::collections::{BTreeMap, BTreeSet};

use crate::design::Component;
use crate::fit::{Fit, Start};
use crate::hypothesis::{Element, Hypothesis, Member};
use crate::noise::EXCLUDED;
use crate::problem::Problem;
use crate::score::{Addition, Scores};
use crate::thinning::Thinned;

/// Extent of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchOptions {
    /// Occam's window: hypotheses further below the best one, in nats, are ignored.
    pub window: f64,
    /// Expansions after which only the best hypothesis is expanded.
    pub expansions: usize,
    /// Effects that are fitted in an expansion; half as many kernels are.
    pub width: usize,
    /// Most members of a hypothesis, not counting gross errors, and most gross errors that one expansion adds.
    pub members: usize,
    /// Number of readings above which a search starts on about so many of them.
    pub thinned_above: usize,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self { window: 7.0, expansions: 6, width: 6, members: 8, thinned_above: 4000 }
    }
}

impl SearchOptions {
    /// Returns the extent of a search that fits only the hypothesis without members.
    pub fn baseline() -> Self {
        Self { members: 0, ..Self::default() }
    }
}

/// Rows above which first-order scores are trusted more, and fewer hypotheses are fitted.
const LARGE_TABLE: usize = 1000;
/// Loss in nats up to which a usual effect is removed at the start.
const THINNING_LOSS: f64 = 1.0;
/// Forms of a member that are fitted in an expansion.
const MOST_FORMS: usize = 8;
/// Exchanges that are fitted for each member.
const EXCHANGES: usize = 4;
/// Largest number of expansions.
const MOST_EXPANSIONS: usize = 24;
/// Hypotheses near the best one that are fitted again.
const MOST_POLISHED: usize = 6;

/// What a search fits: distances in nats of scores, and how much it tries.
struct Selectivity {
    /// Below the best addition.
    addition: f64,
    /// Gain over the fit above which an addition is fitted in any case.
    certain: f64,
    /// Below the best addition, for another form of a fitted effect.
    form: f64,
    /// Below the best exchange.
    exchange: f64,
    /// Loss by the removal of a member, or by its exchange.
    loss: f64,
    /// First-order loss of an addition against the fit.
    added_loss: f64,
    /// Below the best fit, for an expansion.
    expansion: f64,
    /// Below the best fit, for another fit from its own mode.
    polish: f64,
    /// Whether an expansion also tries additions by the noise of repeated readings, exchanges and removals.
    is_thorough: bool,
}

impl Selectivity {
    fn of_rows(rows: usize) -> Self {
        let small = Self {
            addition: 25.0,
            certain: 60.0,
            form: 4.0,
            exchange: f64::INFINITY,
            loss: f64::INFINITY,
            added_loss: 5.0,
            expansion: 3.0,
            polish: 6.0,
            is_thorough: true,
        };
        if rows > LARGE_TABLE {
            Self { addition: 8.0, certain: f64::INFINITY, form: 2.0, exchange: 6.0, loss: 15.0, ..small }
        } else {
            small
        }
    }

    /// Returns that of a search that continues one on some of the readings, which was thorough: only additions to the best
    /// hypothesis that gain on all readings follow.
    fn continued(rows: usize) -> Self {
        Self { added_loss: 0.0, expansion: 0.0, polish: 3.0, is_thorough: false, ..Self::of_rows(rows) }
    }
}

/// Fitted hypotheses of a problem.
pub(crate) struct Search<'a> {
    problem: &'a Problem,
    options: SearchOptions,
    selectivity: Selectivity,
    fits: BTreeMap<Hypothesis, Fit>,
    failed: BTreeSet<Hypothesis>,
    /// Score of each hypothesis after the last fit from its own mode with every autoregression.
    polished: BTreeMap<Hypothesis, f64>,
    /// Score of each best hypothesis when those without one of its members were fitted from its mode.
    reduced: BTreeMap<Hypothesis, f64>,
    excluded: &'a [bool],
    pub(crate) fit_count: usize,
}

impl<'a> Search<'a> {
    /// Returns a search without the rows that are `excluded`, a list that may be empty.
    pub(crate) fn new(problem: &'a Problem, options: SearchOptions, excluded: &'a [bool]) -> Self {
        let selectivity = Selectivity::of_rows(problem.len());
        Self {
            problem,
            options,
            selectivity,
            fits: BTreeMap::new(),
            failed: BTreeSet::new(),
            polished: BTreeMap::new(),
            reduced: BTreeMap::new(),
            excluded,
            fit_count: 0,
        }
    }

    /// Returns the fits within the window, best first; empty if no hypothesis can be fitted.
    pub(crate) fn run(&mut self) -> Vec<Fit> {
        let is_continued = self.continue_from_thinned();
        self.fit(&Hypothesis::default(), Start { excluded: self.excluded, ..Start::default() });
        if self.options.members == 0 {
            return self.fits.values().cloned().collect();
        }
        if !is_continued {
            self.start_from_usual_effects();
        }
        let mut expanded = BTreeSet::new();
        // Beyond the wide ones only the best hypothesis is expanded: a search ends with one from which no step leads higher, or
        // after this number.
        while expanded.len() < MOST_EXPANSIONS {
            let Some(best) = self.best_score() else { break };
            let is_wide = expanded.len() < self.options.expansions;
            let least = if is_wide { best - self.selectivity.expansion } else { best };
            let near = self.ranked().into_iter().filter(|fit| fit.score >= least);
            let Some(fit) = near.into_iter().find(|fit| !expanded.contains(&fit.hypothesis)).cloned() else {
                // Another autoregression may have changed the ranks.
                self.polish();
                match self.ranked().first() {
                    Some(best) if !expanded.contains(&best.hypothesis) => continue,
                    _ => break,
                }
            };
            // All hypotheses that follow start from this mode, and from its autoregression.
            self.polish_one(&fit);
            let Some(fit) = self.fits.get(&fit.hypothesis).cloned() else { break };
            expanded.insert(fit.hypothesis.clone());
            self.expand(&fit);
        }
        self.polish();
        let Some(best) = self.best_score() else { return Vec::new() };
        let window = best - self.options.window;
        self.ranked().into_iter().filter(|fit| fit.score > window).cloned().collect()
    }

    /// Returns the fit without members.
    pub(crate) fn baseline(&self) -> Option<Fit> {
        self.fits.get(&Hypothesis::default()).cloned()
    }

    fn ranked(&self) -> Vec<&Fit> {
        let mut fits: Vec<&Fit> = self.fits.values().collect();
        fits.sort_by(|a, b| b.score.total_cmp(&a.score));
        fits
    }

    fn best_score(&self) -> Option<f64> {
        self.fits.values().map(|fit| fit.score).max_by(f64::total_cmp)
    }

    /// Fits a hypothesis unless it has been fitted.
    fn fit(&mut self, hypothesis: &Hypothesis, start: Start<'_>) -> Option<&Fit> {
        if !self.fits.contains_key(hypothesis) && !self.failed.contains(hypothesis) {
            self.fit_count += 1;
            match Fit::new(self.problem, hypothesis, start) {
                Some(fit) => drop(self.fits.insert(hypothesis.clone(), fit)),
                None => drop(self.failed.insert(hypothesis.clone())),
            }
        }
        self.fits.get(hypothesis)
    }

    /// Fits a hypothesis again from another mode, with its autoregression or with any, and keeps the
    /// better fit.
    fn fit_again(&mut self, hypothesis: &Hypothesis, start: &Fit, is_final: bool) {
        self.fit_count += 1;
        let start = Start { is_final, ..Start::at(start, None) };
        let Some(again) = Fit::new(self.problem, hypothesis, start) else { return };
        let known = self.fits.get(hypothesis).map_or(f64::NEG_INFINITY, |fit| fit.score);
        if again.score > known {
            self.fits.insert(hypothesis.clone(), again);
        }
    }

    /// Fits the best hypotheses of a search on some of the readings, if there are too many for a search on all; returns whether
    /// it did.
    fn continue_from_thinned(&mut self) -> bool {
        let Some(thinned) = Thinned::new(self.problem, self.options.thinned_above) else { return false };
        let excluded = thinned.select(self.excluded);
        let options = SearchOptions { thinned_above: usize::MAX, ..self.options };
        let mut search = Search::new(&thinned.problem, options, &excluded);
        let window = search.run();
        self.fit_count += search.fit_count;
        for fit in search.baseline().iter().chain(window.iter().take(MOST_POLISHED)) {
            let mode = thinned.extended(&fit.mode, self.excluded);
            let start = Start { mode: Some(&mode), hypothesis: Some(&fit.hypothesis), ..Start::default() };
            self.fit(&fit.hypothesis, start);
        }
        let is_continued = !self.fits.is_empty();
        if is_continued {
            self.selectivity = Selectivity::continued(self.problem.len());
        }
        is_continued
    }

    /// Fits the usual effects together, then removes them while the loss is small.
    fn start_from_usual_effects(&mut self) {
        let usual = self.problem.space.usual_effects.iter();
        let elements = usual.map(|effect| Element { member: Member::Effect(*effect), form: 0 });
        let hypothesis = Hypothesis::from_elements(elements);
        let start = Start { excluded: self.excluded, ..Start::default() };
        let Some(mut fit) = self.fit(&hypothesis, start).cloned() else { return };
        while !fit.hypothesis.is_empty() {
            let mut best: Option<Fit> = None;
            for member in fit.hypothesis.members().collect::<Vec<_>>() {
                let start = Start::at(&fit, None);
                let reduced = self.fit(&fit.hypothesis.without(member), start);
                if let Some(reduced) = reduced.filter(|r| best.as_ref().is_none_or(|b| r.score > b.score)) {
                    best = Some(reduced.clone());
                }
            }
            match best {
                Some(best) if best.score >= fit.score - THINNING_LOSS => fit = best,
                _ => break,
            }
        }
    }

    fn expand(&mut self, fit: &Fit) {
        let Some(scores) = Scores::new(self.problem, fit) else { return };
        let gross_errors = fit.hypothesis.members().filter(|member| self.is_gross_error(*member)).count();
        if fit.hypothesis.len() - gross_errors < self.options.members {
            self.add(fit, scores.additions(None));
            if self.selectivity.is_thorough {
                // Scatter that stands for missing structure hides it: the additions count again by the
                // noise of repeated readings.
                let quiet = fit.quiet(self.problem);
                let scores = quiet.as_ref().and_then(|quiet| Scores::new(self.problem, quiet));
                scores.into_iter().for_each(|scores| self.add(fit, scores.additions(None)));
                self.add_gross_errors(quiet.as_ref().unwrap_or(fit).clone());
            }
        }
        if !self.selectivity.is_thorough {
            return;
        }
        for element in fit.hypothesis.elements().collect::<Vec<_>>() {
            self.exchange(fit, element, &scores.additions(Some(element.member)));
        }
    }

    fn is_gross_error(&self, member: Member) -> bool {
        matches!(member, Member::Kernel(kernel) if self.problem.space.kernels[kernel].is_gross_error)
    }

    /// Adds gross errors one after the other by the noise of a fit, and fits every number of them: several wrong series hide
    /// each other in the scatter that they make, and in small weights of Student's t (forward search: Atkinson and Riani 2000).
    fn add_gross_errors(&mut self, mut fit: Fit) {
        if self.problem.space.kernels.iter().all(|kernel| !kernel.is_gross_error) {
            return;
        }
        fit.mode.weights.iter_mut().filter(|weight| **weight != EXCLUDED).for_each(|weight| *weight = 1.0);
        for _ in 0..self.options.members {
            let base = fit.hypothesis.log_prior_odds(&self.problem.space);
            let scores = Scores::of(self.problem, &fit, |member| self.is_gross_error(member));
            let additions = scores.map_or_else(Vec::new, |scores| scores.additions(None));
            let Some(addition) = additions.into_iter().next().filter(|a| a.score > base) else { break };
            let Member::Kernel(kernel) = addition.element.member else { break };
            fit.hypothesis = addition.hypothesis;
            fit.mode
                .log_sd
                .insert(Component::Kernel(kernel), libm::log(self.problem.space.kernels[kernel].scale));
            self.fit(&fit.hypothesis, Start::at(&fit, None));
        }
    }

    /// Fits the best additions of effects and structure.
    fn add(&mut self, fit: &Fit, additions: Vec<Addition>) {
        let additions: Vec<Addition> =
            additions.into_iter().filter(|addition| !self.is_gross_error(addition.element.member)).collect();
        let Some(top) = additions.first().map(|a| a.score) else { return };
        let base = fit.hypothesis.log_prior_odds(&self.problem.space);
        let usual = (top - self.selectivity.addition).min(base + self.selectivity.certain);
        let least = usual.max(base - self.selectivity.added_loss);
        let mut effects: Vec<Member> = Vec::new();
        let mut kernels: Vec<Member> = Vec::new();
        for addition in additions.iter().filter(|a| a.score > least) {
            let member = addition.element.member;
            let (members, most) = match member {
                Member::Effect(_) => (&mut effects, self.options.width),
                Member::Kernel(_) => (&mut kernels, (self.options.width / 2).max(2)),
            };
            if members.len() < most && !members.contains(&member) {
                members.push(member);
                self.fit(&addition.hypothesis, start_of(fit, addition));
            }
        }
        let least = (top - self.selectivity.form).max(base - 2.0);
        let mut forms: BTreeMap<Member, usize> = BTreeMap::new();
        for addition in additions.iter().filter(|a| a.score > least) {
            let member = addition.element.member;
            let count = forms.entry(member).or_insert(0);
            *count += 1;
            if *count <= MOST_FORMS && (effects.contains(&member) || kernels.contains(&member)) {
                self.fit(&addition.hypothesis, start_of(fit, addition));
            }
        }
    }

    /// Fits a hypothesis without a member, and the best exchanges of the member.
    fn exchange(&mut self, fit: &Fit, element: Element, exchanges: &[Addition]) {
        // The noise of the fit applies to the removed element too, whose gain is then its worth.
        let own = exchanges.iter().find(|exchange| exchange.element == element);
        let worth = own.map_or(0.0, |own| own.gain);
        let mut start = fit.clone();
        if worth < self.selectivity.loss {
            let reduced = fit.hypothesis.without(element.member);
            let Some(reduced) = self.fit(&reduced, Start::at(fit, None)) else { return };
            start = reduced.clone();
        }
        let mut others: Vec<&Addition> = exchanges.iter().filter(|e| e.element != element).collect();
        // Forms that the readings do not distinguish, such as intervals that differ by series without pins, gain the same.
        others.dedup_by(|a, b| a.element.member == b.element.member && a.gain.total_cmp(&b.gain).is_eq());
        let Some(top) = others.first().map(|a| a.score) else { return };
        let least = worth - self.selectivity.loss;
        for exchange in others.into_iter().take(EXCHANGES) {
            if exchange.score > top - self.selectivity.exchange && exchange.gain > least {
                self.fit(&exchange.hypothesis, start_of(&start, exchange));
            }
        }
    }

    /// Fits the hypotheses near the best one again from their own modes, and the best one without
    /// each member from the best mode, until none of these is better.
    fn polish(&mut self) {
        let Some(best) = self.best_score() else { return };
        let ranked = self.ranked().into_iter();
        let least = best - self.selectivity.polish;
        let near: Vec<Fit> = ranked.take(MOST_POLISHED).filter(|fit| fit.score > least).cloned().collect();
        for fit in &near {
            self.polish_one(fit);
        }
        // One without a member may be better, and is the best then.
        while let Some(best) = self.ranked().first().map(|fit| (*fit).clone()) {
            let before = self.reduced.insert(best.hypothesis.clone(), best.score);
            if before.is_some_and(|score| score.total_cmp(&best.score).is_eq()) {
                break;
            }
            for member in best.hypothesis.members() {
                let reduced = best.hypothesis.without(member);
                self.fit_again(&reduced, &best, false);
                let known = self.fits.get(&reduced);
                let is_far = known.is_none_or(|fit| fit.score < best.score - self.options.window);
                if self.selectivity.is_thorough
                    && is_far
                    && let Some(known) = known.cloned()
                {
                    self.polish_one(&known);
                }
            }
        }
    }

    /// Fits a hypothesis again from its own mode, unless that is where the last such fit ended.
    fn polish_one(&mut self, fit: &Fit) {
        if self.polished.get(&fit.hypothesis) == Some(&fit.score) {
            return;
        }
        self.fit_again(&fit.hypothesis, fit, true);
        let score = self.fits.get(&fit.hypothesis).map_or(f64::NEG_INFINITY, |fit| fit.score);
        self.polished.insert(fit.hypothesis.clone(), score);
    }

    /// Returns the fit of a hypothesis, if there is one.
    pub(crate) fn fit_of(&self, hypothesis: &Hypothesis) -> Option<&Fit> {
        self.fits.get(hypothesis)
    }
}

fn start_of<'a>(fit: &'a Fit, addition: &Addition) -> Start<'a> {
    Start::at(fit, addition.hint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_problem::problem;

    #[test]
    fn a_large_effect_wins() {
        let window = Search::new(&problem(12, 0.6), SearchOptions::default(), &[]).run();
        assert!(window[0].hypothesis.contains(Member::Effect(0)));
        assert_eq!(window[0].hypothesis.len(), 1);
    }

    #[test]
    fn nothing_wins_without_effects() {
        let window = Search::new(&problem(12, 0.0), SearchOptions::default(), &[]).run();
        assert!(window[0].hypothesis.is_empty());
    }
}
